"""Balls must hold what 60 digits of mpmath say, and be small; bad divisions must be noticed."""

import unittest

import numpy as np
from mpmath import iv, mp, mpc, mpf

from balls import Ball, Undecided

mp.dps = 60


class Balls(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(2)
        self.a = random.standard_normal(60) * 20.0 + 1j * random.standard_normal(60)
        self.b = random.standard_normal(60) + 1j * random.standard_normal(60) * 1e3
        self.exact_a = [mpc(complex(z)) for z in self.a]
        self.exact_b = [mpc(complex(z)) for z in self.b]

    def holds(self, ball, exact, relative):
        for middle, radius, own in zip(ball.middle.ravel(), ball.radius.ravel(), exact):
            self.assertLessEqual(abs(own - mpc(complex(middle))), mpf(float(radius)))
            self.assertLessEqual(float(radius), relative * float(abs(own)))

    def test_operations_hold_the_exact_result(self):
        a, b = Ball(self.a), Ball(self.b)
        pairs = list(zip(self.exact_a, self.exact_b))
        self.holds(a + b, [x + y for x, y in pairs], 1e-14)
        self.holds(a - b, [x - y for x, y in pairs], 1e-14)
        self.holds(a * b, [x * y for x, y in pairs], 1e-14)
        self.holds(b.inverse(), [1 / y for y in self.exact_b], 1e-14)
        self.holds(Ball((a * b).middle[None, :], (a * b).radius[None, :]).sum(1),
                   [sum(x * y for x, y in pairs)], 1e-12)

    def test_exponential_holds_the_exact_result(self):
        z = np.concatenate([self.b[:30] - 30.0, 1e-9 * self.a[:10], [0.0]])
        self.holds(Ball(z).exp(), [mp.exp(mpc(complex(own))) for own in z], 1e-9)

    def test_radii_pass_through(self):
        ball = Ball(np.array([2.0 + 1.0j]), 1e-6)
        inside = mpc(2, 1) + mpc("0.6e-6", "0.8e-6")  # On its edge.
        other = Ball(np.array([1.0 - 3.0j]), 1e-7)
        far = mpc(1, -3) - mpc("0.8e-7", "0.6e-7")
        for result, exact in ((ball * other, inside * far), (ball + other, inside + far),
                              (ball.inverse(), 1 / inside), (ball.exp(), mp.exp(inside))):
            self.assertLessEqual(abs(exact - mpc(complex(result.middle[0]))),
                                 mpf(float(result.radius[0])))

    def test_intervals_become_balls(self):
        ball = Ball.of_interval(iv.mpc(iv.pi, iv.sqrt(2)))
        self.holds(Ball(ball.middle[None], ball.radius[None]), [mpc(mp.pi, mp.sqrt(2))], 1e-15)

    def test_a_division_by_what_may_be_zero_is_noticed(self):
        with self.assertRaises(Undecided):
            Ball(np.array([1e-9]), 1e-9).inverse()


if __name__ == "__main__":
    unittest.main()
