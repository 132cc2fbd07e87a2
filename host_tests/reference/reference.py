"""Reference implementation of the paper's equations by quadrature, to test the C++ against.

K. Tomczyk, "Monte Carlo-Based Procedure for Determining the Maximum Energy at the Output of
Accelerometers", Energies 2020, 13(7), 1552. Numbers in parentheses are equations of that paper.

Nothing here uses the formulas of the C++ code. The accelerometer's impulse response is the textbook
closed form; the filter's comes from its differential equations, integrated in time by a matrix
exponential and Taylor series; responses, energies and the kernel Phi are Gauss-Legendre integrals.

Units: time in s, frequency in Hz, x in m/s2, S in V/(m/s2), k in V/(m/s2)/s, y in V, E in V2 s.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
from dataclasses import dataclass, field, replace
from typing import Callable, Iterator, Sequence

import numpy as np

Array = np.ndarray

TAYLOR_TERMS = 24  # |A| u <= 1 on a panel, so the first term left out is below 1/24! = 2e-24.
PANEL_NODES = 16  # Gauss-Legendre nodes on a panel of at most a quarter of the fastest period.


def gauss_legendre(count: int) -> tuple[Array, Array]:
    """Nodes and weights on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (nodes + 1.0), 0.5 * weights


# --------------------------------------------------------------------------- impulse responses


def matrix_exponential(matrix: Array) -> Array:
    """exp(matrix) by scaling, a Taylor series and squaring."""
    norm = float(np.linalg.norm(matrix, 1))
    squarings = max(0, math.ceil(math.log2(norm)) + 2) if norm > 0.0 else 0
    scaled = matrix / 2.0**squarings
    term = np.eye(len(matrix))
    total = term.copy()
    for n in range(1, TAYLOR_TERMS):
        term = term @ scaled / n
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total


@dataclass(frozen=True)
class Accelerometer:
    """The sensor of (1): S in V/(m/s2), f0 in Hz, 0 < beta < 1."""

    S: float
    f0: float
    beta: float

    def transfer(self, s: Array | complex) -> Array | complex:
        """K_a(s) of (1), s in rad/s."""
        w0 = 2.0 * math.pi * self.f0
        return self.S * w0**2 / (s * s + 2.0 * self.beta * w0 * s + w0**2)

    def impulse_response(self, t: Array) -> Array:
        """k_a(t), zero for t < 0: the textbook response of an underdamped second-order system."""
        w0 = 2.0 * math.pi * self.f0
        damped = math.sqrt(1.0 - self.beta**2)
        time = np.maximum(t, 0.0)
        envelope = self.S * w0 / damped * np.exp(-self.beta * w0 * time)
        return envelope * np.sin(w0 * damped * time)

    def decay_rate(self) -> float:
        """Smallest decay rate of the response, 1/s."""
        return self.beta * 2.0 * math.pi * self.f0

    def delay(self) -> float:
        """Group delay at low frequencies, s."""
        return self.beta / (math.pi * self.f0)


