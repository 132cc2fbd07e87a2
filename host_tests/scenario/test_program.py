"""The program `emax` as its user meets it: what it prints, writes, refuses, and how it ends.

usage: test_program.py PROGRAM DATA_DIRECTORY [unittest arguments]
"""

import cmath
import csv
import json
import math
import os
import pathlib
import pty
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest

from program_test import DATA, MODEL, QUICK, ProgramTest, main

HEADER = "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg"
FREQUENCIES = [100.0, 200.0, 300.0, 500.0, 700.0, 800.0, 900.0, 1000.0, 1100.0, 1300.0]
TRUTH = {"S": 1.037, "f0": 4073.0, "beta": 0.3182}
FAULTS = {
    "lost-block": ("lost block", "lost between two blocks"),
    "late-block": ("late block", "check their clock"),
    "stuck-channel": ("stuck channel", "check its converter"),
    "saturation": ("saturated channel", "lower the conditioner's gain"),
    "unplugged-reference": ("no reference", "check the reference sensor's cable"),
    "unplugged-device": ("no device", "device under test carries no signal beyond its noise; check its cable"),
    "swapped-channels": ("swapped channels", "check the cables"),
    "inverted-polarity": ("inverted polarity", "swap the sensor's leads"),
    "dc-drift": ("DC drift", "warm up"),
}
# Of a device whose parameters are known, without a trend.
FILES = ["histogram.csv", "histogram.svg", "impulse_response.csv", "impulse_response.svg", "pictures.gp"]
FILES += ["report.html", "report.txt", "results.json", "signal.csv", "signal.svg", "trend.csv"]
FILES_OF_POINTS = ["frequency_response.csv", "frequency_response.svg", *FILES]


def table(response, frequencies=FREQUENCIES) -> list[str]:
    """Lines of a table of points; `response` gives K at a frequency in Hz."""
    lines = [HEADER]
    for frequency in frequencies:
        k = response(frequency)
        lines.append(f"{frequency!r},{abs(k)!r},{math.degrees(cmath.phase(k))!r},0.01,1.0")
    return lines


def second_order(sensitivity=1.0, f0=1000.0, damping=0.1):
    return lambda f: sensitivity / (1 - (f / f0) ** 2 + 2j * damping * f / f0)


class GoodPoints(ProgramTest):
    def test_paper_table(self):
        report = self.succeed("report", "--points", DATA / "djb_a1800v.csv", *QUICK)
        # Weighted least squares on 1/K, computed independently with NumPy; to half a unit of the last digit given.
        expected = {
            "S": (1.0079, 0.0011, 5e-5, 5e-5),
            "f0": (4057.25, 2.9, 5e-2, 6e-2),
            "beta": (0.2462, 0.0009, 5e-5, 5e-5),
        }
        for name, (estimate, u, tolerance, u_tolerance) in expected.items():
            row = re.search(rf"^ *{name} +([0-9.]+) +([0-9.]+) ", report, re.MULTILINE)
            self.assertIsNotNone(row, name)
            self.assertAlmostEqual(float(row[1]), estimate, delta=tolerance)
            self.assertAlmostEqual(float(row[2]), u, delta=u_tolerance)
        self.assertRegex(report, r"8595\b.* 81 degrees of freedom")
        self.assertRegex(report, r"WARNING: chi2/dof = 106")

    def test_paper_table_in_numbers(self):
        model = self.json_of("--points", DATA / "djb_a1800v.csv", *QUICK)["model"]
        # As above.
        self.assertAlmostEqual(model["S"], 1.0079, delta=5e-5)
        self.assertAlmostEqual(model["f0"], 4057.25, delta=5e-3)
        self.assertAlmostEqual(model["beta"], 0.2462, delta=5e-5)
        self.assertAlmostEqual(model["uS"], 0.0011, delta=5e-5)
        self.assertAlmostEqual(model["uf0"], 2.9, delta=5e-2)
        self.assertAlmostEqual(model["ubeta"], 0.0009, delta=5e-5)
        self.assertAlmostEqual(model["chi2"], 8595, delta=0.5)
        self.assertEqual(model["dof"], 81)

    def test_exact_points_give_their_device_without_warning(self):
        name = self.write(table(second_order(2.0, 1000.0, 0.1)))
        model = self.json_of("--points", name, "--cutoff", "300", *QUICK)["model"]
        # Only rounding stands between the points and the device.
        self.assertAlmostEqual(model["S"], 2.0, delta=1e-12)
        self.assertAlmostEqual(model["f0"], 1000.0, delta=1e-9)
        self.assertAlmostEqual(model["beta"], 0.1, delta=1e-12)
        self.assertEqual(model["dof"], 2 * len(FREQUENCIES) - 3)
        report = self.succeed("report", "--points", name, "--cutoff", "300", "--trials", "200000", "--trend", "none",
                              "--time", "0.007")  # Longer than the settling time.
        self.assertNotIn("WARNING", report)

    def test_forms_of_a_table_do_not_matter(self):
        lines = table(second_order())
        first, second = lines[1], lines[2]
        expected = self.succeed("report", "--points", self.write(lines), *QUICK)
        variants = {
            "CR LF": "\r\n".join(lines) + "\r\n",
            "no header": "\n".join(lines[1:]) + "\n",
            "no line feed at the end": "\n".join(lines),
            "comments and empty lines": "\n".join(["# a", "", *lines[:2], "", "# b, 1", *lines[2:], "#"]),
            "byte order mark": "\ufeff" + "\n".join(lines),
            "byte order mark, no header": "\ufeff" + "\n".join(lines[1:]),
            "spaces": "\n".join([HEADER, " " + first.replace(",", " , ") + " ", second, *lines[3:]]),
        }
        for variant, text in variants.items():
            with self.subTest(variant):
                self.assertEqual(self.succeed("report", "--points", self.write(text.encode()), *QUICK), expected)

    def test_name_of_the_table(self):
        (self.directory / "prüf Ω.csv").write_bytes((DATA / "djb_a1800v.csv").read_bytes())
        points = ["--points", "prüf Ω.csv", *QUICK]
        self.assertEqual(self.json_of(*points)["model"]["name"], "prüf Ω.csv")
        text = self.run_program("report", *points).stdout.decode()
        self.assertIn("measured points: prüf Ω.csv\n", text)

    def test_standard_input(self):
        text = "\n".join(table(second_order())).encode()
        report = self.succeed("report", "--points", "-", *QUICK, input=text)
        self.assertIn("standard input", report)

    def test_most_and_fewest_points(self):
        for count in [3, 64]:
            with self.subTest(count):
                frequencies = [100.0 + 1200.0 * i / (count - 1) for i in range(count)]
                model = self.json_of("--points", self.write(table(second_order(), frequencies)), *QUICK)["model"]
                self.assertEqual(model["dof"], 2 * count - 3)


