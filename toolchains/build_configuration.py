"""Configures and builds one configuration of CMakePresets.json, and says now and then how far it is.

usage: build_configuration.py TITLE PRESET CMAKE

Everything that CMake and the compilers say is printed; of Ninja's lines only a few. Ends with the status of what failed.
"""

import os
import re
import subprocess
import sys
import time

STEP_DONE = re.compile(r"\[(\d+)/(\d+)\] ")
LONGEST_SILENCE_S = 60


def main() -> int:
    title, preset, cmake = sys.argv[1:]
    begin = time.monotonic()
    say(f"{title}: {preset}, configuring")
    configured = subprocess.run([cmake, "--preset", preset, "--log-level=NOTICE"], stdout=subprocess.PIPE, text=True, check=False)
    if configured.returncode != 0:
        print(configured.stdout, flush=True)
        return configured.returncode
    status = build(title, preset, cmake)
    if status == 0:
        say(f"{title}: {preset}, done after {time.monotonic() - begin:.0f} s")
    return status


def build(title: str, preset: str, cmake: str) -> int:
    environment = os.environ | {"NINJA_STATUS": "[%f/%t] "}
    process = subprocess.Popen(
        [cmake, "--build", "--preset", preset], stdout=subprocess.PIPE, text=True, errors="replace", env=environment
    )
    said = 0.0
    for line in process.stdout:
        step = STEP_DONE.match(line)
        if not step:
            if line.strip() and line.strip() != "ninja: no work to do.":
                print(line, end="", flush=True)
            continue
        if time.monotonic() - said > LONGEST_SILENCE_S:
            say(f"{title}: {preset}, compiling, {step[1]} of {step[2]} steps done")
            said = time.monotonic()
    return process.wait()


def say(text: str) -> None:
    print(f"{time.strftime('%H:%M:%S')} {text}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
