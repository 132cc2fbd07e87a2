"""Tests of the reference implementation: closed forms, convergence, published and design values."""

from __future__ import annotations

import cmath
import math
import os
import unittest
from dataclasses import replace

import numpy as np

import claims
import reference as ref

HERE = os.path.dirname(os.path.abspath(__file__))
TABLE_1 = os.path.join(HERE, "..", "data", "djb_a1800v.csv")

# Table 2 of the paper, filter of order 10 at 1 kHz with the same gain, limit a = S.
SENSOR = ref.Accelerometer(1.037, 4073.0, 0.3182)
U = (0.003, 6.0, 0.0004)
LIMIT = 1.037
BEST_2_MS = [0.0010474909417558]
BEST_10_MS = [t * 1e-3 for t in (
    0.84866315101641, 1.9058315037729, 2.9367350905267, 3.976378908253, 5.0135209735015,
    6.049938135172, 7.0918057372703, 8.1148875436357, 9.1942917643007)]


class Case(unittest.TestCase):
    """Relative comparison."""

    def near(self, value: float, expected: float, relative: float) -> None:
        self.assertLessEqual(abs(value - expected), relative * abs(expected),
                             f"{value!r} is not {expected!r} to {relative:g} relative")


class ImpulseResponse(Case):
    def test_filter_of_every_order_against_the_contour_integral(self) -> None:
        for order in range(1, 16):
            filt = ref.Butterworth(order, 1000.0, 1.037)
            for t in (2e-5, 1e-4, 3e-4, 1e-3, 2e-3):
                rate = 2e3 * math.pi
                expected = ref.impulse_response_by_contour(filt.transfer, rate, t)
                value = float(filt.impulse_response(np.array(t)))
                # What the contour's rounding leaves, relative to the response's scale.
                self.assertLess(abs(value - expected), 1e-12 * filt.gain * rate,
                                f"order {order}, t = {t}")

    def test_filter_of_order_one_and_two_against_closed_forms(self) -> None:
        t = np.linspace(0.0, 5e-3, 201)
        w = 2.0 * math.pi * 700.0
        one = ref.Butterworth(1, 700.0, 0.9).impulse_response(t)
        self.assertLess(np.max(np.abs(one - 0.9 * w * np.exp(-w * t))), 1e-13 * w)
        two = ref.Butterworth(2, 700.0, 0.9).impulse_response(t)
        d = w / math.sqrt(2.0)
        self.assertLess(np.max(np.abs(two - 0.9 * w**2 / d * np.exp(-d * t) * np.sin(d * t))),
                        1e-13 * w)

    def test_filter_has_its_gain_at_zero_and_half_power_at_the_cutoff(self) -> None:
        for order in range(1, 16):
            filt = ref.Butterworth(order, 1000.0, 1.3)
            self.near(abs(filt.transfer(0j)), 1.3, 1e-13)
            self.near(abs(filt.transfer(2j * math.pi * 1000.0)), 1.3 / math.sqrt(2.0), 1e-12)
            kernel = ref.Kernel(filt.impulse_response, filt.fastest_time())
            area = kernel.integral(np.array(0.0), np.array(60.0 / filt.decay_rate()))
            self.near(float(area), 1.3, 1e-12)

    def test_accelerometer_against_the_contour_integral(self) -> None:
        for beta in (0.01, 0.3182, 0.9):
            sensor = ref.Accelerometer(1.0, 4073.0, beta)
            for t in (1e-5, 5e-5, 2e-4):
                rate = 2.0 * math.pi * sensor.f0
                expected = ref.impulse_response_by_contour(sensor.transfer, rate, t)
                value = float(sensor.impulse_response(np.array(t)))
                self.assertLess(abs(value - expected), 1e-12 * rate)

    def test_design_values(self) -> None:
        k = ref.System(SENSOR).k(np.array([10, 50, 100, 500, 1000, 2000]) * 1e-6)
        expected = (6199.1624, 17451.1509, 8133.60891, -259.559968, -1744.33268, 424.175752)
        for value, target in zip(k, expected):
            self.near(value, target, 5e-9)

    def test_peak_and_settling_time(self) -> None:
        figures = ref.impulse_figures(ref.System(SENSOR))
        self.assertAlmostEqual(figures.peak, 17462.4, delta=0.05)
        self.assertAlmostEqual(figures.peak_time, 51.4e-6, delta=0.05e-6)
        self.assertAlmostEqual(figures.settling_time, 1.453582e-3, delta=0.5e-9)

    def test_absolute_error_of_a_response_of_one_sign(self) -> None:
        only_filter = ref.System(ref.Accelerometer(0.0, 4000.0, 0.3), 1, 500.0, 1.2)
        self.near(ref.absolute_error(only_filter, 1e-3, 2.0),
                  2.0 * 1.2 * (1.0 - math.exp(-math.pi)), 1e-12)


