#!/usr/bin/env python3
"""Checks a certificate of `emax certify` without any of the code that made it.

    check_certificate.py CERTIFICATE      exit status 0 and the proven bound, or 1 and the reason

The certificate says: every signal |x| <= a on [0, T] has E <= bound. What is believed of it: the
model, T, a, the edges of the cells, the multipliers, the y and the tree of cases, as numbers that
prove something or do not. What is found anew, by quadrature from `reference.py`:

1. The bounds m_n(t) of the integral over s of |d^n phi / dt^n| on a mesh, the least length of a
   run, and from them what rounding a signal to the cells costs at most. The certificate's costs
   must not be lower, and its runs must be impossible.
2. The matrix of F, as Gauss-Legendre integrals of products of step responses.
3. With the multipliers, Diag(y) - Q' for each case, which must have a Cholesky factor; that the
   cases are all there are; and the bound.

Quadrature and mesh have no enclosures here: MARGIN covers them, 0.2 % of the costs, and
ENTRY_MARGIN the matrix. The program's own costs come from enclosures.
"""

from __future__ import annotations

import argparse
import json
import math
import sys

import numpy as np

import reference

Array = np.ndarray

MARGIN = 1.002  # On m_n and on the energy of a pulse, whose mesh errors are about 1e-4.
MESH_RESOLUTION = 40.0  # Mesh intervals per time constant of the fastest mode.
FACTOR_MARGIN = 5e-11  # Left out of each diagonal element, in units of 2^30 units.
ENTRY_MARGIN = 2e-14  # Each element of the matrix is believed to this, in units of 2^30 units.
TRIANGLE_SIGNS = ((-1, -1, -1), (-1, 1, 1), (1, -1, 1), (1, 1, -1))


class Rejected(Exception):
    """Why a certificate proves nothing."""


def require(condition: bool, reason: str) -> None:
    if not condition:
        raise Rejected(reason)


# ------------------------------------------------------------------------------ step response


class StepResponse:
    """H(t), the integral of k, by Chebyshev polynomials on panels."""

    DEGREE = 17

    def __init__(self, system: reference.System, time: float) -> None:
        self.panel = 0.5 * system.panel()
        self.count = math.ceil(time / self.panel) + 1
        edges = np.arange(self.count + 1) * self.panel
        kernel = reference.Kernel(system.k, system.panel())
        table = np.concatenate([[0.0], np.cumsum(kernel.integral(edges[:-1], edges[1:]))])
        nodes = np.cos(math.pi * (np.arange(self.DEGREE + 1) + 0.5) / (self.DEGREE + 1))
        starts = np.broadcast_to(edges[:-1, None], (self.count, len(nodes)))
        stops = starts + 0.5 * self.panel * (nodes + 1.0)
        values = table[:-1, None] + kernel.integral(starts, stops)
        self.coefficients = np.polynomial.chebyshev.chebfit(nodes, values.T, self.DEGREE)

    def __call__(self, t: Array) -> Array:
        scaled = np.maximum(t, 0.0) / self.panel
        index = np.minimum(scaled.astype(np.int64), self.count - 1)
        u = 2.0 * (scaled - index) - 1.0
        # Clenshaw's recursion, panel by panel.
        one, two = np.zeros(u.shape), np.zeros(u.shape)
        for n in range(self.DEGREE, 0, -1):
            one, two = 2.0 * u * one - two + self.coefficients[n][index], one
        return np.where(t > 0.0, u * one - two + self.coefficients[0][index], 0.0)


# ----------------------------------------------------------------------------------- constants


