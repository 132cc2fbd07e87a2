"""The paper's testable claims, recalculated with the reference implementation alone.

    claims.py            prints the table "the paper and the reference", row by row
    claims.py --quick    leaves out the rows for T > 2 ms

Every function returns numbers in SI units; the table shows energies in 1e-3 V2 s, which the paper
prints as "mV m2".
"""

from __future__ import annotations

import argparse
import math
import os
from dataclasses import dataclass, replace
from typing import Callable

import numpy as np

import reference as ref

HERE = os.path.dirname(os.path.abspath(__file__))
TABLE_1 = os.path.join(HERE, "..", "data", "djb_a1800v.csv")

TABLE_2 = ref.Accelerometer(1.037, 4073.0, 0.3182)
TABLE_2_U = (0.003, 6.0, 0.0004)
LIMIT = 1.037  # a, the number of S, in m/s2
T = 2e-3  # s
PAPER_SWITCHES = [0.68e-3, 1.49e-3]  # s, Fig. 8
PAPER_E = {2e-3: 5.862e-3, 10e-3: 34.115e-3}  # V2 s


@dataclass(frozen=True)
class Row:
    """One claim: what it is, what the paper says, what the reference gets."""

    claim: str
    paper: str
    reference: str
    note: str = ""


def system(sensor: ref.Accelerometer = TABLE_2, order: int = 10) -> ref.System:
    """The paper's filter: 1 kHz, gain fixed at Table 2's S."""
    return ref.System(sensor, order, 1000.0, TABLE_2.S)


def cells_for(time: float) -> int:
    """Cells of at most 1/(12 f0), so that the resonance is seen."""
    return math.ceil(12.0 * TABLE_2.f0 * time)


def largest(sensor: ref.Accelerometer, time: float, order: int = 10) -> tuple[list[float], float]:
    """Switching times (s) and E (V2 s): search on the grid, then refinement in continuous time."""
    here = system(sensor, order)
    starts, _ = ref.search(here, time, LIMIT, cells_for(time))
    return ref.refine_switches(here, starts, time, LIMIT)


def largest_near(sensor: ref.Accelerometer, switches: list[float], time: float) -> float:
    """E (V2 s) of the optimum that moves continuously from a known one."""
    return ref.refine_switches(system(sensor), switches, time, LIMIT)[1]


def eigenvalue_bound(here: ref.System, time: float) -> float:
    """a^2 T lambda_max of Phi in (4), V2 s: no signal within +-a has more, whatever its shape.

    Limit of the largest eigenvalue on 200 and 400 cells, whose error falls with the square of the
    cell: good to about 1e-5 relative.
    """
    coarse, fine = (LIMIT**2 * cells * float(np.linalg.eigvalsh(ref.Grid(here, cells, time)
                                                                .matrix())[-1])
                    for cells in (200, 400))
    return fine + (fine - coarse) / 3.0


def relaxation_bound(here: ref.System, time: float, cells: int, sweeps: int = 300) -> float:
    """Upper bound over all |x| <= a that are constant on the cells, in V2 s.

    Any d with diag(d) - Phi positive semidefinite gives x'Phi x <= a^2 sum d. Candidates come from
    the mixing method for the dual of the semidefinite relaxation; then d is scaled until a
    Cholesky factorisation exists, which is the proof.
    """
    matrix = ref.Grid(here, cells, time).matrix()
    vectors = np.random.default_rng(2).standard_normal((cells, 16))
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    for _ in range(sweeps):
        for i in range(cells):
            pull = matrix[i] @ vectors - matrix[i, i] * vectors[i]
            vectors[i] = pull / np.linalg.norm(pull)
    d = np.linalg.norm(matrix @ vectors, axis=1)
    scale = 1.0
    while True:
        try:
            np.linalg.cholesky(np.diag(scale * d) - matrix)
            return LIMIT**2 * scale * float(np.sum(d))
        except np.linalg.LinAlgError:
            scale *= 1.0001


