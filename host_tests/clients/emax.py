"""emax from Python: reports of the program as data, lists of numbers as NumPy arrays. One file, to be copied.

    import emax
    result = emax.run_report(points="sensor.csv", limit=1)
    result["energy"]["E"]          # V^2 s
    result["trend"]["points"]      # an array with a row for each length: s, V^2 s

firmware/desk/README.md lists all fields with their units. What is null in the file is None here.
"""

import csv
import json
import os
import pathlib
import shutil
import subprocess

import numpy

FAULT = 3  # Exit status of a measurement that has failed.


class EmaxError(RuntimeError):
    """What the program says when it refuses, or when the measurement has failed.

    status   2: bad input, 3: a fault of the measurement; others as the system has them.
    results  What was measured until the fault, as `load()` gives it; None if nothing was.
    """

    def __init__(self, status: int, words: str, results=None):
        super().__init__(words)
        self.status, self.results = status, results


def find_program() -> str:
    """$EMAX, else `emax` on the PATH, else the one built in the tree of this file. Raises EmaxError if there is none."""
    if found := os.environ.get("EMAX") or shutil.which("emax"):
        return found
    for folder in pathlib.Path(__file__).resolve().parents:
        if (built := folder / "build/host/emax").is_file():
            return str(built)
    raise EmaxError(2, "the program emax is not found: put it on the PATH, or set EMAX to its path, such as build/host/emax")


def option_words(options: dict) -> list[str]:
    """`reference_delay="none"` as `--reference-delay none`; lists with commas, True as a switch, None as nothing.

    `label` is given once for each item of its list, as the program has it.
    """
    words = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        option = "--" + name.replace("_", "-")
        is_list = isinstance(value, (list, tuple, numpy.ndarray))
        if value is True:
            words.append(option)
        elif is_list and name == "label":
            words += [word for item in value for word in (option, str(item))]
        else:
            words += [option, ",".join(str(item) for item in value) if is_list else str(value)]
    return words


def with_arrays(value, name: str = ""):
    """The same, with an array of double for every list of numbers and every table of them; None in one is NaN."""
    if isinstance(value, dict):
        return {key: with_arrays(item, key) for key, item in value.items()}
    if not isinstance(value, list) or name == "warnings":
        return value
    leaves = [leaf for item in value for leaf in (item if isinstance(item, list) else [item])]
    if all(leaf is None or (isinstance(leaf, (int, float)) and not isinstance(leaf, bool)) for leaf in leaves):
        return numpy.array(value, dtype=float)
    return [with_arrays(item) for item in value]


def run(*arguments, program: str | None = None) -> bytes:
    """What the program prints for these arguments. Raises EmaxError if its status is not 0."""
    command = [program or find_program(), *map(str, arguments)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    if done.returncode != 0:
        kept = with_arrays(json.loads(done.stdout)) if done.returncode == FAULT and "--json" in command else None
        raise EmaxError(done.returncode, done.stderr.decode().strip(), kept)
    return done.stdout


def run_report(*arguments, program: str | None = None, **options) -> dict:
    """`emax report` with these words and options: `run_report("--adaptive", model=(1, 5000, 0.7), trend="none")`.

    Returns the fields of results.json. With `out=DIRECTORY` the files are written as well; `load(DIRECTORY)` reads them.
    """
    return with_arrays(json.loads(run("report", *arguments, *option_words(options), "--json", program=program)))


def figures(result: dict) -> dict:
    """The figures of a result as numbers, NaN for each that does not exist, so that sensors can be put into one array.

    S, f0, beta       V/(m/s^2), Hz, 1
    E, E_low, E_high  The largest energy found and its 95 % interval, V^2 s; where the points leave beta open, its range
                      over the dampings that a device may have.
    error, error_low, error_high
                      The in-band error in % of S a, the constant delay taken out where that exists, with U (k = 2) on
                      both sides, or the interval in the place of U.
    warnings          How many there are, but for the one on fewer trials than rule (3) asks for.
    """
    nothing = (numpy.nan, numpy.nan)
    model, energy = result["model"], result["energy"] or {}
    fit, uncertainty = result.get("fit") or {}, result["uncertainty"] or {}
    band = result["band"] or {}
    figure = band.get("matched") or band
    error, u = figure.get("rms_percent", numpy.nan), figure.get("U_percent")
    interval = figure.get("instead_of_U_percent")
    if interval is None:
        interval = nothing if u is None else (error - u, error + u)
    range_of_energy = fit.get("E_range")
    if range_of_energy is None:
        range_of_energy = uncertainty.get("interval", nothing)
    warnings = [warning for warning in result["warnings"] if not warning["text"].startswith("fewer trials than rule (3)")]
    return {
        **{name: numpy.nan if model[name] is None else float(model[name]) for name in ("S", "f0", "beta")},
        "E": energy.get("E", numpy.nan), "E_low": float(range_of_energy[0]), "E_high": float(range_of_energy[1]),
        "error": error, "error_low": float(interval[0]), "error_high": float(interval[1]),
        "warnings": len(warnings),
    }


def load_table(path) -> dict:
    """A CSV table of the program: an array for each column, in its order; an empty field, as of a phase that was not
    measured, is NaN. Lines that begin with # are left out."""
    with open(path, encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    numbers = [[float(field) if field else numpy.nan for field in row] for row in rows]
    columns = numpy.array(numbers, dtype=float).reshape(-1, len(head)).T
    return dict(zip(head, columns))


def load(path) -> dict:
    """A results.json, or the directory that `--out` has written; then "tables" has its CSV tables by name."""
    path = pathlib.Path(path)
    if not path.is_dir():
        return with_arrays(json.loads(path.read_text(encoding="utf-8")))
    results = load(path / "results.json")
    return results | {"tables": {table.stem: load_table(table) for table in sorted(path.glob("*.csv"))}}