class BadPoints(ProgramTest):
    def setUp(self):
        super().setUp()
        self.lines = table(second_order())

    def replaced(self, line, text):
        """The table with another line; the header is line 1."""
        return [*self.lines[: line - 1], text, *self.lines[line:]]

    def test_files_that_are_not_there_or_not_tables(self):
        (self.directory / "folder").mkdir()
        self.refuse(["report", "--points", "missing.csv"], "emax: missing.csv: ", "No such file", "expected a table")
        self.refuse(["report", "--points", "missing/x.csv"], "emax: missing/x.csv: ", "No such file")
        self.refuse(["report", "--points", "folder"], "emax: folder: ", "Is a directory", "expected a table")
        self.refuse(["report", "--points", "x" * 5000], "emax: xxx", "name too long")
        self.refuse(["report", "--points", "a\nb"], "emax: a?b: ")

    def test_names_in_other_writings(self):
        names = {
            "prüf Ω 試.csv": "prüf Ω 試.csv: No such file",
            b"pr\xfcf\n\x1b[1m\xc3.csv": "pr?f??[1m?.csv: No such file",
            "ü" * 100 + "/" + "Ω" * 120: "ü" * 100 + "/" + "Ω" * 99 + "...: No such file",
        }
        for name, words in names.items():
            with self.subTest(name):
                self.refuse(["report", "--points", os.fsdecode(name)], f"emax: {words}")

    def test_empty(self):
        self.refuse_points(b"", None, "empty", "expected")
        self.refuse_points([HEADER], None, "expected")
        self.refuse_points(["# nothing", "", "\r"], None, "expected")
        self.refuse(["report", "--points", "-"], "emax: standard input: ", "empty")

    def test_binary(self):
        self.refuse_points(bytes(range(256)) * 8, 1, "expected")
        self.refuse_points(b"\x7fELF\x02\x01\x01\x00\x00\n" * 5, 1, "expected")
        self.refuse_points("\n".join(self.lines).encode("utf-32"), 1, "UTF-32", "expected")
        high = bytes(range(128, 256))
        self.refuse_points(b"\n".join([HEADER.encode(), high, high]), 2, "expected")
        self.refuse_points("\n".join(self.lines).encode() + b"\n\0", 12, "not a text file")

    def test_too_large(self):
        self.refuse_points(b"# comment\n" * 200_000, None, "1 MiB", "expected")
        with open("/dev/zero", "rb") as endless:
            self.refuse(["report", "--points", "-"], "standard input: larger than 1 MiB", stdin=endless)

    def test_long_line(self):
        self.refuse_points(self.replaced(3, "1" * 100_000), 3, "expected")
        self.refuse_points(self.replaced(3, "200" + "," * 500_000), 3, "expected")

    def test_wrong_count_of_columns(self):
        self.refuse_points(self.replaced(4, "300,1.1,-3,0.01"), 4, "expected")
        self.refuse_points(self.replaced(4, "300,1.1,-3,0.01,1,7"), 4, "expected")
        self.refuse_points(self.replaced(4, "300,1.1,,0.01,1"), 4, "expected")
        self.refuse_points(self.replaced(4, "300;1.1;-3;0.01;1"), 4, "expected")

    def test_text_where_a_number_should_be(self):
        for column in range(5):
            cells = self.lines[5].split(",")
            cells[column] = "abc"
            with self.subTest(column=column):
                self.refuse_points(self.replaced(6, ",".join(cells)), 6, "expected")
        self.refuse_points(self.replaced(6, "500,1.3,-7.6,0.01,1.0x"), 6, "expected")
        self.refuse_points(self.replaced(6, HEADER), 6, "expected")

    def test_not_finite(self):
        for value in ["nan", "NaN", "-nan", "inf", "-inf", "Infinity", "1e999"]:
            for column in range(5):
                cells = self.lines[5].split(",")
                cells[column] = value
                with self.subTest(value=value, column=column):
                    self.refuse_points(self.replaced(6, ",".join(cells)), 6, "expected")

    def test_not_positive(self):
        for column in [0, 1, 3, 4]:
            for value in ["0", "-0", "-0.01"]:
                cells = self.lines[5].split(",")
                cells[column] = value
                with self.subTest(value=value, column=column):
                    self.refuse_points(self.replaced(6, ",".join(cells)), 6, "expected")

    def test_line_numbers_count_every_line(self):
        self.refuse_points(["# a", "", *self.replaced(4, "x"), "y"], 6, "expected", end="\r\n")

    def test_count_of_points(self):
        self.refuse_points(self.lines[:2], None, "3", "expected")
        self.refuse_points(self.lines[:3], None, "3", "expected")
        frequencies = [100.0 + i for i in range(1025)]
        self.refuse_points(table(second_order(), frequencies), 1026, "1024", "expected")

    def test_inverted_polarity(self):
        response = second_order()
        self.refuse_points(table(lambda f: -response(f)), None, "inverted polarity", "180 degrees", "S = -")

    def test_negative_mu(self):
        response = second_order()
        self.refuse_points(table(lambda f: response(f).conjugate()), None, "cannot exist", "phases", "mu2 = -")
        self.refuse_points(table(lambda f: 1 / (1 + (f / 1000) ** 2 + 1e-4j * f)), None, "cannot exist", "mu3 = -")

    def test_overdamped(self):
        self.refuse_points(table(second_order(damping=1.5)), None, "damping is 1 or more", "beta = 1.5")

    def test_not_identifiable(self):
        frequencies = [1000.0, 1000.0 + 2**-40, 1000.0 + 2**-39]
        self.refuse_points(table(second_order(), frequencies), None, "do not determine", "add frequencies")


class GoodModel(ProgramTest):
    def test_report(self):
        report = self.succeed("report", *MODEL, *QUICK)
        # From DESIGN: peak of k, its time, settling time; E_max at 2 ms to the digits that a grid reaches.
        for expected in ["17462", "51.4", "1.453"]:
            self.assertIn(expected, report)

    def test_energy_and_monte_carlo(self):
        results = self.json_of(*MODEL, "--trials", "5000", "--trend", "none")
        energy = results["energy"]
        # The continuous optimum is 0.005115251; signs on 98 cells come within 1e-3 of it.
        self.assertLess(energy["E"], 0.005115251359877)
        self.assertGreater(energy["E"], 0.005115251 * (1 - 1e-3))
        self.assertEqual(energy["T"], 0.002)
        self.assertEqual(energy["a"], 1.037)
        self.assertAlmostEqual(energy["xi"], energy["E"] / (1.037**2 * 0.002), delta=1e-15)
        monte_carlo = results["monte_carlo"]
        self.assertEqual(monte_carlo["trials"], 5000)
        # The corner of the box bounds the maximum from above.
        self.assertLess(monte_carlo["E_max"], 0.0051346992)
        self.assertGreater(monte_carlo["E_max"], energy["E"])
        self.assertLess(monte_carlo["mean"], monte_carlo["E_max"])
        self.assertAlmostEqual(monte_carlo["u"], 1.1e-5, delta=1e-6)
        at = monte_carlo["at"]
        self.assertTrue(1.034 <= at["S"] <= 1.040 and 4067 <= at["f0"] <= 4079 and 0.3178 <= at["beta"] <= 0.3186)

    def test_without_uncertainties_there_is_no_monte_carlo(self):
        self.succeed("report", "--model", "1.037,4073,0.3182", *QUICK)
        self.assertEqual(
            self.json_of("--model", "1.037,4073,0.3182", *QUICK)["energy"]["E"],
            self.json_of("--model", "1.037,4073,0.3182,0,0,0", *QUICK)["energy"]["E"],
        )

    def test_few_trials_bring_a_warning(self):
        self.assertIn("WARNING", self.succeed("report", *MODEL, "--trials", "1000", "--trend", "none"))
        self.assertNotIn("WARNING", self.succeed("report", *MODEL, "--trials", "200000", "--trend", "none"))

    def test_trend(self):
        trend = self.json_of(*MODEL, "--trials", "1000", "--trend", "0.001,0.002,0.003")["trend"]
        self.assertEqual([point[0] for point in trend["points"]], [0.001, 0.002, 0.003])
        self.assertGreater(trend["slope"], 0)

    def test_no_absolute_error_rather_than_a_wrong_one(self):
        # 24000 periods of the resonance: beyond what is sampled for the integral of |k|.
        long = ["--model", "1.037,4073,0.3182", "--method", "paper", "--step", "1e-3", "--time", "6", "--trend", "none"]
        self.assertIsNone(self.json_of(*long)["energy"]["absolute_error"])
        text = self.succeed("report", *long, "--out", "out")
        self.assertRegex(text, r"Largest \|y\| +not computed: k moves too often for so long a T\n")

    def test_fields_of_results(self):
        results = self.json_of(*MODEL, "--trials", "1000", "--trend", "0.001,0.002")
        self.assertLessEqual({"version", "model", "filter", "energy", "monte_carlo", "trend"}, set(results))
        fields = {
            "model": "S f0 beta uS uf0 ubeta covariance chi2 dof source",
            "filter": "order cutoff gain",
            "energy": "criterion method T a E xi rms bound switch_times iterations absolute_error",
            "monte_carlo": "trials probability seed E_max at trial mean u interval shortest disagreements",
            "trend": "slope intercept points",
        }
        for part, names in fields.items():
            with self.subTest(part):
                self.assertLessEqual(set(names.split()), set(results[part]))
        self.assertEqual([len(row) for row in results["model"]["covariance"]], [3, 3, 3])
        self.assertEqual(len(results["monte_carlo"]["seed"]), 4)
        self.assertEqual(len(results["monte_carlo"]["interval"]), 2)
        self.assertEqual(len(results["monte_carlo"]["shortest"]), 2)
        self.assertEqual(set(results["monte_carlo"]["at"]), {"S", "f0", "beta"})


