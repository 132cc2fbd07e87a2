"""Says which lines and branches of the product the tests of the PC run, and keeps the table of it in host_tests/README.md.

usage: coverage.py [--run] [--write | --check] [--tree TREE] [--gcov GCOV] [--ctest CTEST] [--jobs N]
                   [--tests EXPRESSION] [--leave-out EXPRESSION] [--left FILE]

TREE is a tree of the preset `coverage`, already built. --run sets its counts to zero and runs the tests; without it, the
counts are those of the last run. Prints a table of the areas, and writes each branch that never ran to FILE
(TREE/left.txt), but for those that uncovered.txt lists with the reason. --write puts the table of all files into the
README; --check exits with 1 if that table is another one. The exit status is 1, too, if a test failed, or an entry of
uncovered.txt does not fit any more.
"""

import argparse
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from counts import Source, counts_of_tree

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "toolchains" / "gates"))
import tables  # noqa: E402

README = ROOT / "host_tests" / "README.md"
UNCOVERED = Path(__file__).with_name("uncovered.txt")
AREAS = ["algo", "hal", "firmware/app", "firmware/boards/host", "firmware/desk"]
TABLE = "coverage"
HEAD = ["file", "lines", "run", "branches", "run", "listed", "left", "run or listed"]
# Take minutes each, for the sake of their many numbers.
LONG = r"[.](Coverage|OpenDamping|Devices)[.]"


class Entry(NamedTuple):
    """Branches that no test can or should run."""

    path: str
    count: int
    text: str  # Of the line, without its indentation.
    reason: str


class Row(NamedTuple):
    name: str
    lines: int
    lines_run: int
    branches: int
    branches_run: int
    listed: int

    @property
    def cells(self) -> list[str]:
        left = self.branches - self.branches_run - self.listed
        share = f"{100.0 * (self.branches - left) / self.branches:.1f} %" if self.branches else ""
        return [self.name, *map(tables.grouped, self[1:]), tables.grouped(left), share]


class Result(NamedTuple):
    rows: dict[str, list[Row]]  # Of each area.
    left: list[str]  # Branches that never ran and are not listed, a line each.
    stale: list[str]  # Entries that do not fit.


def read_entries(text: str) -> list[Entry]:
    entries = []
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip() and not line.startswith("#"):
            match = re.fullmatch(r"(\S+) \| (\d+) \| (.+) \| (.+?)", line)
            if match is None:
                sys.exit(f"{UNCOVERED.name}:{number}: expected 'PATH | branches | text of the line | reason'")
            entries.append(Entry(match[1], int(match[2]), match[3], match[4]))
    return entries


def judge_file(path: str, source: Source, text: list[str], entries: list[Entry]) -> tuple[Row, list[str], list[str]]:
    """The row of a file, its branches that are left, and entries that do not fit: with no such line, or with more branches
    than never ran on all lines of that text together."""
    allowed: Counter = Counter()
    for entry in entries:
        allowed[entry.text] += entry.count
    listed, left = 0, []
    for line, count in sorted(source.branches_left().items()):
        words = text[line - 1].strip()
        taken = min(count, allowed[words])
        allowed[words] -= taken
        listed += taken
        if count > taken:
            left.append(f"{path}:{line}: {count - taken} | {words}")
    stale = [f"{path} | {words}: {count} more than never ran" for words, count in allowed.items() if count > 0]
    row = Row(path, len(source.lines), source.lines_run, len(source.branches), source.branches_run, listed)
    return row, left, stale


def judge(sources: dict[str, Source], entries: list[Entry], root: Path) -> Result:
    result = Result({area: [] for area in AREAS}, [], [])
    for path in sorted(sources):
        area = next((area for area in AREAS if path.startswith(area + "/")), None)
        if area is not None:
            text = (root / path).read_text().splitlines()
            row, left, stale = judge_file(path, sources[path], text, [entry for entry in entries if entry.path == path])
            result.rows[area].append(row)
            result.left.extend(left)
            result.stale.extend(stale)
    result.stale.extend(f"{entry.path}: no such file has run" for entry in entries if entry.path not in sources)
    return result


def total(name: str, rows: list[Row]) -> Row:
    return Row(name, *(sum(column) for column in list(zip(*rows))[1:]))


def markdown(rows: list[Row]) -> str:
    lines = [HEAD, ["---", *["---:"] * (len(HEAD) - 1)], *(row.cells for row in rows)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def table_of(result: Result) -> str:
    """The sums of the areas, then each area's files."""
    totals, files = [], []
    for area, rows in result.rows.items():
        if rows:
            totals.append(total(f"**{area}**", rows))
            files.extend(row._replace(name=f"`{row.name}`") for row in rows)
    return f"{markdown(totals)}\n\n{markdown(files)}"


def run_tests(ctest: str, tree: Path, jobs: int, tests: str, left_out: str) -> bool:
    for file in tree.rglob("*.gcda"):
        file.unlink()
    command = [ctest, "--test-dir", str(tree), "--output-on-failure", "--progress", f"-j{jobs}", "-R", tests or ".", "-E", left_out]
    return subprocess.run(command, check=False).returncode == 0


def report(result: Result, file: Path) -> None:
    totals = [total(area, rows) for area, rows in result.rows.items() if rows]
    for cells in [HEAD, *(row.cells for row in totals)]:
        print(f"{cells[0]:22}" + "".join(f"{cell:>14}" for cell in cells[1:]))
    file.write_text("".join(line + "\n" for line in result.left))
    print(f"{len(result.left)} lines have branches that never ran: {file}")
    for line in result.stale:
        print(f"{UNCOVERED.name}: {line}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", action="store_true", help="run the tests before")
    action = parser.add_mutually_exclusive_group()
    action.add_argument("--write", action="store_true", help="write the table")
    action.add_argument("--check", action="store_true", help="compare the table")
    parser.add_argument("--tree", type=Path, default=ROOT / "build" / "coverage")
    parser.add_argument("--gcov", default="gcov", help="of the compiler's release")
    parser.add_argument("--ctest", default="ctest")
    parser.add_argument("--jobs", type=int, default=2, help="tests at a time, %(default)s")
    parser.add_argument("--tests", default="", help="only tests whose names have this expression in them")
    parser.add_argument("--leave-out", default=LONG, help="but not these; default: %(default)s")
    parser.add_argument("--left", type=Path)
    arguments = parser.parse_args()

    tree = arguments.tree.resolve()
    passed = not arguments.run or run_tests(
        arguments.ctest, tree, arguments.jobs, arguments.tests, arguments.leave_out
    )
    sources = counts_of_tree(arguments.gcov, tree, ROOT)
    if not any(path.startswith(f"{area}/") for path in sources for area in AREAS):
        sys.exit(f"{tree}: nothing has been counted; build it with the preset `coverage`")
    result = judge(sources, read_entries(UNCOVERED.read_text()), ROOT)
    report(result, arguments.left or tree / "left.txt")
    if arguments.write:
        tables.replace(str(README), TABLE, table_of(result))
        print(f"{README}: table written")
    changed = arguments.check and tables.text(str(README), TABLE).strip() != table_of(result)
    if changed:
        print(f"{README}: the table is another one; --write writes it")
    return 1 if changed or result.stale or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