def convexity_in_S() -> tuple[float, float]:
    """The largest and smallest second difference of E over S for fixed random signals."""
    generator = np.random.default_rng(4)
    bends = []
    for _ in range(20):
        switches = sorted(generator.uniform(0.0, T, 3))
        low, middle, high = (ref.switching_energy(system(replace(TABLE_2, S=S)), switches, T, LIMIT)
                             for S in (1.034, 1.037, 1.040))
        bends.append(low - 2.0 * middle + high)
    return max(bends), min(bends)


def box_corners(switches: list[float]) -> dict[tuple[int, int, int], float]:
    """E_max (V2 s) at the corners, edge and face centres of the box of (21)."""
    uS, uf, ub = TABLE_2_U
    return {(i, j, k): largest_near(
        ref.Accelerometer(TABLE_2.S + i * uS, TABLE_2.f0 + j * uf, TABLE_2.beta + k * ub),
        switches, T) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)}


def monte_carlo(switches: list[float], trials: int = 500) -> tuple[float, float, float]:
    """Mean, u and maximum of E_max (V2 s) over the first trials of the default seed."""
    values = [largest_near(sensor, switches, T)
              for sensor in ref.box_trials(TABLE_2, TABLE_2_U, range(trials))]
    return float(np.mean(values)), float(np.std(values, ddof=1)), max(values)


def rests(time: float, step: float, columns: range) -> list[int | None]:
    """Iterations to rest of the fixed point from the signs of several columns of Phi."""
    cells = round(time / step)
    grid = ref.Grid(system(), cells, time)
    found = []
    for column in columns:
        unit = np.zeros(cells)
        unit[column] = 1.0
        found.append(ref.fixed_point(grid, LIMIT, 1000, grid.apply(unit)[0]).rest)
    return found


def other_signals() -> list[tuple[str, float]]:
    """Largest E (V2 s) of signals of other shapes within +-a, at T = 2 ms."""
    here, results = system(), []
    generator = np.random.default_rng(8)
    grid = ref.Grid(here, 200, T)
    matrix = LIMIT**2 * grid.matrix()
    for name, draws in (
        ("random levels in 200 cells, 20000 draws", generator.uniform(-1.0, 1.0, (20000, 200))),
        ("random signs in 200 cells, 20000 draws", generator.choice([-1.0, 1.0], (20000, 200))),
        ("random signs in 20 cells, 20000 draws",
         np.repeat(generator.choice([-1.0, 1.0], (20000, 20)), 10, axis=1)),
    ):
        results.append((name, float(np.max(np.einsum("ni,ni->n", draws @ matrix, draws)))))

    def triangle(cycles: np.ndarray) -> np.ndarray:
        return 1.0 - 4.0 * np.abs((cycles + 0.25) % 1.0 - 0.5)

    shapes: list[tuple[str, Callable[[np.ndarray], np.ndarray], bool]] = [
        ("sine", lambda cycles: np.sin(2.0 * math.pi * cycles), False),
        ("triangle", triangle, True),
    ]
    for name, shape, kinked in shapes:
        best, place = -math.inf, (0.0, 0.0)

        def energy(f: float, phase: float) -> float:
            corners = [(n / 4.0 - phase) / f for n in range(1, 80, 2)] if kinked else []
            corners = [t for t in corners if 0.0 < t < T]
            return ref.signal_energy(here, lambda t: LIMIT * shape(f * t + phase), corners, T)

        for f in [*range(100, 1600, 100), 2000, 3000, 4000, 4500, 5000]:
            for phase in (0.0, 0.125, 0.25, 0.375):
                value = energy(float(f), phase)
                if value > best:
                    best, place = value, (float(f), phase)
        where = f"{place[0]:g} Hz, phase {360 * place[1]:g} deg"
        results.append((f"{name}, best of 80 ({where})", best))
    return results


