"""Shows that ctest fails for each deliberately bad image, and says why.

usage: test_failures.py CTEST FOLDER

FOLDER is the build folder of the images, whose tests ctest only knows as configuration `bad`.
"""

import re
import subprocess
import sys

# ctest's verdict on each image, and what its output must say.
EXPECTED = {
    "bad_failure": ("Failed", r"\[  FAILED  \] Bad\.Fails"),
    "bad_fault": ("Failed", r"\[ RUN      \] Bad\.Faults\s+fault, configurable fault status 0x0000[0-9a-f]{4}\n"),
    "bad_hang": ("Timeout", r"\[ RUN      \] Bad\.Hangs\n"),
    "bad_left_out": ("Failed", r"left out, but there is no such test: Bad\.WasRenamed\n"),
    "bad_memory": ("Failed", r"std::bad_alloc[^\n]*\n\[  FAILED  \] Bad\.TakesAllMemory"),
}


def main() -> int:
    ctest, folder = sys.argv[1:]
    run = subprocess.run(
        [ctest, "--test-dir", folder, "--build-config", "bad", "--tests-regex", r"\.bad_", "--output-on-failure"],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    print(run.stdout, run.stderr, sep="")
    complaints = []
    if run.returncode != 8:
        complaints.append(f"ctest ended with {run.returncode}, not with 8 for a failed test")
    outputs = split(run.stdout)
    if set(outputs) != set(EXPECTED):
        complaints.append(f"ctest ran {sorted(outputs)}")
    for image, (verdict, pattern) in EXPECTED.items():
        output = outputs.get(image, "")
        if not re.search(rf"\*\*\*{verdict} ", output):
            complaints.append(f"{image}: ctest does not say {verdict}")
        if not re.search(pattern, output):
            complaints.append(f"{image}: no line like {pattern}")
    for complaint in complaints:
        print(complaint)
    return 1 if complaints else 0


def split(listing: str) -> dict[str, str]:
    """What ctest says about each test, which begins with its number among all."""
    parts = re.split(r"^ *\d+/\d+ Test +#\d+: \S+?\.(bad_\w+)", listing, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


if __name__ == "__main__":
    sys.exit(main())