class Butterworth:
    """The reference filter of (6): `order` 1 to 15, `cutoff` in Hz, `gain` in V/(m/s2).

    A cascade of second-order sections u'' + 2 zeta u' + u = (output of the section before), in the
    time theta = 2 pi cutoff t, with a first-order section u' + u for an odd order. The state at the
    panel edges follows from one matrix exponential; inside a panel k_f is its Taylor polynomial.
    """

    def __init__(self, order: int, cutoff: float, gain: float) -> None:
        self.order, self.cutoff, self.gain = order, cutoff, gain
        self._rate = 2.0 * math.pi * cutoff
        self._system = self._cascade(order)
        self._panel = 1.0 / float(np.linalg.norm(self._system, 2))
        self._step = matrix_exponential(self._system * self._panel)
        self._observe = self._taylor_rows()
        start = np.zeros(order)
        start[0 if order == 1 else 1] = 1.0
        self._state = start
        self._coefficients = np.zeros((TAYLOR_TERMS, 0))

    @staticmethod
    def _cascade(order: int) -> Array:
        """System matrix: every second-order section holds (u, u'), the odd one holds u."""
        dampings = [math.sin((2 * i - 1) * math.pi / (2 * order)) for i in range(1, order // 2 + 1)]
        matrix = np.zeros((order, order))
        row = 0
        for zeta in dampings:
            matrix[row, row + 1] = 1.0
            matrix[row + 1, row] = -1.0
            matrix[row + 1, row + 1] = -2.0 * zeta
            if row > 0:
                matrix[row + 1, row - 2] = 1.0
            row += 2
        if order % 2:
            matrix[row, row] = -1.0
            if row > 0:
                matrix[row, row - 2] = 1.0
        return matrix

    def _taylor_rows(self) -> Array:
        """Row m gives the m-th Taylor coefficient of the output, on a panel scaled to [0, 1]."""
        row = np.zeros(self.order)
        row[self.order - 1 if self.order % 2 else self.order - 2] = 1.0
        rows = [row]
        for m in range(1, TAYLOR_TERMS):
            rows.append(rows[-1] @ self._system * (self._panel / m))
        return np.array(rows)

    def _extend(self, panels: int) -> None:
        new = []
        for _ in range(self._coefficients.shape[1], panels):
            new.append(self._observe @ self._state)
            self._state = self._step @ self._state
        if new:
            self._coefficients = np.column_stack([self._coefficients, *new])

    def transfer(self, s: Array | complex) -> Array | complex:
        """K_f(s) of (6) as printed, s in rad/s."""
        product: Array | complex = 1.0
        for i in range(1, self.order + 1):
            pole = np.exp(1j * (2 * i + self.order - 1) * math.pi / (2 * self.order))
            product = product * (s / self._rate - pole)
        return self.gain / product

    def impulse_response(self, t: Array) -> Array:
        """k_f(t), zero for t < 0; for order 1 the value at t = 0 is the limit from the right."""
        theta = np.maximum(t, 0.0) * self._rate / self._panel
        panel = theta.astype(np.int64)
        self._extend(int(panel.max(initial=0)) + 1)
        u = theta - panel
        value = self._coefficients[TAYLOR_TERMS - 1][panel]
        for m in range(TAYLOR_TERMS - 2, -1, -1):
            value = value * u + self._coefficients[m][panel]
        return np.where(t < 0.0, 0.0, self.gain * self._rate * value)

    def decay_rate(self) -> float:
        """Smallest decay rate of the response, 1/s."""
        return self._rate * math.sin(math.pi / (2 * self.order))

    def fastest_time(self) -> float:
        """Length over which the response is a low-degree polynomial, s."""
        return self._panel / self._rate


@dataclass(frozen=True)
class Kernel:
    """One causal impulse response and the longest step on which quadrature may see it as smooth."""

    response: Callable[[Array], Array]
    panel: float  # s

    def integral(self, start: Array, stop: Array, refine: int = 1) -> Array:
        """Integrals of k from `start` to `stop` (arrays in s, 0 <= start <= stop), by Gauss."""
        longest = float(np.max(stop - start, initial=0.0))
        pieces = max(1, math.ceil(refine * longest / self.panel - 1e-9))
        nodes, weights = gauss_legendre(PANEL_NODES)
        width = (stop - start) / pieces
        total = np.zeros(np.broadcast(start, stop).shape)
        for piece in range(pieces):
            times = start[..., None] + width[..., None] * (piece + nodes)
            total = total + width * (self.response(times) @ weights)
        return total


class InBand:
    """k of the in-band error y = h * (y_a - G x(t - tau)), h the filter with gain 1.

    h * y_a comes from the filter's differential equations driven by the sensor's: one matrix
    exponential for a panel, a Taylor polynomial inside. The delayed filter is h itself, at t - tau,
    and for t < tau its continuation: the same differential equations solved backwards from t = 0.
    """

    def __init__(self, sensor: Accelerometer, unit_filter: Butterworth, gain: float,
                 delay: float = 0.0) -> None:
        self.filter, self.gain, self.delay = unit_filter, gain, delay
        order, rate = unit_filter.order, 2.0 * math.pi * unit_filter.cutoff
        w0 = 2.0 * math.pi * sensor.f0 / rate
        matrix = np.zeros((order + 2, order + 2))
        matrix[0, 1] = 1.0
        matrix[1, :2] = [-w0**2, -2.0 * sensor.beta * w0]
        matrix[2:, 2:] = Butterworth._cascade(order)
        matrix[2 if order == 1 else 3, 0] = sensor.S
        self._matrix, self._rate = matrix, rate
        self._panel = 0.5 / float(np.linalg.norm(matrix, 2))
        self._step = matrix_exponential(matrix * self._panel)
        row = np.zeros(order + 2)
        row[2 + (order - 1 if order % 2 else order - 2)] = 1.0
        self._rows = [row]
        for m in range(1, TAYLOR_TERMS):
            self._rows.append(self._rows[-1] @ matrix * (self._panel / m))
        self._observe = np.array(self._rows)
        self._state = np.zeros(order + 2)
        self._state[1] = w0**2  # An impulse in rate t.
        self._coefficients: list[Array] = []

    def continued(self, t: Array) -> Array:
        """h(t) of the filter's modes for t of either sign, in 1/s."""
        before = np.minimum(t, 0.0) * self._rate
        system = Butterworth._cascade(self.filter.order)
        start = np.zeros(self.filter.order)
        start[0 if self.filter.order == 1 else 1] = 1.0
        row = np.zeros(self.filter.order)
        row[self.filter.order - 1 if self.filter.order % 2 else self.filter.order - 2] = 1.0
        value = np.zeros(np.shape(t))
        term = start
        for m in range(40):  # |t| rate is at most 1.
            value = value + (row @ term) * before**m
            term = system @ term / (m + 1)
        return np.where(t < 0.0, self._rate * value, self.filter.impulse_response(t))

    def response(self, t: Array) -> Array:
        """k(t) for t >= 0, in V/(m/s2)/s."""
        theta = np.maximum(t, 0.0) * self._rate / self._panel
        panel = theta.astype(np.int64)
        while len(self._coefficients) <= int(panel.max(initial=0)):
            self._coefficients.append(self._observe @ self._state)
            self._state = self._step @ self._state
        table = np.array(self._coefficients).T
        u = theta - panel
        value = table[TAYLOR_TERMS - 1][panel]
        for m in range(TAYLOR_TERMS - 2, -1, -1):
            value = value * u + table[m][panel]
        passed = self._rate * value
        reference = self.gain * self.continued(np.asarray(t) - self.delay)
        return np.where(t < 0.0, 0.0, passed - reference)


@dataclass(frozen=True)
class System:
    """Accelerometer, reference filter and what is to be maximised.

    `criterion` is "ise", the integral-square error (15), "difference", the energy difference of (5)
    and the left part of (13), or "band", the in-band error, its reference delayed by `delay` s. All
    are sums of signed energies of single kernels.
    """

    sensor: Accelerometer
    order: int = 10
    cutoff: float = 1000.0
    gain: float | None = None  # None: the sensor's S
    criterion: str = "ise"
    delay: float = 0.0
    filter: Butterworth = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        gain = self.sensor.S if self.gain is None else self.gain
        object.__setattr__(self, "filter", Butterworth(self.order, self.cutoff, gain))
        unit = Butterworth(self.order, self.cutoff, 1.0)
        in_band = InBand(self.sensor, unit, gain, self.delay) if self.criterion == "band" else None
        object.__setattr__(self, "_in_band", in_band)

    def k(self, t: Array | float) -> Array:
        """k(t) = k_a(t) - k_f(t) of (14), or of the in-band error, in V/(m/s2)/s."""
        time = np.asarray(t, dtype=float)
        if self._in_band is not None:
            return self._in_band.response(time)
        return self.sensor.impulse_response(time) - self.filter.impulse_response(time)

    def panel(self) -> float:
        """Panel for quadrature, s: a quarter period of f0, and short against the filter's poles."""
        return min(0.25 / self.sensor.f0, self.filter.fastest_time())

    def kernels(self) -> list[tuple[float, Kernel]]:
        """The signed kernels whose energies add up to the criterion."""
        if self.criterion in ("ise", "band"):
            return [(1.0, Kernel(self.k, self.panel()))]
        if self.criterion == "difference":
            return [
                (1.0, Kernel(self.sensor.impulse_response, self.panel())),
                (-1.0, Kernel(self.filter.impulse_response, self.panel())),
            ]
        raise ValueError(f"criterion {self.criterion!r}: expected 'ise', 'difference' or 'band'")


def impulse_response_by_contour(
    transfer: Callable[[Array], Array], rate: float, t: float, nodes: int = 400
) -> float:
    """Inverse Laplace transform at t > 0 (s): a check of the responses above.

    Trapezoidal rule on a circle around all poles, which must lie in the left half of |s| <= rate
    (rad/s). Rounding is amplified by e^(0.8 rate t): for rate t up to about 13.
    """
    circle = 1.3 * np.exp(2j * math.pi * (np.arange(nodes) + 0.5) / nodes)
    s = rate * (circle - 0.5)
    return float(np.mean(np.exp(s * t) * transfer(s) * rate * circle).real)


@dataclass(frozen=True)
class ImpulseFigures:
    """Peak of k with its sign (V/(m/s2)/s), its time (s), and the 5 % settling time (s)."""

    peak: float
    peak_time: float
    settling_time: float


def impulse_figures(system: System, fraction: float = 0.05) -> ImpulseFigures:
    """Peak and settling: the last time at which |k| equals `fraction` of its peak.

    Scans a mesh until all modes are below 1e-4 of their start, then bisects between mesh points.
    """
    horizon = 12.0 / min(system.sensor.decay_rate(), system.filter.decay_rate())
    step = system.panel() / 40.0
    times = np.arange(0.0, horizon, step)
    values = np.abs(system.k(times))
    top = int(np.argmax(values))
    peak_time = _maximise(
        lambda t: float(np.abs(system.k(t))), max(times[top] - step, 0.0), times[top] + step
    )
    peak = float(system.k(peak_time))
    level = fraction * abs(peak)
    last = int(np.flatnonzero(values > level)[-1])
    low, high = times[last], times[last] + step
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if abs(float(system.k(middle))) > level else (low, middle)
    return ImpulseFigures(peak, peak_time, 0.5 * (low + high))


def _maximise(function: Callable[[float], float], low: float, high: float) -> float:
    """Golden-section search for the maximum, ends included."""
    ratio = 0.5 * (math.sqrt(5.0) - 1.0)
    ends = (low, high)
    for _ in range(80):
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, right) if function(left) > function(right) else (left, high)
    return max((0.5 * (low + high), *ends), key=function)


def absolute_error(system: System, time: float, limit: float) -> float:
    """Largest |y(T)| over signals within +-limit: limit times the integral of |k|, in V."""
    mesh = np.arange(0.0, time, system.panel() / 40.0)
    values = system.k(mesh)
    crossings = []
    for n in np.flatnonzero(values[1:] * values[:-1] < 0.0):
        low, high = mesh[n], mesh[n + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            same = float(system.k(middle)) * values[n] > 0.0
            low, high = (middle, high) if same else (low, middle)
        crossings.append(0.5 * (low + high))
    edges = np.array([0.0, *crossings, time])
    kernel = Kernel(system.k, system.panel())
    return limit * float(np.sum(np.abs(kernel.integral(edges[:-1], edges[1:]))))


# --------------------------------------------------------------- switching signals and energies


def switching_response(kernel: Kernel, switches: Sequence[float], t: Array, limit: float) -> Array:
    """y(t) of (9), (10) for x = +limit before the first switch, then alternating sign.

    The convolution is split at the switching times; every piece is an integral of k.
    """
    edges = [0.0, *switches, math.inf]
    y = np.zeros(t.shape)
    for m, (start, stop) in enumerate(zip(edges[:-1], edges[1:])):
        newest = np.maximum(t - start, 0.0)
        oldest = np.maximum(t - stop, 0.0) if math.isfinite(stop) else np.zeros(t.shape)
        y += (-1) ** m * limit * kernel.integral(oldest, newest)
    return y


def _time_nodes(edges: Sequence[float], panel: float, count: int) -> tuple[Array, Array]:
    """Composite Gauss nodes and weights over the intervals between `edges` (s)."""
    nodes, weights = gauss_legendre(count)
    times, factors = [], []
    for start, stop in zip(edges[:-1], edges[1:]):
        if not stop > start:
            continue
        pieces = max(1, math.ceil((stop - start) / panel - 1e-9))
        width = (stop - start) / pieces
        for piece in range(pieces):
            times.append(start + width * (piece + nodes))
            factors.append(width * weights)
    return np.concatenate(times), np.concatenate(factors)


def switching_energy(
    system: System, switches: Sequence[float], time: float, limit: float, refine: float = 1.0
) -> float:
    """E of (15), or the difference of (5), for a +-limit signal given by its switching times.

    Gauss-Legendre in t, split at the switches, where y has kinks. `refine` divides the panels.
    """
    inside = [t for t in switches if 0.0 < t < time]
    energy = 0.0
    for sign, kernel in system.kernels():
        t, weights = _time_nodes([0.0, *inside, time], kernel.panel / refine, 12)
        finer = replace(kernel, panel=kernel.panel / refine)
        y = _fast_switching_response(finer, inside, t, limit)
        energy += sign * float(weights @ y**2)
    return energy


def _fast_switching_response(
    kernel: Kernel, switches: Sequence[float], t: Array, limit: float
) -> Array:
    """As `switching_response`, from one table of the step response H(t), the integral of k.

    y = limit (H(t) - 2 H(t - t1) + 2 H(t - t2) - ...). H is summed panel by panel.
    """
    horizon = float(np.max(t))
    panels = max(1, math.ceil(horizon / kernel.panel))
    edges = np.arange(panels + 1) * kernel.panel
    table = np.concatenate([[0.0], np.cumsum(kernel.integral(edges[:-1], edges[1:]))])

    def step_response(s: Array) -> Array:
        index = np.minimum((s / kernel.panel).astype(np.int64), panels)
        return table[index] + kernel.integral(np.minimum(edges[index], s), s)

    y = step_response(t)
    for m, switch in enumerate(switches):
        late = t > switch
        y[late] += 2.0 * (-1.0) ** (m + 1) * step_response(t[late] - switch)
    return limit * y


def ideal_energy(
    filt: Butterworth, sensitivity: float, switches: Sequence[float], time: float, limit: float
) -> float:
    """E of y = S x - y_f, the error against an ideal sensor, for a +-limit signal."""
    inside = [t for t in switches if 0.0 < t < time]
    kernel = Kernel(filt.impulse_response, filt.fastest_time())
    t, weights = _time_nodes([0.0, *inside, time], kernel.panel, 12)
    sign = (-1.0) ** np.searchsorted(np.array(inside), t)
    y = limit * sensitivity * sign - _fast_switching_response(kernel, inside, t, limit)
    return float(weights @ y**2)


def signal_energy(
    system: System,
    signal: Callable[[Array], Array],
    breaks: Sequence[float],
    time: float,
) -> float:
    """E for any signal x(t) in m/s2 that is smooth between the times `breaks` (s)."""
    edges = [0.0, *[t for t in breaks if 0.0 < t < time], time]
    nodes, weights = gauss_legendre(12)
    energy = 0.0
    for sign, kernel in system.kernels():
        t, factors = _time_nodes(edges, kernel.panel, 12)
        starts, widths = [], []
        for start, stop in zip(edges[:-1], edges[1:]):
            pieces = max(1, math.ceil((stop - start) / kernel.panel - 1e-9))
            starts += [start + (stop - start) * piece / pieces for piece in range(pieces)]
            widths += [(stop - start) / pieces] * pieces
        y = np.zeros(t.shape)
        for start, width in zip(starts, widths):
            late = t > start
            length = np.minimum(t[late] - start, width)
            tau = start + length[:, None] * nodes
            y[late] += length * ((kernel.response(t[late, None] - tau) * signal(tau)) @ weights)
        energy += sign * float(factors @ y**2)
    return energy


def energy_gradient(
    system: System, switches: Sequence[float], time: float, limit: float
) -> Array:
    """dE/dt_j in V2 for the switching times t_j.

    Moving t_j changes x by x(t_j-) - x(t_j+) there, and E = x' Phi x by twice that times
    (Phi x)(t_j), where (Phi x)(tau) of (16) is the integral of k(t - tau) y(t) from tau to T.
    """
    gradient = np.zeros(len(switches))
    for sign, kernel in system.kernels():
        t, weights = _time_nodes([0.0, *switches, time], kernel.panel, 12)
        y = _fast_switching_response(kernel, switches, t, limit)
        for j, switch in enumerate(switches):
            late = t > switch
            product = float((weights[late] * y[late]) @ kernel.response(t[late] - switch))
            gradient[j] += sign * 4.0 * limit * (-1.0) ** j * product
    return gradient


def refine_switches(
    system: System, switches: Sequence[float], time: float, limit: float, sweeps: int = 12
) -> tuple[list[float], float]:
    """Local maximum of E over the switching times; returns the times (s) and E.

    Newton's method with the Hessian from differences of the gradient. Eigenvalues are taken
    negative, so that every step climbs; a step that gains nothing or lets switches meet is halved.
    """
    times = np.array(sorted(switches), dtype=float)
    best = switching_energy(system, times, time, limit)
    count, step, longest = len(times), 1e-3 * system.panel(), 0.2 * system.panel()
    for _ in range(sweeps if count else 0):
        gradient = energy_gradient(system, times, time, limit)
        hessian = np.zeros((count, count))
        for i in range(count):
            shift = np.zeros(count)
            shift[i] = step
            hessian[i] = (energy_gradient(system, times + shift, time, limit)
                          - energy_gradient(system, times - shift, time, limit)) / (2.0 * step)
        values, vectors = np.linalg.eigh(0.5 * (hessian + hessian.T))
        curvature = np.maximum(np.abs(values), 1e-3 * np.max(np.abs(values)))
        move = vectors @ ((vectors.T @ gradient) / curvature)
        move *= min(1.0, longest / max(float(np.max(np.abs(move))), 1e-300))
        for _ in range(8):
            trial = times + move
            ordered = bool(np.all(np.diff(np.concatenate([[0.0], trial, [time]])) > 2.0 * step))
            energy = switching_energy(system, trial, time, limit) if ordered else -math.inf
            if energy > best:
                break
            move *= 0.5
        if not energy > best:
            break
        gained, times, best = energy - best, trial, energy
        if gained < 1e-15 * abs(best):
            break
    return times.tolist(), best


# -------------------------------------------------------------------- Phi and the fixed point


def phi(system: System, tau: float, v: float, time: float) -> float:
    """Phi(tau, v) of (5) at one point, in V2/(m/s2)2/s; for "ise" with k = k_a - k_f."""
    total = 0.0
    start = max(tau, v)
    for sign, kernel in system.kernels():
        t, weights = _time_nodes([start, time], kernel.panel, 12)
        total += sign * float(weights @ (kernel.response(t - tau) * kernel.response(t - v)))
    return total


def phi_cell(system: System, i: int, j: int, cells: int, time: float, nodes: int = 8) -> float:
    """Double integral of (5) over cell i in tau and cell j in v, in V2 s/(m/s2)2.

    Slow and literal: a triple integral. On the diagonal the square is split along its kink.
    """
    h = time / cells
    u, w = gauss_legendre(nodes)
    pieces = max(1, math.ceil(h / system.panel()))
    total = 0.0
    if i != j:
        points = ((np.arange(pieces)[:, None] + u) / pieces).ravel()
        factors = np.tile(w / pieces, pieces)
        for p, wp in zip(points, factors):
            for q, wq in zip(points, factors):
                total += wp * wq * phi(system, (i + p) * h, (j + q) * h, time)
        return total * h * h
    points = ((np.arange(pieces)[:, None] + u) / pieces).ravel()
    factors = np.tile(w / pieces, pieces)
    for p, wp in zip(points, factors):
        for q, wq in zip(points, factors):
            total += 2.0 * wp * wq * p * phi(system, (i + p) * h, (i + p * q) * h, time)
    return total * h * h


class Grid:
    """Signals that are constant on `cells` equal cells of [0, time].

    Holds, per signed kernel, the response to one cell of height 1 at Gauss nodes in every later
    cell: responses[n, q] = c((n + xi_q) h), itself an integral of k. Then y is a discrete
    convolution, E a weighted sum of y^2, and Phi x a correlation with y. No sampling error: x is
    exactly constant on the cells and the quadrature in t is exact to rounding.
    """

    def __init__(self, system: System, cells: int, time: float, refine: int = 1) -> None:
        self.cells, self.time, self.h = cells, time, time / cells
        panels = max(1, math.ceil(self.h / system.panel()))
        count = (6 if self.h < system.panel() / 8.0 else 12) + 4 * (refine - 1)
        nodes, weights = gauss_legendre(count)
        xi = ((np.arange(panels)[:, None] + nodes) / panels).ravel()
        self.weights = np.tile(weights / panels, panels) * self.h
        self.parts: list[tuple[float, Array]] = []
        start = np.arange(cells)[:, None]
        for sign, kernel in system.kernels():
            newest = (start + xi) * self.h
            oldest = np.maximum(newest - self.h, 0.0)
            self.parts.append((sign, kernel.integral(oldest, newest, refine)))
        self._size = 1 << (2 * cells - 1).bit_length()
        self._spectra = [np.fft.rfft(part, self._size, axis=0) for _, part in self.parts]

    def matrix(self) -> Array:
        """Phi on the cells, V2 s/(m/s2)2: E = x' Phi x."""
        n = self.cells
        total = np.zeros((n, n))
        lag = np.arange(n)[:, None] - np.arange(n)[None, :]
        for sign, part in self.parts:
            for q, weight in enumerate(self.weights):
                columns = np.where(lag >= 0, part[np.maximum(lag, 0), q], 0.0)
                total += sign * weight * (columns.T @ columns)
        return total

    def first_column(self) -> Array:
        """Phi's first column by direct sums, so that its small entries keep their signs."""
        column = np.zeros(self.cells)
        for sign, part in self.parts:
            for q, weight in enumerate(self.weights):
                full = np.correlate(part[:, q], part[:, q], "full")
                column += sign * weight * full[self.cells - 1 :]
        return column

    def apply(self, x: Array) -> tuple[Array, float]:
        """Phi x (V2 s/(m/s2)) and E (V2 s) for cell values x (m/s2)."""
        product, energy = np.zeros(self.cells), 0.0
        drive = np.fft.rfft(x, self._size)[:, None]
        for (sign, _), spectrum in zip(self.parts, self._spectra):
            y = np.fft.irfft(spectrum * drive, self._size, axis=0)[: self.cells]
            weighted = y * self.weights
            energy += sign * float(np.sum(weighted * y))
            back = np.conj(spectrum) * np.fft.rfft(weighted, self._size, axis=0)
            product += sign * np.sum(np.fft.irfft(back, self._size, axis=0)[: self.cells], axis=1)
        return product, energy


def sign_pattern(values: Array) -> Array:
    """+1 and -1; zero counts as +1."""
    return np.where(values >= 0.0, 1.0, -1.0)


def switch_times(pattern: Array, h: float) -> list[float]:
    """Times (s) at which a pattern of cell signs changes."""
    return [float(n * h) for n in np.flatnonzero(np.diff(pattern)) + 1]


@dataclass(frozen=True)
class FixedPoint:
    """Outcome of (18), (19): energies E_0, E_1, ..., the best iterate and where it came to rest.

    `rest` is the first i with x_(i+1) = x_i, or None if that did not happen within J iterations.
    """

    energies: list[float]
    best: float
    best_index: int
    switches: list[float]
    rest: int | None


def fixed_point(
    grid: Grid, limit: float, iterations: int = 30, start: Array | None = None
) -> FixedPoint:
    """The paper's algorithm (Fig. 2): x_0 = a sgn Phi(., 0), x_(i+1) = a sgn(Phi x_i).

    The multipliers xi_i only scale and are left out; Fig. 2 keeps the best iterate.
    """
    x = sign_pattern(grid.first_column() if start is None else start)
    product, energy = grid.apply(limit * x)
    energies, best, best_index, best_x = [energy], energy, 0, x
    rest = None
    for i in range(iterations):
        following = sign_pattern(product)
        if np.array_equal(following, x):
            rest = i
            break
        x = following
        product, energy = grid.apply(limit * x)
        energies.append(energy)
        if energy > best:
            best, best_index, best_x = energy, i + 1, x
    return FixedPoint(energies, best, best_index, switch_times(best_x, grid.h), rest)


def paper_method(
    system: System, time: float, limit: float, step: float = 2e-6, iterations: int = 30
) -> FixedPoint:
    """The fixed point on the paper's grid of cells of length `step` (s)."""
    return fixed_point(Grid(system, round(time / step), time), limit, iterations)


def climb_by_flips(matrix: Array, pattern: Array) -> tuple[Array, float]:
    """Flips the most profitable single cell until none gains; E for height 1."""
    x = pattern.copy()
    product = matrix @ x
    diagonal = np.diag(matrix)
    floor = 1e-14 * float(np.sum(np.abs(diagonal)))
    while True:
        gain = 4.0 * (diagonal - x * product)
        cell = int(np.argmax(gain))
        if gain[cell] <= floor:
            return x, float(x @ product)
        product -= 2.0 * x[cell] * matrix[:, cell]
        x[cell] = -x[cell]


def search(
    system: System, time: float, limit: float, cells: int, random_starts: int = 200, seed: int = 1
) -> tuple[list[float], float]:
    """A good maximum on a grid: starts from the columns, block patterns and random signs.

    Every start runs through the fixed point and single flips. Returns switching times (s) and E.
    """
    matrix = Grid(system, cells, time).matrix()
    generator = np.random.default_rng(seed)
    index = np.arange(cells)
    starts = [sign_pattern(matrix[:, j]) for j in range(0, cells, max(1, cells // 50))]
    _, vectors = np.linalg.eigh(matrix)
    starts += [sign_pattern(vectors[:, -m]) for m in range(1, min(9, cells))]
    for runs in range(1, 13):
        starts += [sign_pattern(np.cos(math.pi * (index * runs / cells + shift)))
                   for shift in (0.0, 0.25, 0.5, 0.75)]
    starts += [sign_pattern(generator.standard_normal(cells)) for _ in range(random_starts)]
    best_x, best = starts[0], -math.inf
    for x in starts:
        for _ in range(50):
            following = sign_pattern(matrix @ x)
            if np.array_equal(following, x) or following @ matrix @ following <= x @ matrix @ x:
                break
            x = following
        x, energy = climb_by_flips(matrix, x)
        if energy > best:
            best_x, best = x, energy
    return switch_times(best_x, time / cells), best * limit**2


def enumerate_patterns(matrix: Array) -> tuple[Array, float]:
    """Largest x' Phi x over all sign patterns, for height 1; even numbers of cells up to 26."""
    cells = len(matrix)
    half = cells // 2
    bits = (np.arange(1 << half)[:, None] >> np.arange(half)) & 1
    right = 1.0 - 2.0 * bits
    left = right[: 1 << (half - 1)]  # the first half's last sign is +: E does not see a global sign
    own_left = np.einsum("ni,ij,nj->n", left, matrix[:half, :half], left, optimize=True)
    own_right = np.einsum("ni,ij,nj->n", right, matrix[half:, half:], right, optimize=True)
    total = 2.0 * (left @ matrix[:half, half:]) @ right.T
    total += own_left[:, None] + own_right[None, :]
    row, column = np.unravel_index(int(np.argmax(total)), total.shape)
    return np.concatenate([left[row], right[column]]), float(total[row, column])


# --------------------------------------------------------------------- least squares and trend


@dataclass(frozen=True)
class Points:
    """Measured points: f in Hz, amplitude in V/(m/s2), phase in rad, and standard uncertainties."""

    f: Array
    amplitude: Array
    phase: Array
    u_amplitude: Array
    u_phase: Array


def read_points(path: str, coverage: float = 2.0) -> Points:
    """Reads columns f, A, phase (degrees), U(A), U(phase); divides U by the coverage factor."""
    rows = []
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.reader(file):
            try:
                rows.append([float(cell) for cell in row[:5]])
            except ValueError:
                continue
    table = np.array([row for row in rows if len(row) == 5])
    degree = math.pi / 180.0
    return Points(table[:, 0], table[:, 1], table[:, 2] * degree,
                  table[:, 3] / coverage, table[:, 4] * degree / coverage)


@dataclass(frozen=True)
class Fit:
    """Estimates of (1), their covariance in the order S, f0, beta, and the fit's quality."""

    S: float
    f0: float
    beta: float
    covariance: Array
    chi2: float
    dof: int


def whitened_rows(
    points: Points, common: float = 0.0, mu: Array | None = None
) -> tuple[Array, Array]:
    """Two rows per point: design and values of 1/K, whitened by an inverse root of the covariance.

    1/K(jw) = mu1 + 2jw mu2 - w^2 mu3 and 1/K = (1/A) e^(-j phi); the covariance of its real and
    imaginary part follows from u(A), u(phi) to first order. Frequencies are scaled by the largest.
    `common` is a relative standard uncertainty of A that all points share and that u(A) contains:
    its square is taken out of every u(A). Given `mu`, it comes back as one full term over all
    points, along the modelled 1/K. (Along the measured 1/K it would pull the estimate towards
    small 1/K, the more the worse the model fits.)
    """
    scale = 2.0 * math.pi * float(np.max(points.f))
    count = len(points.f)
    design, values = np.zeros((2 * count, 3)), np.zeros(2 * count)
    covariance = np.zeros((2 * count, 2 * count))
    for n in range(count):
        f, A, p = points.f[n], points.amplitude[n], points.phase[n]
        w = 2.0 * math.pi * f / scale
        rows = slice(2 * n, 2 * n + 2)
        design[rows] = [[1.0, 0.0, -(w**2)], [0.0, 2.0 * w, 0.0]]
        values[rows] = [math.cos(p) / A, -math.sin(p) / A]
        jacobian = np.array([[-math.cos(p) / A**2, -math.sin(p) / A],
                             [math.sin(p) / A**2, -math.cos(p) / A]])
        variances = [points.u_amplitude[n] ** 2 - (common * A) ** 2, points.u_phase[n] ** 2]
        covariance[rows, rows] = jacobian @ np.diag(variances) @ jacobian.T
    if mu is not None:
        modelled = design @ mu
        covariance += common**2 * np.outer(modelled, modelled)
    root = np.linalg.cholesky(covariance)
    return np.linalg.solve(root, design), np.linalg.solve(root, values)


def parameters_of(mu: Array, scale: float) -> Array:
    """(S, f0, beta) from mu for frequencies divided by `scale` (rad/s)."""
    w0 = math.sqrt(mu[0] / mu[2])
    return np.array([1.0 / mu[0], w0 * scale / (2.0 * math.pi), mu[1] / math.sqrt(mu[0] * mu[2])])


def wlsp(points: Points, common: float = 0.0) -> Fit:
    """Weighted least squares for S, f0, beta; covariance by a numerical Jacobian of (mu -> S, ...).

    `common` as in `whitened_rows`.
    """
    scale = 2.0 * math.pi * float(np.max(points.f))
    design, values = whitened_rows(points, common)
    mu = np.linalg.lstsq(design, values, rcond=None)[0]
    if common:
        design, values = whitened_rows(points, common, mu)
        mu = np.linalg.lstsq(design, values, rcond=None)[0]
    residual = values - design @ mu
    inverse = np.linalg.pinv(design)
    cov_mu = inverse @ inverse.T
    jacobian = np.zeros((3, 3))
    for i in range(3):
        step = 1e-5 * mu[i]
        up, down = mu.copy(), mu.copy()
        up[i] += step
        down[i] -= step
        jacobian[:, i] = (parameters_of(up, scale) - parameters_of(down, scale)) / (2.0 * step)
    S, f0, beta = parameters_of(mu, scale)
    covariance = jacobian @ cov_mu @ jacobian.T
    return Fit(S, f0, beta, covariance, float(residual @ residual), len(values) - 3)


def chi_square(points: Points, sensor: Accelerometer) -> float:
    """Weighted sum of squares of 1/K - model for given parameters."""
    scale = 2.0 * math.pi * float(np.max(points.f))
    w0 = 2.0 * math.pi * sensor.f0 / scale
    mu = np.array([1.0, sensor.beta / w0, 1.0 / w0**2]) / sensor.S
    design, values = whitened_rows(points)
    residual = values - design @ mu
    return float(residual @ residual)


def linear_regression(x: Sequence[float], y: Sequence[float]) -> tuple[float, float]:
    """Slope and intercept of the least-squares line, chapter 5."""
    design = np.column_stack([np.asarray(x, dtype=float), np.ones(len(x))])
    slope, intercept = np.linalg.lstsq(design, np.asarray(y, dtype=float), rcond=None)[0]
    return float(slope), float(intercept)


# ------------------------------------------------------------------------------- Monte Carlo


class WichmannHill2006:
    """The four-component generator of JCGM 101:2008, C.3, in plain integers."""

    FACTORS = (11600, 47003, 23000, 33000)
    MODULI = (2147483579, 2147483543, 2147483423, 2147483123)

    def __init__(self, seed: Sequence[int]) -> None:
        self.state = list(seed)

    def next(self) -> float:
        """Next number in [0, 1)."""
        self.state = [a * i % m for a, i, m in zip(self.FACTORS, self.state, self.MODULI)]
        return sum(i / m for i, m in zip(self.state, self.MODULI)) % 1.0

    def jump(self, draws: int) -> None:
        """Skips `draws` numbers."""
        self.state = [pow(a, draws, m) * i % m
                      for a, i, m in zip(self.FACTORS, self.state, self.MODULI)]


class WichmannHill1982:
    """The three-component generator, AS 183."""

    FACTORS = (171, 172, 170)
    MODULI = (30269, 30307, 30323)

    def __init__(self, seed: Sequence[int]) -> None:
        self.state = list(seed[:3])

    next = WichmannHill2006.next
    jump = WichmannHill2006.jump


DEFAULT_SEED = (123456789, 345678901, 567890123, 789012345)


def box_trials(
    estimate: Accelerometer,
    u: Sequence[float],
    trials: Sequence[int],
    seed: Sequence[int] = DEFAULT_SEED,
) -> Iterator[Accelerometer]:
    """Parameters of the given trials: uniform in the box of (21), draws 3t, 3t+1, 3t+2.

    The order is S, f0, beta; each is alpha - u(alpha) + 2 u(alpha) times the draw.
    """
    for trial in trials:
        generator = WichmannHill2006(seed)
        generator.jump(3 * trial)
        S, f0, beta = (centre - half + 2.0 * half * generator.next()
                       for centre, half in zip((estimate.S, estimate.f0, estimate.beta), u))
        yield Accelerometer(S, f0, beta)


def monte_carlo_paper(
    system: System,
    u: Sequence[float],
    trials: Sequence[int],
    time: float,
    limit: float,
    step: float = 2e-6,
    iterations: int = 30,
    seed: Sequence[int] = DEFAULT_SEED,
) -> list[tuple[Accelerometer, float]]:
    """The paper's procedure (Fig. 5) for some trials: the whole fixed point in each of them.

    The filter keeps its gain. Slow: for a handful of trials.
    """
    gain = system.filter.gain
    results = []
    for sensor in box_trials(system.sensor, u, trials, seed):
        trial = replace(system, sensor=sensor, gain=gain)
        results.append((sensor, paper_method(trial, time, limit, step, iterations).best))
    return results


# ------------------------------------------------------------------------------ command line


def _numbers(text: str) -> list[float]:
    return [float(item) for item in text.split(",")] if text else []


def main() -> None:
    """Prints one JSON object for the chosen calculation."""
    parser = argparse.ArgumentParser(description="Reference calculations by quadrature.")
    parser.add_argument("what", choices=["impulse", "energy", "fixed-point", "fit", "trials"])
    parser.add_argument("--model", default="1.037,4073,0.3182,0.003,6,0.0004",
                        help="S,f0,beta[,uS,uf0,ubeta]")
    parser.add_argument("--order", type=int, default=10)
    parser.add_argument("--cutoff", type=float, default=1000.0, help="Hz")
    parser.add_argument("--gain", type=float, help="filter gain, default S")
    parser.add_argument("--criterion", choices=["ise", "difference", "band"], default="ise")
    parser.add_argument("--delay", type=float, help="s, of the reference in band; default none; "
                        "a negative number: the sensor's 2 beta/(2 pi f0)")
    parser.add_argument("--time", type=float, default=0.002, help="T in s")
    parser.add_argument("--limit", type=float, help="a in m/s2, default the number of S")
    parser.add_argument("--step", type=float, default=2e-6, help="s")
    parser.add_argument("--iterations", type=int, default=30)
    parser.add_argument("--switches", type=_numbers, default=[], help="s, for 'energy'")
    parser.add_argument("--at", type=_numbers, default=[1e-5, 1e-4, 1e-3], help="s, for 'impulse'")
    parser.add_argument("--points", help="CSV file, for 'fit'")
    parser.add_argument("--trials", type=_numbers, default=[0, 1, 2], help="numbers, for 'trials'")
    options = parser.parse_args()

    model = _numbers(options.model)
    sensor = Accelerometer(*model[:3])
    delay = options.delay or 0.0
    if delay < 0.0:
        delay = sensor.delay()
    system = System(sensor, options.order, options.cutoff, options.gain, options.criterion, delay)
    limit = sensor.S if options.limit is None else options.limit
    result: dict[str, object]
    if options.what == "impulse":
        figures = impulse_figures(system)
        result = {"k": system.k(np.array(options.at)).tolist(), **figures.__dict__,
                  "absolute_error": absolute_error(system, options.time, limit)}
    elif options.what == "energy":
        energy = switching_energy(system, options.switches, options.time, limit)
        result = {"E": energy, "xi": energy / (limit**2 * options.time)}
    elif options.what == "fixed-point":
        result = paper_method(system, options.time, limit, options.step,
                              options.iterations).__dict__
    elif options.what == "fit":
        fit = wlsp(read_points(options.points))
        result = {**fit.__dict__, "covariance": fit.covariance.tolist(),
                  "u": np.sqrt(np.diag(fit.covariance)).tolist()}
    else:
        numbers = [int(t) for t in options.trials]
        done = monte_carlo_paper(system, model[3:6], numbers, options.time, limit, options.step,
                                 options.iterations)
        result = {"trials": [{"trial": t, **s.__dict__, "E": e}
                             for t, (s, e) in zip(numbers, done)]}
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