def milli(value: float, digits: int = 4) -> str:
    """V2 s as 1e-3 V2 s."""
    return f"{1e3 * value:.{digits}f}e-3"


def rows_of_the_fit() -> list[Row]:
    """Table 2 against Table 1."""
    points = ref.read_points(TABLE_1)
    fit = ref.wlsp(points)
    uS, uf, ub = np.sqrt(np.diag(fit.covariance))
    chi2 = ref.chi_square(points, TABLE_2)
    return [
        Row("Table 2: S", "1.037 +- 0.003", f"{fit.S:.5f} +- {uS:.5f}", "WLSP of Table 1, k = 2"),
        Row("Table 2: f0 in Hz", "4073 +- 6", f"{fit.f0:.2f} +- {uf:.2f}"),
        Row("Table 2: beta", "0.3182 +- 0.0004", f"{fit.beta:.5f} +- {ub:.5f}"),
        Row("chi2 of the fit", "not given", f"{fit.chi2:.1f} / {fit.dof}",
            f"Birge ratio {math.sqrt(fit.chi2 / fit.dof):.2f}"),
        Row("chi2 of Table 2's triple", "not given", f"{chi2:.1f}", "same points and weights"),
    ]


def rows_of_the_response() -> list[Row]:
    """Peak, settling time."""
    figures = ref.impulse_figures(system())
    return [
        Row("peak of k", "1764", f"{figures.peak:.1f} at {1e6 * figures.peak_time:.1f} us",
            "a factor of 10, nearly"),
        Row("5 % settling time", "T = 2 ms", f"{1e3 * figures.settling_time:.4f} ms"),
        Row("largest |y|, a times integral of |k|", "not given",
            f"{ref.absolute_error(system(), T, LIMIT):.4f} V in 2 ms"),
    ]


def rows_of_two_milliseconds() -> list[Row]:
    """E_max and what belongs to it at T = 2 ms."""
    here = system()
    own = ref.switching_energy(here, PAPER_SWITCHES, T, LIMIT)
    plain = ref.paper_method(here, T, LIMIT)
    switches, best = largest(TABLE_2, T)
    places = ", ".join(f"{1e3 * t:.3f}" for t in plain.switches)
    corners = box_corners(switches)
    top = max(corners, key=lambda corner: corners[corner])
    at_paper = largest_near(ref.Accelerometer(1.038, 4070.0, 0.3178), switches, T)
    mean, u, most = monte_carlo(switches)
    bend = convexity_in_S()
    rest = [r for r in rests(T, 2e-6, range(0, 1000, 5)) if r is not None]
    return [
        Row("E of its signal, 0.68 and 1.49 ms", "5.862e-3", milli(own, 6)),
        Row("E_max, its own fixed point", "5.862e-3", milli(plain.best, 6),
            f"reversals: {places} ms; rest after {plain.rest}"),
        Row("E_max, best found", "5.862e-3", milli(best, 9),
            f"reversals: {', '.join(f'{1e3 * t:.6f}' for t in switches)} ms"),
        Row("number of reversals", "2", str(len(switches))),
        Row("bound, constant multiplier", "5.862e-3", milli(eigenvalue_bound(here, T)),
            "any signal within +-a"),
        Row("bound, semidefinite, 200 cells", "5.862e-3", milli(relaxation_bound(here, T, 200)),
            "any levels within +-a on the cells"),
        Row("argument of the maximum", "1.038, 4070, 0.3178",
            f"corner {top}: {milli(corners[top], 7)}",
            f"at the paper's arguments {milli(at_paper, 7)}"),
        Row("E is convex in S", "inside the range", "second difference over S: "
            f"{bend[1]:.2e} to {bend[0]:.2e} V2 s", "positive: maximum at an end of the range"),
        Row("u(E_max)", "0.008e-3", milli(u), f"500 trials: mean {milli(mean)}, max {milli(most)}"),
        Row("ranges of (21): u(S), u(beta)", '0.016, "8"', "0.006, 0.0008", "slips of the paper"),
        Row("rest within 30 iterations", "always", f"{min(rest)} to {max(rest)}",
            f"starts from 200 columns; {sum(r > 30 for r in rest)} of {len(rest)} take more"),
    ]


