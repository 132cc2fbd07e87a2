"""Runs the tests of a build tree one after the other and lists those that take long.

usage: long_tests.py CTEST TREE LIST [SECONDS]

With SECONDS, only those of GoogleTest are listed that take more, and lines of the program's classes stay. The head of the
list stays as it is. A time is what a test takes of a processor, so it matters little what else runs. The list has no
names of configurations: it holds for all builds for a PC.
"""

import json
import os
import re
import resource
import subprocess
import sys
from pathlib import Path


def main() -> int:
    ctest, tree, list_file = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    long_s = float(sys.argv[4]) if len(sys.argv) > 4 else 1.0
    shown = subprocess.run([ctest, "--show-only=json-v1"], cwd=tree, stdout=subprocess.PIPE, check=True).stdout
    long, total_s = {}, 0.0
    tests = json.loads(shown)["tests"]
    if len(sys.argv) > 4:
        tests = [test for test in tests if any(word.startswith("--gtest_filter=") for word in test["command"])]
    for test in tests:
        seconds = time_of(test)
        total_s += seconds
        if seconds > long_s:
            long[test["name"].partition(".")[2]] = seconds
    print(f"{len(long)} of {len(tests)} tests are long: {sum(long.values()):.0f} of {total_s:.0f} s")
    head, _, lines = list_file.read_text().partition("\n\n")
    if len(sys.argv) > 4:
        for name, seconds in re.findall(r"^(scenario\.\S+) (\d+) s$", lines, re.MULTILINE):
            long[name] = float(seconds)
    list_file.write_text(head + "\n\n" + "".join(f"{name} {long[name]:.0f} s\n" for name in sorted(long)))
    return 0


def time_of(test: dict) -> float:
    properties = {entry["name"]: entry["value"] for entry in test.get("properties", [])}
    before = used_s()
    subprocess.run(
        test["command"],
        cwd=properties.get("WORKING_DIRECTORY", os.getcwd()),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=False,
    )
    return used_s() - before


def used_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    sys.exit(main())
