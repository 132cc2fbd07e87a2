"""Checks that a linked image has nothing in it that a microcontroller should not carry.

usage: image_symbols.py (--objdump OBJDUMP | --tree TREE) [--semihosting] IMAGE

Refused are the heap, exceptions, stdio, libm and the C library's state, guards of function-local statics, code that
runs before main or after it, thread-local storage, and calls to a debugger (semihosting), which stop a processor that
has none attached; --semihosting permits the last to test images. Prints one line for each breach and exits with 1 if
there is one.
"""

import argparse
import sys
from pathlib import Path

from disassembly import disassemble, objdump_of
from image import Image
from symbols import DEFINED, FAMILIES, SECTIONS, meaning

LINKED = [
    (r"_?_?(malloc|calloc|realloc|free|sbrk)(_r|_lock|_unlock)?|_Zn[wa].*|_Zd[la].*", "heap"),
    (r"__cxa_.*|__(gnu|aeabi)_unwind_.*|__gnu_Unwind_.*|__(de)?register_frame.*", "exceptions"),
    (r"(exit|abort|raise|signal|atexit|_exit|_kill|_getpid)(_r)?", "the end of a process"),
    (r"_(global_)?impure_ptr|_reclaim_reent|__s(init|flush|write|read|seek|close)|__sf", "state of the C library"),
    *FAMILIES,
    *DEFINED,
]
EMPTY = [*SECTIONS, (r"\.eh_frame|\.ARM\.extab(\..*)?", "exception tables")]

# What gcc puts into the vtables of interfaces; the boards have their own, which stops.
PURE_VIRTUAL = "__cxa_pure_virtual"

ARM_SEMIHOSTING = ("bkpt", "0x00ab")
RISCV_SEMIHOSTING = ["slli zero,zero,0x1f", "ebreak", "srai zero,zero,0x7"]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    tool = parser.add_mutually_exclusive_group(required=True)
    tool.add_argument("--objdump")
    tool.add_argument("--tree", type=Path, help="a build tree, which knows its objdump")
    parser.add_argument("--semihosting", action="store_true")
    parser.add_argument("image")
    arguments = parser.parse_args()

    image = Image(arguments.image)
    names = {symbol.name for symbol in image.symbols if symbol.name}
    if not names:
        sys.exit(f"image_symbols: {image.path} has no symbols; nothing was checked")
    complaints = breaches(image, names)
    if not arguments.semihosting:
        complaints += debugger_calls(image, arguments.objdump or objdump_of(arguments.tree))
    for complaint in complaints:
        print(f"{image.name}: {complaint}")
    print(f"{image.name}: {len(names)} symbols, {len(complaints)} breaches")
    return 1 if complaints else 0


def breaches(image: Image, names: set[str]) -> list[str]:
    complaints = []
    for name in sorted(names - {PURE_VIRTUAL}):
        if reason := meaning(LINKED, name):
            complaints.append(f"has {name}: {reason}")
    for section in image.sections:
        if section.is_allocated and section.size > 0 and (reason := meaning(EMPTY, section.name)):
            complaints.append(f"has section {section.name}, {section.size} bytes: {reason}")
    return complaints


def debugger_calls(image: Image, objdump: str) -> list[str]:
    found = []
    for code in disassemble(objdump, image):
        lines = [" ".join(f"{i.mnemonic} {i.operands}".split()) for i in code.instructions]
        if image.is_arm:
            calls = sum(1 for line in lines if line.split() == list(ARM_SEMIHOSTING))
        else:
            calls = sum(1 for at in range(len(lines)) if is_riscv_call(lines[at : at + 3]))
        if calls:
            found.append(f"calls a debugger in {code.label}")
    return found


def is_riscv_call(lines: list[str]) -> bool:
    shifts = [line.replace("sll ", "slli ").replace("sra ", "srai ") for line in lines]
    return shifts == RISCV_SEMIHOSTING


if __name__ == "__main__":
    sys.exit(main())
