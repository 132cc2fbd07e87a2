"""Changes one place of the sources at a time, and says which changes no test notices.

usage: mutate.py [--seed N] [--minutes N] [--most N] [--areas AREA...] [--file PATH...] [--list FILE] [--tests EXPRESSION]
                 [--work FOLDER] [--jobs N]

Works on a copy of the tree in FOLDER (build/mutation), which it builds there; the tree itself is only read. Takes the
places in the order that the seed gives, as many as fit into the minutes. --list takes the changes of a report instead,
each a line "survived PATH:LINE kind | text of the line => other text"; lines that have moved are found by their text.
Prints a line for each change, and at the end the share that was noticed. equivalents.txt lists changes that change
nothing, with the reason: they are not made.
"""

import argparse
import random
import re
import sys
import time
from pathlib import Path
from typing import Iterator, NamedTuple

from bench import AREAS, Bench
from changes import changed_line, changes_of, apply, with_line

ROOT = Path(__file__).resolve().parents[2]
EQUIVALENTS = Path(__file__).with_name("equivalents.txt")
REPORTED = re.compile(r"(?:survived|not covered)\s+(\S+?):(\d+) (\w+) \| (.*?) => (.*)")


class Mutant(NamedTuple):
    area: str
    path: str
    line: int
    kind: str
    before: str  # The whole line, without its indentation.
    after: str
    text: str  # Of the file.

    @property
    def title(self) -> str:
        return f"{self.path}:{self.line} {self.kind} | {self.before} => {self.after}"


def sources(area: str) -> list[str]:
    return sorted(str(file.relative_to(ROOT)) for file in (ROOT / AREAS[area][0]).rglob("*.cpp"))


def mutants_of(area: str, path: str) -> list[Mutant]:
    text = (ROOT / path).read_text()
    return [
        Mutant(area, path, change.line, change.kind, *changed_line(text, change), apply(text, change))
        for change in changes_of(text)
    ]


def drawn(areas: list[str], files: list[str], seed: int) -> list[Mutant]:
    """All places in the order of the seed, which is the same on every machine."""
    found = [
        mutant for area in areas for path in sources(area) if not files or path in files for mutant in mutants_of(area, path)
    ]
    random.Random(seed).shuffle(found)
    return found


def listed(file: Path) -> Iterator["Mutant | str"]:
    """The changes of a report; of those that are not in the sources any more, the line."""
    everywhere = {path: area for area in AREAS for path in sources(area)}
    for line in file.read_text().splitlines():
        if match := REPORTED.match(line):
            yield from place_of(match, everywhere) or [f"gone: {line}"]


def place_of(match: "re.Match[str]", everywhere: dict[str, str]) -> list[Mutant]:
    name, number, kind, before, after = Path(match[1]).name, int(match[2]), match[3], match[4], match[5]
    same = [path for path in everywhere if Path(path).name == name]
    places = [
        (path != match[1], abs(at - number), path, at)
        for path in same + [path for path in everywhere if path not in same]
        for at, line in enumerate((ROOT / path).read_text().split("\n"), 1)
        if line.strip() == before
    ]
    if not places:
        return []
    *_, path, at = min(places)
    return [Mutant(everywhere[path], path, at, kind, before, after, with_line((ROOT / path).read_text(), at, after))]


def equivalents(file: Path = EQUIVALENTS) -> dict[tuple[str, str, str], str]:
    """The changes that change nothing, by path and both lines, with the reason."""
    found = {}
    for number, line in enumerate(file.read_text().splitlines(), 1):
        if line.strip() and not line.startswith("#"):
            match = re.fullmatch(r"(\S+) \| (.*?) => (.*?) \| (.+)", line)
            if match is None:
                sys.exit(f"{file}:{number}: expected 'PATH | line => other line | reason'")
            found[match[1], match[2], match[3]] = match[4]
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--most", type=int, default=1_000_000)
    parser.add_argument("--areas", nargs="+", choices=list(AREAS), default=list(AREAS))
    parser.add_argument("--file", nargs="+", default=[])
    parser.add_argument("--list", type=Path)
    parser.add_argument("--tests", default="", help="only programs whose names have this expression in them")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "mutation")
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()

    end = time.monotonic() + 60.0 * arguments.minutes
    chosen = listed(arguments.list) if arguments.list else drawn(arguments.areas, arguments.file, arguments.seed)
    todo = [mutant for mutant in chosen if isinstance(mutant, str) or mutant.area in arguments.areas]
    bench = Bench(ROOT, arguments.work.resolve(), arguments.jobs, arguments.tests)
    for name in bench.prepare(arguments.areas):
        print(f"{name} fails without any change, and is left out", flush=True)
    counts = go_through(bench, todo[: arguments.most], end)
    noticed = counts.get("killed", 0) + counts.get("hung", 0)
    judged = noticed + counts.get("survived", 0)
    print(f"seed {arguments.seed}: " + ", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    print(f"{noticed} of {judged} noticed" + (f", {noticed / judged:.1%}" if judged else ""))
    return 0


def go_through(bench: Bench, todo: "list[Mutant | str]", end: float) -> dict[str, int]:
    counts: dict[str, int] = {}
    known = equivalents()
    for mutant in todo:
        if time.monotonic() > end:
            break
        if isinstance(mutant, str):
            what = "gone"
            print(mutant, flush=True)
        elif (mutant.path, mutant.before, mutant.after) in known:
            what = "equivalent"
            print(f"equivalent {mutant.title}", flush=True)
        else:
            what, by = bench.judge(mutant.area, mutant.path, mutant.text)
            print(f"{what} {mutant.title}" + (f" [{by}]" if by else ""), flush=True)
        counts[what] = counts.get(what, 0) + 1
    return counts


if __name__ == "__main__":
    sys.exit(main())