class Energy(Case):
    def test_first_order_filter_alone_with_a_step(self) -> None:
        w, T, gain, a = 2.0 * math.pi * 500.0, 3e-3, 1.2, 2.0
        expected = (gain * a) ** 2 * (T - 2.0 * (1.0 - math.exp(-w * T)) / w
                                      + (1.0 - math.exp(-2.0 * w * T)) / (2.0 * w))
        silent = ref.Accelerometer(0.0, 4000.0, 0.3)
        for criterion, sign in (("ise", 1.0), ("difference", -1.0)):
            system = ref.System(silent, 1, 500.0, gain, criterion)
            self.near(ref.switching_energy(system, [], T, a), sign * expected, 1e-12)

    def test_accelerometer_alone_with_a_switch(self) -> None:
        """y = S a Re(1 - c e^pt), after the switch minus twice the same, delayed."""
        sensor, T, switch, a = ref.Accelerometer(1.1, 3000.0, 0.05), 2e-3, 0.7e-3, 1.5
        w0 = 2.0 * math.pi * sensor.f0
        p = complex(-sensor.beta * w0, w0 * math.sqrt(1.0 - sensor.beta**2))
        c = complex(1.0, p.real / p.imag)

        def part(constant: float, w: complex, length: float) -> float:
            """Integral of (constant + Re(w e^pt))^2 over [0, length]."""
            first = 2.0 * constant * (w * (cmath.exp(p * length) - 1.0) / p).real
            decay = abs(w) ** 2 * (math.exp(2.0 * p.real * length) - 1.0) / (4.0 * p.real)
            ringing = (w * w * (cmath.exp(2.0 * p * length) - 1.0) / (4.0 * p)).real
            return constant**2 * length + first + decay + ringing

        late = -c * cmath.exp(p * switch) + 2.0 * c
        expected = (sensor.S * a) ** 2 * (part(1.0, -c, switch) + part(-1.0, late, T - switch))
        system = ref.System(sensor, 10, 1000.0, 0.0)
        self.near(ref.switching_energy(system, [switch], T, a), expected, 1e-12)

    def test_three_ways_of_convolving_agree(self) -> None:
        system = ref.System(SENSOR)
        switches = [0.2e-3, 0.9e-3, 1.3e-3]
        _, kernel = system.kernels()[0]
        t = np.linspace(0.0, 2e-3, 57)
        direct = ref.switching_response(kernel, switches, t, LIMIT)
        table = ref._fast_switching_response(kernel, switches, t, LIMIT)
        self.assertLess(np.max(np.abs(direct - table)), 1e-13)

        def x(time: np.ndarray) -> np.ndarray:
            return LIMIT * (-1.0) ** np.searchsorted(switches, time)

        self.near(ref.signal_energy(system, x, switches, 2e-3),
                  ref.switching_energy(system, switches, 2e-3, LIMIT), 1e-12)

    def test_finer_panels_change_nothing(self) -> None:
        for order, beta, criterion in ((1, 0.01, "ise"), (5, 0.9, "difference"), (15, 0.3, "ise")):
            system = ref.System(ref.Accelerometer(1.0, 6000.0, beta), order, 2000.0, 0.8, criterion)
            coarse = ref.switching_energy(system, [1e-4, 7e-4], 2e-3, 1.0)
            self.near(ref.switching_energy(system, [1e-4, 7e-4], 2e-3, 1.0, 2.0), coarse, 1e-12)

    def test_design_values(self) -> None:
        system = ref.System(SENSOR)
        for switches, T, expected, relative in (
            ([], 2e-3, 0.00110693771864, 5e-12),
            ([0.68e-3, 1.49e-3], 2e-3, 0.00399063106536, 2e-12),
            (BEST_2_MS, 2e-3, 0.005115251359876, 2e-13),
            (BEST_10_MS, 1e-2, 0.03809122131476, 2e-13),
        ):
            self.near(ref.switching_energy(system, switches, T, LIMIT), expected, relative)

    def test_gradient_against_differences_of_the_energy(self) -> None:
        switches, step = [0.3e-3, 0.8e-3, 1.5e-3], 1e-7
        for order, criterion in ((1, "ise"), (6, "difference")):
            system = ref.System(SENSOR, order, criterion=criterion)
            gradient = ref.energy_gradient(system, switches, 2e-3, LIMIT)
            for j, value in enumerate(gradient):
                energies = []
                for sign in (1.0, -1.0):
                    moved = list(switches)
                    moved[j] += sign * step
                    energies.append(ref.switching_energy(system, moved, 2e-3, LIMIT))
                slope = (energies[0] - energies[1]) / (2.0 * step)
                self.assertLess(abs(value - slope), 1e-4 * np.max(np.abs(gradient)))

    def test_the_best_known_signals_are_stationary(self) -> None:
        system = ref.System(SENSOR)
        for switches, T in ((BEST_2_MS, 2e-3), (BEST_10_MS, 1e-2)):
            gradient = ref.energy_gradient(system, switches, T, LIMIT)
            # A switch moved by 1 ns from the optimum changes dE/dt by about 5e-5.
            self.assertLess(np.max(np.abs(gradient)), 1e-6)

    def test_refinement_finds_the_best_known_switch_from_the_grid(self) -> None:
        switches, energy = ref.refine_switches(ref.System(SENSOR), [1.04e-3], 2e-3, LIMIT)
        self.assertAlmostEqual(switches[0], BEST_2_MS[0], delta=1e-12)
        self.near(energy, 0.005115251359876, 2e-13)

    def test_difference_is_the_difference_of_two_energies(self) -> None:
        both = ref.System(SENSOR, criterion="difference")
        sensor_only = ref.System(SENSOR, gain=0.0)
        filter_only = ref.System(replace(SENSOR, S=0.0), gain=SENSOR.S)
        energies = [ref.switching_energy(s, [1e-3], 2e-3, LIMIT)
                    for s in (both, sensor_only, filter_only)]
        self.near(energies[0], energies[1] - energies[2], 1e-12)