class Options(ProgramTest):
    def test_defaults_are_what_the_help_says(self):
        defaults = ["--order", "10", "--cutoff", "1000", "--gain", "auto", "--time", "0.002", "--limit", "auto"]
        defaults += ["--criterion", "ise", "--method", "best", "--step", "2e-6", "--iterations", "30"]
        defaults += ["--probability", "0.95", "--seed", "123456789,345678901,567890123,789012345"]
        defaults += ["--generator", "2006", "--distribution", "box", "--reference-uncertainty", "0"]
        defaults += ["--trend", "0.002,0.004,0.006,0.008,0.010"]
        report = self.succeed("report", *MODEL, "--trials", "1000")
        self.assertEqual(self.succeed("report", *MODEL, "--trials", "1000", *defaults), report)
        text = self.succeed("report", "--help")
        for option, value in zip(defaults[::2], defaults[1::2]):
            self.assertRegex(text, rf"(?s){option} .*?\(default {re.escape(value)}\)")

    def test_one_name_for_what_points_have_in_common(self):
        for command in ["report", "certify", "scpi"]:
            self.refuse([command, "--common-uncertainty", "0.5"], "--common-uncertainty: ", "did you mean --reference-uncertainty?")
        self.refuse(["compare", "--common-uncertainty", "0.5"], "--common-uncertainty: no option of emax compare; --help lists them")

    def test_two_forms(self):
        spaced = self.succeed("report", *MODEL, *QUICK, "--order", "4")
        joined = self.succeed("report", f"--model={MODEL[1]}", "--trials=1e3", "--trend=none", "--order=4")
        self.assertEqual(joined, spaced)

    def test_settings_arrive(self):
        results = self.json_of(*MODEL, *QUICK, "--order", "3", "--cutoff", "800", "--gain", "0.5", "--time", "1e-3",
                               "--limit", "2", "--probability", "0.9", "--seed", "1,2,3,4")  # fmt: skip
        self.assertEqual([results["filter"][key] for key in ["order", "cutoff", "gain"]], [3, 800, 0.5])
        self.assertEqual([results["energy"][key] for key in ["T", "a"]], [0.001, 2])
        self.assertEqual([results["monte_carlo"][key] for key in ["probability", "seed"]], [0.9, [1, 2, 3, 4]])

    def test_choices_make_a_difference(self):
        reference = self.json_of(*MODEL, *QUICK)
        for part, *choice in [
            ("energy", "--criterion", "difference"),
            ("energy", "--method", "paper"),
            ("monte_carlo", "--gain", "track"),
            ("monte_carlo", "--generator", "1982"),
            ("monte_carlo", "--generator", "1982", "--seed", "1,2,3"),
            ("monte_carlo", "--seed", "1,2,3,4"),
            ("monte_carlo", "--adaptive"),
            ("monte_carlo", "--distribution", "normal"),
        ]:
            with self.subTest(choice):
                self.assertNotEqual(self.json_of(*MODEL, *QUICK, *choice)[part], reference[part])

    def test_normal_distribution_and_birge_ratio(self):
        # Energies are nearly linear in the parameters: u(E) of the normal distribution is sqrt(3) times that of the
        # box of half-width u where parameters are uncorrelated; a standard deviation of 1000 draws is good to 2.2 %.
        box = self.json_of(*MODEL, *QUICK)["monte_carlo"]
        normal = self.json_of(*MODEL, *QUICK, "--distribution", "normal")["monte_carlo"]
        self.assertAlmostEqual(normal["u"] / box["u"], 3**0.5, delta=0.15)
        self.assertAlmostEqual(normal["mean"], box["mean"], delta=5 * normal["u"] / 1000**0.5)
        self.assertEqual([box["disagreements"], normal["disagreements"]], [0, 0])
        table = ["--points", DATA / "djb_a1800v.csv", *QUICK, "--distribution", "normal"]
        plain, birge = self.json_of(*table), self.json_of(*table, "--birge")
        ratio = (plain["model"]["chi2"] / plain["model"]["dof"]) ** 0.5
        scaled = birge["monte_carlo"]["u"] / plain["monte_carlo"]["u"]
        self.assertAlmostEqual(scaled / ratio, 1.0, delta=0.05)
        self.assertIn("times the Birge ratio, 10.3", self.succeed("report", *table, "--birge"))

    def test_normal_draws_that_are_no_device_are_made_again(self):
        model = ["--model", "1.037,4073,0.3182,0.003,6,0.2", *QUICK]
        # 5.61 % of the draws of beta are below 0.0001 or not below 1: 59 in 1000, with a deviation of 8.
        self.assertAlmostEqual(self.json_of(*model)["uncertainty"]["redrawn"], 59, delta=4 * 8)
        self.assertRegex(self.succeed("report", *model), r"WARNING: that is more than 1 %, so S, f0 and beta are not normal")

    def test_paper_method(self):
        # The plain fixed point from Phi's first column, step 2 us: at rest after 6 iterations.
        energy = self.json_of("--model", "1.037,4073,0.3182", "--method", "paper", "--trend", "none")["energy"]
        self.assertAlmostEqual(energy["E"], 0.00448654991209, delta=1e-12)
        times = [0.000342, 0.000470, 0.000574, 0.001540]
        self.assertEqual(len(energy["switch_times"]), len(times))
        for got, expected in zip(energy["switch_times"], times):
            self.assertAlmostEqual(got, expected, delta=1e-12)

    def test_same_seed_same_bytes_in_any_locale(self):
        first = self.succeed("report", *MODEL, *QUICK)
        for name in ["C", "de_DE.UTF-8", "C.UTF-8"]:
            self.assertEqual(self.succeed("report", *MODEL, *QUICK, env=os.environ | {"LC_ALL": name}), first)


class Threads(ProgramTest):
    def test_no_byte_depends_on_their_number(self):
        for arguments in (
            ["--points", DATA / "djb_a1800v.csv", "--trials", "5000", "--distribution", "normal"],
            ["--model", "1.037,4073,0.3182,0.003,6,0.0004", "--method", "paper", "--trials", "1000"],
        ):
            one, *others = (
                self.succeed("report", *arguments, "--trend", "none", "--json", "--threads", number)
                for number in (1, 2, 3, 7)
            )
            self.assertGreater(json.loads(one)["monte_carlo"]["u"], 0.0)
            self.assertEqual(others, [one] * 3)

    def test_numbers_that_are_refused(self):
        for number in ("0", "65", "1.5", "-1", "some"):
            self.refuse_option("--threads", number, "expected a whole number from 1 to 64")


