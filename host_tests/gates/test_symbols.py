"""Shows that the symbol gate refuses each deliberately bad object, with the complaint that names the fault.

usage: test_symbols.py SYMBOLS.PY READELF OBJECT...
"""

import subprocess
import sys
from pathlib import Path

COMPLAINTS = {
    "bad_exception": "needs __cxa_throw: exceptions",
    "bad_heap": "needs _Znwm: heap",
    "bad_initialiser": "has section .init_array: code that runs before main",
    "bad_libm": "needs exp: libm",
    "bad_operator_new": "has _ZN12_GLOBAL__N_114BadOperatorNewnwEm: heap",
    "bad_static": "has _ZGVZ10bad_staticiE5first: guard of a function-local static",
    "bad_stdio": "needs printf: stdio",
    "bad_thread_local": "has section .tdata: thread-local storage",
}


def main() -> int:
    gate, readelf, *objects = sys.argv[1:]
    missed = set(COMPLAINTS)
    failures = 0
    for file in objects:
        name = Path(file).name
        bad = name.split(".", 1)[0]
        expected = f"{name}: {COMPLAINTS[bad]}"
        missed.discard(bad)
        result = subprocess.run(
            [sys.executable, "-B", gate, "--readelf", readelf, file], capture_output=True, text=True, check=False
        )
        if result.returncode == 1 and expected in result.stdout.splitlines():
            print(f"refused: {expected}")
            continue
        failures += 1
        print(f"{name}: exit status {result.returncode}, and no line '{expected}' in:\n{result.stdout}{result.stderr}")
    for bad in sorted(missed):
        failures += 1
        print(f"{bad}: no such object was given")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
