"""A short run of `emax certify`: the check accepts its certificate, and rejects damaged ones.

    test_check_certificate.py PROGRAM
"""

import copy
import json
import math
import pathlib
import signal
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import check_certificate
import reference

PROGRAM = "emax"
BEST_KNOWN = 0.005115251359876  # Table 2's estimates, T = 2 ms.
EFFORT = "1"  # Seconds; decides the grid.
ROUNDS = "25"


def remembered(function):
    """The same answer for the same system, edges and time: damaged certificates share most of them."""
    answers = {}

    def answer(system, where):
        key = (repr(system), np.asarray(where).tobytes())
        if key not in answers:
            answers[key] = function(system, where)
        return answers[key]

    return answer


check_certificate.slope_of = remembered(check_certificate.slope_of)
check_certificate.matrix_of = remembered(check_certificate.matrix_of)


def certify(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([PROGRAM, "certify", "--model", "1.037,4073,0.3182", *arguments],
                          capture_output=True, timeout=500, check=False)


class CheckCertificate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "certificate.json"
            # At the same time as another one, so that neither has the time that it would have alone.
            again = pathlib.Path(directory) / "again.json"
            with subprocess.Popen([PROGRAM, "certify", "--model", "1.037,4073,0.3182", "--effort", EFFORT, "--rounds",
                                   ROUNDS, "--out", str(again)], stdout=subprocess.DEVNULL) as other:
                run = certify("--effort", EFFORT, "--rounds", ROUNDS, "--json", "--out", str(path))
            if other.returncode != 0:
                raise AssertionError("the second run failed")
            cls.again = again.read_bytes()
            again.unlink()
            cls.bytes = path.read_bytes()
            if run.returncode != 0 or run.stderr:
                raise AssertionError(run.stderr)
            cls.result = json.loads(run.stdout)
            cls.checked = subprocess.run(
                [sys.executable, "-B", check_certificate.__file__, str(path)],
                capture_output=True, timeout=500, check=False)
            cls.files = [file.name for file in pathlib.Path(directory).iterdir()]
            cls.certificate = json.loads(path.read_text(encoding="ascii"))

    def rejects(self, damage, reason):
        data = copy.deepcopy(self.certificate)
        damage(data)
        with self.assertRaisesRegex(check_certificate.Rejected, reason):
            check_certificate.check(data)

    def test_accepts_what_the_program_proves(self):
        self.assertEqual(self.checked.returncode, 0, self.checked.stderr)
        self.assertIn(b"proven: E <= 0.005", self.checked.stdout)
        self.assertEqual(self.files, ["certificate.json"])

    def test_prints_the_bound_and_the_size_of_the_proof(self):
        result = self.result
        self.assertEqual(sorted(result), sorted(["T", "E", "bound", "gap", "cells", "multipliers",
                                                 "nodes", "corners", "seconds", "E_range", "warnings"]))
        self.assertAlmostEqual(result["E"] / BEST_KNOWN, 1.0, delta=1e-9)
        self.assertAlmostEqual(result["gap"], result["bound"] / result["E"] - 1.0, delta=1e-12)
        self.assertGreater(result["gap"], 0.0)
        self.assertLess(result["gap"], 0.005)  # The plain relaxation has 14.5 %.
        self.assertEqual(result["bound"], self.certificate["bound"])
        self.assertEqual(result["cells"] + 1, len(self.certificate["edges"]))
        self.assertEqual(result["multipliers"], len(self.certificate["multipliers"]))
        self.assertEqual((result["nodes"], result["corners"]), (0, 1))

    def test_the_same_rounds_give_the_same_bytes_under_load(self):
        self.assertEqual(self.bytes, self.again)

    def largest_multiplier(self, data):
        return max(data["multipliers"], key=lambda m: m[4])

    def test_rejects_a_moved_multiplier(self):
        def lower(data):
            self.largest_multiplier(data)[4] -= self.largest_multiplier(data)[4] // 10

        def raise_it(data):
            self.largest_multiplier(data)[4] *= 2
            data["bound"] *= 1.1

        def missing(data):
            data["multipliers"].remove(self.largest_multiplier(data))

        self.rejects(lower, "not positive definite")
        self.rejects(raise_it, "not positive definite")
        self.rejects(missing, "not positive definite")

    def test_rejects_a_moved_y(self):
        def lower(data):
            cell = max(range(len(data["y"])), key=data["y"].__getitem__)
            data["y"][cell] -= data["y"][cell] // 50

        def raise_it(data):
            data["y"][0] += 1 + sum(data["y"]) // 100000

        self.rejects(lower, "not positive definite")
        self.rejects(raise_it, "proves")
        self.rejects(lambda data: data["y"].pop(), "do not fit the edges")
        self.rejects(lambda data: data["y"].__setitem__(3, -1), "negative y")

    def test_rejects_a_moved_edge(self):
        def later(data):
            edges = data["edges"]
            edges[20] += 0.1 * (edges[21] - edges[20])

        self.rejects(later, "cost of cell 19 is too low")
        self.rejects(lambda data: data["edges"].__setitem__(-1, 1.9e-3), "from 0 to T")

    def test_rejects_costs_that_are_too_low(self):
        self.rejects(lambda data: data["costs"].__setitem__(20, 0.9 * data["costs"][20]),
                     "cost of cell 20 is too low")

    def test_rejects_a_lower_bound(self):
        self.rejects(lambda data: data.update(bound=data["bound"] * (1.0 - 1e-9)), "proves")

    def test_rejects_another_device_time_or_limit(self):
        self.rejects(lambda data: data["model"].update(S=1.01 * data["model"]["S"]), ".")
        self.rejects(lambda data: data["model"].update(beta=0.3), ".")
        self.rejects(lambda data: data["signal"].update(T=2.1e-3), "from 0 to T")
        self.rejects(lambda data: data["signal"].update(a=1.04), "proves")
        self.rejects(lambda data: data["energy"].update(E=1.001 * data["energy"]["E"]),
                     "does not have the energy")

    def test_rejects_what_is_no_multiplier(self):
        def negative(data):
            data["multipliers"][0][4] = -1

        def unordered(data):
            data["multipliers"][0][:2] = data["multipliers"][0][1::-1]

        def of_any_sign(data):  # Kind 4 of format 1.
            data["multipliers"][0][3] = 4

        self.rejects(negative, "negative multiplier")
        self.rejects(unordered, "i < j < k")
        self.rejects(of_any_sign, "no known kind")

    def test_says_what_to_do_with_an_old_format(self):
        self.rejects(lambda data: data.update(certificate=1), "format 1.*make a new one")
        self.rejects(lambda data: data.update(certificate=4), "not known here")
        self.rejects(lambda data: data.pop("certificate"), "not a certificate")
        self.rejects(lambda data: data.pop("y"), "not a certificate")

    def test_elements_of_phi_are_enclosed(self):
        # Energies of patterns by quadrature, which shares nothing with the closed forms.
        certificate = check_certificate.Certificate(self.certificate)
        parts = check_certificate.Response.parts_of(certificate.systems[0])
        matrix, radius = check_certificate.cell_matrix(parts, certificate.edges)
        self.assertLess(float(np.sum(radius)), 1e-8 * certificate.energy)
        generator = np.random.default_rng(1)
        for pattern in (np.ones(certificate.cells),
                        reference.sign_pattern(generator.standard_normal(certificate.cells))):
            switches = certificate.edges[np.flatnonzero(np.diff(pattern)) + 1]
            energy = reference.switching_energy(certificate.systems[0], list(switches),
                                                certificate.time, 1.0)
            self.assertAlmostEqual(float(pattern @ matrix @ pattern) / energy, 1.0, delta=1e-11)


class Constants(unittest.TestCase):
    """Against quadrature of the responses, which shares nothing with the closed forms."""

    SENSOR = reference.Accelerometer(1.037, 4073.0, 0.3182)
    SYSTEMS = (
        reference.System(SENSOR),
        reference.System(SENSOR, 1),
        reference.System(SENSOR, 5, 1000.0, 0.9, "difference"),
        reference.System(SENSOR, 1, 1000.0, None, "difference"),
        reference.System(SENSOR, 4, 1000.0, None, "band", SENSOR.delay()),
    )
    TIME = 1e-3

    def test_slopes_are_enclosed(self):
        # m_1 by Gauss-Legendre of phi itself and differences in t.
        nodes, weights = reference.gauss_legendre(24)
        s = ((np.arange(200)[:, None] + nodes) / 200 * self.TIME).ravel()
        s_weights = np.tile(weights, 200) / 200 * self.TIME
        t0, d = 0.35e-3, 1e-7
        for system in self.SYSTEMS:
            with self.subTest(system=system):
                slope = check_certificate.SlopeBound(check_certificate.Response.parts_of(system), self.TIME)

                def phi(t):
                    start = np.maximum(s, t)
                    total = np.zeros(s.shape)
                    for piece in range(6):
                        for node, weight in zip(nodes, weights):
                            u = start + (self.TIME - start) * (piece + node) / 6
                            for sign, kernel in system.kernels():
                                total += (sign * weight * (self.TIME - start) / 6
                                          * kernel.response(u - t) * kernel.response(u - s))
                    return total

                by_hand = float(s_weights @ np.abs((phi(t0 + d) - phi(t0 - d)) / (2.0 * d)))
                # 1e-3 for the kinks of |f|.
                self.assertGreater(slope.over(t0, t0), by_hand * 0.999)
                self.assertLess(slope.over(t0, t0), by_hand * 1.02)

    def test_curvatures_are_enclosed(self):
        # Second differences of the textbook response.
        time, step = 2e-3, 1e-3
        t = (np.arange(40000) + 0.5) * (time / 40000)

        def size(sensors):
            below, middle, above = (sensor.impulse_response(t) for sensor in sensors)
            inner = np.cumsum(np.abs(below - 2.0 * middle + above)) * (time / 40000) / step**2
            return math.sqrt(float(np.mean(inner**2))) / 1.037

        def sensor(f0, beta):
            return reference.Accelerometer(1.037, f0, beta)

        # Envelopes take the sizes of complex numbers; with more damping the real parts are far smaller.
        for beta, most in ((0.05, 2.0), (0.3182, 2.1), (0.7, 8.0)):
            by_f0 = size([sensor(4073.0 * (1.0 + i * step), beta) for i in (-1, 0, 1)])
            by_beta = size([sensor(4073.0, beta + i * step) for i in (-1, 0, 1)])
            found = check_certificate.sensor_curvatures(4073.0, beta, beta + 1e-9, time)
            for true, bound in zip((by_f0, by_beta), found):
                self.assertGreater(bound, true * 0.999)
                self.assertLess(bound, true * most)

    def test_integral_of_the_filter_is_enclosed(self):
        for order in (1, 2, 10):
            system = reference.System(self.SENSOR, order)
            t = (np.arange(40000) + 0.5) * (2e-3 / 40000)
            by_hand = float(np.mean(np.abs(system.filter.impulse_response(t)))) * 2e-3 / system.filter.gain
            found = check_certificate.filter_integral(system, 2e-3)
            self.assertGreater(found, by_hand * (1.0 - 1e-6))
            self.assertLess(found, by_hand * 1.005)

    def test_energies_of_signals_are_enclosed(self):
        switches = [0.21e-3, 0.35e-3, 0.8e-3]
        for system in self.SYSTEMS:
            with self.subTest(system=system):
                found = check_certificate.signal_energy(check_certificate.Response.parts_of(system), switches, self.TIME)
                by_hand = reference.switching_energy(system, switches, self.TIME, 1.0)
                self.assertLess(float(found.delta.b), 1e-20)
                self.assertAlmostEqual(float(found.mid.b) / by_hand, 1.0, delta=1e-10)

    def test_energy_of_a_small_error_keeps_its_digits(self):
        # 1e-4 of the output. Quadrature in floating point is 1.3e-8 off; from the same poles with 50 digits, by hand:
        sensor = reference.Accelerometer(1.0, 50000.0, 0.02)
        system = reference.System(sensor, 10, 1000.0, None, "band", 1.2732395447351627e-07)
        found = check_certificate.signal_energy(check_certificate.Response.parts_of(system),
                                                [0.0004019210078617678, 0.0009926302416682071], 2e-3)
        self.assertAlmostEqual(float(found.mid.b) / 2.1297992233671387e-11, 1.0, delta=1e-14)

    def test_elements_of_phi_are_enclosed(self):
        edges = np.linspace(0.0, self.TIME, 41)
        generator = np.random.default_rng(1)
        pattern = reference.sign_pattern(generator.standard_normal(40))
        switches = edges[np.flatnonzero(np.diff(pattern)) + 1]
        for system in self.SYSTEMS:
            with self.subTest(system=system):
                matrix, radius = check_certificate.cell_matrix(check_certificate.Response.parts_of(system), edges)
                energy = reference.switching_energy(system, list(switches), self.TIME, 1.0)
                self.assertAlmostEqual(float(pattern @ matrix @ pattern) / energy, 1.0, delta=1e-11)
                self.assertLess(float(np.sum(radius)), 1e-6 * abs(energy))

    def test_what_a_delay_leaves_open_is_enclosed(self):
        # DESIGN's figures: 2.6e-15 at order 10, 2.7e-5 at order 4.
        for order in (2, 4, 7, 10):
            system = reference.System(self.SENSOR, order, 1000.0, None, "band", self.SENSOR.delay())
            in_band = system._in_band  # pylint: disable=protected-access
            nodes, weights = reference.gauss_legendre(24)
            by_hand = system.delay * float(weights @ np.abs(in_band.continued(-system.delay * nodes)))
            found = check_certificate.delay_error(system)
            self.assertGreaterEqual(found, by_hand * (1.0 - 1e-9))
            self.assertLess(found, by_hand * 1.001)


class CheckOtherCertificates(unittest.TestCase):
    # Energies in closed form at refined switches, found with other code.
    KNOWN = {
        ("--order", "4", "--criterion", "band"): (1.49396682e-6, 1.01),
        ("--order", "1"): (3.3392861e-3, 1.06),
        ("--criterion", "difference"): (4.7871801e-3, 1.04),
    }

    def test_accepts_what_the_program_proves(self):
        for options, (known, most) in self.KNOWN.items():
            with self.subTest(options=options), tempfile.TemporaryDirectory() as directory:
                path = pathlib.Path(directory) / "certificate.json"
                run = certify(*options, "--effort", EFFORT, "--rounds", "8", "--out", str(path))
                self.assertEqual((run.returncode, run.stderr), (0, b""))
                certificate = json.loads(path.read_text(encoding="ascii"))
                self.assertAlmostEqual(certificate["energy"]["E"] / known, 1.0, delta=1e-7)
                self.assertLess(certificate["bound"], most * known)
                self.assertGreater(certificate["bound"], certificate["energy"]["E"])
                check_certificate.check(certificate)
                self.rejects_another_criterion(certificate)

    def test_light_damping_at_high_frequencies(self):
        for model in ("0.1,12000,0.03", "0.1,16000,0.03"):
            with self.subTest(model=model), tempfile.TemporaryDirectory() as directory:
                path = pathlib.Path(directory) / "certificate.json"
                run = subprocess.run(
                    [PROGRAM, "certify", "--model", model, "--time", "0.0005", "--effort", "0.5", "--rounds", "5",
                     "--out", str(path)], capture_output=True, timeout=500, check=False)
                self.assertEqual((run.returncode, run.stderr), (0, b""))
                certificate, bound = check_certificate.check(json.loads(path.read_text(encoding="ascii")))
                self.assertGreater(bound, certificate.energy)
                self.assertLess(bound, 1.1 * certificate.energy)

    def test_high_resonance_in_band(self):
        """Its mesh is that of the resonance, though the cells are those of the band."""
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "certificate.json"
            run = subprocess.run(
                [PROGRAM, "certify", "--model", "1,25000,0.02", "--criterion", "band", "--time", "0.002", "--effort", "0.5",
                 "--rounds", "5", "--out", str(path)], capture_output=True, timeout=500, check=False)
            self.assertEqual((run.returncode, run.stderr), (0, b""))
            certificate, bound = check_certificate.check(json.loads(path.read_text(encoding="ascii")))
            self.assertGreater(bound, certificate.energy)
            self.assertLess(bound, 1.1 * certificate.energy)

    def rejects_another_criterion(self, certificate):
        model = certificate["model"]
        criterion = model.get("criterion", "ise")
        for other in {"ise", "difference", "band"} - {criterion}:
            model["criterion"] = other
            with self.assertRaises(check_certificate.Rejected):
                check_certificate.check(certificate)
        model["criterion"] = criterion
        if criterion == "band":
            for delay in (model["delay"] + 1e-6, 0.2e-3, -1e-6):
                with self.assertRaises(check_certificate.Rejected):
                    check_certificate.check({**certificate, "model": {**model, "delay": delay}})

    def test_names_the_error_that_the_proof_is_about(self):
        short = ("--effort", "0.2", "--rounds", "1")
        self.assertIn(b"in band, the reference without a delay",
                      certify("--criterion", "band", "--reference-delay", "none", *short).stdout)
        run = certify("--criterion", "band", "--order", "4", *short)
        self.assertIn(b"in band, the reference delayed by 24.868 us", run.stdout)
        self.assertIn(b"True delay  E <= 1.", run.stdout)
        self.assertIn(b"sensor less that of the filter", certify("--criterion", "difference", *short).stdout)


class CheckBoxCertificate(unittest.TestCase):
    MODEL = "1.037,4073,0.3182,0.003,6,0.0004"

    @classmethod
    def setUpClass(cls):
        cls.certificate, cls.text = cls.prove("--box", "auto", "--rounds", "12")

    @classmethod
    def prove(cls, *options):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "certificate.json"
            run = subprocess.run(
                [PROGRAM, "certify", "--model", cls.MODEL, "--time", "0.001", "--effort", EFFORT, "--out",
                 str(path), *options], capture_output=True, timeout=500, check=False)
            if run.returncode != 0 or run.stderr:
                raise AssertionError(run.stderr)
            return json.loads(path.read_text(encoding="ascii")), run.stdout

    def rejects(self, damage, reason):
        data = copy.deepcopy(self.certificate)
        damage(data)
        with self.assertRaisesRegex(check_certificate.Rejected, reason):
            check_certificate.check(data)

    def assert_just_outside(self, knots, wanted):
        for own, (low, *rest) in zip(knots, wanted):
            self.assertLessEqual(own[0], low)
            self.assertAlmostEqual(own[0] / low, 1.0, delta=1e-15)
            if rest:
                self.assertGreaterEqual(own[-1], rest[0])
                self.assertAlmostEqual(own[-1] / rest[0], 1.0, delta=1e-15)

    def test_accepts_what_the_program_proves(self):
        certificate, bound = check_certificate.check(self.certificate)
        self.assertEqual(len(certificate.systems), 8)
        self.assert_just_outside(certificate.knots, [[1.034, 1.04], [4067.0, 4079.0], [0.3178, 0.3186]])
        self.assertLess(bound, 1.02 * certificate.energy)
        # Energies of the best signal all over the box, by quadrature.
        sensors = [reference.Accelerometer(s, f0, beta) for s in (1.034, 1.037, 1.04) for f0 in (4067.0, 4072.0, 4079.0)
                   for beta in (0.3178, 0.3186)]
        for sensor in sensors:
            system = reference.System(sensor, 10, 1000.0, 1.037)
            self.assertLess(reference.switching_energy(system, certificate.switches, 1e-3, 1.037),
                            certificate.energy * (1.0 + 1e-9))
        self.assertIn(b"every device in the box", self.text)
        self.assertIn(b"Box         S +- 0.003 V/(m/s^2), f0 +- 6 Hz, beta +- 0.0004, the gain is fixed", self.text)

    def test_a_gain_that_follows_needs_one_end_of_s(self):
        data, text = self.prove("--box", "0.003,0,0.0004", "--gain", "track", "--rounds", "2")
        certificate, _ = check_certificate.check(data)
        self.assert_just_outside([[1.034] + certificate.knots[0], *certificate.knots[1:]],
                                 [[1.034, 1.04], [4073.0], [0.3178, 0.3186]])
        self.assertEqual([system.filter.gain for system in certificate.systems], 2 * certificate.knots[0])
        self.assertIn(b"the gain follows S", text)
        data["box"]["S"] = [1.034, 1.04]
        data["y"] = 2 * data["y"]
        with self.assertRaisesRegex(check_certificate.Rejected, "more than one S"):
            check_certificate.check(data)

    def test_wide_boxes_have_more_corners(self):
        data, _ = self.prove("--box", "0,70,0.0004", "--rounds", "2")
        certificate, bound = check_certificate.check(data)
        self.assertGreater(len(certificate.systems), 4)
        self.assertGreater(bound, certificate.energy)
        data["box"]["f0"].pop(1)  # Wider cells, fewer corners.
        del data["y"][2:4]
        with self.assertRaisesRegex(check_certificate.Rejected, "curvature by f0"):
            check_certificate.check(data)

    def test_rejects_what_has_been_moved(self):
        def lower_multiplier(data):
            largest = max(data["multipliers"], key=lambda m: m[4])
            largest[4] -= largest[4] // 10

        def lower_y(data):
            y = data["y"][-1]
            cell = max(range(len(y)), key=y.__getitem__)
            y[cell] -= y[cell] // 50

        def move_edge(data):
            edges = data["edges"]
            edges[20] += 0.1 * (edges[21] - edges[20])

        self.rejects(lower_multiplier, "not positive definite")
        self.rejects(lower_y, "not positive definite")
        self.rejects(move_edge, "cost of cell 19 is too low")
        self.rejects(lambda data: data["costs"].__setitem__(20, 0.9 * data["costs"][20]), "cost of cell 20 is too low")
        for name in ("f0", "beta"):
            self.rejects(lambda data, name=name: data["curvature"].__setitem__(name, 0.95 * data["curvature"][name]),
                         f"curvature by {name} is too low")
        self.rejects(lambda data: data.update(bound=data["bound"] * (1.0 - 1e-9)), "proves")
        self.rejects(lambda data: data["energy"].update(S=1.041), "outside the box")

    def test_rejects_other_boxes(self):
        def swap(data):
            data["y"][0], data["y"][7] = data["y"][7], data["y"][0]

        self.rejects(lambda data: data["y"].pop(), "a y for each corner")
        self.rejects(swap, "not positive definite")
        self.rejects(lambda data: data["box"]["f0"].__setitem__(1, 4080.0), "curvature by f0")
        self.rejects(lambda data: data["box"]["beta"].__setitem__(0, 0.3177), "curvature by beta")
        self.rejects(lambda data: data["box"]["S"].__setitem__(1, 1.041), "not positive definite|cost")
        self.rejects(lambda data: data["box"]["f0"].reverse(), "do not ascend")
        self.rejects(lambda data: data["box"].update(gain=None), "more than one S")
        self.rejects(lambda data: data["box"].update(gain=1.04), "not positive definite|cost")


class CertifyStops(unittest.TestCase):
    def test_ctrl_c_keeps_what_is_proven(self):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "certificate.json"
            run = subprocess.Popen(
                [PROGRAM, "certify", "--model", "1.037,4073,0.3182", "--effort", "1", "--rounds", "100000", "--out",
                 str(path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            try:
                run.wait(timeout=6)
            except subprocess.TimeoutExpired:
                run.send_signal(signal.SIGINT)
            output, errors = run.communicate(timeout=450)
            self.assertEqual((run.returncode, errors), (0, b""))
            self.assertIn(b"for every such signal", output)
            certificate, bound = check_certificate.check(
                json.loads(path.read_text(encoding="ascii")))
            self.assertGreater(bound, certificate.energy)


class CertifyRefuses(unittest.TestCase):
    def refuses(self, words, *arguments):
        run = subprocess.run([PROGRAM, "certify", *arguments], capture_output=True, timeout=500,
                             check=False)
        self.assertEqual(run.returncode, 2)
        self.assertEqual(run.stdout, b"")
        self.assertIn(words, run.stderr)
        self.assertEqual(run.stderr.count(b"\n"), 1)

    def test_bad_input(self):
        model = ("--model", "1.037,4073,0.3182")
        self.refuses(b"no device")
        self.refuses(b"did you mean --time", *model, "--tim", "0.01")
        self.refuses(b"--trials: no option", *model, "--trials", "1000")
        self.refuses(b"--effort: \"soon\"", *model, "--effort", "soon")
        self.refuses(b"--effort: no value", *model, "--effort")
        self.refuses(b"--rounds: \"0\"", *model, "--rounds", "0")
        self.refuses(b"--rounds: \"2.5\"", *model, "--rounds", "2.5")
        self.refuses(b"--box: \"0.003,6\"", *model, "--box", "0.003,6")
        self.refuses(b"--box: a box without width", *model, "--box", "auto")
        self.refuses(b"--box: some devices of the box cannot exist", *model, "--box", "0.003,6,0.4")
        self.refuses(b"--out: no value", *model, "--out=")
        self.refuses(b"take no delay out", *model, "--order", "1", "--criterion", "band")
        self.refuses(b"--criterion: no signal is known", "--model", "0.01,4073,0.7", "--gain", "1", "--order", "1", "--criterion",
                     "difference")
        self.refuses(b"--time", *model, "--time", "0.1")
        self.refuses(b"--out: /nowhere/at/all", *model, "--out", "/nowhere/at/all")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
