"""A copy of the tree in which one file at a time is changed, built and tested."""

import json
import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path
from typing import NamedTuple

AREAS = {
    "algo": ("algo/src", ["algo"]),
    "hal": ("hal/src", ["hal", "app"]),
    "app": ("firmware/app/src", ["app"]),
    "desk": ("firmware/desk", ["desk", "scenario"]),
}
OPTIONS = [
    *("-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1", "-DCMAKE_CXX_COMPILER=g++"),
    *("-DEMAX_TESTS=ON", "-DEMAX_LONG_TESTS=ON", "-DEMAX_CONFIGURATION=mutation"),
    "-DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST",
]
# A mutant may be slower than what it is made of, and other work may run beside it.
LEAST_LIMIT_S, LIMIT_FACTOR = 20.0, 8.0
BUILD_LIMIT_S = 900.0


class Test(NamedTuple):
    """A program of tests, and how long it takes when nothing is wrong."""

    name: str
    source: str  # Its folder within host_tests.
    command: list[str]
    seconds: float


def run(command: list[str], limit_s: float, folder: Path) -> "int | None":
    """The exit status; None if it did not end in time, and then nothing of it is left."""
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL,
        start_new_session=True,
    ) as process:
        try:
            return process.wait(limit_s)
        except subprocess.TimeoutExpired:
            return None
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass


def copy_tree(source: Path, target: Path) -> int:
    """Makes the copy what the tree is, without touching files that are so already; returns how many were not."""
    listed = subprocess.run(
        ["git", "-C", str(source), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        capture_output=True, check=True,
    ).stdout.decode()
    wanted = {name for name in listed.split("\0") if name and (source / name).is_file()}
    changed = 0
    for name in sorted(wanted):
        file = target / name
        if not file.is_file() or file.read_bytes() != (source / name).read_bytes():
            file.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source / name, file)
            changed += 1
    for file in [file for file in target.rglob("*") if file.is_file()]:
        if str(file.relative_to(target)) not in wanted:
            file.unlink()
            changed += 1
    return changed


class Changed:
    """A file that is another one within a `with`, and the one of before again in any case."""

    def __init__(self, file: Path, text: str):
        self.file = file
        self.text = text
        self.original = file.read_bytes()

    def __enter__(self) -> None:
        self.file.write_text(self.text)

    def __exit__(self, *_: object) -> None:
        self.file.write_bytes(self.original)


class Bench:
    def __init__(self, source: Path, work: Path, jobs: int, wanted: str):
        self.tree = work / "tree"
        self.build = work / "build"
        self.times = work / "times.json"  # Of the tests, as long as the tree is the same.
        self.jobs = jobs
        self.wanted = re.compile(wanted)
        self.copied = copy_tree(source, self.tree)
        self.tests: dict[str, list[Test]] = {}

    def prepare(self, areas: list[str]) -> list[str]:
        """Configures and builds what is not changed, and times its tests. Returns the names of those that fail."""
        if not (self.build / "build.ninja").is_file():
            subprocess.run(["cmake", "-S", str(self.tree), "-B", str(self.build), *OPTIONS],
                           check=True, stdout=subprocess.DEVNULL)
        failing = []
        known = {} if self.copied or not self.times.is_file() else json.loads(self.times.read_text())
        folders = sorted({folder for area in areas for folder in AREAS[area][1] if folder != "scenario"})
        programs = self._programs(folders)
        if not self._ninja([*programs, *(["emax"] if "desk" in areas else [])], None):
            raise RuntimeError("the unchanged tree does not build")
        for name, folder in programs.items():
            start = time.monotonic()
            command = [str(self.build / name), "--gtest_fail_fast", "--gtest_brief=1"]
            if name not in known and run(command, 600.0, self.tree) != 0:
                failing.append(name)
                continue
            known.setdefault(name, time.monotonic() - start)
            self.tests.setdefault(folder.split("/")[0], []).append(Test(name, folder, command, known[name]))
        self.times.write_text(json.dumps(known))
        return failing

    def _programs(self, folders: list[str]) -> dict[str, str]:
        """The test programs as ninja names them, with the folder of their source."""
        listing = subprocess.run(["ninja", "-C", str(self.build), "-t", "targets", "all"],
                                 capture_output=True, text=True, check=True).stdout
        found = {}
        for match in re.finditer(r"^(host_tests/(\w+)/(test_\w+)): CXX_EXECUTABLE_LINKER", listing, re.MULTILINE):
            if match[2] in folders and self.wanted.search(match[1]):
                source = next((self.tree / "host_tests" / match[2]).rglob(f"{match[3]}.cpp"), None)
                if source is not None:
                    found[match[1]] = str(source.parent.relative_to(self.tree / "host_tests"))
        return found

    def _ninja(self, targets: list[str], limit_s: "float | None") -> bool:
        command = ["ninja", "-C", str(self.build), f"-j{self.jobs}", *targets]
        return run(command, limit_s or 3600.0, self.tree) == 0

    def in_order(self, area: str, path: str) -> list[Test]:
        """The tests of an area: first those that are named like the file, then those of its wing, the quick ones first."""
        folders = [folder for folder in AREAS[area][1] if folder != "scenario"]
        wing = Path(path).parent.name
        words = set(Path(path).stem.split("_"))

        def rank(test: Test) -> tuple:
            common = len(words & set(Path(test.name).name.removeprefix("test_").split("_")))
            return (folders.index(test.source.split("/")[0]), not (test.source.endswith("/" + wing) or common > 0),
                    -common, test.seconds)

        return sorted((test for folder in folders for test in self.tests.get(folder, [])), key=rank)

    def judge(self, area: str, path: str, text: str) -> "tuple[str, str]":
        """What becomes of the tree with this text in that file, and the test that says so."""
        with Changed(self.tree / path, text):
            for test in self.in_order(area, path):
                if not self._ninja([test.name], BUILD_LIMIT_S):
                    return "no program", ""
                status = run(test.command, max(LEAST_LIMIT_S, LIMIT_FACTOR * test.seconds), self.tree)
                if status != 0:
                    return ("hung" if status is None else "killed"), Path(test.name).name
            if "scenario" in AREAS[area][1]:
                if not self._ninja(["emax"], BUILD_LIMIT_S):
                    return "no program", ""
                command = ["ctest", "--test-dir", str(self.build), "-R", "scenario", "-E", "Coverage|OpenDamping|Devices",
                           "--stop-on-failure"]
                if run(command, BUILD_LIMIT_S, self.tree) != 0:
                    return "killed", "scenario"
            return "survived", ""
