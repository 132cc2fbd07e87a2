"""A short run of `emax certify`: the check accepts its certificate, and rejects damaged ones.

    test_check_certificate.py PROGRAM
"""

import copy
import json
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


def certify(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([PROGRAM, "certify", "--model", "1.037,4073,0.3182", *arguments],
                          capture_output=True, timeout=55, check=False)


class CheckCertificate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "certificate.json"
            run = certify("--effort", EFFORT, "--rounds", ROUNDS, "--json", "--out", str(path))
            again = pathlib.Path(directory) / "again.json"
            certify("--effort", EFFORT, "--rounds", ROUNDS, "--out", str(again))
            cls.again = again.read_bytes()
            again.unlink()
            cls.bytes = path.read_bytes()
            if run.returncode != 0 or run.stderr:
                raise AssertionError(run.stderr)
            cls.result = json.loads(run.stdout)
            cls.checked = subprocess.run(
                [sys.executable, "-B", check_certificate.__file__, str(path)],
                capture_output=True, timeout=55, check=False)
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
        self.assertEqual(sorted(result), sorted(["E", "bound", "gap", "cells", "multipliers",
                                                 "nodes", "seconds", "E_range", "warnings"]))
        self.assertAlmostEqual(result["E"] / BEST_KNOWN, 1.0, delta=1e-9)
        self.assertAlmostEqual(result["gap"], result["bound"] / result["E"] - 1.0, delta=1e-12)
        self.assertGreater(result["gap"], 0.0)
        self.assertLess(result["gap"], 0.005)  # The plain relaxation has 14.5 %.
        self.assertEqual(result["bound"], self.certificate["bound"])
        self.assertEqual(result["cells"] + 1, len(self.certificate["edges"]))
        self.assertEqual(result["multipliers"], len(self.certificate["multipliers"]))
        self.assertEqual(result["nodes"], 0)

    def test_the_same_rounds_give_the_same_bytes(self):
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
        self.rejects(lambda data: data.update(certificate=3), "not known here")
        self.rejects(lambda data: data.pop("certificate"), "not a certificate")
        self.rejects(lambda data: data.pop("y"), "not a certificate")

    def test_elements_of_phi_are_enclosed(self):
        # Energies of patterns by quadrature, which shares nothing with the closed forms.
        certificate = check_certificate.Certificate(self.certificate)
        parts = check_certificate.Response.parts_of(certificate.system)
        matrix, radius = check_certificate.cell_matrix(parts, certificate.edges)
        self.assertLess(float(np.sum(radius)), 1e-8 * certificate.energy)
        generator = np.random.default_rng(1)
        for pattern in (np.ones(certificate.cells),
                        reference.sign_pattern(generator.standard_normal(certificate.cells))):
            switches = certificate.edges[np.flatnonzero(np.diff(pattern)) + 1]
            energy = reference.switching_energy(certificate.system, list(switches),
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
        ("--order", "4", "--criterion", "band", "--reference-delay", "none"): (2.02966723e-5, 1.01),
        ("--order", "4", "--criterion", "band"): (1.49396682e-6, 1.01),
        ("--order", "1"): (3.3392861e-3, 1.06),
        ("--criterion", "difference"): (4.7871801e-3, 1.03),
    }

    def test_accepts_what_the_program_proves(self):
        for options, (known, most) in self.KNOWN.items():
            with self.subTest(options=options), tempfile.TemporaryDirectory() as directory:
                path = pathlib.Path(directory) / "certificate.json"
                run = certify(*options, "--effort", EFFORT, "--rounds", "12", "--out", str(path))
                self.assertEqual((run.returncode, run.stderr), (0, b""))
                certificate = json.loads(path.read_text(encoding="ascii"))
                self.assertAlmostEqual(certificate["energy"]["E"] / known, 1.0, delta=1e-7)
                self.assertLess(certificate["bound"], most * known)
                self.assertGreater(certificate["bound"], certificate["energy"]["E"])
                check_certificate.check(certificate)
                self.rejects_another_criterion(certificate)

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
            output, errors = run.communicate(timeout=45)
            self.assertEqual((run.returncode, errors), (0, b""))
            self.assertIn(b"for every such signal", output)
            certificate, bound = check_certificate.check(
                json.loads(path.read_text(encoding="ascii")))
            self.assertGreater(bound, certificate.energy)


class CertifyRefuses(unittest.TestCase):
    def refuses(self, words, *arguments):
        run = subprocess.run([PROGRAM, "certify", *arguments], capture_output=True, timeout=55,
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
        self.refuses(b"--out: no value", *model, "--out=")
        self.refuses(b"take no delay out", *model, "--order", "1", "--criterion", "band")
        self.refuses(b"--criterion: no signal is known", "--model", "0.01,4073,0.7", "--gain", "1", "--order", "1", "--criterion",
                     "difference")
        self.refuses(b"--time", *model, "--time", "0.1")
        self.refuses(b"--out: /nowhere/at/all", *model, "--out", "/nowhere/at/all")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
