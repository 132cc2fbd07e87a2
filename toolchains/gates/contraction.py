"""Checks that objects and archives contain no fused multiply-add, which rounds once where the source rounds twice.

usage: contraction.py --objdump OBJDUMP FILE...

Prints one line for each function that has such an instruction (x86, Arm, RISC-V) and exits with 1 if there is one.
"""

import argparse
import re
import subprocess
import sys

FUNCTION = re.compile(r"[0-9a-f]+ <(.*)>:")
INSTRUCTION = re.compile(r"\s*[0-9a-f]+:\s+([a-z][\w.]*)")
CONDITION = r"(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?"
FUSED = re.compile(
    r"vfn?m(add|sub|addsub|subadd)\d+[ps][sdh]|fn?m(add|sub)(\.[sdh])?|fml[as]" rf"|vfn?m[as]{CONDITION}(\.f\d+)?"
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--objdump", required=True)
    parser.add_argument("files", nargs="+", metavar="FILE")
    arguments = parser.parse_args()

    instructions = 0
    breaches: dict[str, str] = {}
    for file in arguments.files:
        listing = subprocess.run(
            [arguments.objdump, "--disassemble", "--no-show-raw-insn", file], capture_output=True, text=True, check=True
        ).stdout
        function = ""
        for line in listing.splitlines():
            if match := FUNCTION.match(line):
                function = f"{file.rsplit('/', 1)[-1]}: {match[1]}"
            elif match := INSTRUCTION.match(line):
                instructions += 1
                if FUSED.fullmatch(match[1]):
                    breaches.setdefault(function, match[1])
    for function, instruction in breaches.items():
        print(f"{function} has {instruction}")
    print(f"{instructions} instructions, {len(breaches)} functions with a fused multiply-add")
    if instructions == 0:
        sys.exit("contraction: nothing was disassembled")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
