"""Compares the program `emax` with the reference implementation, one parameter set per case.

Each comparison prints one line: case, what, value of the program, value of the reference, relative
difference, tolerance, verdict. Exit status 1 if any of them failed, 0 otherwise.

    compare.py --program build/host/emax              all cases
    compare.py --program build/host/emax --case NAME  one case
    compare.py --list                                 the names, one a line
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field, replace

import numpy as np

import reference as ref

HERE = os.path.dirname(os.path.abspath(__file__))
TABLE_1 = os.path.join(HERE, "..", "data", "djb_a1800v.csv")

# Tolerances, relative.
ENERGY = 1e-9  # Both sides are exact but for rounding; a difference of energies loses digits.
DRAWN = 1e-14  # One product and one sum after an exact integer recurrence.
FITTED = 1e-9  # Two ways of solving one scaled least-squares problem.
FITTED_U = 1e-7  # The reference differentiates (S, f0, beta) numerically.
GRID = 2e-3  # Monte Carlo by `best` may stay on a grid; its cells cost up to about 1e-3.
SEARCHED = 1e-6  # The reference's search ends where refinement stops; the program may not be worse.


@dataclass(frozen=True)
class Case:
    """One run of `emax report`. Times in s, limit in m/s2, gain in V/(m/s2)."""

    sensor: ref.Accelerometer = ref.Accelerometer(1.037, 4073.0, 0.3182)
    u: tuple[float, float, float] | None = None
    order: int = 10
    cutoff: float = 1000.0
    gain: float | None = None
    time: float = 2e-3
    limit: float = 1.037
    criterion: str = "ise"
    method: str = "best"
    step: float = 2e-6
    iterations: int = 30
    trials: int = 1000
    seed: tuple[int, int, int, int] = ref.DEFAULT_SEED
    points: str | None = None  # "table1" or "synthetic" in place of the parameters
    common: float = 0.0  # --reference-uncertainty, expanded, percent
    all_trials: bool = False  # repeat every Monte Carlo trial, not only the largest one

    def system(self) -> ref.System:
        """The reference's view of the case."""
        return ref.System(self.sensor, self.order, self.cutoff, self.gain, self.criterion)

    def arguments(self, points_file: str | None) -> list[str]:
        """Options of `emax report`; every one that matters is given, none is left to a default."""
        numbers: list[float] = [self.sensor.S, self.sensor.f0, self.sensor.beta, *(self.u or ())]
        source = (["--points", points_file] if points_file
                  else ["--model", ",".join(repr(value) for value in numbers)])
        trend = f"{0.5 * self.time!r},{self.time!r}"
        arguments = [
            "report", *source, "--order", str(self.order), "--cutoff", repr(self.cutoff),
            "--gain", "auto" if self.gain is None else repr(self.gain),
            "--time", repr(self.time), "--limit", repr(self.limit),
            "--criterion", self.criterion, "--method", self.method, "--step", repr(self.step),
            "--iterations", str(self.iterations), "--trials", str(self.trials),
            "--seed", ",".join(str(part) for part in self.seed), "--trend", trend, "--json",
        ]
        if self.common:
            arguments += ["--reference-uncertainty", repr(self.common)]
        return arguments


TABLE_2 = ref.Accelerometer(1.037, 4073.0, 0.3182)
TABLE_2_U = (0.003, 6.0, 0.0004)