class Phi(Case):
    def test_matrix_against_literal_double_integrals(self) -> None:
        for order, criterion in ((1, "ise"), (4, "difference"), (10, "ise")):
            system = ref.System(SENSOR, order, criterion=criterion)
            matrix = ref.Grid(system, 8, 4e-4).matrix()
            scale = np.max(np.abs(matrix))
            for i, j in ((0, 0), (0, 1), (2, 5), (6, 6), (7, 7), (7, 0)):
                literal = ref.phi_cell(system, i, j, 8, 4e-4)
                self.assertLess(abs(matrix[i, j] - literal), 1e-10 * scale, f"{i}, {j}")

    def test_matrix_column_product_and_energy_agree(self) -> None:
        system = ref.System(SENSOR, 3, criterion="difference")
        grid = ref.Grid(system, 50, 2e-3)
        matrix = grid.matrix()
        x = np.random.default_rng(7).uniform(-1.0, 1.0, 50)
        product, energy = grid.apply(x)
        scale = np.max(np.abs(matrix @ x))
        self.assertLess(np.max(np.abs(product - matrix @ x)), 1e-13 * scale)
        self.near(energy, x @ matrix @ x, 1e-12)
        self.assertLess(np.max(np.abs(grid.first_column() - matrix[:, 0])),
                        1e-14 * np.max(np.abs(matrix)))

    def test_grid_energy_is_the_energy_of_the_switching_signal(self) -> None:
        system = ref.System(SENSOR)
        grid = ref.Grid(system, 40, 2e-3)
        x = ref.sign_pattern(np.random.default_rng(3).standard_normal(40))
        switches = ref.switch_times(x, grid.h)
        self.near(grid.apply(LIMIT * x)[1],
                  ref.switching_energy(system, switches, 2e-3, LIMIT), 1e-12)

    def test_finer_quadrature_changes_nothing(self) -> None:
        system = ref.System(ref.Accelerometer(1.0, 8000.0, 0.01), 15, 3000.0)
        coarse, fine = (ref.Grid(system, 60, 2e-3, refine).matrix() for refine in (1, 2))
        self.assertLess(np.max(np.abs(fine - coarse)), 1e-13 * np.max(np.abs(fine)))

    def test_enumeration_against_brute_force(self) -> None:
        matrix = ref.Grid(ref.System(SENSOR), 10, 2e-3).matrix()
        signs = 1.0 - 2.0 * ((np.arange(1024)[:, None] >> np.arange(10)) & 1)
        expected = np.max(np.einsum("ni,ij,nj->n", signs, matrix, signs))
        self.near(ref.enumerate_patterns(matrix)[1], expected, 1e-13)

    def test_design_values_for_20_and_24_cells(self) -> None:
        system = ref.System(SENSOR)
        for cells, expected, runs in ((20, 0.0050935397728704, (10, 10)),
                                      (24, 0.0051028687271305, (13, 11))):
            pattern, energy = ref.enumerate_patterns(ref.Grid(system, cells, 2e-3).matrix())
            self.near(energy * LIMIT**2, expected, 2e-13)
            first = int(np.flatnonzero(np.diff(pattern))[0]) + 1
            self.assertEqual(len(ref.switch_times(pattern, 1.0)), 1)
            self.assertEqual((first, cells - first), runs)

    def test_fixed_point_from_a_constant_on_24_cells(self) -> None:
        grid = ref.Grid(ref.System(SENSOR), 24, 2e-3)
        done = ref.fixed_point(grid, LIMIT, 100, np.ones(24))
        self.near(done.best, 0.00387315215917, 2e-12)
        self.assertIsNotNone(done.rest)


