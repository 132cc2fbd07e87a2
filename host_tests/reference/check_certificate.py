#!/usr/bin/env python3
"""Checks a certificate of `emax certify` without any of the code that made it.

    check_certificate.py CERTIFICATE      exit status 0 and the proven bound, or 1 and the reason

The certificate says: every signal |x| <= a on [0, T] has E <= bound. What is believed of it: the
model, T, a, the edges of the cells, the multipliers and the y, as numbers that prove something or
do not. What is found anew, with every constant enclosed in a ball (`balls.py`) or an interval
(mpmath's `iv`), from the poles and residues of the error response k = sum of r e^(p t):

1. m_1(t), the integral over s of |d phi(t, s)/dt|, from above on a mesh; from it what each cell
   costs, m_1 h^2/2. The certificate's costs must not be lower.
2. Phi on the cells, by closed forms, each element with a radius.
3. With the multipliers, Diag(y) - Q', less the row sums of all radii, must have a Cholesky factor
   by Rump's criterion (BIT 46 (2006) 433): with (n + 2) 2^-52 of the trace taken off the diagonal
   a factorisation in floating point proves that the matrix is positive semidefinite.
4. The bound, a^2 (sum of y + sum of multipliers + sum of costs), in rational numbers.

What is assumed: the lemma and its proof in `algo/README.md`, IEEE arithmetic, and that NumPy,
LAPACK and mpmath do what they say.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from fractions import Fraction

import numpy as np
from mpmath import iv

import reference
from balls import RAISE, U, Ball, Undecided

Array = np.ndarray

MESH_RESOLUTION = 40.0  # Mesh intervals per time constant of the fastest mode.
MAX_MESH = 12000
TRIANGLE_SIGNS = ((-1, -1, -1), (-1, 1, 1), (1, -1, 1), (1, 1, -1))


class Rejected(Exception):
    """Why a certificate proves nothing."""


def require(condition: bool, reason: str) -> None:
    if not condition:
        raise Rejected(reason)


# ------------------------------------------------------------------------------------ the response


class Response:
    """Poles p and residues r of k(t) = sum of r e^(p t): intervals, and balls of them."""

    def __init__(self, system: reference.System) -> None:
        sensor, order = system.sensor, system.order
        gain = iv.mpf(system.filter.gain)
        w0 = 2 * iv.pi * iv.mpf(sensor.f0)
        beta = iv.mpf(sensor.beta)
        own = iv.mpc(-beta * w0, w0 * iv.sqrt(1 - beta * beta))
        sensor_poles = [own, self.conjugate(own)]
        rate = 2 * iv.pi * iv.mpf(system.cutoff)
        filter_poles = []
        for i in range(1, order + 1):
            angle = iv.pi * (2 * i + order - 1) / (2 * order)
            filter_poles.append(iv.mpc(rate * iv.cos(angle), rate * iv.sin(angle)))

        def residue(poles: list, i: int, numerator: object) -> object:
            value = iv.mpc(numerator)
            for j, pole in enumerate(poles):
                if j != i:
                    value = value / (poles[i] - pole)
            return value

        def value(poles: list, numerator: object, at: object) -> object:
            result = iv.mpc(numerator)
            for pole in poles:
                result = result / (at - pole)
            return result

        sensor_part, filter_part = iv.mpf(sensor.S) * w0**2, rate**order
        sensor_residues = [residue(sensor_poles, i, sensor_part) for i in range(2)]
        filter_residues = [residue(filter_poles, i, filter_part) for i in range(order)]
        if system.criterion == "band":
            sensor_residues = [r * value(filter_poles, filter_part, p)
                               for r, p in zip(sensor_residues, sensor_poles)]
            filter_residues = [r * (value(sensor_poles, sensor_part, p) - gain)
                               for r, p in zip(filter_residues, filter_poles)]
        else:
            filter_residues = [-gain * r for r in filter_residues]
        self.poles = sensor_poles + filter_poles
        self.residues = sensor_residues + filter_residues
        self.p = Ball.stack([Ball.of_interval(pole) for pole in self.poles])
        self.r = Ball.stack([Ball.of_interval(r) for r in self.residues])

    @staticmethod
    def conjugate(z: object) -> object:
        return iv.mpc(z.real, -z.imag)

    def norms(self, count: int) -> list[float]:
        """At least the square roots of the integrals of |k^(n)|^2 over [0, infinity)."""
        result = []
        for n in range(count):
            total = iv.mpf(0)
            weights = [r * p**n for r, p in zip(self.residues, self.poles)]
            for p, own in zip(self.poles, weights):
                for q, other in zip(self.poles, weights):
                    total -= (own * other / (p + q)).real
            result.append(float(iv.sqrt(abs(total)).b) * RAISE)
        return result

    def starts(self, count: int) -> list[float]:
        """At least |k^(n)(0)|."""
        result = []
        for n in range(count):
            total = sum(((r * p**n).real for r, p in zip(self.residues, self.poles)), iv.mpf(0))
            result.append(float(abs(total).b) * RAISE)
        return result


# ----------------------------------------------------------------------------------- constants


class SlopeBound:
    """m_1(t) = integral over s of |f(t, s)|, f = d phi/dt, from above on [0, T].

    For s >= t, f = -integral of k(w) k'(w + s - t) up to T - s; for s <= t it is -k(T - t) k(T - s)
    + integral of k(w) k'(w + t - s) up to T - t. f has a continuous slope, as k(0) = 0. Second
    derivatives of f by t or s, integrated over s, are at most `curvature`: the norms of k and k'''
    for the integral, and products of the largest |k^(n)| with integrals of |k^(2 - n)| for what the
    moving end adds. So linear interpolation of |f| in s and in t is off by at most curvature/8
    times the square of the step, each.
    """

    def __init__(self, response: Response, time: float) -> None:
        fastest = float(np.max(response.p.size()))
        self.count = max(400, math.ceil(time * fastest * MESH_RESOLUTION))
        require(self.count <= MAX_MESH, "T is too long for the mesh of this check")
        norms, starts = response.norms(4), response.starts(3)
        root = math.sqrt(time) * RAISE
        largest = [starts[n] + root * norms[n + 1] for n in range(3)]
        curvature = time * norms[0] * norms[3]
        curvature += sum(largest[2 - n] * root * norms[n] for n in range(3))
        self.step = Fraction(time) / self.count
        step = float(self.step) * RAISE
        self.remainder = 0.25 * curvature * step * step * (1.0 + 1e-12)
        self.integrals = self._integrals(response, step)

    def _integrals(self, response: Response, step: float) -> Array:
        """By the trapezoidal rule, at each point of the mesh."""
        n, p = self.count, response.p
        step_ball = Ball(float(self.step), float(self.step) * U)
        powers = (p * step_ball).exp()
        e = self._powers(powers, n + 1)  # e^(p m step), by mode and m.
        # U_p(tau) = sum over q of r_q (e^((p + q) tau) - 1)/(p + q).
        held_middle = np.zeros((len(p.middle), n + 1), dtype=complex)
        held_radius = np.zeros(held_middle.shape)
        one = Ball(1.0)
        for i in range(len(p.middle)):
            weight = (response.r * (p[i] + p).inverse())[:, None]
            held = (weight * (e * e[i : i + 1] - one)).sum(0)
            held_middle[i], held_radius[i] = held.middle, held.radius
        held = Ball(held_middle, held_radius)
        k = (response.r[:, None] * e).sum(0)
        c = (response.r * p)[:, None]
        later = c * held  # By mode and M, s = T - M step.
        # What a sum over modes of products may be off by, the same everywhere.
        def largest(values: Array) -> Array:
            return np.max(values, axis=1)

        off = float(np.sum(largest(np.abs(later.middle)) * largest(e.radius)
                           + largest(later.radius) * largest(e.size())))
        off += 8.0 * (len(p.middle) + 4) * U * float(
            np.sum(largest(later.size()) * largest(e.size())))
        size = float(np.max(k.size()))
        off += 2.0 * size * float(np.max(k.radius)) + 8.0 * U * size * size
        off *= RAISE**2
        totals = np.zeros(n + 1)
        em, lm, km = e.middle, later.middle, k.middle.real
        for t in range(n + 1):
            left = n - t  # T - t in steps.
            # s = t + m: T - s = left - m.
            after = np.abs(np.einsum("pm,pm->m", em[:, : left + 1], lm[:, left::-1]).real)
            # s = t - m: T - s = left + m.
            before = np.abs(np.einsum("p,pm->m", lm[:, left], em[:, : t + 1]).real
                            - km[left] * km[left : n + 1])
            total = np.sum(after) - 0.5 * (after[0] + after[-1])
            total += np.sum(before) - 0.5 * (before[0] + before[-1])
            totals[t] = total * (1.0 + 8.0 * n * U) + (n + 2) * off
        return totals * step * RAISE**2

    @staticmethod
    def _powers(base: Ball, count: int) -> Ball:
        """base^m, m below count, in the second dimension, by doubling."""
        result = Ball(np.ones((len(base.middle), 1)))
        factor = base[:, None]
        while result.middle.shape[1] < count:
            more = result * factor
            result = Ball(np.concatenate([result.middle, more.middle], axis=1),
                          np.concatenate([result.radius, more.radius], axis=1))
            factor = factor * factor
        return result[:, :count]

    def over(self, start: float, stop: float) -> float:
        """At least m_1 anywhere on [start, stop]."""
        low = max(math.floor(Fraction(start) / self.step), 0)
        high = min(math.ceil(Fraction(stop) / self.step), self.count)
        return (float(np.max(self.integrals[low : high + 1])) + self.remainder) * RAISE


def cell_matrix(response: Response, edges: Array) -> tuple[Array, Array]:
    """Phi on the cells and the radii of its elements, by closed forms.

    For cells i < j, Phi_ij = sum over p of early_p(i) e^(p d) late_p(j), d from the end of i to the
    start of j: early is the integral of e^(p (end - t)) over i, late that of r_p e^(p (s - start))
    U_p(T - s) over j. The powers come from cell to cell, so they only decay.
    """
    p, r = response.p, response.r
    modes, cells = len(p.middle), len(edges) - 1
    width = np.diff(edges)  # Exact or rounded once.
    widths = Ball(width, U * width)[:, None]
    left = edges[-1] - edges
    to_end = Ball(left, U * np.abs(left))[:, None]  # T - edge.
    row = p[None, :]
    decay = (row * widths).exp()
    end = (row * to_end).exp()
    one = Ball(1.0)
    early = (decay - one) * row.inverse()
    late_middle = np.zeros((cells, modes), dtype=complex)
    late_radius = np.zeros((cells, modes))
    diagonal = Ball(np.zeros(cells))
    for i in range(modes):
        own, c = p[i], r * (p[i] + p).inverse()
        c = c[None, :]
        begin = end[:-1, i : i + 1]
        held = (c * (begin * end[1:] * early - early[:, i : i + 1])).sum(1)
        part = r[i] * held
        late_middle[:, i], late_radius[:, i] = part.middle, part.radius
        # (1 - e^(-q w))/q e^((p+q) tau) = e^(p tau) e^(q (tau - w)) early_q, and for p + q too.
        both = (decay * decay[:, i : i + 1] - one) * (row + own).inverse()
        ends = begin * end[1:] * early - end[1:] * end[1:, i : i + 1] * both
        inner = (c * (ends - (early[:, i] - widths[:, 0])[:, None])).sum(1)
        diagonal = diagonal + r[i] * own.inverse() * inner * Ball(2.0)
    late = Ball(late_middle, late_radius)
    matrix = np.diag(diagonal.middle.real)
    radius = np.diag(diagonal.radius)
    reach = early[:1]  # early_p(i) e^(p d) of all i < j.
    for j in range(1, cells):
        column = (reach * late[j : j + 1]).sum(1)
        matrix[:j, j] = matrix[j, :j] = column.middle.real
        radius[:j, j] = radius[j, :j] = column.radius
        moved = reach * decay[j : j + 1]
        reach = Ball(np.concatenate([moved.middle, early.middle[j : j + 1]]),
                     np.concatenate([moved.radius, early.radius[j : j + 1]]))
    return matrix, radius


# ------------------------------------------------------------------------------- the certificate


class Certificate:
    """A file of `emax certify`, with the plain faults of its form found."""

    def __init__(self, data: dict) -> None:
        require(isinstance(data, dict) and "certificate" in data, "not a certificate")
        require(data["certificate"] != 1,
                "a certificate of format 1, from before version 2 of the proof; "
                "make a new one with emax certify")
        require(data["certificate"] == 2, "a certificate of a format that is not known here")
        try:
            model, limits = data["model"], data["signal"]
            self.system = reference.System(
                reference.Accelerometer(float(model["S"]), float(model["f0"]),
                                        float(model["beta"])),
                int(model["order"]), float(model["cutoff"]), float(model["gain"]),
                model.get("criterion", "ise"))
            self.time, self.limit = float(limits["T"]), float(limits["a"])
            self.energy = float(data["energy"]["E"])
            self.switches = [float(t) for t in data["energy"]["switch_times"]]
            self.bound = float(data["bound"])
            self.edges = np.array(data["edges"], dtype=float)
            self.costs = np.array(data["costs"], dtype=float)
            self.unit = float(data["unit"])
            self.multipliers = np.array(data["multipliers"], dtype=np.int64).reshape(-1, 5)
            self.y = np.array(data["y"], dtype=np.int64)
        except (KeyError, TypeError, ValueError) as error:
            raise Rejected(f"not a certificate: {error!r}") from error
        self.cells = len(self.edges) - 1
        self.check_form()

    def check_form(self) -> None:
        require(self.system.criterion in ("ise", "band"), "a criterion that is not covered")
        require(self.system.order >= 2, "a filter of order 1 or less")
        require(self.cells >= 2 and self.edges[0] == 0.0 and self.edges[-1] == self.time
                and bool(np.all(np.diff(self.edges) > 0.0)), "edges do not go from 0 to T")
        require(self.costs.shape == (self.cells,) and self.y.shape == (self.cells,),
                "costs or y do not fit the edges")
        require(self.limit > 0.0 and math.isfinite(self.limit), "the limit is not above 0")
        require(self.unit > 0.0 and math.frexp(self.unit)[0] == 0.5, "unit is no power of two")
        require(bool(np.all(self.y >= 0)), "a negative y")
        i, j, k, kind, units = self.multipliers.T
        require(bool(np.all((0 <= i) & (i < j) & (j < k) & (k < self.cells))),
                "a multiplier of cells that are not i < j < k")
        require(bool(np.all((0 <= kind) & (kind <= 3))), "a multiplier of no known kind")
        require(bool(np.all(units >= 0)), "a negative multiplier of an inequality")
        largest = max(int(np.sum(units)), int(np.sum(self.y)))
        require(largest < 2**51, "multipliers or y are too large for this check")


def check_costs(certificate: Certificate, slope: SlopeBound) -> None:
    for cell, (start, stop) in enumerate(zip(certificate.edges[:-1], certificate.edges[1:])):
        width = Fraction(float(stop)) - Fraction(float(start))
        least = Fraction(slope.over(float(start), float(stop))) * width * width / 2
        require(Fraction(float(certificate.costs[cell])) >= least,
                f"the cost of cell {cell} is too low")


def check_slack(certificate: Certificate, matrix: Array, radius: Array) -> None:
    """Diag(y) - Q' is positive semidefinite, Q' = Phi - Diag(costs) - multipliers."""
    i, j, k, kind, units = certificate.multipliers.T
    cells = certificate.cells
    signs = np.array(TRIANGLE_SIGNS)[kind]
    doubled = np.zeros((cells, cells), dtype=np.int64)  # In half units; whole numbers are exact.
    for column, (first, second) in enumerate(((i, j), (j, k), (i, k))):
        np.add.at(doubled, (first, second), units * signs[:, column])
        np.add.at(doubled, (second, first), units * signs[:, column])
    doubled += np.diag(2 * certificate.y)
    exact = 0.5 * certificate.unit * doubled  # Below 2^53 half units.
    costs = np.diag(certificate.costs)
    slack = (exact - matrix) + costs
    off = radius + 4.0 * U * (np.abs(exact) + np.abs(matrix) + costs)
    slack -= np.diag(np.sum(off, axis=1) * (1.0 + 4.0 * cells * U) * RAISE)
    diagonal = np.diag(slack)
    require(bool(np.all(diagonal > 0.0)), "Diag(y) - Q' is not positive definite")
    rump = (cells + 4) * 2.0 * 2.0**-52 * float(np.sum(diagonal))
    slack[np.diag_indices(cells)] -= rump + 8.0 * U * np.abs(diagonal)
    try:
        np.linalg.cholesky(slack)
    except np.linalg.LinAlgError as error:
        raise Rejected("Diag(y) - Q' is not positive definite") from error


def proven_bound(certificate: Certificate) -> Fraction:
    units = int(np.sum(certificate.y)) + int(np.sum(certificate.multipliers[:, 4]))
    total = units * Fraction(certificate.unit)
    total += sum((Fraction(float(cost)) for cost in certificate.costs), Fraction(0))
    return Fraction(certificate.limit) ** 2 * total


def check(data: dict) -> tuple[Certificate, float]:
    """Returns the certificate and its bound if that is proven, or raises Rejected."""
    certificate = Certificate(data)
    proven = proven_bound(certificate)
    require(proven <= Fraction(certificate.bound),
            f"it says {certificate.bound:.12g} V^2 s, but proves {float(proven):.12g} V^2 s only")
    try:
        response = Response(certificate.system)
        check_costs(certificate, SlopeBound(response, certificate.time))
        matrix, radius = cell_matrix(response, certificate.edges)
    except (Undecided, ZeroDivisionError) as error:
        raise Rejected(f"not decided: {error}") from error
    check_slack(certificate, matrix, radius)
    reached = reference.switching_energy(certificate.system, certificate.switches,
                                         certificate.time, certificate.limit)
    require(abs(reached - certificate.energy) <= 1e-9 * reached,
            "its signal does not have the energy that it says")
    return certificate, certificate.bound


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
