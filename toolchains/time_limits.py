"""Compares the time that each test took with its limit, after the tests have run.

usage: time_limits.py CTEST TREE

TREE is a build tree, of which ctest keeps the mean time of each test. A limit must be at least ten times that, so that
a busy machine fails nothing; exits with 1 if one is lower.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

LEAST_FACTOR = 10


def main() -> int:
    ctest, tree = sys.argv[1], Path(sys.argv[2])
    limits = limits_of(ctest, tree)
    times = {test: time for test, time in times_of(tree).items() if test in limits}
    if not times:
        sys.exit(f"time_limits: no test of {tree} has run")
    low = {test: time for test, time in times.items() if limits[test] < LEAST_FACTOR * time}
    for test, time in sorted(low.items()):
        print(f"{test}: took {time:.1f} s, and its limit is {limits[test]:.0f} s")
    nearest = max(times, key=lambda test: times[test] / limits[test])
    print(f"{len(times)} tests, {len(low)} with a limit of less than {LEAST_FACTOR} times what they took; "
          f"the nearest: {nearest}, {times[nearest]:.1f} of {limits[nearest]:.0f} s")
    return 1 if low else 0


def limits_of(ctest: str, tree: Path) -> dict[str, float]:
    shown = subprocess.run([ctest, "--show-only=json-v1"], cwd=tree, stdout=subprocess.PIPE, check=True).stdout
    limits = {}
    for test in json.loads(shown)["tests"]:
        properties = {entry["name"]: entry["value"] for entry in test.get("properties", [])}
        limits[test["name"]] = float(properties.get("TIMEOUT", "inf"))
    return limits


def times_of(tree: Path) -> dict[str, float]:
    """The means that ctest keeps of the runs that passed: name, number of runs, seconds."""
    text = (tree / "Testing/Temporary/CTestCostData.txt").read_text()
    return {name: float(time) for name, time in re.findall(r"^(\S+) [1-9]\d* (\S+)$", text, re.MULTILINE)}


if __name__ == "__main__":
    sys.exit(main())
