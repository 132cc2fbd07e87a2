"""Shows that each gate lets a good image pass and refuses each deliberately bad one, with the complaint that names it.

usage: test_images.py --gates FOLDER --objdump OBJDUMP --levels HANDLERS... --callgraph FOLDER... --images IMAGE...

The call graphs are those of the libraries; each image's own is beside its object.
"""

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

GOOD = "good_image"
TIGHT = "tight_image"  # The good one under a name that has hardly any budget.

# Bytes of flash, RAM and stack: enough for the good one, and none under the other name of it.
BUDGETS = {GOOD: ("65536", "32768", "8192"), TIGHT: ("100", "100", "100")}
BUDGET_OF_BAD_ONES = ("196608", "122880", "8192")

# On a Cortex-M priorities decide it, and the stacks add up; on RISC-V the handler itself.
NESTING = r"stack is \d+ bytes over its budget|bad_interrupt\(\) lets interrupts interrupt one another"

# Image, gate and a part of the line that it must be refused with.
REFUSED = [
    ("bad_array", "stack", "main() has an array on the stack whose size only the running program knows"),
    ("bad_contraction", "contraction", "_Z15bad_contractionfff has "),
    ("bad_depth", "stack", "bytes over its budget"),
    ("bad_exception", "symbols", "has __cxa_throw: exceptions"),
    ("bad_growth", "stack", "main() moves the stack by an amount that is not known"),
    ("bad_heap", "symbols", "has _Znwj: heap"),
    ("bad_hidden_depth", "stack", "bytes over its budget"),
    ("bad_initialiser", "symbols", "has section .init_array, 4 bytes: code that runs before main"),
    ("bad_libm", "symbols", "has exp: libm"),
    ("bad_member_pointer", "stack", "{anonymous}::Step::again(int) calls something through a pointer in line "),
    ("bad_nesting", "stack", NESTING),
    ("bad_operator_new", "symbols", "has _ZN12_GLOBAL__N_114BadOperatorNewnwEj: heap"),
    ("bad_pointer", "stack", "main() calls bad_pointer through a pointer in line 11"),
    ("bad_pointer", "stack", "something points at {anonymous}::bad_target(), which no known call reaches"),
    ("bad_recursion", "stack", "recursion: {anonymous}::bad_recursion(int) -> {anonymous}::bad_detour(int)"),
    ("bad_semihosting", "symbols", "calls a debugger in "),
    ("bad_static", "symbols", "has _ZGVZ10bad_staticiE5first: guard of a function-local static"),
    ("bad_stdio", "symbols", "has printf: stdio"),
    ("bad_thread_local", "symbols", ": thread-local storage"),
    ("bad_virtual_recursion", "stack", "recursion: {anonymous}::BadStep::take(int) -> {anonymous}::BadStep::take(int)"),
    (TIGHT, "footprint", "flash is "),
    (TIGHT, "footprint", "ram is "),
    (TIGHT, "stack", "stack is "),
]


class Gates:
    def __init__(self, arguments: argparse.Namespace, calls: str):
        self.arguments = arguments
        self.calls = calls
        self.built = {Path(image).name: Path(image) for image in arguments.images}
        self.built[TIGHT] = self.built[GOOD]

    def command(self, gate: str, image: Path) -> list[str]:
        built = self.built[image.name]
        objects = built.parent / "CMakeFiles" / f"{built.stem}.dir"
        objdump = ["--objdump", self.arguments.objdump]
        budget = ["--budget", *BUDGETS.get(image.name, BUDGET_OF_BAD_ONES)]
        return {
            "symbols": ["image_symbols.py", *objdump, str(image)],
            "contraction": ["contraction.py", *objdump, str(objects / f"{built.stem}.cpp.obj")],
            "footprint": ["footprint.py", *budget, str(image)],
            "stack": [
                *("stack.py", *objdump, *budget, "--calls", self.calls, "--levels", *self.arguments.levels),
                *("--callgraph", *self.arguments.callgraph, str(objects), "--image", str(image)),
            ],
        }[gate]

    def run(self, gate: str, image: Path) -> "subprocess.CompletedProcess[str]":
        script, *rest = self.command(gate, image)
        command = [sys.executable, "-B", str(Path(self.arguments.gates) / script), *rest]
        return subprocess.run(command, capture_output=True, text=True, check=False)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gates", required=True)
    parser.add_argument("--objdump", required=True)
    parser.add_argument("--levels", nargs="*", default=[])
    parser.add_argument("--callgraph", nargs="+", required=True)
    parser.add_argument("--images", nargs="+", required=True)
    arguments = parser.parse_args()

    with tempfile.TemporaryDirectory() as folder:
        calls = Path(folder) / "calls.txt"
        calls.write_text("memset -> itself\n")
        images = {Path(image).name: Path(image) for image in arguments.images}
        images[TIGHT] = Path(folder) / TIGHT
        shutil.copy(images[GOOD], images[TIGHT])
        failures = check(Gates(arguments, str(calls)), images)
    for name in sorted(set(images) - {GOOD} - {image for image, _, _ in REFUSED}):
        print(f"{name}: nothing is expected of it")
        failures += 1
    return 1 if failures else 0


def is_it(complaint: str, line: str) -> bool:
    return re.search(NESTING, line) is not None if complaint == NESTING else complaint in line


def check(gates: Gates, images: dict[str, Path]) -> int:
    failures = 0
    for gate in ("symbols", "contraction", "footprint", "stack"):
        result = gates.run(gate, images[GOOD])
        print(f"{GOOD} passes {gate}: {'yes' if result.returncode == 0 else 'NO'}")
        if result.returncode != 0:
            failures += 1
            print(result.stdout + result.stderr)
    for name, gate, complaint in REFUSED:
        result = gates.run(gate, images[name])
        lines = result.stdout.splitlines()
        if result.returncode == 1 and any(is_it(complaint, line) for line in lines):
            print(f"{name} is refused by {gate}: {complaint}")
            continue
        failures += 1
        print(f"{name}: exit status {result.returncode} of {gate}, and no '{complaint}' in:")
        print(result.stdout + result.stderr)
    return failures


if __name__ == "__main__":
    sys.exit(main())