class KernelBounds:
    """m_0, m_1, m_2 at the points of a mesh, and the energy of pulses."""

    def __init__(self, system: reference.System, step: StepResponse, time: float) -> None:
        fastest = 2.0 * math.pi * max(system.sensor.f0, system.filter.cutoff)
        self.count = max(3000, math.ceil(time * fastest * MESH_RESOLUTION))
        self.h = time / self.count
        self.time = time
        middle = (np.arange(self.count) + 0.5) * self.h
        # k' and k'' by differences so narrow that their error is below 1e-6.
        narrow = min(2e-3 / fastest, 0.4 * self.h)
        before, k, after = (system.k(middle + shift) for shift in (-narrow, 0.0, narrow))
        slope = (after - before) / (2.0 * narrow)
        curvature = (after - 2.0 * k + before) / narrow**2
        first_slope = float((4.0 * system.k(np.array(narrow)) - system.k(np.array(2.0 * narrow)))
                            / (2.0 * narrow))
        self.integrals = self._integrals(system, (k, slope, curvature), first_slope)
        self.steps = step(middle)

    def _integrals(
        self, system: reference.System, derivatives: tuple[Array, ...], first_slope: float
    ) -> Array:
        """m_n(t_i), n = 0, 1, 2, t_i = i h, by the trapezoidal rule in s, lag by lag.

        With d = |s - t|, dn/dtn phi is (-1)^n times the integral of k^(n)(w + d) k(w) for s >= t
        and of k^(n)(w) k(w + d) for s <= t, up to T, for n = 2 plus k'(0) k(d).
        """
        n, k = self.count, derivatives[0]
        totals = np.zeros((3, n + 1))
        lagged = system.k(np.arange(n + 1) * self.h)
        for lag in range(n + 1):
            weight = self.h * (0.5 if lag == 0 else 1.0)
            for order, derivative in enumerate(derivatives):
                # After cumsum, element M is the integral over [0, M h].
                later = np.zeros(n - lag + 1)
                np.cumsum(derivative[lag:] * k[: n - lag], out=later[1:])
                earlier = np.zeros(n - lag + 1)
                np.cumsum(derivative[: n - lag] * k[lag:], out=earlier[1:])
                later *= self.h
                earlier *= self.h
                if order == 2:
                    earlier += first_slope * lagged[lag]
                # s = T - M h, t = s - lag h; then t = T - M h, s = t - lag h.
                totals[order, : n - lag + 1] += weight * np.abs(later[::-1])
                totals[order, lag:] += weight * np.abs(earlier[::-1])
        return totals

    def largest(self, order: int, start: float, stop: float) -> float:
        """The largest m_order on [start, stop], with the margin."""
        low = max(math.floor(start / self.h), 0)
        high = min(math.ceil(stop / self.h), self.count)
        return MARGIN * float(np.max(self.integrals[order, low : high + 1]))

    def pulse_energies(self, left: float, widths: Array) -> Array:
        """At least the energies of unit pulses of these numbers of mesh steps, `left` before T."""
        last = int(left / self.h)
        rest = left / self.h - last  # Of the mesh step that T cuts.
        energies = []
        for width in widths:
            y = self.steps[: last + 1].copy()
            y[width:] -= self.steps[: max(len(y) - width, 0)]
            energy = float(y[:last] @ y[:last])
            energy += rest * float(y[last] ** 2) if last < len(y) else 0.0
            energies.append(self.h * energy / MARGIN)
        return np.array(energies)


# ------------------------------------------------------------------------------- the certificate