class FixedPoint(Case):
    def test_two_milliseconds(self) -> None:
        done = ref.paper_method(ref.System(SENSOR), 2e-3, LIMIT)
        self.near(done.energies[0], 0.00381585783775, 2e-12)
        self.near(done.best, 0.00448654991209, 2e-12)
        self.assertEqual(done.rest, 6)
        self.assertEqual([round(t * 1e6) for t in done.switches], [342, 470, 574, 1540])
        self.assertEqual(done.energies, sorted(done.energies))

    def test_ten_milliseconds(self) -> None:
        done = ref.paper_method(ref.System(SENSOR), 1e-2, LIMIT)
        self.near(done.energies[30], 0.0375854265552, 2e-12)
        self.assertIsNone(done.rest)
        self.assertEqual(len(done.energies), 31)

    def test_ise_never_loses_energy_from_random_starts(self) -> None:
        grid = ref.Grid(ref.System(SENSOR, 5), 60, 2e-3)
        generator = np.random.default_rng(5)
        for _ in range(20):
            done = ref.fixed_point(grid, LIMIT, 100, generator.standard_normal(60))
            self.assertTrue(all(b >= a for a, b in zip(done.energies, done.energies[1:])))

    def test_search_reaches_the_enumerated_maximum(self) -> None:
        switches, energy = ref.search(ref.System(SENSOR), 2e-3, LIMIT, 24)
        self.near(energy, 0.0051028687271305, 1e-12)
        self.assertEqual(len(switches), 1)