class BadOptions(ProgramTest):
    def test_commands(self):
        self.refuse([], "emax: ", "expected emax report")
        self.refuse(["reprot"], "emax: reprot: ", "did you mean emax report?")
        self.refuse(["bananas"], "emax: bananas: unknown command; emax --help lists them")
        self.refuse(["--json"], "emax: --json: ", "emax report")
        self.refuse(["scpi", "a"], "emax: a: unexpected argument", "expected options, such as --tcp 5025")
        self.refuse(["certify"], "emax: certify: no device; ", "expected --model S,f0,beta or --points FILE")

    def test_unknown_options(self):
        meant = {"--tirals": "trials", "--iter": "iterations", "--outdir": "out", "--probabilty": "probability"}
        for wrong, right in meant.items():
            self.refuse(["report", *MODEL, wrong, "1"], f"emax: {wrong}: ", f"did you mean --{right}?")
        self.refuse(["report", *MODEL, "--" + "x" * 100_000], "emax: --xxx", "unknown option")
        self.refuse(["report", "points.csv"], "emax: points.csv: ", "--points FILE")
        self.refuse(["report", "-x"], "emax: -x: ")
        self.refuse(["report", "--"], "emax: --: ")
        self.refuse(["report", ""], "emax: ", "unexpected")

    def test_forms(self):
        self.refuse_option("--time", None, "no value", "expected")
        self.refuse(["report", *MODEL, "--time"], "emax: --time: no value")
        self.refuse(["report", *MODEL, "--out="], "emax: --out: no value")
        self.refuse(["report", *MODEL, "--out", ""], "emax: --out: no value")
        self.refuse(["report", *MODEL, "--json=1"], "emax: --json: takes no value")
        self.refuse(["report", *MODEL, "--json", "--json"], "emax: --json: given twice")
        self.refuse(["report", *MODEL, "--time", "1", "--time=1"], "emax: --time: given twice")
        self.refuse(["report", *MODEL, "--points", "x"], "emax: --model: excludes --points")
        self.refuse_option("--reference-uncertainty", "1", "excluded by --model", "expected with points")

    def test_not_numbers(self):
        for option in ["--order", "--cutoff", "--gain", "--time", "--limit", "--step", "--iterations", "--trials",
                       "--probability", "--seed", "--trend", "--reference-uncertainty"]:  # fmt: skip
            for value in ["abc", "nan", "inf", "1e999", "1x", "1 2", "0x10", "1,", ","]:
                with self.subTest(option=option, value=value):
                    self.refuse_option(option, value, f'"{value}" given', "expected")

    def test_choices(self):
        wrong = {"--criterion": "ISE", "--method": "good", "--generator": "2007", "--distribution": "x"}
        for option, value in wrong.items():
            self.refuse_option(option, value, f'"{value}" given', "expected")

    def test_ranges(self):
        values = {
            "--order": ["0", "16", "-1", "1.5", "1e10"],
            "--cutoff": ["0", "-1", "1e10"],
            "--gain": ["-1"],
            "--time": ["0", "-1", "-0", "1e4"],
            "--limit": ["0", "-1"],
            "--iterations": ["0", "-1", "1.5", "1e10"],
            "--trials": ["0", "999", "-1", "1000.5", "1000000001", "1e20"],
            "--probability": ["0", "1", "-1", "2"],
            "--seed": ["0,1,1,1", "1,2", "1,2,3", "1,2,3,4,5", "-1,2,3,4", "2147483579,1,1,1", "1.5,2,3,4"],
            "--trend": ["0.001", "0,1", "-1,1", "0.002,0.001", "0.001,0.001", ",".join(map(str, range(1, 18)))],
        }
        for option, wrong in values.items():
            for value in wrong:
                with self.subTest(option=option, value=value):
                    self.refuse_option(option, value, f'"{value}" given', "expected")
        self.refuse_option("--step", "0", "expected", device=[*MODEL, "--method", "paper"])

    def test_bench(self):
        values = {
            "--bench-seed": ["-1", "1.5", "4294967296", "x"],
            "--bench-truth": ["1,2", "1,2,0.3,4", "0,4073,0.3", "1,0,0.3", "1,4073,0", "1,4073,1", "x", "nan,1,0.3"],
            "--bench-noise": ["-1", "nan", "2"],
            "--bench-fault": ["x", "@1", "dc-drift@", "dc-drift@-1", "dc-drift@x", "dc-drift@nan", "DC-DRIFT"],
            "--level": ["0", "-1", "nan", "21"],
            "--acceleration-limit": ["0", "0.5", "x"],
            "--drive-limit": ["0", "-1", "11"],
            "--slew": ["0", "100", "x"],
            "--settle": ["-1", "11"],
            "--cycles": ["0", "1001", "1.5"],
            "--reference-uncertainty": ["-1", "51", "nan"],
        }
        for option, wrong in values.items():
            for value in wrong:
                with self.subTest(option=option, value=value):
                    said = "emax: --acceleration-limit" if value == "21" else f'emax: {option}: "{value}" given'
                    self.refuse(["report", option, value, "--out", "out"], said, "expected")
        self.refuse(["report", "--level", "30"], "--acceleration-limit: 20 by default", "at least the level")
        self.refuse(["report", "--time", "10", "--out", "out"], "emax: --time: ", "65536 cells")

    def test_bench_options_exclude_other_devices(self):
        options = {"seed": 1, "truth": "1,4000,0.3", "noise": 0, "fault": "none"}
        given = [(f"--bench-{name}", value) for name, value in options.items()]
        given += [("--level", 1), ("--acceleration-limit", 20), ("--drive-limit", 5), ("--slew", 1e5)]
        given += [("--settle", 0.01), ("--cycles", 3)]
        for option, value in given:
            self.refuse(["report", *MODEL, option, value], f"emax: {option}: excluded by --model", "expected")
            self.refuse(["report", "--points", "x", option, value], f"emax: {option}: excluded by --points")

    def test_what_the_memory_does_not_hold(self):
        self.refuse_option("--time", "10", "65536 cells", "at most 1.34 s")
        self.refuse_option("--trend", "0.001,10", "65536 cells", "at most 1.34 s")
        paper = [*MODEL, "--method", "paper"]
        self.refuse_option("--time", "0.2", "65536 cells", device=paper)
        # Of 2 us by default. 2 numbers for each of 9 modes at 2049 places, and 6 for each of 2048 switches.
        self.refuse_option("--time", "0.098342", "no room for so many cells", "at most 0.09834 s", device=paper)

    def test_more_signs_than_the_table_holds(self):
        device = ["--model", "1,10000,0.01", "--method", "paper", "--step", "1e-5", "--trend", "none"]
        # A switch every 50 us, and 8 of the 2048 for the ends: 0.102 s, less rounding.
        self.refuse_option("--time", "0.12", "2048", "shorten", "; there is room for 0.1019 s", device=device)
        self.succeed("report", *device, "--time", "0.1019")

    def test_birge_ratio_without_a_fit(self):
        self.refuse(["report", *MODEL, "--birge"], "emax: --birge: excluded by --model", "expected with points")

    def test_energy_difference_of_a_time_too_short(self):
        """Both outputs begin with powers of t: they do not cancel, they are small."""
        options = ["report", *MODEL, "--criterion", "difference", "--trend", "none", "--time", "1e-7"]
        self.refuse(options, "emax: --time: ", "rounding hides their energies; take a longer time")