class Certificate:
    """A file of `emax certify`, with the plain faults of its form found."""

    def __init__(self, data: dict) -> None:
        try:
            model, limits = data["model"], data["signal"]
            self.system = reference.System(
                reference.Accelerometer(model["S"], model["f0"], model["beta"]),
                model["order"], model["cutoff"], model["gain"],
                model.get("criterion", "ise"))
            self.time, self.limit = float(limits["T"]), float(limits["a"])
            self.energy = float(data["energy"]["E"])
            self.switches = [float(t) for t in data["energy"]["switch_times"]]
            self.bound = float(data["bound"])
            self.edges = np.array(data["edges"], dtype=float)
            self.free_from = int(data["free_from"])
            self.constant = float(data["constant"])
            self.switch_cost = np.array(data["switch_cost"], dtype=float)
            self.run_end = np.array(data["run_end"], dtype=int)
            self.unit = float(data["unit"])
            self.multipliers = np.array(data["multipliers"], dtype=np.int64).reshape(-1, 5)
            self.tree = data["tree"]
        except (KeyError, TypeError, ValueError) as error:
            raise Rejected(f"not a certificate: {error!r}") from error
        self.cells = len(self.edges) - 1
        self.check_form()

    def check_form(self) -> None:
        require(self.system.order >= 2, "a filter of order 1 or less")
        require(self.cells >= 2 and self.edges[0] == 0.0 and self.edges[-1] == self.time
                and bool(np.all(np.diff(self.edges) > 0.0)), "edges do not go from 0 to T")
        require(1 <= self.free_from <= self.cells, "free_from is not an edge")
        require(len(self.switch_cost) == self.cells and len(self.run_end) == self.cells,
                "switch_cost or run_end do not fit the edges")
        require(bool(np.all(self.switch_cost >= 0.0)), "a negative cost")
        require(self.unit > 0.0 and self.limit > 0.0, "unit or limit not above 0")

    def excluded(self) -> tuple[Array, Array, Array]:
        """All cells i < j < k such that v_i = v_k and v_j different needs too short a run."""
        triples = []
        for i in range(self.cells - 2):
            for k in range(i + 2, self.cells):
                if self.run_end[i + 1] <= k:
                    break
                for j in range(i + 1, k):
                    if self.run_end[j] <= k:
                        break
                    triples.append((i, j, k))
        table = np.array(triples, dtype=np.int64).reshape(-1, 3)
        return table[:, 0], table[:, 1], table[:, 2]


def check_costs(certificate: Certificate, bounds: KernelBounds) -> None:
    """The costs of rounding, and that the runs said to be impossible are."""
    edges, free = certificate.edges, certificate.free_from
    middle = 0.5 * (edges[:-1] + edges[1:])  # Of cell e, after edge e.

    def half_cell(start: float, stop: float) -> float:
        return 2.0 * bounds.largest(1, start, stop) * (stop - start) ** 2

    for e in range(1, free):
        cost = max(half_cell(middle[e - 1], edges[e]), half_cell(edges[e], middle[e]))
        require(certificate.switch_cost[e] >= cost, f"the cost of a switch at edge {e} is too low")
        end = int(certificate.run_end[e])
        require(e < end <= free, f"run_end of edge {e} is out of range")
        longest = middle[end - 1] - middle[e - 1]
        widths = np.arange(1, math.ceil(longest / bounds.h) + 1)
        energies = bounds.pulse_energies(bounds.time - middle[e], widths)
        for width, energy in zip(widths * bounds.h, energies):
            curvature = bounds.largest(2, middle[e - 1], middle[e] + width)
            require(energy > curvature * width**3 / 12.0,
                    f"runs from edge {e} may be as short as {1e6 * width:.2f} us")
    constant = half_cell(0.0, middle[0]) + half_cell(middle[free - 1], edges[free])
    for cell in range(free, certificate.cells):
        start, stop = edges[cell], edges[cell + 1]
        width = stop - start
        constant += width * min(2.0 * bounds.largest(0, start, stop),
                                width * bounds.largest(1, start, stop))
    require(certificate.constant >= constant, "the constant for the last cells is too low")