class Fit(Case):
    def test_table_1(self) -> None:
        points = ref.read_points(TABLE_1)
        fit = ref.wlsp(points)
        u = np.sqrt(np.diag(fit.covariance))
        for value, expected, digits in ((fit.S, 1.00791, 5e-6), (fit.f0, 4057.25, 5e-3),
                                        (fit.beta, 0.24618, 5e-6), (u[0], 0.00113, 5e-6),
                                        (u[1], 2.85, 5e-3), (u[2], 0.00088, 5e-6)):
            self.assertAlmostEqual(value, expected, delta=digits)
        self.assertEqual(round(fit.chi2), 8595)
        self.assertEqual(fit.dof, 81)
        self.assertEqual(round(ref.chi_square(points, SENSOR)), 14975)
        best = ref.Accelerometer(fit.S, fit.f0, fit.beta)
        self.near(ref.chi_square(points, best), fit.chi2, 1e-11)

    def test_noise_free_points_come_back(self) -> None:
        f = np.geomspace(30.0, 6000.0, 42)
        response = SENSOR.transfer(2j * math.pi * f)
        points = ref.Points(f, np.abs(response), np.angle(response),
                            0.005 * np.abs(response), np.full(42, 0.01))
        fit = ref.wlsp(points)
        self.near(fit.S, SENSOR.S, 1e-12)
        self.near(fit.f0, SENSOR.f0, 1e-12)
        self.near(fit.beta, SENSOR.beta, 1e-12)
        self.assertLess(fit.chi2, 1e-18)

    def test_a_common_part_moves_into_the_uncertainty_of_S_only(self) -> None:
        f = np.geomspace(30.0, 6000.0, 42)
        response = SENSOR.transfer(2j * math.pi * f)
        alone = ref.Points(f, np.abs(response), np.angle(response),
                           0.005 * np.abs(response), np.full(42, 0.01))
        total = replace(alone, u_amplitude=math.hypot(0.005, 0.01) * np.abs(response))
        first, second = ref.wlsp(alone), ref.wlsp(total, 0.01)
        added = second.covariance - first.covariance
        self.near(added[0, 0], (0.01 * SENSOR.S) ** 2, 1e-6)
        for i in (1, 2):
            self.near(second.covariance[i, i], first.covariance[i, i], 1e-6)

    def test_covariance_against_draws(self) -> None:
        """1000 draws: standard deviations good to 2.2 %, so 9 % is four sigma."""
        f = np.geomspace(30.0, 6000.0, 42)
        response = SENSOR.transfer(2j * math.pi * f)
        points = ref.Points(f, np.abs(response), np.angle(response),
                            0.005 * np.abs(response), np.full(42, 0.01))
        generator = np.random.default_rng(11)
        draws = []
        for _ in range(1000):
            fit = ref.wlsp(replace(
                points, amplitude=generator.normal(points.amplitude, points.u_amplitude),
                phase=generator.normal(points.phase, points.u_phase)))
            draws.append((fit.S, fit.f0, fit.beta))
        for drawn, formula in zip(np.std(draws, axis=0),
                                  np.sqrt(np.diag(ref.wlsp(points).covariance))):
            self.near(drawn, formula, 0.09)

    def test_regression(self) -> None:
        slope, intercept = ref.linear_regression([1.0, 2.0, 4.0], [3.5, 6.0, 11.0])
        self.near(slope, 2.5, 1e-14)
        self.near(intercept, 1.0, 1e-13)