class Bench(ProgramTest):
    def measure(self, *options):
        return self.json_of(*QUICK, *options)

    def assert_within(self, model, truth):
        # The interval of S covers what its own bench has drawn for the reference and the gains.
        for name in ["S", "f0", "beta"]:
            self.assertLessEqual(abs(model[name] - truth[name]), 1.96 * model["u" + name], name)

    def test_default_job_recovers_the_truth(self):
        results = json.loads(self.succeed("report", "--json"))
        self.assertEqual(results["model"]["source"], "bench")
        self.assert_within(results["model"], TRUTH)
        self.assertEqual(results["model"]["dof"], 81)
        self.assertLess(results["model"]["chi2"], 81 * 1.401)  # One in a hundred is beyond.
        bench = results["bench"]
        self.assertEqual((bench["points"], bench["seed"], bench["truth"]), (42, 1, TRUTH))
        # The bench cannot know S better than its reference: 0.25 %, 0.05 % and 0.1 % are common to all points.
        self.assertGreater(results["model"]["uS"] / results["model"]["S"], math.hypot(0.0025, 0.0005, 0.001) * 0.999)
        self.assertGreater(results["monte_carlo"]["E_max"], results["energy"]["E"])
        self.assertEqual(len(results["trend"]["points"]), 5)

    def test_another_truth(self):
        results = self.measure("--bench-truth", "0.2,2500,0.5", "--bench-seed", "3", "--bench-noise", "0.001")
        # Five standard uncertainties: this is not about the width of the interval.
        for name, value in {"S": 0.2, "f0": 2500, "beta": 0.5}.items():
            self.assertLessEqual(abs(results["model"][name] - value), 5 * results["model"]["u" + name], name)

    def test_same_seed_same_bytes(self):
        first = self.succeed("report", *QUICK)
        self.assertEqual(self.succeed("report", *QUICK), first)
        self.assertEqual(self.succeed("report", *QUICK, "--bench-seed", "1"), first)
        self.assertNotEqual(self.measure("--bench-seed", "2")["model"]["S"], self.measure()["model"]["S"])

    def test_defaults_are_what_the_help_says(self):
        defaults = {"bench-seed": "1", "bench-truth": "1.037,4073,0.3182", "bench-noise": "0.005"}
        defaults |= {"bench-fault": "none", "level": "1", "acceleration-limit": "20", "drive-limit": "5"}
        defaults |= {"slew": "100000", "settle": "0.01", "cycles": "3"}
        report = self.succeed("report", *QUICK)
        given = [part for name, value in defaults.items() for part in (f"--{name}", value)]
        given += ["--reference-uncertainty", "0.5"]
        self.assertEqual(self.succeed("report", *QUICK, *given), report)
        text = self.succeed("report", "--help")
        for name, value in defaults.items():
            self.assertRegex(text, rf"(?s)--{name} .*?\(default {re.escape(value)}\)")

    def test_settings_arrive(self):
        results = self.measure("--level", "2", "--acceleration-limit", "30", "--drive-limit", "6", "--slew", "2e5",
                               "--reference-uncertainty", "1", "--settle", "0.02", "--cycles", "5")  # fmt: skip
        names = ["level", "acceleration_limit", "drive_limit", "slew", "reference_percent"]
        self.assertEqual([results["bench"][name] for name in names], [2, 30, 6, 2e5, 1])
        self.assertGreater(results["bench"]["common_percent"], math.hypot(1, 0.1, 0.2) * 0.999)

    def test_files_and_the_way_back(self):
        report = self.succeed("report", *QUICK, "--out", "out")
        self.assertEqual(self.files(), ["out", *(f"out/{name}" for name in FILES_OF_POINTS)])
        self.assertEqual((self.directory / "out/report.txt").read_text(), report)
        results = json.loads((self.directory / "out/results.json").read_text())
        again = self.json_of("--points", "out/frequency_response.csv", *QUICK)
        # 15 digits of the totals leave 12 of a part that is a thirtieth of them.
        for name in ["S", "f0", "beta", "uS", "uf0", "ubeta", "chi2"]:
            self.assertAlmostEqual(again["model"][name] / results["model"][name], 1, delta=1e-9)
        self.assertIsNone(again["bench"])

    def test_faults(self):
        for fault, (name, advice) in FAULTS.items():
            with self.subTest(fault):
                result = self.run_program("report", *QUICK, "--bench-fault", f"{fault}@4", "--out", "out")
                self.assertEqual(result.returncode, 3)
                line = self.assert_one_line(result.stderr, name, advice, " of 42 points kept, drive at zero)")
                found = re.search(rf"\Aemax: {name} at ([0-9]+) Hz: .* \(([0-9]+) of 42", line)
                kept = int(found[2])
                self.assertTrue(0 < kept < 42)
                report = result.stdout.decode("ascii")
                self.assertRegex(report, rf"FAULT\n  {name} +at {found[1]} Hz\n")
                self.assertEqual((self.directory / "out/report.txt").read_text(), report)
                files = ["frequency_response.csv", "report.html", "report.txt", "results.json"]
                self.assertEqual(self.files(), ["out", *(f"out/{file}" for file in files)])
                bench = json.loads((self.directory / "out/results.json").read_text())["bench"]
                self.assertEqual((bench["fault"]["name"], bench["points"]), (name, kept))
                rows = (self.directory / "out/frequency_response.csv").read_text().splitlines()
                rows = [row for row in rows if not row.startswith("# shared:")]
                self.assertEqual((rows[0], len(rows)), (HEADER + ",u_common,level_mps2", 1 + kept))
                self.assertLess(float(rows[-1].split(",")[0]), float(found[1]))

    def test_fault_before_the_first_point(self):
        result = self.run_program("report", "--bench-fault", "dc-drift@0", "--json", "--out", "out")
        self.assertEqual(result.returncode, 3)
        self.assert_one_line(result.stderr, "DC drift before the first frequency", "0 of 42 points kept")
        results = json.loads(result.stdout)
        self.assertEqual((results["model"], results["energy"], results["bench"]["points"]), (None, None, 0))
        self.assertEqual((self.directory / "out/frequency_response.csv").read_text(), HEADER + ",u_common,level_mps2\n")

    def test_fault_keeps_a_complete_report_of_an_earlier_run(self):
        report = self.succeed("report", *QUICK, "--out", "out")
        before = sorted(os.listdir(self.directory / "out"))
        result = self.run_program("report", "--bench-fault", "late-block", "--out", "out")
        self.assertEqual(result.returncode, 3)
        self.assert_one_line(result.stderr, "begin with failed_")
        names = ["frequency_response.csv", "report.html", "report.txt", "results.json"]
        files = sorted(before + [f"failed_{name}" for name in names])
        self.assertEqual(sorted(os.listdir(self.directory / "out")), files)
        self.assertEqual((self.directory / "out/report.txt").read_text(), report)

    def test_levels_that_cannot_be_reached(self):
        # 5 V reach 10 m/s^2; with these gains 19 m/s^2 are within the range of the converters.
        result = self.run_program("report", "--level", "19", "--reference-gain", "1", "--device-gain", "0.1")
        self.assertEqual(result.returncode, 3)
        self.assert_one_line(result.stderr, "level not reached at 160 Hz", "lower the level, or check cables and gains")

    def test_levels_of_few_steps_are_named_with_the_least_one(self):
        # The drive's 12 bits have steps of 4.9 mV; 1 m/s^2 at 160 Hz takes 0.5 V, within 20 %.
        result = self.run_program("report", "--level", "0.01", "--bench-noise", "1e-4", "--bench-hum", "0")
        self.assertEqual(result.returncode, 3)
        line = self.assert_one_line(result.stderr, "at 160 Hz", "expected at least that for --level")
        least = float(re.search(r"five steps of the drive's converter make ([0-9.]+) m/s\^2", line)[1])
        self.assertAlmostEqual(least, 0.05, delta=0.01)
        self.succeed("report", *QUICK, "--frequencies", "100,160,200", "--level", str(2 * least), "--bench-noise", "1e-4")

    def test_a_level_above_the_least_one_is_not_told_to_be_below_it(self):
        """Nine or ten steps make 0.1 m/s^2, which may distort it; a look at a quarter of it has fewer than five."""
        for seed in "1", "2", "5":
            result = self.run_program("report", *QUICK, "--level", "0.1", "--bench-seed", seed)
            if result.returncode != 0:
                line = self.assert_one_line(result.stderr, "five steps of the drive's converter make 0.05")
                self.assertNotIn("expected at least", line)
                self.assertRegex(line, "the level of 0.1 m/s.2 has about (9|10), and the last look .* raise --level")

    def test_limits_below_the_steps_of_the_drive_are_refused_in_words(self):
        # 2 m/s^2 for each V of the drive: five steps of 4.9 mV make 0.05 m/s^2.
        line = self.assert_one_line(self.run_program("report", "--level", "0.06", "--acceleration-limit", "0.06").stderr,
                                    "few steps at 160 Hz", "for --acceleration-limit; an attenuator is told by")
        least = re.search(r"five steps of the drive's converter make ([0-9.]+) m/s\^2: expected at least ([0-9.]+)", line)
        self.assertAlmostEqual(float(least[1]), 0.05, delta=0.01)
        limit = ("--level", least[2], "--acceleration-limit", least[2])
        self.succeed("report", *QUICK, "--frequencies", "100,160,200", *limit)

    def test_a_device_below_the_noise_is_named_by_its_data_sheet(self):
        result = self.run_program("report", "--bench-truth", "1e-4,4073,0.3182")
        self.assert_one_line(result.stderr, "no device", "by its data sheet the device makes 0.0001 V", "raise --level")

    def test_an_interference_at_the_check_frequency_is_among_the_causes(self):
        for seed in "1", "2":
            result = self.run_program("report", "--bench-hum", "0.05,160", "--bench-seed", seed)
            self.assertEqual(result.returncode, 3)
            self.assert_one_line(result.stderr, "or an interference is at")

    def test_exchanged_cables_never_ask_for_more_drive(self):
        for sensitivity in "0.01", "0.05", "0.1":
            result = self.run_program("report", "--bench-truth", f"{sensitivity},4073,0.3182",
                                      "--bench-fault", "swapped-channels@0", "--level", "10", "--drive-limit", "10")
            line = self.assert_one_line(result.stderr, "swapped channels at 160 Hz")
            self.assertNotIn("raise", line)

    def test_what_a_sensitive_device_needs_is_said(self):
        result = self.run_program("report", "--bench-truth", "100,4073,0.3182")
        self.assertEqual(result.returncode, 3)
        self.assert_one_line(result.stderr, "saturated channel", "five steps of the drive's converter make",
                             "--drive-full-scale", "--device-gain and --reference-gain below 1 are attenuators")
        # As it says: an attenuator of 10 behind the drive.
        self.succeed("report", *QUICK, "--bench-truth", "100,4073,0.3182", "--drive-full-scale", "1", "--drive-limit", "1")

    def test_interference_at_frequencies_of_the_sweep_is_named(self):
        # Hum of 0.5 % and a third of it at three times the frequency.
        for hum, words in (("0.005,500", "Without the point at 500 Hz chi2/dof is "),
                           ("0.005,1000", "Without the points at 1000 and 3000 Hz chi2/dof is ")):
            report = " ".join(self.succeed("report", *QUICK, "--bench-hum", hum).split())
            self.assertIn(words, report)
            self.assertIn("of 50 Hz)", report)
        self.assertNotIn("Without the point", self.succeed("report", *QUICK))

    def test_tables_of_the_reference_that_the_bench_does_not_have(self):
        self.refuse(["report", "--reference-table", "10,0.1,1000,0.1,6000,0.11"], "emax: --reference-table: ",
                    "the reference of the simulated bench has one at all frequencies")
        self.succeed("report", *QUICK, "--reference-table", "10,0.1,6000,0.1004")

    def test_tables_of_the_reference_that_cannot_be(self):
        self.refuse(["report", "--reference-table", "30,0.1,20,0.1"],
                    'emax: --reference-table: "30,0.1,20,0.1" given; expected frequencies in ascending order')
        self.refuse(["report", "--reference-table", "30,0,6000,0"],
                    'emax: --reference-table: "30,0,6000,0" given; expected sensitivities above 0')

    def test_a_table_that_ends_within_the_sweep_is_named(self):
        words = "table does not span the sweep's frequencies"
        for table, is_short in (("100,0.1,200,0.1", True), ("30,0.1,5000,0.1", True), ("31,0.1,6000,0.1", True), ("30,0.1,6000,0.1", False)):
            result = self.run_program("report", *QUICK, "--reference-table", table, "--json")
            self.assertEqual(result.returncode, 0)
            self.assertEqual(words in result.stderr.decode(), is_short, table)
            warnings = [line["text"] for line in json.loads(result.stdout)["warnings"]]
            self.assertEqual(any(words in message for message in warnings), is_short, table)
        self.assertIn(words, " ".join(self.run_program("report", *QUICK, "--reference-table", "100,0.1,200,0.1").stdout.decode().split()))
        self.assertNotIn(words, self.run_program("report", *QUICK).stderr.decode())

    def test_a_contradiction_says_by_how_much(self):
        report = self.succeed("report", *QUICK, "--device-sensitivity", "0.6")
        self.assertRegex(" ".join(report.split()), r"f0 is not near the check frequency \(1\.7\d* times it there\)\. ")
        self.assertNotIn("?.", report)

    def test_an_uncertainty_behind_its_value_is_named_by_its_option(self):
        self.refuse(["report", "--reference-gain", "10,-1"], 'emax: --reference-gain: "10,-1" given; expected 0 to 50 percent')
        self.refuse(["report", "--correction-skew", "1e-6,1"], "emax: --correction-skew: ")

    def test_fault_after_the_end_is_none(self):
        expected = self.succeed("report", *QUICK)
        result = self.run_program("report", *QUICK, "--bench-fault", "dc-drift@1000")
        self.assertEqual((result.returncode, result.stdout.decode("ascii")), (0, expected))
        self.assert_one_line(result.stderr, "dc-drift did not strike", "give an earlier time")

    def test_faults_name_their_likely_cause(self):
        def line_of(*options):
            result = self.run_program("report", *QUICK, *options)
            self.assertEqual(result.returncode, 3)
            return result.stderr

        # Five times 400 Hz is the resonance.
        self.assert_one_line(line_of("--bench-truth", "1,2000,0.001", "--frequencies", "100,150,200,300,400,500,700,1000"),
                             "distorted response at 400 Hz: ", "; harmonic 5 of the drive, 2000 Hz, falls on the resonance",
                             "leave this frequency out (4 of 8 points kept, drive at zero)")
        # 300 V at a channel that takes 10 V.
        self.assert_one_line(line_of("--bench-truth", "300,4000,0.3"), "saturated channel at ",
                             "the device makes 300 V of the level of 1 m/s^2, and its channel takes 10 V: put a divider "
                             "before it, told by --device-gain 0.02, or lower --level")
        self.succeed("report", *QUICK, "--bench-truth", "300,4000,0.3", "--device-gain", "0.02")
        low = ["--frequencies", "10,20,30,40,60,80,100,120,140,180,200"]
        for truth, name in [("1,170,0.05", "swapped channels at 160 Hz: "), ("1,100,0.3", "inverted polarity at 160 Hz: ")]:
            self.assert_one_line(line_of("--bench-truth", truth, *low), name, "f0 is near the check frequency")
        self.succeed("report", *QUICK, "--bench-truth", "1,170,0.05", "--check-frequency", "20", *low)
        self.assert_one_line(line_of("--bench-hum", "0.05,50", "--check-frequency", "50"), "mains hum at 50 Hz: ",
                             "the check frequency is given by --check-frequency")

    def test_sweep_that_a_fault_ends_late_is_fitted(self):
        result = self.run_program("report", *QUICK, "--bench-fault", "unplugged-device@5", "--out", "out")
        self.assertEqual(result.returncode, 3)
        self.assert_one_line(result.stderr, "no device at", "(31 of 42 points kept, drive at zero)")
        self.assertIn("WARNING: a fault has ended the sweep", result.stdout.decode("ascii"))
        self.assertIn("MAXIMUM ENERGY", result.stdout.decode("ascii"))
        results = json.loads((self.directory / "out/results.json").read_text())
        self.assertEqual((results["bench"]["points"], results["bench"]["fault"]["name"]), (31, "no device"))
        self.assertAlmostEqual(results["model"]["f0"], 4073, delta=3 * results["model"]["uf0"])
        self.assertIn("a fault has ended the sweep", results["warnings"][-1]["text"])


