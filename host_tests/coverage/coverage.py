"""Runs the test programs of the PC on a build that counts, and prints how much of each source file they reach.

usage: coverage.py [--areas AREA...] [--work FOLDER] [--jobs N] [--branches]

Builds algo, hal, app and desk with gcc's counters in FOLDER (build/coverage), which takes minutes, runs the test
programs of the areas, and prints a table: lines and branches of each file, and how many of them were never reached.
Branches that only an exception takes are not counted. --branches also lists each branch that was not taken.
"""

import argparse
import json
import os
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[2]
# The sources of an area, and its library's target.
AREAS = {
    "algo": ("algo/", "emax_algo"),
    "hal": ("hal/src/", "emax_hal"),
    "app": ("firmware/app/", "emax_app"),
    "desk": ("firmware/desk/", "emax_desk"),
}
OPTIONS = [
    *("-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_COMPILER=g++"),
    "-DCMAKE_CXX_FLAGS_RELEASE=-O0 --coverage -fprofile-update=atomic",
    *("-DEMAX_TESTS=ON", "-DEMAX_CONFIGURATION=coverage", "-DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST"),
]
LIMIT_S = 1800.0


class Reached(NamedTuple):
    """Of one file, by line: how often it ran, and how often each of its branches was taken."""

    lines: "dict[int, int]"
    branches: "dict[tuple[int, int], int]"


def programs(build: Path, areas: list[str]) -> list[str]:
    listing = subprocess.run(["ninja", "-C", str(build), "-t", "targets", "all"],
                             capture_output=True, text=True, check=True).stdout
    folders = "|".join(areas)
    return sorted(set(re.findall(rf"^(host_tests/(?:{folders})/test_\w+): CXX_EXECUTABLE_LINKER", listing, re.MULTILINE)))


def counters(build: Path) -> list[Path]:
    return sorted(file for file in build.rglob("*.gcda") if "host_tests" not in file.parts)


def read(build: Path, prefixes: list[str]) -> dict[str, Reached]:
    """What gcov says of the sources that begin with one of these."""
    found: dict[str, Reached] = defaultdict(lambda: Reached(defaultdict(int), defaultdict(int)))
    for counter in counters(build):
        text = subprocess.run(
            ["gcov", "--json-format", "--stdout", "--branch-probabilities", str(counter)],
            capture_output=True, text=True, check=True, cwd=build,
        ).stdout
        for document in text.splitlines():
            for file in json.loads(document)["files"]:
                path = os.path.relpath(os.path.join(build, file["file"]), ROOT)
                if path.startswith(tuple(prefixes)):
                    add(found[path], file["lines"])
    return dict(found)


def add(reached: Reached, lines: list[dict]) -> None:
    for line in lines:
        reached.lines[line["line_number"]] += line["count"]
        for at, branch in enumerate(line["branches"]):
            if not branch["throw"]:
                reached.branches[line["line_number"], at] += branch["count"]


def share(counts: list[int]) -> str:
    return f"{sum(1 for count in counts if count) / len(counts):.1%}" if counts else "-"


def row(title: str, files: list[Reached]) -> str:
    lines = [count for file in files for count in file.lines.values()]
    branches = [count for file in files for count in file.branches.values()]
    return (f"| {title} | {len(lines)} | {lines.count(0)} | {share(lines)} "
            f"| {len(branches)} | {branches.count(0)} | {share(branches)} |")


def table(found: dict[str, Reached], areas: list[str]) -> str:
    rows = ["| file | lines | not run | | branches | not taken | |", "|---|---:|---:|---:|---:|---:|---:|"]
    for area in areas:
        files = {path: file for path, file in sorted(found.items()) if path.startswith(AREAS[area][0])}
        rows += [row(f"`{path}`", [file]) for path, file in files.items()]
        rows.append(row(f"**{area}**", list(files.values())))
    return "\n".join(rows)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--areas", nargs="+", choices=list(AREAS), default=list(AREAS))
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "coverage")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--branches", action="store_true")
    arguments = parser.parse_args()

    build = arguments.work.resolve()
    if not (build / "build.ninja").is_file():
        subprocess.run(["cmake", "-S", str(ROOT), "-B", str(build), *OPTIONS], check=True, stdout=subprocess.DEVNULL)
    tests = programs(build, arguments.areas)
    subprocess.run(["ninja", "-C", str(build), f"-j{arguments.jobs}", *tests], check=True, stdout=subprocess.DEVNULL)
    for counter in build.rglob("*.gcda"):
        counter.unlink()
    for test in tests:
        result = subprocess.run([str(build / test), "--gtest_brief=1"], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL, cwd=build, timeout=LIMIT_S, check=False)
        if result.returncode != 0:
            print(f"{test} fails: what it reaches is counted all the same", file=sys.stderr)
    found = read(build, [AREAS[area][0] for area in arguments.areas])
    print(table(found, arguments.areas))
    if arguments.branches:
        for path, file in sorted(found.items()):
            for (line, at), count in sorted(file.branches.items()):
                if count == 0:
                    print(f"{path}:{line} branch {at}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
