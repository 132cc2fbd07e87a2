#!/usr/bin/env python3
"""Checks a certificate of `emax certify` without any of the code that made it.

    check_certificate.py CERTIFICATE      exit status 0 and the proven bound, or 1 and the reason

The certificate says: every signal |x| <= a on [0, T] has E <= bound, for one device or for all in
a box. What is believed of it: the
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
5. For a box of devices all that for each of its corners, and what the energy of a signal may be
   more inside, by bounds of the second derivatives of the sensor's response by f0 and by beta.

What is assumed: the lemma and its proof in `algo/README.md`, IEEE arithmetic, and that NumPy,
LAPACK and mpmath do what they say.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import sys
from fractions import Fraction
from typing import Callable, Iterable

import numpy as np
from mpmath import iv

import reference
from balls import RAISE, U, Ball, Undecided

Array = np.ndarray

MESH_RESOLUTION = 40.0  # Mesh intervals per time constant of the fastest mode.
# As far as the program goes: 32768 intervals, 16 per time constant, there; more takes minutes here.
MAX_MESH = 81920
TRIANGLE_SIGNS = ((-1, -1, -1), (-1, 1, 1), (1, -1, 1), (1, 1, -1))


class Rejected(Exception):
    """Why a certificate proves nothing."""


def require(condition: bool, reason: str) -> None:
    if not condition:
        raise Rejected(reason)


# ------------------------------------------------------------------------------------ the response


class Response:
    """Poles p and residues r of k(t) = sum of r e^(p t): intervals, and balls of them."""

    def __init__(self, sensor: list, filter_poles: list, residues: list, starts_at_zero: bool) -> None:
        poles = sensor + filter_poles
        # Where the conjugate of each pole is: both ways round in both lists.
        self.mirrors = [len(sensor) - 1 - i for i in range(len(sensor))]
        self.mirrors += [len(poles) - 1 - i for i in range(len(filter_poles))]
        self.poles, self.residues, self.starts_at_zero = poles, residues, starts_at_zero
        self.p = Ball.stack([Ball.of_interval(pole) for pole in poles])
        self.r = Ball.stack([Ball.of_interval(r) for r in residues])

    @staticmethod
    def parts_of(system: reference.System) -> "list[tuple[float, Response]]":
        """The responses whose energies, each with its sign, add up to the criterion."""
        sensor, order = system.sensor, system.order
        gain = iv.mpf(system.filter.gain)
        w0 = 2 * iv.pi * iv.mpf(sensor.f0)
        beta = iv.mpf(sensor.beta)
        own = iv.mpc(-beta * w0, w0 * iv.sqrt(1 - beta * beta))
        sensor_poles = [own, Response.conjugate(own)]
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
        starts_at_zero = order >= 2 and system.delay == 0.0
        if system.criterion == "difference":
            filter_residues = [gain * r for r in filter_residues]
            return [(1.0, Response(sensor_poles, [], sensor_residues, True)),
                    (-1.0, Response([], filter_poles, filter_residues, starts_at_zero))]
        if system.criterion == "band":
            # The delayed filter is h(t - delay) continued to earlier t by its modes.
            delay = iv.mpf(system.delay)
            sensor_residues = [r * value(filter_poles, filter_part, p)
                               for r, p in zip(sensor_residues, sensor_poles)]
            filter_residues = [r * (value(sensor_poles, sensor_part, p) - gain * iv.exp(-p * delay))
                               for r, p in zip(filter_residues, filter_poles)]
        else:
            filter_residues = [-gain * r for r in filter_residues]
        return [(1.0, Response(sensor_poles, filter_poles, sensor_residues + filter_residues,
                               starts_at_zero))]

    @staticmethod
    def conjugate(z: object) -> object:
        return iv.mpc(z.real, -z.imag)

    def over_times(self, function: Callable[[object, object], object], times: list) -> Ball:
        """Function(pole, time) for each time and pole, in intervals; real up to conjugation."""
        balls: dict[int, list[Ball]] = {}
        for i, pole in enumerate(self.poles):
            mirror = self.mirrors[i]
            if mirror in balls:
                balls[i] = [Ball(np.conj(ball.middle), ball.radius) for ball in balls[mirror]]
            else:
                balls[i] = [Ball.of_interval(function(pole, time)) for time in times]
        return Ball(np.array([[complex(ball.middle) for ball in balls[i]] for i in balls]).T,
                    np.array([[float(ball.radius) for ball in balls[i]] for i in balls]).T)

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

    def start(self) -> float:
        """At least |k(0)|."""
        total = sum((r.real for r in self.residues), iv.mpf(0))
        return float(abs(total).b) * RAISE


# ----------------------------------------------------------------------------------- constants


class SlopeBound:
    """m_1(t) = integral over s of |f(t, s)|, f = d phi/dt, from above on [0, T].

    For s >= t, f = -integral of k(w) k'(w + s - t) up to T - s; for s <= t it is -k(T - t) k(T - s)
    + integral of k(w) k'(w + t - s) up to T - t. Second derivatives of either by t or s, integrated
    over s, are at most `curvature`: the norms of k and k''' for the integral, and products of the
    largest |k^(n)| with integrals of |k^(2 - n)| for what the moving end adds. Where k(0) = 0, f has
    a continuous slope; so linear interpolation of |f| in s and in t is off by at most curvature/8
    times the square of the step, each.

    Where k(0) is not 0, f jumps at s = t, by k(0)^2. For t at a part c of the way between two points
    of the mesh, that is within one step of s. There |f| is above its interpolation by no more than
    the jump and two steps of `slope`, a bound of |df/dt| on both sides, times 1 - c before t and c
    after it: over s, by at most a step times half the jump and a step of slope. The energy
    difference is a sum of two f.
    """

    def __init__(self, parts: "list[tuple[float, Response]]", time: float) -> None:
        fastest = max(float(np.max(response.p.size())) for _, response in parts)
        self.count = max(400, math.ceil(time * fastest * MESH_RESOLUTION))
        require(self.count <= MAX_MESH, "T is too long for the mesh of this check")
        self.step = Fraction(time) / self.count
        step = float(self.step) * RAISE
        self.remainder = sum(self._remainder(response, time, step) for _, response in parts)
        self.integrals = self._integrals(parts, step)

    @staticmethod
    def _remainder(response: Response, time: float, step: float) -> float:
        norms, start = response.norms(4), response.start()
        root = math.sqrt(time) * RAISE
        # |k^(n)|^2 = -2 integral of k^(n) k^(n+1) from there on.
        largest = [math.sqrt(2.0 * norms[n] * norms[n + 1]) * RAISE for n in range(3)]
        curvature = time * norms[0] * norms[3]
        curvature += sum(largest[2 - n] * root * norms[n] for n in range(3))
        result = 0.25 * curvature * step * step
        if not response.starts_at_zero:
            slope = 2.0 * largest[0] * largest[1] + norms[0] * norms[2]
            result += step * (0.5 * start**2 + step * slope)
        return result * (1.0 + 1e-12)

    def _integrals(self, parts: "list[tuple[float, Response]]", step: float) -> Array:
        """By the trapezoidal rule, at each point of the mesh."""
        n = self.count
        tables = [(sign, *self._tables(response)) for sign, response in parts]
        off = sum(table[-1] for table in tables) * (1.0 + 16.0 * U)
        totals = np.zeros(n + 1)
        for t in range(n + 1):
            left = n - t  # T - t in steps.
            after, before = np.zeros(left + 1), np.zeros(t + 1)
            for sign, em, lm, km, _ in tables:
                # s = t + m: T - s = left - m; and s = t - m: T - s = left + m.
                after += sign * np.einsum("pm,pm->m", em[:, : left + 1], lm[:, left::-1]).real
                before += sign * (np.einsum("p,pm->m", lm[:, left], em[:, : t + 1]).real
                                  - km[left] * km[left : n + 1])
            after, before = np.abs(after), np.abs(before)
            total = np.sum(after) - 0.5 * (after[0] + after[-1])
            total += np.sum(before) - 0.5 * (before[0] + before[-1])
            totals[t] = total * (1.0 + 8.0 * n * U) + (n + 2) * off
        return totals * step * RAISE**2

    def _tables(self, response: Response) -> tuple[Array, Array, Array, float]:
        """e^(p m step); r p U_p(m step), by mode and m; k(m step); what a term of f is off by."""
        n, p = self.count, response.p
        step_ball = Ball(float(self.step), float(self.step) * U)
        e = self._powers((p * step_ball).exp(), n + 1)
        # U_p(tau) = sum over q of r_q (e^((p + q) tau) - 1)/(p + q).
        held_middle = np.zeros((len(p.middle), n + 1), dtype=complex)
        held_radius = np.zeros(held_middle.shape)
        one = Ball(1.0)
        for i in range(len(p.middle)):
            weight = (response.r * (p[i] + p).inverse())[:, None]
            held = (weight * (e * e[i : i + 1] - one)).sum(0)
            held_middle[i], held_radius[i] = held.middle, held.radius
        k = (response.r[:, None] * e).sum(0)
        later = (response.r * p)[:, None] * Ball(held_middle, held_radius)

        def largest(values: Array) -> Array:
            return np.max(values, axis=1)

        # What a sum over modes of products may be off by, the same everywhere.
        off = float(np.sum(largest(np.abs(later.middle)) * largest(e.radius)
                           + largest(later.radius) * largest(e.size())))
        off += 8.0 * (len(p.middle) + 4) * U * float(
            np.sum(largest(later.size()) * largest(e.size())))
        size = float(np.max(k.size()))
        off += 2.0 * size * float(np.max(k.radius)) + 8.0 * U * size * size
        return e.middle, later.middle, k.middle.real, off * RAISE**2

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


def cell_matrix(parts: "list[tuple[float, Response]]", edges: Array) -> tuple[Array, Array]:
    """Phi on the cells and the radii of its elements."""
    matrix = radius = np.zeros((len(edges) - 1, len(edges) - 1))
    for sign, response in parts:
        part, off = part_matrix(response, edges)
        matrix = matrix + sign * part
        radius = (radius + off + 2.0 * U * np.abs(matrix)) * RAISE
    return matrix, radius


def part_matrix(response: Response, edges: Array) -> tuple[Array, Array]:
    """Phi of one response and the radii of its elements, by closed forms.

    For cells i < j, Phi_ij = sum over p of early_p(i) e^(p d) late_p(j), d from the end of i to the
    start of j: early is the integral of e^(p (end - t)) over i, late that of r_p e^(p (s - start))
    U_p(T - s) over j. The powers come from cell to cell, so they only decay.
    """
    p, r = response.p, response.r
    modes, cells = len(p.middle), len(edges) - 1
    width = np.diff(edges)  # Exact or rounded once.
    widths = Ball(width, U * width)[:, None]
    row = p[None, :]
    exact = [iv.mpf(float(edge)) for edge in edges]
    exact_widths = [stop - start for start, stop in zip(exact, exact[1:])]
    decay = response.over_times(lambda pole, time: iv.exp(pole * time), exact_widths)
    early = response.over_times(lambda pole, time: (iv.exp(pole * time) - 1) / pole, exact_widths)
    end = response.over_times(lambda pole, time: iv.exp(pole * time), [exact[-1] - edge for edge in exact])
    one = Ball(1.0)
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
    """A file of `emax certify`, with the plain faults of its form found.

    Format 2 is about one device, format 3 about a box of them: knots along S, f0 and beta, whose
    products are the corners, beta running fastest. `systems` are the corners, `y` has a row for each.
    """

    def __init__(self, data: dict) -> None:
        require(isinstance(data, dict) and "certificate" in data, "not a certificate")
        require(data["certificate"] != 1,
                "a certificate of format 1, from before version 2 of the proof; "
                "make a new one with emax certify")
        require(data["certificate"] in (2, 3), "a certificate of a format that is not known here")
        self.is_box = data["certificate"] == 3
        try:
            model, limits, energy = data["box" if self.is_box else "model"], data["signal"], data["energy"]
            self.knots = [[float(value) for value in (model[name] if self.is_box else [model[name]])]
                          for name in ("S", "f0", "beta")]
            self.gain_follows = self.is_box and model["gain"] is None
            self.systems = [self.system_of(model, device) for device in itertools.product(*self.knots)]
            self.time, self.limit = float(limits["T"]), float(limits["a"])
            self.energy = float(energy["E"])
            self.switches = [float(t) for t in energy["switch_times"]]
            self.best = (self.system_of(model, (float(energy[name]) for name in ("S", "f0", "beta")))
                         if self.is_box else self.systems[0])
            self.bound = float(data["bound"])
            self.curvature = ([float(data["curvature"][name]) for name in ("f0", "beta")]
                              if self.is_box else [0.0, 0.0])
            self.edges = np.array(data["edges"], dtype=float)
            self.costs = np.array(data["costs"], dtype=float)
            self.unit = float(data["unit"])
            self.multipliers = np.array(data["multipliers"], dtype=np.int64).reshape(-1, 5)
            self.y = np.array(data["y"] if self.is_box else [data["y"]], dtype=np.int64)
        except (KeyError, TypeError, ValueError) as error:
            raise Rejected(f"not a certificate: {error!r}") from error
        self.cells = len(self.edges) - 1
        self.check_form()

    @staticmethod
    def system_of(model: dict, device: Iterable[float]) -> reference.System:
        gain = None if model["gain"] is None else float(model["gain"])
        return reference.System(reference.Accelerometer(*device), int(model["order"]),
                                float(model["cutoff"]), gain, model.get("criterion", "ise"),
                                float(model.get("delay", 0.0)))

    def check_box(self) -> None:
        sensitivities, frequencies, dampings = self.knots
        for values in self.knots:
            require(len(values) >= 1 and values[0] > 0.0 and bool(np.all(np.diff(values) > 0.0)),
                    "knots of the box do not ascend")
        require(len(sensitivities) <= 2, "more than two knots along S")
        require(not self.gain_follows or len(sensitivities) == 1, "a gain that follows more than one S")
        require(dampings[-1] < 1.0, "a damping of 1 or more")
        best = self.best.sensor
        for value, knots in zip((best.S, best.f0, best.beta), self.knots):
            require(knots[0] <= value <= knots[-1], "its signal is for a device outside the box")

    def check_form(self) -> None:
        self.check_box()
        system = self.systems[0]
        require(system.criterion in ("ise", "difference", "band"), "a criterion that is not covered")
        require(1 <= system.order <= 15, "a filter that is not of order 1 to 15")
        most = 1.0 / (2.0 * math.pi * system.cutoff) if system.criterion == "band" else 0.0
        require(0.0 <= system.delay <= most, "a delay that is not covered")
        require(self.cells >= 2 and self.edges[0] == 0.0 and self.edges[-1] == self.time
                and bool(np.all(np.diff(self.edges) > 0.0)), "edges do not go from 0 to T")
        require(self.costs.shape == (self.cells,) and self.y.shape[1:] == (self.cells,),
                "costs or y do not fit the edges")
        require(len(self.y) == len(self.systems), "there is not a y for each corner")
        require(self.limit > 0.0 and math.isfinite(self.limit), "the limit is not above 0")
        require(self.unit > 0.0 and math.frexp(self.unit)[0] == 0.5, "unit is no power of two")
        require(bool(np.all(self.y >= 0)), "a negative y")
        i, j, k, kind, units = self.multipliers.T
        require(bool(np.all((0 <= i) & (i < j) & (j < k) & (k < self.cells))),
                "a multiplier of cells that are not i < j < k")
        require(bool(np.all((0 <= kind) & (kind <= 3))), "a multiplier of no known kind")
        require(bool(np.all(units >= 0)), "a negative multiplier of an inequality")
        largest = max(int(np.sum(units)), int(np.max(np.sum(self.y, axis=1))))
        require(largest < 2**51, "multipliers or y are too large for this check")


def check_costs(certificate: Certificate, system: reference.System, slope: SlopeBound) -> None:
    """At least m_1 h^2/2, and h^3 (max |s Kf|/pi)^2 for the energy difference: |s Kf| <= G 2 pi fc."""
    rest = Fraction(0)
    if system.criterion == "difference":
        rest = (2 * Fraction(system.filter.gain) * Fraction(system.cutoff)) ** 2
    for cell, (start, stop) in enumerate(zip(certificate.edges[:-1], certificate.edges[1:])):
        width = Fraction(float(stop)) - Fraction(float(start))
        m1 = Fraction(slope.over(float(start), float(stop)))
        least = (m1 / 2 + rest * width) * width * width
        require(Fraction(float(certificate.costs[cell])) >= least,
                f"the cost of cell {cell} is too low")


def multipliers_matrix(certificate: Certificate) -> Array:
    """Twice what the multipliers take off Phi, in units; whole numbers are exact."""
    i, j, k, kind, units = certificate.multipliers.T
    signs = np.array(TRIANGLE_SIGNS)[kind]
    doubled = np.zeros((certificate.cells, certificate.cells), dtype=np.int64)
    for column, (first, second) in enumerate(((i, j), (j, k), (i, k))):
        np.add.at(doubled, (first, second), units * signs[:, column])
        np.add.at(doubled, (second, first), units * signs[:, column])
    return doubled


def check_slack(certificate: Certificate, doubled: Array, y: Array, matrix: Array,
                radius: Array) -> None:
    """Diag(y) - Q' is positive semidefinite, Q' = Phi - Diag(costs) - multipliers."""
    cells = certificate.cells
    exact = 0.5 * certificate.unit * (doubled + np.diag(2 * y))  # Below 2^53 half units.
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


# ------------------------------------------------------------------------------------------- boxes


def root_mean_square(values: Array, step: float) -> float:
    """At least the root of the mean over v of (integral up to v of q)^2, `values` >= q on each step."""
    integrals = np.cumsum(values) * step * (1.0 + 8.0 * len(values) * U)
    return math.sqrt(float(np.sum(integrals**2)) / len(values)) * (1.0 + 8.0 * len(values) * U)


def sensor_curvatures(frequency: float, low: float, high: float, time: float) -> tuple[float, float]:
    """At least the sizes of w^2 d^2 K/dw^2 x and of d^2 K/dbeta^2 x over [0, T], for |x| <= 1.

    In units of sqrt(T) S; w is 2 pi f0. The sensor has frequencies up to `frequency` and dampings from `low` to
    `high`. With u = 2 pi f0 t and pole -beta + i kappa, |pole| = 1, k = S 2 pi f0 Im e^(pole u)/kappa.
    |Im z| <= |z| gives what is integrated: for f0 u |2 pole + pole^2 u| e^(-beta u)/kappa, and for beta
    |A^2 + dA/dbeta| e^(-beta u)/kappa with A = i pole u/kappa + beta/kappa^2, so that
    |A|^2 = u^2/kappa^2 - 2 u beta/kappa^2 + beta^2/kappa^4 and
    dA/dbeta = (1 + beta^2)/kappa^4 - i u/kappa^3. Each factor is taken where it is largest: on a step
    of u at one of its ends, and of beta at `low` or `high`.
    """
    count = 50000
    end = 2.0 * math.pi * frequency * time * RAISE
    step = end / count * RAISE
    first = np.arange(count) * step * (1.0 - 4.0 * U)
    last = np.arange(1, count + 1) * step * RAISE
    square_low, square_high = (1.0 - low * low) * RAISE, (1.0 - high * high) / RAISE  # kappa^2
    exponential = (Ball(-low) * Ball(first)).exp()
    decay = exponential.size() / math.sqrt(square_high) * RAISE**2

    def quadratic(u: Array) -> Array:
        return 4.0 - 4.0 * low * u + u * u  # Convex in u.

    frequency_values = last * np.sqrt(np.maximum(quadratic(first), quadratic(last))) * decay
    size = last**2 / square_high - 2.0 * first * low / square_low + high**2 / square_high**2
    change = np.sqrt(((1.0 + high**2) / square_high**2) ** 2 + last**2 / square_high**3)
    damping_values = (size + change) * decay
    raised = 1.0 + 2.0**-40  # Roundings of a few operations, and cancellation by 2 in `size`.
    return (root_mean_square(frequency_values, step) * raised,
            root_mean_square(damping_values, step) * raised)


def filter_integral(system: reference.System, time: float) -> float:
    """At least the integral of |h| over [0, T], h the filter with a gain of 1: by the trapezoidal rule
    and step^2/8 times the integral of |h''|, which is at most sqrt(T) times its norm."""
    unit = reference.System(system.sensor, system.order, system.cutoff, 1.0, "difference")
    response = Response.parts_of(unit)[1][1]
    count = 4096
    step = Fraction(time) / count
    base = (response.p * Ball(float(step), float(step) * U)).exp()
    h = (response.r[:, None] * SlopeBound._powers(base, count + 1)).sum(0)
    total = float(np.sum(h.size())) * (1.0 + 8.0 * count * U) * float(step)
    curvature = math.sqrt(time) * response.norms(3)[2]
    return (total + 0.125 * float(step) ** 2 * curvature) * (1.0 + 2.0**-40)


def cells_of(knots: list[float]) -> list[tuple[float, float]]:
    return list(zip(knots, knots[1:])) or [(knots[0], knots[0])]


def check_curvature(certificate: Certificate) -> None:
    """w^2/4 times the size of K_p'' x, w the width of a cell of the box, in each cell."""
    sensitivities, frequencies, dampings = certificate.knots
    system = certificate.systems[0]
    factor = sensitivities[-1] * math.sqrt(certificate.time) * RAISE
    if system.criterion == "band":
        factor *= filter_integral(system, certificate.time)
    needed = [0.0, 0.0]
    for (first, last), (low, high) in itertools.product(cells_of(frequencies), cells_of(dampings)):
        sizes = sensor_curvatures(last, low, high, certificate.time)
        for side, width in enumerate(((last - first) / first, high - low)):
            term = 0.25 * width**2 * sizes[side] * factor * (1.0 + 16.0 * U)
            needed[side] = max(needed[side], term)
    for name, term, given in zip(("f0", "beta"), needed, certificate.curvature):
        require(given >= term, f"the curvature by {name} is too low")


def proven_bound(certificate: Certificate) -> Fraction:
    """From the largest of the corners; between them B <= that + q sqrt(B + W).

    q is the sum of the curvature terms times a. W is 0, and for the energy difference (G a)^2 T, as
    ||Ka x||^2 <= B + ||Kf x||^2. The largest B is the square of z = (q + sqrt(q^2 + 4 (corners +
    W)))/2 less W.
    """
    units = int(np.max(np.sum(certificate.y, axis=1))) + int(np.sum(certificate.multipliers[:, 4]))
    total = units * Fraction(certificate.unit)
    total += sum((Fraction(float(cost)) for cost in certificate.costs), Fraction(0))
    corners = Fraction(certificate.limit) ** 2 * total
    terms = Fraction(certificate.curvature[0]) + Fraction(certificate.curvature[1])
    if terms == 0:
        return corners
    more = Fraction(0)
    if certificate.systems[0].criterion == "difference":
        gain = max(Fraction(system.filter.gain) for system in certificate.systems)
        more = (gain * Fraction(certificate.limit)) ** 2 * Fraction(certificate.time)

    def interval(value: Fraction) -> object:
        return iv.mpf(value.numerator) / iv.mpf(value.denominator)

    q = interval(terms * Fraction(certificate.limit))
    z = (q + iv.sqrt(q * q + 4 * interval(corners + more))) / 2
    return Fraction(float((z * z - interval(more)).b) * RAISE)


def slope_of(system: reference.System, time: float) -> SlopeBound:
    try:
        return SlopeBound(Response.parts_of(system), time)
    except (Undecided, ZeroDivisionError) as error:
        raise Rejected(f"not decided: {error}") from error


def matrix_of(system: reference.System, edges: Array) -> tuple[Array, Array]:
    try:
        return cell_matrix(Response.parts_of(system), edges)
    except (Undecided, ZeroDivisionError) as error:
        raise Rejected(f"not decided: {error}") from error


def signal_energy(parts: "list[tuple[float, Response]]", switches: list[float], time: float) -> object:
    """The interval of E of a signal that begins as +1 and changes its sign at these times.

    Within a piece where x = c, y = sum of w e^(p u) + c D with D = -sum of r/p, and w = r (z + c/p)
    at its start, z being the integral of e^(p (start - v)) x(v). Small errors are differences of
    large outputs: 40 digits keep theirs, which sums in floating point do not.
    """
    times = [iv.mpf(float(t)) for t in [0.0, *switches, time]]
    total = iv.mpf(0)
    for sign, response in parts:
        poles, residues = response.poles, response.residues
        size = range(len(poles))
        settled = -sum(r / p for r, p in zip(residues, poles))
        pairs = [(i, j, (1 if i == j else 2) / (poles[i] + poles[j])) for i in size for j in size if i <= j]
        held, value, energy = [iv.mpc(0)] * len(poles), 1, iv.mpc(0)
        for start, stop in zip(times, times[1:]):
            decay = [iv.exp(p * (stop - start)) for p in poles]
            first = [r * (z + value / p) for r, z, p in zip(residues, held, poles)]
            last = [w * e for w, e in zip(first, decay)]
            energy += sum(weight * (last[i] * last[j] - first[i] * first[j]) for i, j, weight in pairs)
            energy += sum(2 * value * settled * (last[i] - first[i]) / poles[i] for i in size)
            energy += settled * settled * (stop - start)
            held = [(z + value / p) * e - value / p for z, p, e in zip(held, poles, decay)]
            value = -value
        total += sign * energy.real
    return total


def check(data: dict) -> tuple[Certificate, float]:
    """Returns the certificate and its bound if that is proven, or raises Rejected."""
    certificate = Certificate(data)
    proven = proven_bound(certificate)
    require(proven <= Fraction(certificate.bound),
            f"it says {certificate.bound:.12g} V^2 s, but proves {float(proven):.12g} V^2 s only")
    doubled = multipliers_matrix(certificate)
    if certificate.is_box:
        check_curvature(certificate)
    for system, y in zip(certificate.systems, certificate.y):
        check_costs(certificate, system, slope_of(system, certificate.time))
        check_slack(certificate, doubled, y, *matrix_of(system, certificate.edges))
    reached = signal_energy(Response.parts_of(certificate.best), certificate.switches, certificate.time)
    reached *= iv.mpf(certificate.limit) ** 2
    require((abs(reached - iv.mpf(certificate.energy)) <= iv.mpf(1e-9) * abs(reached)) is True,
            "its signal does not have the energy that it says")
    return certificate, certificate.bound


def delay_error(system: reference.System) -> float:
    """At least the integral of |h(-s)| from 0 to the delay, h the filter with gain 1, continued.

    By the Taylor series at 0, whose terms below order - 1 are 0: h^(n)(0) = sum of r p^n, and what
    comes after the 40 terms that are summed is at most the sum of |r| for each, as |p| delay <= 1.
    """
    if system.delay == 0.0:
        return 0.0
    unit = reference.System(system.sensor, system.order, system.cutoff, 1.0, "difference")
    response = Response.parts_of(unit)[1][1]
    delay, total, factor = iv.mpf(system.delay), iv.mpf(0), iv.mpf(1)
    last = system.order + 40
    for n in range(last):
        factor = factor * delay / (n + 1)  # delay^(n + 1)/(n + 1)!
        if n >= system.order - 1:
            terms = (r * p**n for r, p in zip(response.residues, response.poles))
            total += abs(sum((term.real for term in terms), iv.mpf(0))) * factor
    sizes = sum((abs(r) for r in response.residues), iv.mpf(0))
    return float((total + 2 * sizes * delay / iv.mpf(math.factorial(last))).b) * RAISE


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
    if certificate.is_box:
        ranges = ", ".join(f"{name} from {knots[0]:.9g} to {knots[-1]:.9g}"
                           for name, knots in zip(("S", "f0", "beta"), certificate.knots))
        print(f"that holds for every device with {ranges}")
    system = certificate.systems[0]
    if system.delay > 0.0:
        off = delay_error(system) * system.filter.gain * certificate.limit
        whole = (math.sqrt(bound) + off * math.sqrt(certificate.time)) ** 2
        print(f"that is for the delayed filter continued by its modes; "
              f"for the delay of {system.delay:.9g} s itself: E <= {whole * (1.0 + 1e-12):.9g} V^2 s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
