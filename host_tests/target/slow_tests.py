"""Measures the tests of GoogleTest images on the emulated core and writes the list of those that take long.

usage: slow_tests.py LIST SECONDS LEFT_OUT RUNNER... -- IMAGE...

LEFT_OUT is a file with the names of the tests that do not run for other reasons, one a line. A
time is what the emulator takes of a processor of this PC, so it matters little what else runs. A test that
takes twice SECONDS is ended. What LIST says of other images stays.
"""

import os
import re
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK")
BEGIN = re.compile(r"\[ RUN      \] (\S+)")
END = re.compile(r"\[(?:       OK|  FAILED|  SKIPPED) \] (\S+?),? .*\(\d+ ms\)")


def main() -> int:
    list_file, limit_s, left_out_file = Path(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3])
    split = sys.argv.index("--")
    runner, images = sys.argv[4:split], sys.argv[split + 1 :]
    left_out = set(left_out_file.read_text().split())

    measured = {Path(image).name for image in images}
    old = list_file.read_text().splitlines()[3:] if list_file.exists() else []
    lines = [line for line in old if line.split()[0] not in measured]
    total_s = 0.0
    for image in images:
        seconds = measure(runner, image, left_out, 2 * limit_s)
        slow = {test: s for test, s in seconds.items() if s > limit_s}
        kept_s = sum(seconds.values()) - sum(slow.values())
        total_s += kept_s
        print(f"{Path(image).name}: {len(seconds) - len(slow)} tests of {kept_s:.1f} s, {len(slow)} slow", flush=True)
        if len(slow) == len(seconds):
            lines.append(f"{Path(image).name} *")
            continue
        for test, s in slow.items():
            lines.append(f"{Path(image).name} {test} {'more than ' if s >= 2 * limit_s else ''}{s:.1f} s")
    list_file.write_text(
        f"Tests that do not run on the emulated core, since they take more than {limit_s:g} s of a PC's processor there.\n"
        "Written by the target slow_tests.\n\n" + "".join(line + "\n" for line in sorted(lines))
    )
    print(f"all but the slow ones: {total_s:.0f} s")
    return 0


def measure(runner: list[str], image: str, left_out: set[str], longest_s: float) -> dict[str, float]:
    """The seconds of each test; the image starts anew behind each that had to be ended."""
    seconds: dict[str, float] = {}
    remaining = [test for test in names(runner, image) if test not in left_out]
    while remaining:
        seconds.update(run(runner, image, remaining, longest_s))
        if not seconds.keys() & set(remaining):
            sys.exit(f"{image}: no test ran of {remaining}")
        remaining = [test for test in remaining if test not in seconds]
    return seconds


def names(runner: list[str], image: str) -> list[str]:
    listing = subprocess.run(
        [*runner, image, "--gtest_list_tests", "--gtest_filter=*"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    found = []
    suite = ""
    for line in listing.splitlines():
        name = line.split("#")[0].rstrip()
        if name.startswith("  "):
            found.append(suite + name.strip())
        else:
            suite = name
    return found


def run(runner: list[str], image: str, tests: list[str], longest_s: float) -> dict[str, float]:
    with tempfile.NamedTemporaryFile("w", suffix=".flags") as flags:
        flags.write(f"--gtest_filter={':'.join(tests)}\n")
        flags.flush()
        process = subprocess.Popen(
            [*runner, image, f"--gtest_flagfile={flags.name}"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            text=True,
        )
        return follow(process, longest_s)


def follow(process: subprocess.Popen, longest_s: float) -> dict[str, float]:
    seconds: dict[str, float] = {}
    running = ""
    since_s = 0.0
    killed = False
    ended = threading.Event()

    def watch() -> None:
        nonlocal killed
        while not ended.wait(0.2):
            if time_of(process) - since_s > longest_s:
                killed = True
                process.kill()
                return

    watcher = threading.Thread(target=watch)
    watcher.start()
    for line in process.stdout:
        if match := BEGIN.match(line):
            running, since_s = match[1], time_of(process)
        elif match := END.match(line):
            seconds[match[1]] = time_of(process) - since_s
            running, since_s = "", time_of(process)
    ended.set()
    watcher.join()
    process.wait()
    if running and not killed:
        sys.exit(f"the image ended in {running}")
    if running:
        seconds[running] = longest_s
    return seconds


def time_of(process: subprocess.Popen) -> float:
    """Of a process that was not waited for, and so still has its entry."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_SECOND


if __name__ == "__main__":
    sys.exit(main())
