"""What each image may take, from toolchains/budgets.txt."""

import fnmatch
import sys
from pathlib import Path

COLUMNS = ("flash", "ram", "stack")


def read(path: str) -> dict[str, dict[str, int]]:
    found = {}
    for number, line in enumerate(Path(path).read_text().splitlines(), 1):
        fields = line.partition("#")[0].split()
        if not fields:
            continue
        if len(fields) != 1 + len(COLUMNS) or not all(field.isdigit() for field in fields[1:]):
            sys.exit(f"{path}:{number}: expected '<image> <{'> <'.join(COLUMNS)}>', in bytes")
        found[fields[0]] = dict(zip(COLUMNS, map(int, fields[1:])))
    return found


def judge(path: str, image: str, used: dict[str, int]) -> list[str]:
    """Prints what is left of each budget, and returns what is over."""
    limits = next((limits for pattern, limits in read(path).items() if fnmatch.fnmatchcase(image, pattern)), None)
    if limits is None:
        sys.exit(f"{path} has no line for {image}")
    over = []
    for what, taken in used.items():
        left = limits[what] - taken
        print(f"{what}: {taken} of {limits[what]} bytes, {left} left")
        if left < 0:
            over.append(f"{what} is {-left} bytes over its budget")
    return over
