"""Trials per second of the paper's procedure as one would write it with NumPy, beside emax.

    naive_numpy.py BENCHMARK

runs the program BENCHMARK (emax_benchmark) and the two NumPy versions one after the other on this
machine and prints a table. The NumPy versions are honest short programs: the impulse response in
closed form, Phi as a product of convolution matrices or, better, two FFT convolutions in its place,
30 iterations on 1000 cells of 2 us (5000 cells for T = 10 ms) from Phi's first column. All run on one
core, and its time is that of the processor: what else the machine does hardly matters.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from typing import Callable

import numpy as np

Array = np.ndarray

ORDER, CUTOFF, GAIN = 10, 1000.0, 1.037
ESTIMATE = np.array([1.037, 4073.0, 0.3182])
HALF_WIDTH = np.array([0.003, 6.0, 0.0004])
ITERATIONS, STEP = 30, 2e-6
LIMIT = 1.037
KNOWN_ENERGY = 0.00448654991209  # Of the fixed point for T = 2 ms, by exact integrals.
SECONDS = 2.0


def impulse_response(parameters: Array, t: Array) -> Array:
    """k(t) of sensor minus filter."""
    s, f0, beta = parameters
    w0 = 2.0 * np.pi * f0
    damped = w0 * np.sqrt(1.0 - beta**2)
    sensor = s * w0**2 / damped * np.exp(-beta * w0 * t) * np.sin(damped * t)
    wc = 2.0 * np.pi * CUTOFF
    poles = wc * np.exp(1j * np.pi * (2 * np.arange(1, ORDER + 1) + ORDER - 1) / (2 * ORDER))
    others = poles[:, None] - poles[None, :] + np.eye(ORDER)
    residues = GAIN * wc**ORDER / others.prod(axis=1)
    return sensor - (residues[:, None] * np.exp(poles[:, None] * t)).sum(axis=0).real


def climb(apply: Callable[[Array], Array], first_column: Array) -> float:
    x = np.where(first_column < 0.0, -1.0, 1.0)
    best = 0.0
    for _ in range(ITERATIONS):
        product = apply(x)
        best = max(best, float(x @ product))
        x = np.where(product < 0.0, -1.0, 1.0)
    return LIMIT**2 * best


def dense_trial(parameters: Array, cells: int) -> float:
    k = impulse_response(parameters, (np.arange(cells) + 0.5) * STEP)
    rows = np.arange(cells)
    lag = rows[:, None] - rows[None, :]
    convolution = np.where(lag >= 0, k[np.maximum(lag, 0)], 0.0) * STEP
    phi = convolution.T @ convolution * STEP
    return climb(lambda x: phi @ x, phi[:, 0])


def fft_trial(parameters: Array, cells: int) -> float:
    k = impulse_response(parameters, (np.arange(cells) + 0.5) * STEP) * STEP
    size = 1 << (2 * cells - 1).bit_length()
    transform = np.fft.rfft(k, size)

    def apply(x: Array) -> Array:
        y = np.fft.irfft(transform * np.fft.rfft(x, size), size)[:cells]
        return STEP * np.fft.irfft(transform.conj() * np.fft.rfft(y, size), size)[:cells]

    first = np.zeros(cells)
    first[0] = 1.0
    return climb(apply, apply(first))


def rate(trial: Callable[[Array, int], float], cells: int) -> float:
    """Trials per second of a processor."""
    random = np.random.default_rng(1)
    trial(ESTIMATE, cells)
    made, start = 0, time.process_time()
    while made < 3 or time.process_time() - start < SECONDS:
        trial(ESTIMATE + HALF_WIDTH * random.uniform(-1.0, 1.0, 3), cells)
        made += 1
    return made / (time.process_time() - start)


def emax_rates(program: str) -> dict[str, float]:
    result = subprocess.run(
        [program, "--benchmark_filter=one_trial/best|paper_trials", "--benchmark_format=json"],
        check=True, capture_output=True, text=True)
    return {entry["name"]: entry["trials/s"] for entry in json.loads(result.stdout)["benchmarks"]}


def main() -> int:
    for trial in (dense_trial, fft_trial):
        energy = trial(ESTIMATE, 1000)
        # Sums for integrals: y is taken half a step late, and the last half step is T/2000.
        if abs(energy / KNOWN_ENERGY - 1.0) > 3e-3:
            print(f"{trial.__name__} finds {energy}, not {KNOWN_ENERGY}", file=sys.stderr)
            return 1
    ours = emax_rates(sys.argv[1])
    rows = []
    for milliseconds, cells in ((2, 1000), (10, 5000)):
        fft = rate(fft_trial, cells)
        if milliseconds == 2:
            rows.append((milliseconds, "NumPy, dense Phi", rate(dense_trial, cells), fft))
        rows.append((milliseconds, "NumPy, FFT", fft, fft))
        rows.append((milliseconds, "emax, the same procedure (`--method paper`)",
                     ours[f"paper_trials/{milliseconds}"], fft))
        rows.append((milliseconds, "emax, the best signal of each trial (default)",
                     ours[f"one_trial/best/{milliseconds}"], fft))
    print("| T in ms | one trial by | trials per second | to NumPy with FFT |")
    print("|---|---|---|---|")
    for milliseconds, name, per_second, reference in rows:
        digits = 1 if per_second < 100.0 else 0
        print(f"| {milliseconds} | {name} | {per_second:,.{digits}f} | {per_second / reference:,.3g} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
