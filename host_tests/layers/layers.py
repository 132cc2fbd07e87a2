"""Checks every #include of the tree against layers.txt, the table of who may include whom.

usage: layers.py ROOT TABLE
Prints a line for each include that the table does not permit, for each source or header that no row covers, for each
name between quotes that is no file of the tree, and for each row that names what does not stand above it. Exit status
1 if there is any.
"""

import re
import sys
from pathlib import Path, PurePosixPath

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<(emax/[^>]+)>)', re.MULTILINE)
# What the compiler's search path takes off the name of a file.
SEARCHED = re.compile(r"^.*/include/|^firmware/(?=desk/)|^host_tests/")
# What a file's path has more than the name of its folder in the table.
WRAPPING = re.compile(r"/(?:include/emax(?:/(?:app|hal|sim|board))?|src)(?=/)")


def read_table(text: str) -> tuple[dict[str, set[str]], list[str]]:
    """The rows, each with the rows that it may include, and what is wrong with them."""
    table: dict[str, set[str]] = {}
    problems = []
    for line in text.splitlines():
        name, *permitted = line.partition("#")[0].split() or [""]
        if not name:
            continue
        above = set()
        for entry in permitted:
            rows = {row for row in table if row == entry or (entry.endswith("/*") and row.startswith(entry[:-1]))}
            if not rows:
                problems.append(f"the table: {name} names {entry}, which does not stand above it")
            above |= rows
        table[name] = above | {name}
    return table, problems


def row_of(file: str, table: dict[str, set[str]]) -> str:
    """The longest row that covers a file, or nothing."""
    return next((str(row) for row in PurePosixPath(WRAPPING.sub("", file)).parents if str(row) in table), "")


def check(root: Path, table_text: str) -> list[str]:
    """All that is wrong, a line each."""
    table, problems = read_table(table_text)
    tops = sorted({row.split("/")[0] for row in table})
    paths = [path for top in tops for path in (root / top).rglob("*") if path.suffix in (".hpp", ".cpp")]
    files = {path.relative_to(root).as_posix(): path for path in sorted(paths)}
    found: dict[str, set[str]] = {}
    for file in files:
        for name in (SEARCHED.sub("", file), PurePosixPath(file).name):
            found.setdefault(name, set()).add(file)

    for file, path in files.items():
        row = row_of(file, table)
        if not row:
            problems.append(f"{file}: no row of the table covers its folder")
            continue
        for quoted, bracketed in INCLUDE.findall(path.read_text(encoding="utf-8")):
            include = quoted or bracketed
            neighbour = (PurePosixPath(file).parent / include).as_posix()
            targets = {neighbour} if neighbour in files else found.get(include, set())
            if not targets:
                problems.append(f"{file}: {include} is no file of the tree")
            for other in sorted({row_of(target, table) for target in targets} - table[row] - {""}):
                problems.append(f"{file}: {row} may not include {include} of {other}")
    return problems if files else ["no files"]


def main() -> int:
    root, table = map(Path, sys.argv[1:])
    problems = check(root, table.read_text(encoding="utf-8"))
    print("\n".join(problems) or "every include points the way that the table permits")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
