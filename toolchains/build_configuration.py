"""Configures and builds one configuration of CMakePresets.json, and says how far it is.

usage: build_configuration.py TITLE PRESET CMAKE

Prints everything that CMake and the compilers say, but of Ninja's steps only one a minute. Ends with the status of what
failed.
"""

import os
import re
import subprocess
import sys
import time

STEP = re.compile(r"\[(\d+)/(\d+)\] ")
LONGEST_SILENCE_S = 60


def main() -> int:
    title, preset, cmake = sys.argv[1:]
    begin = time.monotonic()
    say(f"{title}: {preset}, configuring")
    configured = subprocess.run(
        [cmake, "--preset", preset, "--log-level=NOTICE"],
        stdout=subprocess.PIPE,  # Nothing that matters: messages and warnings go to standard error.
        text=True,
        errors="replace",
        check=False,
    )
    if configured.returncode != 0:
        print(configured.stdout, flush=True)
        return configured.returncode
    say(f"{title}: {preset}, compiling")
    status = build(title, preset, cmake)
    if status == 0:
        say(f"{title}: {preset}, done after {time.monotonic() - begin:.0f} s")
    return status


def build(title: str, preset: str, cmake: str) -> int:
    process = subprocess.Popen(
        [cmake, "--build", "--preset", preset],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=os.environ | {"NINJA_STATUS": "[%f/%t] "},
    )
    said = time.monotonic()
    for line in process.stdout:
        step = STEP.match(line)
        if not step:
            if line.strip() and line.strip() != "ninja: no work to do.":
                print(line, end="", flush=True)
        elif time.monotonic() - said > LONGEST_SILENCE_S:
            say(f"{title}: {preset}, compiling, {step[1]} of {step[2]} steps done")
            said = time.monotonic()
    return process.wait()


def say(text: str) -> None:
    print(f"{time.strftime('%H:%M:%S')} {text}", flush=True)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
