"""How often each line and each branch ran: what gcov says of all objects of a tree, added up by source."""

import json
import subprocess
from collections import Counter, defaultdict
from pathlib import Path
from typing import Iterable, NamedTuple

# Of a report of gcov as JSON.
Report = dict
BATCH = 40  # Objects that one gcov reads.


class Branch(NamedTuple):
    line: int
    count: int


class Source:
    """The counts of one file. Many objects hold the same inline function, and templates are many functions on the same lines: each
    branch counts once, wherever it ran."""

    def __init__(self) -> None:
        self.lines: Counter = Counter()
        # By line, by where the function begins, and by how many branches of it the line has: `if constexpr` leaves out some.
        self._branches: dict[tuple, list[int]] = {}

    def add(self, line: int, count: int, function: object, branches: list[int]) -> None:
        self.lines[line] += count
        if branches:
            sums = self._branches.setdefault((line, function, len(branches)), [0] * len(branches))
            for at, branch in enumerate(branches):
                sums[at] += branch

    @property
    def branches(self) -> list[Branch]:
        """In the order of their lines."""
        keys = sorted(self._branches, key=lambda key: (key[0], str(key[1:])))
        return [Branch(key[0], count) for key in keys for count in self._branches[key]]

    @property
    def lines_run(self) -> int:
        return sum(1 for count in self.lines.values() if count > 0)

    @property
    def branches_run(self) -> int:
        return sum(1 for branch in self.branches if branch.count > 0)

    def branches_left(self) -> dict[int, int]:
        """How many branches of a line never ran, for lines where there are any."""
        return Counter(branch.line for branch in self.branches if branch.count == 0)


def of_choices(branches: list[dict]) -> list[int]:
    """The counts of branches that the source decides: a call that may throw has a pair of its own, which goes."""
    kept: list[dict] = []
    at = 0
    while at < len(branches):
        if not branches[at]["throw"]:
            kept.append(branches[at])
        elif kept and kept[-1]["fallthrough"]:
            kept.pop()
        else:
            at += 1  # The pair the other way round.
        at += 1
    return [branch["count"] for branch in kept]


def add_report(sources: dict[str, Source], report: Report, root: Path) -> None:
    """Adds what a report says of files below `root`, which get their path from there."""
    for file in report["files"]:
        path = Path(report["current_working_directory"], file["file"]).resolve()
        if not path.is_relative_to(root):
            continue
        source = sources[path.relative_to(root).as_posix()]
        begins = {function["name"]: (function["start_line"], function["start_column"]) for function in file["functions"]}
        for line in file["lines"]:
            begin = begins.get(line.get("function_name"))
            source.add(line["line_number"], line["count"], begin, of_choices(line["branches"]))


def reports_of(gcov: str, objects: list[Path]) -> Iterable[Report]:
    """What gcov says of objects, which it finds by what the compiler wrote beside them (.gcno)."""
    for first in range(0, len(objects), BATCH):
        command = [gcov, "--json-format", "--stdout", "--branch-probabilities", *map(str, objects[first : first + BATCH])]
        output = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
        for line in output.splitlines():
            if line.strip():
                yield json.loads(line)


def counts_of_tree(gcov: str, tree: Path, root: Path) -> dict[str, Source]:
    sources: dict[str, Source] = defaultdict(Source)
    for report in reports_of(gcov, sorted(tree.rglob("*.gcno"))):
        add_report(sources, report, root)
    return dict(sources)