class ReferenceUncertainty(ProgramTest):
    def setUp(self):
        super().setUp()
        self.table = ["--points", DATA / "djb_a1800v.csv"]

    def test_paper_table(self):
        model = self.json_of(*self.table, "--reference-uncertainty", "0.5", *QUICK)["model"]
        # Weighted least squares with the full covariance matrix, by NumPy; to half a unit of the last digit given.
        self.assertAlmostEqual(model["S"], 1.00645, delta=5e-6)
        self.assertAlmostEqual(model["uS"], 0.00270, delta=5e-6)
        self.assertAlmostEqual(model["chi2"], 8911.7, delta=0.05)
        self.assertAlmostEqual(model["common_percent"], 0.5, delta=1e-12)

    def test_zero_changes_nothing(self):
        expected = self.succeed("report", *self.table, *QUICK)
        self.assertEqual(self.succeed("report", *self.table, *QUICK, "--reference-uncertainty", "0"), expected)

    def test_totals_below_it(self):
        # The table's first point has U/A = 0.01/1.03.
        self.refuse(["report", *self.table, "--reference-uncertainty", "1", "--out", "out"], "djb_a1800v.csv:2: ",
                    "at 30 Hz is 0.9709 %", "expected totals (k = 2)", "--reference-uncertainty")  # fmt: skip
        lines = ["# a", *table(second_order(), [100.0, 200.0, 300.0])]
        lines[3] = "200.0,1.0,-1,0.004,1.0"
        arguments = ["report", "--points", self.write(lines), "--reference-uncertainty", "0.4"]
        self.refuse(arguments, "points.csv:4: ", "200 Hz")