class Draws(Case):
    PUBLISHED = {  # seed (123456789, 345678901, 567890123, 789012345)
        1: (0.75099757068263173, (1874688786, 84897365, 478650314, 1322001748)),
        2: (0.05838148864854009, (971196646, 406424201, 957195702, 2085523378)),
        3: (0.32888922619308092, (182238166, 1290604618, 1648576827, 1879831219)),
        4: (0.11645956405699120, (838883864, 173737190, 1299704512, 85252899)),
        100: (0.73211169856915226, (258119475, 1585670981, 459850852, 1416039761)),
        1000: (0.71003348258806565, (390086939, 647973173, 843362640, 1790845619)),
    }

    def test_published_sequence(self) -> None:
        generator = ref.WichmannHill2006(ref.DEFAULT_SEED)
        for n in range(1, 1001):
            value = generator.next()
            if n in self.PUBLISHED:
                self.assertAlmostEqual(value, self.PUBLISHED[n][0], delta=1e-15)
                self.assertEqual(tuple(generator.state), self.PUBLISHED[n][1])

    def test_jump(self) -> None:
        generator = ref.WichmannHill2006(ref.DEFAULT_SEED)
        generator.jump(1000)
        self.assertEqual(tuple(generator.state), self.PUBLISHED[1000][1])

    def test_1982_generator_against_R(self) -> None:
        generator = ref.WichmannHill1982((2882, 21792, 10079))
        for expected in (0.4625532, 0.2658268, 0.5772108, 0.5107932, 0.3375606):
            self.assertAlmostEqual(generator.next(), expected, delta=5e-8)

    def test_box_uses_three_draws_per_trial(self) -> None:
        first, second = ref.box_trials(SENSOR, U, [0, 1])
        self.near(first.S, 1.034 + 0.006 * 0.75099757068263173, 1e-15)
        self.near(first.f0, 4067.0 + 12.0 * 0.05838148864854009, 1e-15)
        self.near(first.beta, 0.3178 + 0.0008 * 0.32888922619308092, 1e-15)
        self.near(second.S, 1.034 + 0.006 * 0.11645956405699120, 1e-15)


class Box(Case):
    """The box of (21) at T = 2 ms, with the filter's gain fixed at the estimate of S."""

    @staticmethod
    def best(sensor: ref.Accelerometer) -> float:
        system = ref.System(sensor, gain=SENSOR.S)
        return ref.refine_switches(system, BEST_2_MS, 2e-3, LIMIT)[1]

    def test_largest_corner(self) -> None:
        corners = {(i, j, k): self.best(ref.Accelerometer(
            SENSOR.S + i * U[0], SENSOR.f0 + j * U[1], SENSOR.beta + k * U[2]))
            for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)}
        place = max(corners, key=lambda corner: corners[corner])
        self.assertEqual(place, (1, -1, -1))
        self.assertAlmostEqual(corners[place], 0.0051346992, delta=5e-11)

    def test_standard_uncertainty(self) -> None:
        """300 trials give u to 3 % (the distribution is flat), enough for "about 1.1e-5"."""
        values = [ref.switching_energy(ref.System(sensor, gain=SENSOR.S), BEST_2_MS, 2e-3, LIMIT)
                  for sensor in ref.box_trials(SENSOR, U, range(300))]
        self.assertAlmostEqual(float(np.std(values)), 1.1e-5, delta=0.05e-5)

    def test_energy_of_a_fixed_signal_is_convex_in_S(self) -> None:
        low, middle, high = (
            ref.switching_energy(ref.System(replace(SENSOR, S=S), gain=SENSOR.S),
                                 BEST_2_MS, 2e-3, LIMIT) for S in (0.9, 1.0, 1.1))
        self.assertGreater(low - 2.0 * middle + high, 0.0)

    def test_a_handful_of_paper_trials(self) -> None:
        results = ref.monte_carlo_paper(ref.System(SENSOR), U, [0, 1, 2], 2e-3, LIMIT)
        for sensor, energy in results:
            self.assertLess(abs(energy / 0.00448654991209 - 1.0), 0.01)
            system = ref.System(sensor, gain=SENSOR.S)
            self.assertEqual(energy, ref.paper_method(system, 2e-3, LIMIT).best)