CASES: dict[str, Case] = {
    "table2_paper_2ms": Case(u=TABLE_2_U, method="paper"),
    "table2_best_2ms": Case(u=TABLE_2_U),
    "table2_paper_10ms": Case(time=1e-2, method="paper"),
    "order1_best_light_damping": Case(
        ref.Accelerometer(0.95, 2000.0, 0.05), order=1, cutoff=500.0, time=3e-3, limit=2.5),
    "order2_difference_best": Case(
        ref.Accelerometer(0.012, 5000.0, 0.7), (5e-5, 20.0, 0.002), order=2, cutoff=800.0,
        gain=0.0118, time=2e-3, limit=10.0, criterion="difference", seed=(1, 22, 333, 4444)),
    "order5_paper_heavy_damping": Case(
        ref.Accelerometer(0.1, 8000.0, 0.9), order=5, cutoff=2000.0, time=1e-3, limit=1.0,
        method="paper", step=1e-6),
    "order7_paper_damping_1_percent": Case(
        ref.Accelerometer(2.5, 1200.0, 0.01), order=7, cutoff=300.0, gain=2.45, time=8e-3,
        limit=0.5, method="paper", step=4e-6),
    "order15_best": Case(
        ref.Accelerometer(1.037, 4073.0, 0.3182), order=15, time=3e-3),
    "order15_difference_paper": Case(
        ref.Accelerometer(1.2, 6000.0, 0.2), order=15, cutoff=1500.0, time=2e-3, limit=1.0,
        criterion="difference", method="paper"),
    "order3_best_damping_1_percent": Case(
        ref.Accelerometer(1.0, 10000.0, 0.01), order=3, cutoff=3000.0, gain=1.05, time=1e-3,
        limit=3.0),
    "all_trials_paper_coarse_step": Case(
        u=TABLE_2_U, method="paper", step=2e-5, all_trials=True),
    "points_table1": Case(points="table1"),
    "points_table1_reference_uncertainty": Case(points="table1", common=0.5),
    "points_noise_free": Case(points="synthetic", order=6),
}


@dataclass
class Report:
    """Collects and prints the comparisons of one case."""

    name: str
    failures: int = 0
    lines: int = field(default=0)

    def _line(self, what: str, ours: object, theirs: object, difference: str, tolerance: str,
              good: bool) -> None:
        self.lines += 1
        self.failures += not good
        show = [f"{v:.15g}" if isinstance(v, float) else str(v) for v in (ours, theirs)]
        print(f"{self.name} | {what:32} | emax {show[0]:>22} | ref {show[1]:>22} | "
              f"diff {difference:>8} | tol {tolerance:>7} | {'ok' if good else 'FAIL'}", flush=True)

    def fail(self, what: str, reason: str) -> None:
        """A field is absent or of the wrong shape."""
        self._line(what, reason, "-", "-", "-", False)

    def near(self, what: str, ours: object, theirs: float, tolerance: float,
             scale: float | None = None) -> None:
        """|ours - theirs| <= tolerance * scale, the scale being |theirs| unless given."""
        if isinstance(ours, bool) or not isinstance(ours, (int, float)) or math.isnan(ours):
            self.fail(what, "absent" if ours is None else f"not a number: {ours!r:.20}")
            return
        size = abs(theirs) if scale is None else scale
        difference = abs(ours - theirs) / size if size > 0.0 else abs(ours - theirs)
        self._line(what, float(ours), float(theirs), f"{difference:.1e}", f"{tolerance:.0e}",
                   difference <= tolerance)

    def at_least(self, what: str, ours: object, theirs: float, tolerance: float) -> None:
        """ours >= theirs, up to a relative shortfall."""
        if isinstance(ours, bool) or not isinstance(ours, (int, float)) or math.isnan(ours):
            self.fail(what, "absent" if ours is None else f"not a number: {ours!r:.20}")
            return
        shortfall = (theirs - ours) / abs(theirs)
        self._line(what + " >=", float(ours), float(theirs), f"{shortfall:.1e}",
                   f"{tolerance:.0e}", shortfall <= tolerance)

    def equal(self, what: str, ours: object, theirs: object) -> None:
        """Exact equality."""
        self._line(what, ours, theirs, "-", "exact", ours == theirs)


def run(program: str, arguments: list[str]) -> dict:
    """Runs the program and reads results.json from its standard output."""
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"exit status {done.returncode}: {done.stderr.strip()[-300:]}")
    return json.loads(done.stdout)


def find(results: dict, path: str) -> object:
    """Field by its dotted path, None where it is absent."""
    value: object = results
    for part in path.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    return value


def synthetic_points(path: str) -> None:
    """Noise-free points of a model on 24 frequencies, expanded uncertainties that differ."""
    sensor = ref.Accelerometer(0.0512, 5230.0, 0.047)
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["f_hz", "amplitude", "phase_deg", "u_amplitude", "u_phase_deg"])
        for n, f in enumerate(np.geomspace(20.0, 7000.0, 24)):
            response = sensor.transfer(2j * math.pi * float(f))
            amplitude, phase = abs(response), math.degrees(np.angle(response))
            writer.writerow([repr(float(f)), repr(float(amplitude)), repr(phase),
                             repr(float(amplitude * (0.01 + 0.001 * n))), repr(0.5 + 0.02 * n)])