class BadModel(ProgramTest):
    def refuse_model(self, model, *words):
        return self.refuse(["report", "--model", model, "--out", "out"], "emax: --model: ", *words)

    def test_forms(self):
        counts = ["1", "1,2", "1,2,0.3,4", "1,2,0.3,4,5", "1,2,0.3,4,5,6,7"]
        for model in [*counts, "a,b,c", "1,,0.3", "1;2;0.3", "nan,1,0.3"]:
            with self.subTest(model):
                self.refuse_model(model, "expected three or six numbers")

    def test_damping(self):
        for damping in ["1", "1.2", "1e9"]:
            self.refuse_model(f"1,4000,{damping}", "beta is 1 or more", "expected 0.0001 to below 1", "resonance")
        for damping in ["0", "-0.1", "1e-5"]:
            self.refuse_model(f"1,4000,{damping}", "beta", "expected 0.0001 to below 1")

    def test_sensitivity(self):
        self.refuse_model("-1,4000,0.3", "polarity", "magnitude", "expected S above 0")
        self.refuse_model("0,4000,0.3", "S is zero", "expected")
        self.refuse_model("1e200,4000,0.3", "sensitivity", "1e30")

    def test_frequency(self):
        for frequency in ["0", "-4000", "1e-4", "1e10"]:
            self.refuse_model(f"1,{frequency},0.3", "f0 is out of range", "expected 0.001 to 1e9 Hz")

    def test_uncertainties(self):
        for u in ["-1,0,0", "0,-1,0", "0,0,-0.1"]:
            self.refuse_model(f"1,4000,0.3,{u}", "negative", "expected 0 or more")
        self.refuse_model("1,4000,0.3,1,0,0", "u(S) is too large", "expected")
        self.refuse_model("1,4000,0.3,0,4000,0", "u(f0) is too large", "expected")
        self.refuse_model("1,4000,0.3,0,0,0.3", "u(beta) is too large", "expected")
        self.refuse_model("1,4000,0.8,0,0,0.2", "u(beta) is too large", "expected")


class Files(ProgramTest):
    def columns(self, name):
        with open(self.directory / "out" / name, newline="", encoding="ascii") as file:
            rows = list(csv.reader(file))
        self.assertTrue(all(len(row) == len(rows[0]) for row in rows), name)
        for row in rows[1:]:
            self.assertTrue(all(math.isfinite(float(cell)) for cell in row), (name, row))
        return ",".join(rows[0]), rows[1:]

    def test_model(self):
        report = self.succeed("report", *MODEL, "--trials", "1000", "--trend", "0.001,0.002", "--out", "out")
        self.assertEqual(self.files(), ["out", *(f"out/{name}" for name in [*FILES, "trend.svg"])])
        self.assertEqual((self.directory / "out/report.txt").read_text(), report)
        results = self.json_of(*MODEL, "--trials", "1000", "--trend", "0.001,0.002")
        self.assertEqual(json.loads((self.directory / "out/results.json").read_text()), results)

        header, rows = self.columns("impulse_response.csv")
        self.assertEqual(header, "t_s,k,ka,kf")
        self.assertAlmostEqual(max(float(row[1]) for row in rows), 17462.4, delta=20)  # At the next sample.
        header, rows = self.columns("signal.csv")
        self.assertEqual(header, "t_s,x_mps2,y_v")
        self.assertLessEqual({abs(float(row[1])) for row in rows}, {0.0, 1.037})
        header, rows = self.columns("trend.csv")
        self.assertEqual(header, "T_s,E,fit")
        self.assertEqual([float(row[0]) for row in rows], [0.001, 0.002])
        header, rows = self.columns("histogram.csv")
        self.assertEqual(header, "E_low,E_high,count")
        self.assertEqual(sum(int(row[2]) for row in rows), 1000)

    def test_points(self):
        name = self.write(table(second_order()))
        self.succeed("report", "--points", name, *QUICK, "--json", "--out", "out")
        self.assertEqual(self.files(), ["out", *(f"out/{file}" for file in FILES_OF_POINTS), name])
        header, rows = self.columns("frequency_response.csv")
        self.assertEqual(
            header,
            "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg,model_amplitude,model_phase_deg,residual_re,residual_im",
        )
        self.assertEqual([float(row[0]) for row in rows], FREQUENCIES)

    def test_files_of_an_earlier_run_are_replaced(self):
        self.succeed("report", "--points", self.write(table(second_order())), *QUICK, "--out", "out")
        (self.directory / "out/notes.txt").write_text("mine")
        report = self.succeed("report", *MODEL, *QUICK, "--out", "out")
        self.assertEqual((self.directory / "out/report.txt").read_text(), report)
        self.assertEqual(sorted(os.listdir(self.directory / "out")),
                         sorted([*FILES, "frequency_response.1.csv", "notes.txt"]))

    def test_directories_that_cannot_be_written(self):
        self.write(["x"], "file")
        (self.directory / "taken").mkdir()
        (self.directory / "taken/signal.csv").mkdir()
        for directory in ["file", "file/out", "/proc/emax", "o" * 300]:
            with self.subTest(directory):
                arguments = ["report", *MODEL, *QUICK, "--out", directory]
                self.refuse(arguments, f"emax: --out: {directory[:200]}", "expected a directory")
        arguments = ["report", *MODEL, *QUICK, "--out", "taken"]
        self.refuse(arguments, "emax: --out: taken/signal.csv", "expected a directory")

    @unittest.skipIf(os.geteuid() == 0, "root may write everywhere")
    def test_directory_without_permission(self):
        (self.directory / "locked").mkdir(mode=0o555)
        self.refuse(["report", *MODEL, *QUICK, "--out", "locked"], "emax: --out: locked: ", "expected")

    def test_full_disk(self):
        def limit_file_size():
            resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500))

        for start in [None, "out"]:
            if start:
                (self.directory / start).mkdir()
            arguments = ["report", *MODEL, *QUICK, "--out", "out"]
            self.refuse(arguments, "emax: out/", "too large", status=3, preexec_fn=limit_file_size)

    def test_nothing_is_written_for_bad_points(self):
        self.refuse(["report", "--points", self.write(["1,2,3"]), "--out", "out"], "points.csv:1: ")


