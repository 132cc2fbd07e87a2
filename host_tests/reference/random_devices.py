#!/usr/bin/env python3
"""Proves bounds for random devices, and searches each for a signal that would exceed its bound.

    random_devices.py PROGRAM                 20 devices, 5 s of the processor each, and a table
    random_devices.py PROGRAM --count 2 --effort 0.3 --starts 20

Every bound must be at least the largest energy that a search of its own finds (random starts, on
which single cells are turned as long as one gains) and that the program reaches, and no more than
the bound of the report. Exit status 1 if one is not.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys

import numpy as np

import check_certificate
import reference

CELLS = 160
CRITERIA = ("ise", "ise", "band", "difference")


def random_system(generator: np.random.Generator, number: int) -> tuple[reference.System, float]:
    """A system and a T of 1 to 4 periods of its filter."""
    order = int(generator.integers(1, 16))
    cutoff = float(np.round(10.0 ** generator.uniform(2.0, 3.5), 3))
    sensor = reference.Accelerometer(1.0, float(np.round(cutoff * 10.0 ** generator.uniform(0.3, 0.9), 3)),
                                     float(np.round(10.0 ** generator.uniform(-1.3, -0.05), 5)))
    time = float(np.round(generator.uniform(1.0, 4.0) / cutoff, 9))
    return reference.System(sensor, order, cutoff, None, CRITERIA[number % len(CRITERIA)]), time


def run(program: str, command: str, system: reference.System, time: float, *options: str) -> dict:
    sensor = system.sensor
    arguments = [program, command, "--model", f"{sensor.S!r},{sensor.f0!r},{sensor.beta!r}",
                 "--order", str(system.order), "--cutoff", repr(system.cutoff), "--time", repr(time),
                 "--criterion", system.criterion, "--reference-delay", "none", "--json", *options]
    done = subprocess.run(arguments, capture_output=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(arguments)}: {done.stderr.decode().strip()}")
    return json.loads(done.stdout)


def best_on_cells(system: reference.System, time: float, starts: int,
                  generator: np.random.Generator) -> float:
    """The largest energy of signals of +-1 on equal cells that the search comes to."""
    edges = np.linspace(0.0, time, CELLS + 1)
    matrix, _ = check_certificate.matrix_of(system, edges)
    best = 0.0
    for start in range(starts):
        runs = np.repeat(generator.choice([-1.0, 1.0], CELLS), 1 + start % 16)
        x = runs[:CELLS].copy()
        products = matrix @ x
        while True:
            gains = 4.0 * (np.diag(matrix) - x * products)
            cell = int(np.argmax(gains))
            if gains[cell] <= 1e-15 * best:
                break
            products -= 2.0 * x[cell] * matrix[:, cell]
            x[cell] = -x[cell]
        best = max(best, float(x @ matrix @ x))
    return best


def main() -> int:
    parser = argparse.ArgumentParser(description="Bounds and searches for random devices.")
    parser.add_argument("program", help="emax")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--effort", default="5", help="seconds of the processor for each")
    parser.add_argument("--starts", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    generator = np.random.default_rng(options.seed)
    failed = 0
    print("criterion  order    fc/Hz    f0/Hz     beta    T/ms    E reached   bound/E-1  search/E-1  report/E-1")
    for number in range(options.count):
        system, time = random_system(generator, number)
        proven = run(options.program, "certify", system, time, "--effort", options.effort)
        report = run(options.program, "report", system, time, "--trend", "none")
        found = best_on_cells(system, time, options.starts, generator)
        sensor, reached = system.sensor, proven["E"]
        quick = report["energy"]["bound"]
        is_right = max(reached, found) <= proven["bound"] <= quick * (1.0 + 1e-12)
        failed += 0 if is_right else 1
        percents = [f"{100.0 * (value / reached - 1.0):9.3f} %" for value in (proven["bound"], found, quick)]
        print(f"{system.criterion:10s} {system.order:5d} {system.cutoff:8.1f} {sensor.f0:8.1f} {sensor.beta:8.5f} "
              f"{1e3 * time:7.3f} {reached:12.6g} {' '.join(percents)}{'' if is_right else '  WRONG'}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