def compare_fit(report: Report, case: Case, results: dict, path: str) -> Case:
    """The fit of the points; returns the case with the parameters that the program found."""
    points = ref.read_points(path)
    fit = ref.wlsp(points, case.common / 200.0)
    noise_free = case.points == "synthetic"
    for name, value in (("S", fit.S), ("f0", fit.f0), ("beta", fit.beta)):
        report.near(f"model.{name}", find(results, f"model.{name}"), value, FITTED)
    u = np.sqrt(np.diag(fit.covariance))
    for name, value in zip(("uS", "uf0", "ubeta"), u):
        report.near(f"model.{name}", find(results, f"model.{name}"), float(value), FITTED_U)
    covariance = find(results, "model.covariance")
    if np.shape(covariance) == (3, 3):
        for i in range(3):
            for j in range(i + 1):
                report.near(f"model.covariance[{i}][{j}]", covariance[i][j],
                            float(fit.covariance[i, j]), FITTED_U, float(u[i] * u[j]))
    else:
        report.fail("model.covariance", "absent or not 3 x 3")
    report.near("model.chi2", find(results, "model.chi2"), fit.chi2, FITTED,
                1.0 if noise_free else None)
    report.equal("model.dof", find(results, "model.dof"), fit.dof)
    found = [find(results, f"model.{name}") for name in ("S", "f0", "beta", "uS", "uf0", "ubeta")]
    if not all(isinstance(value, (int, float)) for value in found):
        return case
    return replace(case, sensor=ref.Accelerometer(*found[:3]), u=tuple(found[3:]))


def compare_response(report: Report, case: Case, results: dict) -> None:
    """Peak and settling time of k, largest absolute error, filter."""
    system = case.system()
    figures = ref.impulse_figures(system)
    report.near("impulse_response.peak", find(results, "impulse_response.peak"),
                figures.peak, 1e-10)
    # k is flat at its peak: rounding of k moves the place by the square root of epsilon.
    report.near("impulse_response.peak_time_s", find(results, "impulse_response.peak_time_s"),
                figures.peak_time, 1e-6, system.panel())
    report.near("impulse_response.settling_time_s",
                find(results, "impulse_response.settling_time_s"), figures.settling_time, 1e-8)
    report.equal("filter.order", find(results, "filter.order"), case.order)
    report.near("filter.cutoff", find(results, "filter.cutoff"), case.cutoff, 0.0)
    report.near("filter.gain", find(results, "filter.gain"), system.filter.gain, 1e-15)
    reported = find(results, "energy.absolute_error")
    if reported is None:
        print(f"{report.name} | energy.absolute_error | not reported")
        return
    report.near("energy.absolute_error", reported,
                ref.absolute_error(system, case.time, case.limit), 1e-10)


def compare_energy(report: Report, case: Case, results: dict) -> list[float]:
    """The reported signal and energy; returns the switching times (s)."""
    energy, switches = find(results, "energy.E"), find(results, "energy.switch_times")
    report.equal("energy.criterion", find(results, "energy.criterion"), case.criterion)
    report.equal("energy.method", find(results, "energy.method"), case.method)
    report.near("energy.T", find(results, "energy.T"), case.time, 0.0)
    report.near("energy.a", find(results, "energy.a"), case.limit, 0.0)
    if not isinstance(switches, list) or not isinstance(energy, float):
        report.fail("energy.E, energy.switch_times", "absent")
        return []
    increasing = all(b > a for a, b in zip([0.0, *switches], [*switches, case.time]))
    report.equal("switch times increase in (0, T)", increasing, True)
    system = case.system()
    scale = abs(energy)
    if case.criterion == "difference":  # the digits that the two energies lose in subtraction
        only = replace(case, criterion="ise", gain=0.0).system()
        scale = ref.switching_energy(only, switches, case.time, case.limit)
    by_quadrature = ref.switching_energy(system, switches, case.time, case.limit)
    report.near("energy.E of the reported signal", energy, by_quadrature, ENERGY, scale)
    report.near("energy.xi = E/(a^2 T)", find(results, "energy.xi"),
                energy / (case.limit**2 * case.time), 1e-14)
    if energy > 0.0:
        report.near("energy.rms = sqrt(E/T)", find(results, "energy.rms"),
                    math.sqrt(energy / case.time), 1e-14)
    bound = find(results, "energy.bound")
    if isinstance(bound, float) and case.method == "best":
        report.at_least("energy.bound, against E", bound, energy, 0.0)
    if case.method == "paper":
        compare_fixed_point(report, case, results)
    else:
        cells = math.ceil(12.0 * case.sensor.f0 * case.time)
        start, _ = ref.search(system, case.time, case.limit, cells)
        _, searched = ref.refine_switches(system, start, case.time, case.limit)
        report.at_least("energy.E, own search", energy, searched, SEARCHED)
        plain = ref.paper_method(system, case.time, case.limit, case.step, case.iterations).best
        report.at_least("energy.E, plain fixed point", energy, plain, 0.0)
    return switches