class Endings(ProgramTest):
    LONG = ["report", *MODEL, "--trials", "100000000", "--out", "out"]

    def wait_for(self, condition):
        deadline = time.monotonic() + 30
        while not condition():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.02)

    def test_stop_requests(self):
        for number in [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]:
            with self.subTest(number):
                process = self.start_program(*self.LONG)
                self.wait_for((self.directory / "out").exists)  # The long work comes after it.
                time.sleep(0.3)
                process.send_signal(number)
                output, error = process.communicate(timeout=200)
                self.assertEqual((process.returncode, output, error), (130, b"", b"emax: stopped\n"))
                self.assertEqual(self.files(), [])

    LONG_SWEEP = ["report", "--cycles", "1000", "--settle", "10", "--out", "out"]

    def test_stop_of_the_sweep(self):
        process = self.start_program(*self.LONG_SWEEP)
        self.wait_for((self.directory / "out").exists)  # The sweep comes after it.
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        output, error = process.communicate(timeout=200)
        self.assertEqual((process.returncode, output), (130, b""))
        self.assertEqual(error, b"emax: stopped during the sweep, drive at zero\n")
        self.assertEqual(self.files(), [])

    def test_progress_of_the_sweep(self):
        shown = self.shown_until(self.LONG_SWEEP, b"Hz, ")
        self.assertRegex(shown, self.SHOWN_BEFORE + r"\remax: sweep, (check at )?\d+ Hz, \d+ %, \d+ s *\r")
        self.assertRegex(shown, r"\r +\remax: stopped during the sweep, drive at zero\r\n\Z")
        self.assertLess(max(map(len, re.split(r"[\r\n]", shown))), 80)

    def test_stop_keeps_files_of_an_earlier_run(self):
        report = self.succeed("report", *MODEL, *QUICK, "--out", "out")
        process = self.start_program(*self.LONG)
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=200)
        self.assertEqual((self.directory / "out/report.txt").read_text(), report)
        self.assertEqual(sorted(os.listdir(self.directory / "out")), FILES)

    def test_stop_while_waiting_for_input(self):
        process = self.start_program("report", "--points", "-", stdin=subprocess.PIPE)
        process.stdin.write(b"# more than a pipe holds: it is being read when this returns\n" * 5000)
        process.stdin.flush()
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=200), 130)
        self.assertEqual(process.stderr.read(), b"emax: stopped\n")
        process.communicate()

    # On a busy machine even the stages that are over in no time may be seen.
    SHOWN_BEFORE = r"\A(?:\remax: [a-z][^\r\n]*, \d+ s *)*"

    def shown_until(self, arguments, words):
        """What the program shows on a terminal; it is stopped once these words are there."""
        ours, theirs = pty.openpty()
        process = self.start_program(*arguments, stderr=theirs)
        os.close(theirs)
        shown = b""
        try:
            while piece := os.read(ours, 4096):
                shown += piece
                if words in shown:
                    process.send_signal(signal.SIGINT)
        except OSError:  # The other side has been closed.
            pass
        os.close(ours)
        process.communicate(timeout=200)
        return shown.decode("ascii")

    def test_progress_on_a_terminal(self):
        shown = self.shown_until(self.LONG, b"Monte Carlo")
        self.assertRegex(shown, self.SHOWN_BEFORE + r"\remax: Monte Carlo \d+ %, \d+ s *\r")
        self.assertRegex(shown, r"\r +\remax: stopped\r\n\Z")
        self.assertLess(max(map(len, re.split(r"[\r\n]", shown))), 80)

    def test_the_fit_comes_before_long_work(self):
        """Once, in a line that stays. The points say beta = 0.0065 with U = 0.0302: open up to 0.0065 + 0.0302."""
        piezo = DATA / "tables" / "piezo_01.csv"
        shown = self.shown_until(["report", "--points", piezo, "--time", "0.02", "--trials", "100000000"], b"emax: energy")
        self.assertRegex(shown, r"\Aemax: fit: S = 0\.0102\d* V/\(m/s\^2\), f0 = \d+ Hz, beta = 0\.0065\d*, which the points leave "
                                r"open up to 0\.0368; chi2/dof = [0-9.]+\. The figures follow\r\n\remax: ")
        self.assertEqual(shown.count("fit: S"), 1)
        shown = self.shown_until(["report", "--points", DATA / "djb_a1800v.csv", "--trials", "100000000"], b"Monte Carlo")
        self.assertIn("; chi2/dof = 106.1, which is too large. The figures follow\r\n", shown)

    def test_no_progress_for_short_work(self):
        ours, theirs = pty.openpty()
        result = self.run_program("report", "--model", "1.037,4073,0.3182", "--trend", "none", stderr=theirs)
        os.close(theirs)
        self.assertEqual(result.returncode, 0)
        with self.assertRaises(OSError):  # Nothing there to be read.
            os.read(ours, 1)
        os.close(ours)

    def test_output_that_cannot_be_written(self):
        with open("/dev/full", "wb") as full:
            report = ["report", *MODEL, *QUICK]
            for arguments in [report, [*report, "--json"], ["--help"], ["--version"]]:
                self.refuse(arguments, "emax: standard output: No space left", status=3, stdout=full)

    def test_reader_that_goes_away(self):
        reader, writer = os.pipe()
        os.close(reader)
        for options in [{}, {"restore_signals": False}]:
            result = self.run_program("report", *MODEL, *QUICK, stdout=writer, **options)
            self.assertEqual(result.stderr, b"")
            self.assertIn(result.returncode, [-signal.SIGPIPE, 3])
        os.close(writer)

    def test_help_and_version(self):
        version = self.succeed("--version")
        self.assertEqual(self.succeed("report", "--version"), version)
        found = re.fullmatch(r"emax 0\.1\.0(?: \(commit ([0-9a-f]{10})(?: and changes)?\))?\n", version)
        self.assertIsNotNone(found, version)
        # Where the sources are a repository, it is one of its commits.
        source = DATA.parent.parent
        is_repository = shutil.which("git") is not None and (source / ".git").exists() and subprocess.run(
            ["git", "-C", source, "rev-parse", "HEAD"], capture_output=True, check=False).returncode == 0
        if is_repository:
            self.assertIsNotNone(found[1], version)
            known = subprocess.run(["git", "-C", source, "cat-file", "-t", found[1]], capture_output=True, text=True, check=True)
            self.assertEqual(known.stdout, "commit\n")
        short, long = self.succeed("--help"), self.succeed("report", "--help")
        self.assertEqual(self.succeed("report", "--model", "--help"), long)
        for text in [short, long]:
            self.assertLessEqual(max(map(len, text.splitlines())), 80)
            self.assertIn("Exit status", text)
        names = "points model reference-uncertainty order cutoff gain time limit criterion method step iterations"
        names += " bench-seed bench-truth bench-noise bench-fault"
        names += " level acceleration-limit drive-limit slew settle cycles"
        names += " trials adaptive probability distribution birge seed generator trend"
        names += " device serial operator date note units json out"
        names += " help version"
        for name in names.split():
            self.assertIn(f"  --{name} ", long)


if __name__ == "__main__":
    main()
