"""Shows that the READMEs describe the wings of layers.txt, and that every file they name by its wing is there.

usage: test_readmes.py ROOT TABLE
"""

import re
import sys
from pathlib import Path

from layers import read_table

# An area's README, what its rows in the table begin with, and where its headers are.
AREAS = [
    ("algo/README.md", "algo/", "algo/include/emax"),
    ("firmware/README.md", "firmware/app/", "firmware/app/include/emax/app"),
]
WING = re.compile(r"^\| `([a-z]+)/` \|", re.MULTILINE)
FILE = re.compile(r"`([a-z]+)/([a-z0-9_]+)`")


def main() -> int:
    root, table_file = map(Path, sys.argv[1:])
    table, problems = read_table(table_file.read_text(encoding="utf-8"))
    for readme, prefix, headers in AREAS:
        text = (root / readme).read_text(encoding="utf-8")
        wings = {row.removeprefix(prefix) for row in table if row.startswith(prefix)}
        described = set(WING.findall(text))
        problems += [f"{readme}: no row for the wing {wing}/" for wing in sorted(wings - described)]
        problems += [f"{readme}: {wing}/ is no wing of the table" for wing in sorted(described - wings)]
        for wing, name in FILE.findall(text):
            if wing in wings and not (root / headers / wing / f"{name}.hpp").is_file():
                problems.append(f"{readme}: {wing}/{name} is no header of {headers}")
    print("\n".join(problems) or "the READMEs describe every wing, and every file that they name is there")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