class InBand(Case):
    """y = h * (y_a - G x(t - tau))."""

    def transfer(self, system: ref.System, s):
        shift = np.exp(-s * system.delay)
        filt = system.filter
        return (system.sensor.transfer(s) - filt.gain * shift) * filt.transfer(s) / filt.gain

    def test_response_against_the_contour_integral(self) -> None:
        sensor = ref.Accelerometer(1.037, 2500.0, 0.3182)
        for order in (1, 2, 4, 7, 10):
            for delay in (0.0, sensor.delay()):
                system = ref.System(sensor, order, 1000.0, 0.9, "band", delay)
                rate = 2.0 * math.pi * 2500.0
                for t in (5e-5, 2e-4, 6e-4):
                    expected = ref.impulse_response_by_contour(
                        lambda s: self.transfer(system, s), rate, t)
                    # What the contour's rounding leaves, amplified by e^(0.8 rate t) = 2e3.
                    self.assertLess(abs(float(system.k(np.array(t))) - expected), 1e-11 * rate,
                                    f"order {order}, t = {t}")

    def test_energies_of_known_signals(self) -> None:
        """Found with other code; nine digits are given, of some signals only the largest energy."""
        cases = (
            (10, 0.0, [0.639919e-3], 7.66114200e-6),
            (10, SENSOR.delay(), [0.365145378e-3, 0.946493860e-3], 3.30567639e-7),
            (4, 0.0, [0.369196e-3, 0.908663e-3, 1.445841e-3], 2.02966723e-5),
        )
        for order, delay, switches, expected in cases:
            system = ref.System(SENSOR, order, 1000.0, None, "band", delay)
            self.near(ref.switching_energy(system, switches, 2e-3, LIMIT), expected, 5e-9)

    def test_a_nearly_ideal_sensor_leaves_next_to_nothing(self) -> None:
        plain = ref.System(ref.Accelerometer(1.0, 30e3, 0.7), 10, 1000.0, None, "band")
        delayed = replace(plain, delay=plain.sensor.delay())
        one = ref.switching_energy(plain, [0.622532e-3], 2e-3, 1.0)
        other = ref.switching_energy(delayed, [0.320388e-3, 0.878639e-3, 1.445253e-3], 2e-3, 1.0)
        self.assertAlmostEqual(100.0 * math.sqrt(one / 2e-3), 1.608, delta=5e-4)
        self.assertAlmostEqual(100.0 * math.sqrt(other / 2e-3), 0.00059, delta=5e-6)

    def test_the_ideal_sensor_of_the_other_criterion(self) -> None:
        filt = ref.Butterworth(10, 1000.0, 1.037)
        energy = ref.ideal_energy(filt, 1.037, [1.05854e-3], 2e-3, LIMIT)
        self.near(energy, 5.080404e-3, 2e-7)
        # Ever faster switching: 100 % of S a.
        fast = ref.ideal_energy(filt, 1.037, np.arange(5e-6, 2e-3, 5e-6), 2e-3, LIMIT)
        self.near(fast, 1.037**2 * LIMIT**2 * 2e-3, 1e-2)


class Claims(Case):
    """The calculations behind the table of `claims.py`."""

    def test_higher_order_does_not_mean_lower_energy(self) -> None:
        """What a search finds is reached; nothing reaches more than 5.134e-3 at order 10."""
        energies = {order: claims.largest(SENSOR, 2e-3, order)[1] for order in (1, 7, 10, 11)}
        self.near(energies[10], 0.005115251359876, 2e-13)
        self.assertGreater(energies[11], 5.134e-3)
        self.assertGreater(energies[7], 6.0e-3)
        self.assertLess(energies[1], 3.4e-3)

    def test_bounds_lie_above_the_best_known_signal(self) -> None:
        here = ref.System(SENSOR)
        self.assertAlmostEqual(claims.eigenvalue_bound(here, 2e-3), 6.177e-3, delta=1e-6)
        relaxation = claims.relaxation_bound(here, 2e-3, 60, 100)
        self.assertGreater(relaxation, ref.search(here, 2e-3, LIMIT, 60)[1])
        self.assertLess(relaxation, 5.86e-3)

    def test_the_paper_s_own_signal_and_line(self) -> None:
        energy = ref.switching_energy(claims.system(), claims.PAPER_SWITCHES, claims.T, LIMIT)
        self.assertLess(energy, 0.7 * claims.PAPER_E[2e-3])
        slope, intercept = ref.linear_regression([2e-3, 10e-3], list(claims.PAPER_E.values()))
        self.near(slope, 3.531625, 1e-12)
        self.near(intercept, -1.20125e-3, 1e-12)


if __name__ == "__main__":
    unittest.main()