def cell_matrix(certificate: Certificate, step: StepResponse) -> Array:
    """Phi on the cells: integrals of products of the responses to single cells."""
    edges = certificate.edges
    nodes, weights = reference.gauss_legendre(10)
    matrix = np.zeros((certificate.cells, certificate.cells))
    for chunk in np.array_split(np.arange(certificate.cells), max(1, certificate.cells // 64)):
        widths = edges[chunk + 1] - edges[chunk]
        t = (edges[chunk][:, None] + widths[:, None] * nodes).ravel()
        root = np.sqrt((widths[:, None] * weights).ravel())
        responses = root[:, None] * -np.diff(step(t[:, None] - edges[None, :]), axis=1)
        matrix += responses.T @ responses
    return matrix


def check_matrix(certificate: Certificate, matrix: Array) -> None:
    """Energies of two patterns against the integral over time of the squared output."""
    generator = np.random.default_rng(1)
    for pattern in (np.ones(certificate.cells),
                    reference.sign_pattern(generator.standard_normal(certificate.cells))):
        switches = certificate.edges[np.flatnonzero(np.diff(pattern)) + 1]
        energy = reference.switching_energy(certificate.system, list(switches), certificate.time,
                                            1.0)
        mine = float(pattern @ matrix @ pattern)
        require(abs(energy - mine) <= 1e-11 * energy, "the matrix of the check is inaccurate")


def apply_multipliers(certificate: Certificate, matrix: Array) -> tuple[Array, float]:
    """Q' and the sum of the multipliers."""
    result = matrix.copy()
    i, j, k, kind, units = certificate.multipliers.T
    require(bool(np.all((0 <= i) & (i < j) & (j < k) & (k < certificate.cells))),
            "a multiplier of cells that are not i < j < k")
    require(bool(np.all((0 <= kind) & (kind <= 4))), "a multiplier of no known kind")
    require(bool(np.all((units >= 0) | (kind == 4))), "a negative multiplier of an inequality")
    excluded = set(zip(*(index.tolist() for index in certificate.excluded())))
    free = certificate.multipliers[kind == 4]
    require(all((a, b, c) in excluded for a, b, c, _, _ in free.tolist()),
            "a multiplier for a run that may exist")
    signs = np.array(TRIANGLE_SIGNS + (TRIANGLE_SIGNS[3],))[kind]
    half = 0.5 * certificate.unit * units
    for column, (row_index, column_index) in enumerate(((i, j), (j, k), (i, k))):
        np.subtract.at(result, (row_index, column_index), half * signs[:, column])
        np.subtract.at(result, (column_index, row_index), half * signs[:, column])
    return result, certificate.unit * int(np.sum(units))


class Tree:
    """The cases: walked from the root, every sign pattern is in one of them."""

    def __init__(self, certificate: Certificate, matrix: Array, plain: Array, total: float) -> None:
        self.certificate, self.matrix, self.plain, self.total = certificate, matrix, plain, total
        self.excluded = certificate.excluded()
        self.scale = certificate.unit * 2.0**30
        self.largest = -math.inf
        self.leaves = 0

    def walk(self) -> None:
        root = np.zeros(self.certificate.cells, dtype=np.int8)
        root[0] = 1  # F(v) = F(-v).
        open_nodes, seen = [(0, root)], set()
        while open_nodes:
            number, signs = open_nodes.pop()
            require(isinstance(number, int) and 0 <= number < len(self.certificate.tree),
                    "a node of the tree is missing")
            require(number not in seen, "a node of the tree occurs twice")
            seen.add(number)
            node = self.certificate.tree[number]
            possible = self.propagate(signs)
            if not possible:
                continue
            if "y" in node:
                self.check_leaf(number, signs, node["y"])
                continue
            require("cell" in node and "plus" in node and "minus" in node,
                    f"node {number} of the tree is neither a case nor a split, and not impossible")
            cell = int(node["cell"])
            require(0 <= cell < self.certificate.cells, f"node {number} splits by no cell")
            for side, child in ((1, node["plus"]), (-1, node["minus"])):
                if signs[cell] == -side:
                    continue
                fixed = signs.copy()
                fixed[cell] = side
                open_nodes.append((child, fixed))
        require(self.leaves > 0, "no case")

    def propagate(self, signs: Array) -> bool:
        """What follows from the fixed signs; False if they need too short a run."""
        i, j, k = self.excluded
        while True:
            first, middle, last = signs[i], signs[j], signs[k]
            ends = (first != 0) & (first == last)
            if np.any(ends & (middle == -first)):
                return False
            inner = ends & (middle == 0)
            right = (first != 0) & (middle == -first) & (last == 0)
            left = (last != 0) & (middle == -last) & (first == 0)
            if not (np.any(inner) or np.any(right) or np.any(left)):
                return True
            # One rule at a time, so that two of them never write different signs unseen.
            if np.any(inner):
                signs[j[inner]] = first[inner]
            elif np.any(right):
                signs[k[right]] = middle[right]
            else:
                signs[i[left]] = middle[left]

    def check_leaf(self, number: int, signs: Array, y: list[int]) -> None:
        fixed, free = np.flatnonzero(signs), np.flatnonzero(signs == 0)
        require(len(y) == 1 + len(free), f"node {number} has {len(y)} y for {1 + len(free)} cells")
        basis = np.zeros((len(signs), 1 + len(free)))
        basis[fixed, 0] = signs[fixed]
        basis[free, 1 + np.arange(len(free))] = 1.0
        duals = self.certificate.unit * np.array(y, dtype=float)
        self.leaves += 1
        self.largest = max(self.largest, float(np.sum(duals)))
        if len(free) == 0:
            value = float(signs @ self.plain @ signs) - self.total
            require(duals[0] >= value, f"node {number}: the pattern has more energy than y says")
            return
        slack = np.diag(duals) - basis.T @ self.matrix @ basis
        margin = (FACTOR_MARGIN + ENTRY_MARGIN * len(signs)) * self.scale
        margin += 2.0**-50 * len(y) * float(np.sum(np.abs(duals)))
        slack -= margin * np.eye(len(y))
        try:
            np.linalg.cholesky(slack)
        except np.linalg.LinAlgError as error:
            raise Rejected(f"node {number}: Diag(y) - Q' is not positive definite") from error


def check(data: dict) -> tuple[Certificate, float]:
    """Returns the certificate and the bound that it proves, or raises Rejected."""
    certificate = Certificate(data)
    step = StepResponse(certificate.system, certificate.time)
    check_costs(certificate, KernelBounds(certificate.system, step, certificate.time))
    plain = cell_matrix(certificate, step)
    check_matrix(certificate, plain)
    cost = certificate.switch_cost[1:]
    edge = np.arange(1, certificate.cells)
    plain[edge - 1, edge] -= 0.25 * cost
    plain[edge, edge - 1] -= 0.25 * cost
    constant = certificate.constant + 0.5 * float(np.sum(cost))
    matrix, total = apply_multipliers(certificate, plain)
    tree = Tree(certificate, matrix, plain, total)
    tree.walk()
    proven = certificate.limit**2 * (tree.largest + total + constant)
    require(proven <= certificate.bound * (1.0 + 1e-9),
            f"it says {certificate.bound:.9g} V^2 s, but proves {proven:.9g} V^2 s only")
    reached = reference.switching_energy(certificate.system, certificate.switches,
                                         certificate.time, certificate.limit)
    require(abs(reached - certificate.energy) <= 1e-9 * reached,
            "its signal does not have the energy that it says")
    return certificate, max(proven, certificate.bound)


def main() -> int:
    parser = argparse.ArgumentParser(description="Checks a certificate of emax certify.")
    parser.add_argument("certificate", help="the file")
    options = parser.parse_args()
    try:
        with open(options.certificate, encoding="ascii") as file:
            data = json.load(file)
        certificate, bound = check(data)
    except (OSError, ValueError, Rejected) as error:
        print(f"{options.certificate}: rejected: {error}", file=sys.stderr)
        return 1
    gap = 100.0 * (bound / certificate.energy - 1.0)
    print(f"proven: E <= {bound:.9g} V^2 s for every signal within +-{certificate.limit:g} m/s^2 "
          f"on [0, {certificate.time:g} s]; {certificate.energy:.9g} V^2 s is reached, "
          f"{gap:.3f} % below")
    return 0


if __name__ == "__main__":
    sys.exit(main())
