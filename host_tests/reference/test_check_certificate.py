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

import check_certificate

PROGRAM = "emax"
BEST_KNOWN = 0.005115251359876  # Table 2's estimates, T = 2 ms.
EFFORT = "4"  # Seconds.


def certify(*arguments: str) -> subprocess.CompletedProcess:
    return subprocess.run([PROGRAM, "certify", "--model", "1.037,4073,0.3182", *arguments],
                          capture_output=True, timeout=55, check=False)


class CheckCertificate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "certificate.json"
            run = certify("--effort", EFFORT, "--json", "--out", str(path))
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
                                                 "nodes", "seconds"]))
        self.assertAlmostEqual(result["E"] / BEST_KNOWN, 1.0, delta=1e-9)
        self.assertAlmostEqual(result["gap"], result["bound"] / result["E"] - 1.0, delta=1e-12)
        self.assertGreater(result["gap"], 0.0)
        self.assertLess(result["gap"], 0.15)  # The plain relaxation has 14.5 %.
        self.assertEqual(result["bound"], self.certificate["bound"])
        self.assertEqual(result["cells"] + 1, len(self.certificate["edges"]))
        self.assertEqual(result["multipliers"], len(self.certificate["multipliers"]))
        self.assertEqual(result["nodes"], len(self.certificate["tree"]))

    def test_rejects_a_moved_multiplier(self):
        def lower(data):
            largest = max((m for m in data["multipliers"] if m[3] < 4), key=lambda m: m[4])
            largest[4] -= largest[4] // 10

        def raise_it(data):
            largest = max((m for m in data["multipliers"] if m[3] < 4), key=lambda m: m[4])
            largest[4] += largest[4] // 10

        self.rejects(lower, "not positive definite")
        self.rejects(raise_it, "not positive definite|proves")

    def test_rejects_a_moved_y(self):
        def worst_y(data):
            return max((node["y"] for node in data["tree"] if "y" in node), key=sum)

        def lower(data):
            y = worst_y(data)
            cell = max(range(len(y)), key=y.__getitem__)
            y[cell] -= y[cell] // 5

        def raise_it(data):
            y = worst_y(data)
            y[0] += 1 + sum(y) // 1000

        self.rejects(lower, "not positive definite|more energy than y says")
        self.rejects(raise_it, "proves")

    def test_rejects_a_missing_node(self):
        if len(self.certificate["tree"]) < 3:
            self.skipTest("no time for cases on this machine")
        self.rejects(lambda data: data["tree"].pop(), "missing")

    def test_rejects_costs_that_are_too_low(self):
        def lower(data):
            data["switch_cost"][20] *= 0.95

        self.rejects(lower, "cost of a switch at edge 20")
        self.rejects(lambda data: data.update(constant=0.9 * data["constant"]), "constant")

    def test_rejects_runs_that_may_exist(self):
        def longer(data):
            data["run_end"][20] += 4

        self.rejects(longer, "runs from edge 20 may be")

    def test_rejects_another_device(self):
        def more_sensitive(data):
            data["model"]["S"] *= 1.01

        self.rejects(more_sensitive, ".")

    def test_rejects_a_negative_multiplier_and_a_run_without_right(self):
        def negative(data):
            next(m for m in data["multipliers"] if m[3] < 4)[4] = -1

        def free(data):
            last = len(data["edges"]) - 2
            data["multipliers"].append([0, last // 2, last, 4, -5])

        self.rejects(negative, "negative multiplier")
        self.rejects(free, "a run that may exist")


class CheckInBandCertificate(unittest.TestCase):
    # DESIGN: closed form at refined switches, the reference without a delay.
    IN_BAND = {"10": 7.66114200e-6, "4": 2.02966723e-5}

    def test_accepts_what_the_program_proves_of_the_error_in_band(self):
        for order, known in self.IN_BAND.items():
            with self.subTest(order=order), tempfile.TemporaryDirectory() as directory:
                path = pathlib.Path(directory) / "certificate.json"
                run = certify("--criterion", "band", "--order", order, "--effort", EFFORT, "--out", str(path))
                self.assertEqual((run.returncode, run.stderr), (0, b""))
                self.assertIn(b"in band, the reference without a delay", run.stdout)
                certificate = json.loads(path.read_text(encoding="ascii"))
                self.assertAlmostEqual(certificate["energy"]["E"] / known, 1.0, delta=1e-8)
                self.assertLess(certificate["bound"], 1.04 * known)  # The quick bound has 3.6 % at order 10.
                check_certificate.check(certificate)
                certificate["model"]["criterion"] = "ise"
                with self.assertRaises(check_certificate.Rejected):
                    check_certificate.check(certificate)

    def test_refuses_the_energy_difference(self):
        run = certify("--criterion", "difference")
        self.assertEqual((run.returncode, run.stdout), (2, b""))
        self.assertIn(b"expected ise or band", run.stderr)


class CertifyStops(unittest.TestCase):
    def test_ctrl_c_keeps_what_is_proven(self):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "certificate.json"
            run = subprocess.Popen(
                [PROGRAM, "certify", "--model", "1.037,4073,0.3182", "--effort", "1000", "--out",
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
        self.refuses(b"--out: no value", *model, "--out=")
        self.refuses(b"--order", *model, "--order", "1")
        self.refuses(b"--time", *model, "--time", "0.1")
        self.refuses(b"--out: /nowhere/at/all", *model, "--out", "/nowhere/at/all")


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
