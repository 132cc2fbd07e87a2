"""Ball arithmetic: arrays of complex numbers, each with a radius that its true value is within.

Built on IEEE double precision, round to nearest: a sum or product of complex numbers is off by at
most 4 U of its size (sqrt(5) U by Brent, Percival, Zimmermann, 2007), |z| by no more, and a sum
of n terms, in whatever order, by n U of the sum of their sizes. Every radius is raised by more than
what its own calculation can round off. Underflow is covered by TINY.
"""

from __future__ import annotations

import math

import numpy as np
from mpmath import iv

Array = np.ndarray

U = 2.0**-53
RAISE = 1.0 + 2.0**-46
TINY = 1e-290
TAYLOR_TERMS = 14

iv.dps = 40


class Undecided(Exception):
    """A ball is too large for what is asked of it, such as a division by one that holds zero."""


class Ball:
    """Numbers `middle`, each known to `radius`. Shapes follow NumPy's rules."""

    def __init__(self, middle: Array | complex, radius: Array | float = 0.0) -> None:
        self.middle = np.asarray(middle, dtype=complex)
        self.radius = np.broadcast_to(np.asarray(radius, dtype=float), self.middle.shape)

    @staticmethod
    def of_interval(value: object) -> "Ball":
        """From an interval (or a rectangle) of mpmath's `iv`."""
        parts = (value.real, value.imag) if hasattr(value, "imag") else (value, iv.mpf(0))
        middle = complex(*(float(part.mid) for part in parts))
        far = 0.0
        for part, own in zip(parts, (middle.real, middle.imag)):
            distance = part - iv.mpf(own)
            far += max(abs(float(distance.a)), abs(float(distance.b)))
        return Ball(middle, far * RAISE + TINY)

    @staticmethod
    def stack(balls: "list[Ball]") -> "Ball":
        return Ball(np.array([ball.middle for ball in balls]),
                    np.array([ball.radius for ball in balls]))

    def size(self) -> Array:
        """At least the size of every number."""
        return (np.abs(self.middle) * RAISE + self.radius) * RAISE

    def __getitem__(self, index: object) -> "Ball":
        return Ball(self.middle[index], self.radius[index])

    def __add__(self, other: "Ball") -> "Ball":
        middle = self.middle + other.middle
        radius = self.radius + other.radius + 4.0 * U * np.abs(middle)
        return Ball(middle, radius * RAISE + TINY)

    def __neg__(self) -> "Ball":
        return Ball(-self.middle, self.radius)

    def __sub__(self, other: "Ball") -> "Ball":
        return self + (-other)

    def __mul__(self, other: "Ball") -> "Ball":
        mine, its = np.abs(self.middle), np.abs(other.middle)
        radius = (mine * other.radius + its * self.radius + self.radius * other.radius
                  + 4.0 * U * mine * its)
        return Ball(self.middle * other.middle, radius * RAISE + TINY)

    def inverse(self) -> "Ball":
        size = np.abs(self.middle) / RAISE
        if not np.all(size > 2.0 * self.radius):
            raise Undecided("a division by a number that may be zero")
        # |1/z - 1/m| <= r/(|m| (|m| - r)); 16 U covers NumPy's division.
        radius = self.radius / (size * (size - self.radius)) + 16.0 * U / size
        return Ball(1.0 / self.middle, radius * RAISE + TINY)

    def sum(self, axis: int) -> "Ball":
        count = self.middle.shape[axis]
        radius = np.sum(self.radius, axis) + 4.0 * (count + 1) * U * np.sum(np.abs(self.middle), axis)
        return Ball(np.sum(self.middle, axis), radius * (1.0 + 4.0 * count * U) * RAISE + TINY)

    def exp(self) -> "Ball":
        """By Taylor's series of an argument of size 1/8 or less, and squaring."""
        largest = float(np.max(self.size(), initial=0.0))
        squarings = max(0, math.ceil(math.log2(largest * 8.0))) if largest > 0.0 else 0
        small = self * Ball(2.0**-squarings)
        result = Ball(np.ones(self.middle.shape))
        for n in range(TAYLOR_TERMS - 1, 0, -1):
            result = result * small * Ball(1.0 / n, U) + Ball(1.0)
        # What is left out is at most 8/7 of the first term left out.
        rest = 8.0 / 7.0 * 0.126**TAYLOR_TERMS / math.factorial(TAYLOR_TERMS)
        result = Ball(result.middle, result.radius + rest)
        for _ in range(squarings):
            result = result * result
        return result
