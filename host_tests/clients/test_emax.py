"""emax.py: what it makes of files and of the program, and that its example prints what the README shows.

usage: test_emax.py PROGRAM PROJECT_DIRECTORY
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy

import emax

PROGRAM, PROJECT = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
HERE = pathlib.Path(__file__).resolve().parent
# DESIGN: the best known signal of the paper's device for T = 2 ms.
MODEL, ENERGY, SWITCH = (1.037, 4073, 0.3182), 0.005115251359876, 1.0474909417558e-3


class PythonTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)

    def report(self, *arguments, **options):
        return emax.run_report(*arguments, program=PROGRAM, **options)

    def test_report_of_a_model(self):
        result = self.report(model=MODEL, trend=[0.002, 0.004])
        self.assertAlmostEqual(result["energy"]["E"] / ENERGY, 1.0, delta=1e-12)
        numpy.testing.assert_allclose(result["energy"]["switch_times"], [SWITCH], rtol=1e-10)
        self.assertEqual(result["trend"]["points"].shape, (2, 2))
        numpy.testing.assert_array_equal(result["trend"]["points"][:, 0], [0.002, 0.004])
        self.assertIsNone(result["bench"])

    def test_options_as_words(self):
        words = emax.option_words({"model": numpy.array([1.0, 2.5]), "adaptive": True, "json": False, "note": None, "limit": 1})
        self.assertEqual(words, ["--model", "1.0,2.5", "--adaptive", "--limit", "1"])
        self.assertEqual(emax.option_words({"label": ["A=1", "B=2, 3"]}), ["--label", "A=1", "--label", "B=2, 3"])
        labels = self.report(model=MODEL, trials=1000, trend="none", label=["a=1", "b=2, 3"])["labels"]
        self.assertEqual((labels["a"], labels["b"]), ("1", "2, 3"))

    def test_copy_without_a_program(self):
        copy = self.directory / "emax.py"
        copy.write_text((HERE / "emax.py").read_text(encoding="utf-8"), encoding="utf-8")
        words = "import emax\ntry: emax.find_program()\nexcept emax.EmaxError as error: print(error.status, error)"
        environment = {"PATH": "", "PYTHONPATH": os.environ.get("PYTHONPATH", "")}
        done = subprocess.run([sys.executable, "-B", "-c", words], cwd=self.directory, env=environment,
                              capture_output=True, text=True, check=False)
        self.assertEqual((done.stderr, done.stdout[:35]), ("", "2 the program emax is not found: pu"))
        done = subprocess.run([sys.executable, "-B", "-c", "import emax; print(emax.find_program())"], cwd=self.directory,
                              env=environment | {"EMAX": "/some/emax"}, capture_output=True, text=True, check=False)
        self.assertEqual(done.stdout, "/some/emax\n")

    def test_phases_that_were_not_measured_are_nan(self):
        out = self.directory / "out"
        self.report(points=PROJECT / "host_tests/data/tables/magnitude_only.csv", trials=1000, trend="none", out=out)
        response = emax.load(out)["tables"]["frequency_response"]
        self.assertTrue(numpy.isfinite(response["amplitude"]).all())
        self.assertTrue(numpy.isnan(response["phase_deg"]).all())

    def test_what_becomes_an_array(self):
        found = emax.with_arrays(json.loads('{"a": [1, null, 3], "b": [[1, 2], [3, 4]], "c": [], "d": ["x", "y"], '
                                            '"e": [{"f": [5]}], "warnings": [], "g": [true]}'))
        numpy.testing.assert_array_equal(found["a"], [1.0, numpy.nan, 3.0])
        numpy.testing.assert_array_equal(found["b"], [[1.0, 2.0], [3.0, 4.0]])
        self.assertEqual((found["c"].shape, found["d"], found["warnings"], found["g"]), ((0,), ["x", "y"], [], [True]))
        numpy.testing.assert_array_equal(found["e"][0]["f"], [5.0])

    def test_directory(self):
        out = self.directory / "out"
        printed = self.report(points=PROJECT / "host_tests/data/djb_a1800v.csv", trials=1000, trend="none", out=out)
        found = emax.load(out)
        self.assertEqual(sorted(found["tables"]), ["frequency_response", "histogram", "impulse_response", "signal", "trend"])
        response = found["tables"]["frequency_response"]
        self.assertEqual(list(response)[:2], ["f_hz", "amplitude"])
        table = numpy.loadtxt(PROJECT / "host_tests/data/djb_a1800v.csv", delimiter=",", skiprows=1)
        numpy.testing.assert_array_equal(response["f_hz"], table[:, 0])
        numpy.testing.assert_array_equal(response["amplitude"], table[:, 1])
        self.assertEqual(emax.load(out / "results.json")["energy"]["E"], printed["energy"]["E"])

    def test_refusal(self):
        with self.assertRaisesRegex(emax.EmaxError, r"^emax: --order: ") as caught:
            self.report(model=MODEL, order=16)
        self.assertEqual((caught.exception.status, caught.exception.results), (2, None))

    def test_fault_keeps_what_was_measured(self):
        with self.assertRaisesRegex(emax.EmaxError, "no device") as caught:
            self.report(bench_fault="unplugged-device@4")
        self.assertEqual(caught.exception.status, 3)
        self.assertEqual(caught.exception.results["bench"]["fault"]["name"], "no device")
        self.assertEqual(len(caught.exception.results["bench"]["budget"]), caught.exception.results["bench"]["points"])

    def example(self, *words):
        done = subprocess.run([sys.executable, "-B", *words], cwd=PROJECT, env=os.environ | {"EMAX": PROGRAM},
                              capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return done.stdout

    def test_examples_of_the_readme(self):
        readme = (PROJECT / "firmware/desk/README.md").read_text(encoding="utf-8")
        shown = re.findall(r"^```\n\$ python3 (host_tests/clients/.*)\n((?:.*\n)*?)```$", readme, re.MULTILINE)
        self.assertEqual(len(shown), 2)
        for command, output in shown:
            self.assertEqual(self.example(*command.split()), output, command)

    def test_list_of_sensors_of_the_readme(self):
        readme = (PROJECT / "firmware/desk/README.md").read_text(encoding="utf-8")
        scripts = re.findall(r"^```python\n(import csv, emax\n(?:.*\n)*?)```$", readme, re.MULTILINE)
        self.assertEqual(len(scripts), 1)
        head = re.search(r"`sensors.csv` with the head `(\S+)`", readme)[1]
        rows = [head, "C7,1.037,4073,0.3182,0.003,6,0.0004", "D8,2.074,4073,0.3182,0.006,6,0.0004"]
        (self.directory / "sensors.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        (self.directory / "list.py").write_text(scripts[0], encoding="utf-8")
        shutil.copy(HERE / "emax.py", self.directory)
        done = subprocess.run([sys.executable, "-B", "list.py"], cwd=self.directory, env=os.environ | {"EMAX": PROGRAM},
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.stderr, "")
        # E goes with a^2, which is 1 here, and with S^2; the in-band figure of the paper's device is 1.196 % (DESIGN).
        energies = [f"{ENERGY / MODEL[0] ** 2 * scale:.3e}" for scale in (1, 4)]
        for line, name, energy in zip(done.stdout.splitlines(), ["C7", "D8"], energies, strict=True):
            shown = re.fullmatch(rf"{name}: E = {energy} V\^2 s \((\S+) to (\S+)\), in band 1\.196 %, 0 warnings", line)
            self.assertTrue(shown, line)
            self.assertLess(float(shown[1]), float(energy))
            self.assertLess(float(energy), float(shown[2]))

    def test_figures_that_do_not_exist_are_nan(self):
        tables = PROJECT / "host_tests/data/tables"
        alone = emax.figures(emax.run_report(points=tables / "handheld_160hz.csv", program=PROGRAM))
        self.assertEqual({name for name, value in alone.items() if value != value},
                         {"f0", "beta", "E", "E_low", "E_high", "error", "error_low", "error_high"})
        known = emax.figures(emax.run_report(model=MODEL[:3], trend="none", program=PROGRAM))
        self.assertEqual({name for name, value in known.items() if value != value}, {"E_low", "E_high", "error_low", "error_high"})
        result = emax.run_report(points=tables / "mv_per_g.csv", limit=1, trend="none", trials=1000, program=PROGRAM)
        open_damping = emax.figures(result)
        self.assertEqual(result["fit"]["determined"], "all but beta")
        self.assertEqual([open_damping["E_low"], open_damping["E_high"]], list(result["fit"]["E_range"]))
        self.assertGreater(open_damping["warnings"], 0)

    def test_tables_that_are_refused_are_passed_by(self):
        for name in ("handheld_160hz.csv", "khz.csv"):
            shutil.copy(PROJECT / "host_tests/data/tables" / name, self.directory)
        (self.directory / "bad.csv").write_text("f,A\n1,x\n", encoding="utf-8")
        lines = self.example("host_tests/clients/tables_of_a_folder.py", self.directory).splitlines()
        self.assertRegex(lines[1], "^bad.csv: emax: .*bad.csv:1: there is no uncertainty")
        self.assertEqual(lines[2], "handheld_160hz.csv: the points determine S alone")
        self.assertRegex(lines[3], r"^ +[0-9.]+ +[0-9.]+ +[0-9.]+ +0  khz.csv$")
        self.assertEqual(len(lines), 4)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