def compare_fixed_point(report: Report, case: Case, results: dict) -> None:
    """The whole fixed point of (18), (19) on the paper's grid."""
    done = ref.paper_method(case.system(), case.time, case.limit, case.step, case.iterations)
    report.near("fixed point: E", find(results, "energy.E"), done.best, ENERGY)
    taken = done.rest if done.rest is not None else case.iterations
    report.equal("fixed point: iterations", find(results, "energy.iterations"), taken)
    switches = find(results, "energy.switch_times")
    report.equal("fixed point: number of switches", len(switches), len(done.switches))
    if len(switches) == len(done.switches):
        for n, (ours, theirs) in enumerate(zip(switches, done.switches), 1):
            report.near(f"fixed point: switch {n}", ours, theirs, 1e-12, case.time)


def compare_monte_carlo(report: Report, case: Case, results: dict, switches: list[float]) -> None:
    """Arguments of the maximum from seed and trial number, and its energy."""
    if case.u is None:
        return
    trial = find(results, "monte_carlo.trial")
    report.equal("monte_carlo.trials", find(results, "monte_carlo.trials"), case.trials)
    report.equal("monte_carlo.seed", find(results, "monte_carlo.seed"), list(case.seed))
    if not isinstance(trial, int) or not 0 <= trial < case.trials:
        report.fail("monte_carlo.trial", f"not a trial: {trial}")
        return
    sensor = next(ref.box_trials(case.sensor, case.u, [trial], case.seed))
    for name in ("S", "f0", "beta"):
        report.near(f"monte_carlo.at.{name} of trial {trial}",
                    find(results, f"monte_carlo.at.{name}"), getattr(sensor, name), DRAWN)
    system = replace(case.system(), sensor=sensor, gain=case.system().filter.gain)
    largest = find(results, "monte_carlo.E_max")
    if case.method == "paper":
        theirs = ref.paper_method(system, case.time, case.limit, case.step, case.iterations).best
        report.near("monte_carlo.E_max", largest, theirs, ENERGY)
    else:
        # Not below the estimate's signal (up to the grid), and near the local optimum there.
        estimate = ref.switching_energy(system, switches, case.time, case.limit)
        report.at_least("monte_carlo.E_max, fixed signal", largest, estimate, GRID)
        _, local = ref.refine_switches(system, switches, case.time, case.limit)
        report.near("monte_carlo.E_max, re-optimised", largest, local, GRID)
    if case.all_trials:
        compare_all_trials(report, case, results)
        return
    numbers = [n * case.trials // 10 for n in range(10)]
    if case.method == "paper":
        others = [energy for _, energy in ref.monte_carlo_paper(
            case.system(), case.u, numbers, case.time, case.limit, case.step, case.iterations,
            case.seed)]
    else:
        gain = case.system().filter.gain
        others = [ref.switching_energy(replace(case.system(), sensor=other, gain=gain), switches,
                                       case.time, case.limit)
                  for other in ref.box_trials(case.sensor, case.u, numbers, case.seed)]
    slack = ENERGY if case.method == "paper" else GRID
    report.at_least("monte_carlo.E_max, 10 other trials", largest, max(others), slack)
    mean = find(results, "monte_carlo.mean")
    report.near("monte_carlo.mean, 10 trials", mean, float(np.mean(others)), 0.02)


def compare_all_trials(report: Report, case: Case, results: dict) -> None:
    """Every trial by the paper's method: maximum, mean, u and the intervals of JCGM 101."""
    done = ref.monte_carlo_paper(case.system(), case.u, range(case.trials), case.time, case.limit,
                                 case.step, case.iterations, case.seed)
    energies = np.array([energy for _, energy in done])
    ordered = np.sort(energies)
    report.equal("monte_carlo.trial", find(results, "monte_carlo.trial"), int(np.argmax(energies)))
    report.near("monte_carlo.E_max, all trials", find(results, "monte_carlo.E_max"),
                float(ordered[-1]), ENERGY)
    report.near("monte_carlo.mean", find(results, "monte_carlo.mean"), float(np.mean(energies)),
                ENERGY)
    report.near("monte_carlo.u", find(results, "monte_carlo.u"), float(np.std(energies, ddof=1)),
                1e-7)
    # JCGM 101, 7.7: q = p M, r = (M - q)/2 (values counted from 1), shortest over r.
    q = int(0.95 * case.trials + 0.5)
    r = (case.trials - q + 1) // 2
    widths = ordered[q:] - ordered[: case.trials - q]
    place = int(np.argmin(widths))
    for name, low, high in (("interval", ordered[r - 1], ordered[r - 1 + q]),
                            ("shortest", ordered[place], ordered[place + q])):
        found = find(results, f"monte_carlo.{name}")
        if not isinstance(found, list) or len(found) != 2:
            report.fail(f"monte_carlo.{name}", "absent")
            continue
        report.near(f"monte_carlo.{name}[0]", found[0], float(low), ENERGY)
        report.near(f"monte_carlo.{name}[1]", found[1], float(high), ENERGY)


def compare_trend(report: Report, case: Case, results: dict) -> None:
    """The line through the reported points, and their energies by the paper's method."""
    points = find(results, "trend.points")
    if not isinstance(points, list) or len(points) < 2:
        report.fail("trend.points", "absent")
        return
    times, energies = [p[0] for p in points], [p[1] for p in points]
    slope, intercept = ref.linear_regression(times, energies)
    report.near("trend.slope", find(results, "trend.slope"), slope, 1e-9)
    report.near("trend.intercept", find(results, "trend.intercept"), intercept, 1e-9,
                abs(slope) * max(times))
    if case.method == "paper" and max(times) <= 5e-3:
        for time, energy in zip(times, energies):
            done = ref.paper_method(case.system(), time, case.limit, case.step, case.iterations)
            report.near(f"trend E at {time:g} s", energy, done.best, ENERGY)


def compare(program: str, name: str) -> int:
    """Runs one case; returns the number of failures."""
    case, report = CASES[name], Report(name)
    with tempfile.TemporaryDirectory() as folder:
        path = None
        if case.points == "table1":
            path = TABLE_1
        elif case.points == "synthetic":
            path = os.path.join(folder, "points.csv")
            synthetic_points(path)
        arguments = case.arguments(path)
        print(f"{name} | {program} {' '.join(arguments)}")
        try:
            results = run(program, arguments)
        except (RuntimeError, OSError, json.JSONDecodeError) as error:
            report.fail("run", str(error))
            return report.failures
        if path:
            case = compare_fit(report, case, results, path)
    compare_response(report, case, results)
    switches = compare_energy(report, case, results)
    compare_monte_carlo(report, case, results, switches)
    compare_trend(report, case, results)
    print(f"{name} | {report.lines} comparisons, {report.failures} failed")
    return report.failures


def main() -> int:
    """Command line; returns the exit status."""
    parser = argparse.ArgumentParser(description="Compares emax with the reference.")
    parser.add_argument("--program", help="path of emax")
    parser.add_argument("--case", choices=CASES, help="one case only")
    parser.add_argument("--list", action="store_true", help="print the names of the cases")
    options = parser.parse_args()
    if options.list:
        print("\n".join(CASES))
        return 0
    if not options.program:
        parser.error("--program is missing")
    names = [options.case] if options.case else list(CASES)
    failures = {name: compare(options.program, name) for name in names}
    failed = [name for name, count in failures.items() if count]
    print(f"{len(names) - len(failed)} of {len(names)} cases agree"
          + (f"; failed: {', '.join(failed)}" if failed else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
