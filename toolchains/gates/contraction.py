"""Checks that objects and archives contain no fused multiply-add, which rounds once where the source rounds twice.

usage: contraction.py (--objdump OBJDUMP | --tree TREE) FILE...

With --tree the files are in a build tree, which knows its objdump. Prints one line for each function that has such an instruction (x86, Arm, RISC-V, WebAssembly) and exits with 1 if there is one.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

import disassembly

FUNCTION = re.compile(r"[0-9a-f]+ <(.*)>:")
INSTRUCTION = re.compile(r"\s*[0-9a-f]+:\s+([a-z][\w.]*)")
CONDITION = r"(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?"
FUSED = re.compile(
    r"vfn?m(add|sub|addsub|subadd)\d+[ps][sdh]|fn?m(add|sub)(\.[sdh])?|fml[as]" rf"|vfn?m[as]{CONDITION}(\.f\d+)?"
    r"|f\d+x\d+\.(relaxed_n?madd|qfm[as])"
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    tool = parser.add_mutually_exclusive_group(required=True)
    tool.add_argument("--objdump")
    tool.add_argument("--tree", type=Path)
    parser.add_argument("files", nargs="+", metavar="FILE")
    arguments = parser.parse_args()
    objdump, files = arguments.objdump, arguments.files
    if arguments.tree:
        objdump = disassembly.objdump_of(arguments.tree)
        files = [str(arguments.tree / file) for file in files]

    instructions = 0
    breaches: dict[str, str] = {}
    for file in files:
        listing = subprocess.run(
            [objdump, "--disassemble", "--no-show-raw-insn", file], capture_output=True, text=True, check=True
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