def rows_of_the_order() -> list[Row]:
    """Higher order, lower energy."""
    rows, before = [], math.inf
    for order in range(1, 16):
        switches, best = largest(TABLE_2, T, order)
        trend = "first" if order == 1 else ("lower" if best < before else "HIGHER")
        times = ", ".join(f"{1e3 * t:.3f}" for t in switches)
        rows.append(Row(f"E_max, order {order}", "decreases with order", milli(best, 6),
                        f"{trend}; switches {times} ms"))
        before = best
    return rows


def rows_of_other_signals() -> list[Row]:
    """Any other signal yields less."""
    _, best = largest(TABLE_2, T)
    return [Row(name, "less than E_max", milli(energy),
                f"{100.0 * energy / best:.1f} % of the largest")
            for name, energy in other_signals()]


def rows_of_longer_times() -> list[Row]:
    """T = 10 ms and the trend line."""
    rows = []
    plain = ref.paper_method(system(), 10e-3, LIMIT)
    rows.append(Row("E_max at 10 ms, its own fixed point", "34.115e-3", milli(plain.best, 6),
                    f"{len(plain.switches)} reversals, after 30 iterations, "
                    + ("not at rest" if plain.rest is None else f"rest after {plain.rest}")))
    rest = rests(10e-3, 2e-6, range(0, 5000, 250))
    values = [r for r in rest if r is not None]
    rows.append(Row("rest within 30 iterations, 10 ms", "always", f"{min(values)} to {max(values)}",
                    f"starts from 20 columns; {sum(r > 30 for r in values)} of {len(values)} "
                    "take more"))
    times, energies = [2e-3, 4e-3, 6e-3, 8e-3, 10e-3], []
    for time in times:
        switches, best = largest(TABLE_2, time)
        energies.append(best)
        rows.append(Row(f"E_max at {1e3 * time:g} ms, best found",
                        milli(PAPER_E[time], 3) if time in PAPER_E else "", milli(best, 6),
                        f"reversals: {len(switches)}"))
    low, high = PAPER_E[2e-3], PAPER_E[10e-3]
    slope, intercept = ref.linear_regression([2e-3, 10e-3], [low, high])
    rows.append(Row("line through the paper's two values", "3531.0 T - 1.2",
                    f"{1e3 * slope:.1f} T - {-1e3 * intercept:.2f}", "in 1e-3 V2 s, T in s"))
    slope, intercept = ref.linear_regression(times, energies)
    residual = max(abs(e - slope * t - intercept) for t, e in zip(times, energies))
    rows.append(Row("line through the reference's values", "3531.0 T - 1.2",
                    f"{1e3 * slope:.1f} T - {-1e3 * intercept:.3f}",
                    f"largest residual {milli(residual)}"))
    return rows


def print_table(rows: list[Row]) -> None:
    """Columns: claim, paper, reference, note."""
    for row in rows:
        line = f"{row.claim:40} | {row.paper:20} | {row.reference:36} | {row.note}"
        print(line.rstrip(" |"), flush=True)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description="The paper's claims, recalculated.")
    parser.add_argument("--quick", action="store_true", help="only T = 2 ms")
    options = parser.parse_args()
    print_table([Row("claim", "paper", "reference", "note")])
    parts = [rows_of_the_fit, rows_of_the_response, rows_of_two_milliseconds, rows_of_the_order,
             rows_of_other_signals]
    for part in parts if options.quick else [*parts, rows_of_longer_times]:
        print_table(part())


if __name__ == "__main__":
    main()
