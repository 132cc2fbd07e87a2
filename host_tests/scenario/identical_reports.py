"""Runs one command of several builds of `emax` and demands the same bytes from all of them.

usage: identical_reports.py NAME=PROGRAM... -- ARGUMENT...

The first program is the reference and runs twice. A PROGRAM "RUNNER... IMAGE" is an image and what runs it, which get
the same arguments.
"""

import shlex
import subprocess
import sys


def main() -> int:
    split = sys.argv.index("--")
    programs = [entry.split("=", 1) for entry in sys.argv[1:split]]
    arguments = sys.argv[split + 1 :]

    reference_name, reference_program = programs[0]
    reference = run(reference_name, reference_program, arguments)
    if not reference:
        sys.exit(f"{reference_name} printed nothing")
    lines = reference.count(b"\n")

    different = 0
    for name, program in [(f"{reference_name}, run again", reference_program), *programs[1:]]:
        output = run(name, program, arguments)
        if output == reference:
            print(f"{name}: the same {len(output)} bytes, {lines} lines, as {reference_name}")
            continue
        different += 1
        number, expected, got = first_difference(reference, output)
        print(f"{name}: differs from {reference_name} at line {number}")
        print(f"  {reference_name}: {expected}")
        print(f"  {name}: {got}")
    return 1 if different else 0


def run(name: str, program: str, arguments: list[str]) -> bytes:
    result = subprocess.run([*shlex.split(program), *arguments], capture_output=True, check=False)
    if result.returncode != 0:
        message = result.stderr.decode(errors="replace")
        sys.exit(f"{name}: exit status {result.returncode} from {' '.join(arguments)}\n{message}")
    return result.stdout


def first_difference(expected: bytes, got: bytes) -> tuple[int, str, str]:
    """Line number, and that line of both; a line that one lacks reads '(no such line)'."""
    left = expected.splitlines(keepends=True)
    right = got.splitlines(keepends=True)
    for index in range(max(len(left), len(right))):
        pair = [lines[index] if index < len(lines) else None for lines in (left, right)]
        if pair[0] != pair[1]:
            shown = ["(no such line)" if line is None else line.decode(errors="replace").rstrip("\n") for line in pair]
            return index + 1, shown[0], shown[1]
    raise ValueError("the outputs are equal")


if __name__ == "__main__":
    sys.exit(main())
