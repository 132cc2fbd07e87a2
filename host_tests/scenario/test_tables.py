"""Tables as laboratories write them: each is read, or refused by naming what is missing; round trips give the same fit.

The tables in data/tables were made from stated sensors with seeded noise; no measured data of others.

usage: test_tables.py PROGRAM DATA_DIRECTORY [unittest arguments]
"""

import cmath
import json
import math
import random
import re

from program_test import DATA, QUICK, ProgramTest, main

TABLES = DATA / "tables"

# The fit of the points as they stand in plain.csv. Other files have the same points with 6 digits of the frequency or
# the uncertainty, which moves the fit by less than a tenth of its own uncertainty.
PLAIN = {"S": 1.035912, "f0": 4065.30, "beta": 0.316358}
U_PLAIN = {"S": 0.0009, "f0": 4.04, "beta": 0.00097}


# Hundreds of draws, run by hand; test_open_damping.cpp has a few of them.
ByHand = ProgramTest


class Tables:
    def fit(self, name, *options):
        return self.json_of("--points", TABLES / name, *QUICK, *options)

    def assert_near_plain(self, model, share=0.1):
        for parameter, value in PLAIN.items():
            self.assertLess(abs(model[parameter] - value), share * U_PLAIN[parameter], (parameter, model[parameter]))

    def refuse_table(self, name, *words, options=()):
        return self.refuse(["report", "--points", TABLES / name, *QUICK, *options], name, *words)


class TablesOfOneDevice(Tables, ProgramTest):
    def test_the_same_points_in_other_forms(self):
        forms = {
            "plain.csv": "read as Hz, V/(m/s2), deg; 40 points",
            "descending.csv": "read as Hz, V/(m/s2), deg; 40 points",
            "repeated.csv": "40 points, 1 of them the mean of repeated rows",
            "percent_comments.csv": "read as Hz, V/(m/s2), deg; 40 points",
            "quoted.csv": "read as Hz, V/(m/s2), deg; 40 points",
            "trailing_comma.csv": "read as Hz, V/(m/s2), deg; 40 points",
            "inline_comment.csv": "read as Hz, V/(m/s2), deg; 40 points",
            "unit_row.csv": "read as Hz, V/(m/s2), deg; 40 points",
            "unicode_minus.csv": "read as Hz, V/(m/s2), deg; 40 points",
            "khz.csv": "read as kHz, V/(m/s2), deg; 40 points",
            "utf16.txt": "UTF-16",
            "u_percent.csv": "read as Hz, V/(m/s2), deg, percent; 40 points",
        }
        for name, words in forms.items():
            with self.subTest(name=name):
                results = self.fit(name)
                self.assert_near_plain(results["model"])
                self.assertIn(words, results["fit"]["read_as"])
                self.assertEqual(results["fit"]["determined"], "all")

    def test_decibels(self):
        results = self.fit("db.csv")
        # 0.1 dB is 1.16 %, so the weights differ; the points are the same.
        self.assert_near_plain(results["model"], 0.3)
        self.assertIn("Hz, dB re 1 V/(m/s2), deg, dB; 40 points", results["fit"]["read_as"])
        self.assertAlmostEqual(results["model"]["uS"], 1.15 * U_PLAIN["S"], delta=0.02 * U_PLAIN["S"])

    def test_angular_frequency(self):
        model = self.fit("omega_rad_s.csv")["model"]
        self.assertAlmostEqual(model["f0"], 4073, delta=0.01)  # Nine digits in the file.
        self.assertAlmostEqual(model["beta"], 0.3182, delta=1e-6)

    def test_a_lag_that_is_positive(self):
        self.refuse_table("lag_positive.csv", "phases lead", "a lag must be negative")
        self.refuse(["certify", "--points", TABLES / "lag_positive.csv"], "phases lead")
        # The same where the points scatter more than they say.
        rows = [[f, a * (1.03 if i % 2 else 0.97), -p, ua, up] for i, (f, a, p, ua, up) in enumerate(table_rows())]
        self.refuse(["report", "--points", self.write([TablesThereAndBack.NAMES] + [",".join(map(repr, row)) for row in rows])],
                    "phases lead")

    def test_radians_without_a_label(self):
        rows = [[f, a, math.radians(p), ua, math.radians(up)] for f, a, p, ua, up in table_rows()]
        lines = ["f_hz,amplitude,phase,u_amplitude,u_phase"] + [",".join(map(repr, row)) for row in rows]
        text = self.succeed("report", "--points", self.write(lines), *QUICK)
        self.assertIn("  Taking the phases for radians and not for degrees would bring chi2/dof from 5.6e+02 to 1: name\n", text)
        self.assert_near_plain(self.json_of("--points", "points.csv", "--input-units", "rad", *QUICK)["model"])

    def test_magnitudes_alone(self):
        for name in ["magnitude_only.csv", "magnitude_only_blank.csv"]:
            with self.subTest(name=name):
                results = self.fit(name)
                self.assert_near_plain(results["model"], 2.0)  # Half of the equations are missing.
                self.assertEqual(results["fit"]["unknown_phases"], 40)
                self.assertEqual(results["model"]["dof"], 37)
        self.assertIn("there only the magnitude is fitted", self.succeed("report", "--points",
                                                                         TABLES / "magnitude_only.csv", *QUICK))

    def test_what_was_held_is_said_to_be(self):
        rows = [f"{f!r},{a!r},{0.01 * a!r}" for f, a, *_ in table_rows()[:25]]  # To half of f0.
        name = self.write(["f_hz,amplitude,u_amplitude", *rows])
        text = self.succeed("report", "--points", name, *QUICK, "--damping", "0.3182", "--limit", "1")
        self.assertRegex(text, r"\n  beta +0.3182 +held +held +held  1\n")
        self.assertEqual(text.count("held"), 4)  # And in the note on the damping.

    def test_phases_that_say_nothing(self):
        results = self.fit("phase_unknown_1000deg.csv")
        self.assertEqual(results["fit"]["unknown_phases"], 40)
        self.assertAlmostEqual(results["model"]["f0"], 4073, delta=0.01)


class TablesOfPiezos(Tables, ProgramTest):
    """Light damping with wide uncertainties takes many seconds of trials, but few in so short a time; the fit is the same."""

    def fit(self, name, *options):
        return super().fit(name, *([] if "--time" in options else ["--time", "0.00005"]), *options)

    def test_decimal_commas(self):
        for name, form in [("tabs_decimal_comma.csv", "tabs"), ("semicolons_decimal_comma.csv", "semicolons")]:
            results = self.fit(name)
            self.assertAlmostEqual(results["model"]["S"], 0.0102043, delta=1e-7)
            self.assertIn(f"{form}; decimal comma", results["fit"]["read_as"])

    def test_the_export_of_a_dealer(self):
        name = "dealer_export_tabs_comma.txt"
        self.refuse_table(name, "no uncertainty of the amplitude", "--uncertainty 1%,1deg")
        self.refuse_table(name, "no uncertainty of the phase", options=["--uncertainty", "1%"])
        results = self.fit(name, "--uncertainty", "1%,0.5deg")
        self.assertAlmostEqual(results["model"]["S"], 0.0102042, delta=1e-7)
        for words in ["mV/(m/s2)", "tabs; decimal comma; Latin-1", "not used: Accel., Deviation, Deviation, Stdrd. dev."]:
            self.assertIn(words, results["fit"]["read_as"])

    def test_millivolts_per_g(self):
        results = self.fit("mv_per_g.csv")
        # 100.07 mV/g.
        self.assertAlmostEqual(results["model"]["S"], 0.10007 / 9.80665, delta=2e-7)
        model = results["model"]
        device = ",".join(repr(model[name]) for name in ["S", "f0", "beta"])
        energy = self.json_of("--model", device, *QUICK, "--time", "0.002")["energy"]
        self.assertAlmostEqual(energy["E"], 2.862e-8, delta=1e-11)

    def test_radians(self):
        degrees, radians = self.fit("phase_deg.csv")["model"], self.fit("phase_rad.csv")["model"]
        self.assertAlmostEqual(degrees["beta"], 0.0238, delta=1e-4)
        self.assertAlmostEqual(radians["beta"], degrees["beta"], delta=1e-5)  # Three to six digits in the file.

    def test_radians_without_a_label(self):
        rows = (TABLES / "phase_rad.csv").read_text().replace("_rad", "").splitlines()
        text = self.succeed("report", "--points", self.write(rows), *QUICK, "--time", "0.00005")
        self.assertIn("Note: No unit of the phase is named, and degrees were taken. As radians they fit as well, with "
                      "beta =\n  0.0238: name their unit in the header, or by --input-units.", text)
        self.assertNotIn("No unit of the phase", self.succeed("report", "--points", self.write(rows), *QUICK, "--time",
                                                              "0.00005", "--input-units", "deg"))

    def test_inverted(self):
        self.refuse_table("inverted.csv", "inverted polarity", "--invert")
        self.refuse(["certify", "--points", TABLES / "inverted.csv"], "inverted.csv: inverted polarity", "--invert")
        results = self.fit("inverted.csv", "--invert")
        self.assertAlmostEqual(results["model"]["S"], 0.0227, delta=3e-5)
        self.assertIn("polarity turned round", results["fit"]["read_as"])

    def test_two_hundred_points(self):
        results = self.fit("two_hundred_points.csv")
        self.assertEqual(results["model"]["dof"], 397)
        self.assertAlmostEqual(results["model"]["f0"], 40000, delta=1200)

    def test_ac_coupling(self):
        text = self.succeed("report", "--points", TABLES / "high_pass.csv", *QUICK, "--time", "0.00005")
        self.assertIn("WARNING: chi2/dof = 473.3", text)
        self.assertIn("AC coupling (high-pass) with its corner at 0.5 Hz would bring chi2/dof from", text)

    def test_damping_that_is_left_open(self):
        expected = {"piezo_00.csv": (-0.0099, 0.0134), "piezo_01.csv": (0.0065, 0.0151)}
        for number in range(4):
            name = f"piezo_0{number}.csv"
            with self.subTest(name=name):
                results = self.fit(name, "--time", "0.002")
                self.assertEqual(results["fit"]["determined"], "all but beta")
                low, high = results["fit"]["beta_range"]
                estimate, u = results["fit"]["beta"], results["fit"]["ubeta"]
                self.assertEqual(low, 1e-4)
                self.assertAlmostEqual(high, estimate + 2 * u, delta=1e-12)
                self.assertEqual(results["model"]["beta"], max(estimate, 1e-4))
                least, most = results["fit"]["E_range"]
                self.assertTrue(least < results["energy"]["E"] < most)
                self.assertIsNone(results["monte_carlo"])
                if name in expected:
                    self.assertAlmostEqual(estimate, expected[name][0], delta=1e-4)
                    self.assertAlmostEqual(u, expected[name][1], delta=1e-4)
        text = self.succeed("report", "--points", TABLES / "piezo_01.csv", *QUICK)
        self.assertIn("WARNING: the points do not determine beta: within 2u it may be anything from 0.0001 to 0.0368.", text)
        self.assertIn("The energy is given at the estimate, 0.0065,", text)
        # Each figure that depends on it has a mark, and what the mark means is below.
        self.assertRegex(text, r"\n  In band, with its delay +\* +0\.")
        self.assertIn("  * There is a warning below, on: damping.\n", text)
        self.assertIn("The points leave beta open: these figures are at 0.0065.\n", text)
        self.assertIn("The energy is given at the least that a device may have, 0.0001,",
                      self.succeed("report", "--points", TABLES / "piezo_00.csv", *QUICK, "--time", "0.0001"))

    def test_in_band_errors_over_the_open_damping(self):
        """Each damping that may be given within the range has figures within the ranges, at any order of the filter."""
        for options in [(), ("--order", "3")]:
            results = self.fit("piezo_02.csv", "--time", "0.002", *options)
            low, high = results["fit"]["beta_range"]
            ranges = [results["band"]["range_percent"], results["band"]["matched"]["range_percent"]]
            for share in [0, 0.02, 0.2, 0.6, 0.99]:
                given = self.fit("piezo_02.csv", "--time", "0.002", "--damping", repr(low + share * (high - low)), *options)
                for figure, (least, most) in zip([given["band"], given["band"]["matched"]], ranges):
                    self.assertTrue(least <= figure["rms_percent"] <= most, (options, share, figure["rms_percent"], least, most))
                    self.assertNotIn("range_percent", figure)

    def test_ends_of_the_ranges_in_band(self):
        """The ends are those of single devices: f0 lower or higher by 2u, the damping anything within its range."""
        name, options = "piezo_02.csv", ["--time", "0.001", "--order", "3"]
        results = self.fit(name, *options, "--limit", "1")
        model, (low, high) = results["model"], results["fit"]["beta_range"]
        # u(f0) of a damping that is known is that of the fit with that damping given.
        u_f0 = self.fit(name, *options, "--damping", repr(model["beta"]))["model"]["uf0"]

        def of_device(by_u, beta):
            device = f"{model['S']},{model['f0'] + by_u * u_f0!r},{beta!r}"
            band = self.json_of("--model", device, *QUICK, *options)["band"]
            return [band["rms_percent"], band["matched"]["rms_percent"]]

        ends = [of_device(by_u, beta) for by_u in [-2, 2] for beta in [low, high]]
        # With its delay the least is within the range: low orders let the resonance through, and damping takes it away.
        inside = [of_device(2, low + i / 40 * (high - low)) for i in range(4, 16)]
        self.assertGreater(min(figures[0] for figures in ends), 1.1 * min(figures[0] for figures in inside))
        for i, block in enumerate([results["band"], results["band"]["matched"]]):
            least, most = block["range_percent"]
            # f0 moves with the damping by less than a hundredth, and the error with its square; the least is between
            # two dampings of this grid, where it changes by a twentieth.
            self.assertAlmostEqual(most / max(figures[i] for figures in ends), 1, delta=0.02)
            self.assertAlmostEqual(least / min(figures[i] for figures in ends + inside), 0.97, delta=0.04)

    def test_ranges_of_the_report(self):
        text = self.succeed("report", "--points", TABLES / "piezo_01.csv", *QUICK)
        for name in ["In band, constant delay taken out", "In band, with its delay", "The paper's figure, sqrt\\(E/T\\)"]:
            self.assertRegex(text, rf"\n  {name} +\* +[0-9.]+ +[0-9.]+ to [0-9.]+ +[0-9.]+\n")
        self.assertIn("\n  x to y: over the dampings that the points leave open, with f0 +- 2u.\n", text)
        self.assertRegex(text, r"\n  Range, as beta is open +[0-9.]+ to [0-9.]+ % of S a, each with its own delay\n")
        self.assertRegex(text, r"\n  Range, as beta is open +[0-9.]+ to [0-9.]+ % of S a\n")
        # E of the in-band error has the range of its figure: (p/100 S a)^2 T.
        results = self.fit("piezo_01.csv", "--criterion", "band", "--time", "0.002", "--limit", "1")
        for percent, energy in zip(results["band"]["matched"]["range_percent"], results["fit"]["E_range"]):
            self.assertAlmostEqual(energy / ((percent / 100 * results["model"]["S"]) ** 2 * 0.002), 1, delta=1e-9)

    def test_damping_that_is_given(self):
        free = self.fit("piezo_00.csv")
        held = self.fit("piezo_00.csv", "--damping", "0.005")
        self.assertEqual(held["fit"]["determined"], "all")
        self.assertEqual((held["model"]["beta"], held["model"]["ubeta"]), (0.005, 0))
        self.assertEqual(held["model"]["dof"], free["model"]["dof"] + 1)
        # Least squares under a condition: chi-square grows by the square of what it moves beta in units of u.
        moved = (0.005 - free["fit"]["beta"]) / free["fit"]["ubeta"]
        self.assertAlmostEqual(held["model"]["chi2"] - free["model"]["chi2"], moved ** 2, delta=0.02)
        text = self.succeed("report", "--points", TABLES / "piezo_00.csv", *QUICK, "--time", "0.0001", "--damping", "0.005")
        self.assertIn("Note: the points do not determine beta; it is held at the value given.", text)
        self.assertNotIn("WARNING: the points do not determine beta", text)
        # Beyond what the points leave open, where they determine it, and where it is of no use.
        open_words = "with U = 0.0268 (k = 2); expected 0.0001 to 0.0168, which they leave open, or no --damping"
        for name, damping, words in [("piezo_00.csv", "0.3", f"the points say beta = -0.009925 {open_words}"),
                                     ("piezo_00.csv", "0.017", open_words),
                                     ("plain.csv", "0.3", "the points say beta = 0.3164 with U = 0.00193 (k = 2); they "
                                                          "determine it: expected no --damping"),
                                     ("handheld_160hz.csv", "0.3", "determine the sensitivity alone")]:
            for command in ["report", "certify"]:
                arguments = [command, "--points", TABLES / name, "--damping", damping, "--out", "out"]
                self.refuse(arguments, "--damping: ", words)
        # The end is taken as it is printed: piezo_03.csv leaves open what is a little less than that.
        for name in [f"piezo_0{number}.csv" for number in range(4)]:
            high = self.fit(name)["fit"]["beta_range"][1]
            self.assertEqual(self.fit(name, "--damping", f"{high:.3g}")["fit"]["determined"], "all")

    def test_magnitudes_far_below_the_resonance(self):
        S, f0, beta = 0.0102, 55000.0, 0.01
        rows = []
        for i in range(20):
            f = 20.0 * 500.0 ** (i / 19.0)
            amplitude = S / abs(complex(1.0 - (f / f0) ** 2, 2.0 * beta * f / f0))
            rows.append(f"{f!r},{amplitude!r},{0.001 * amplitude!r}")
        table = self.write(["f_hz,amplitude,u_amplitude", *rows])
        found = json.loads(self.succeed("report", "--points", table, *QUICK, "--json"))["fit"]
        self.assertEqual(found["determined"], "S")
        # |K| knows (2 - 4 beta^2)/f0^2 there. What is of higher order moves f0 by less than a thousandth.
        wanted = f0 * math.sqrt((1.0 - 2e-8) / (1.0 - 2.0 * beta * beta))
        low = float(re.search(r"from (\d+) Hz \(U = \d+ Hz, k = 2\) for beta = 0\.0001", found["cause"])[1])
        self.assertAlmostEqual(low / wanted, 1.0, delta=1e-3)
        text = " ".join(self.succeed("report", "--points", table, *QUICK, "--out", "out").split())
        self.assertIn(f"Note: {found['cause']}", text)
        self.assertEqual(" ".join((self.directory / "out/report.txt").read_text().split()), text)
        # Above 1/sqrt(2) there is no resonance that magnitudes could rise to.
        for command in ["report", "certify"]:
            self.refuse([command, "--points", table, "--damping", "0.999"],
                        "--damping: no resonance fits these magnitudes with so large a damping", "expected at most 0.")

    def test_units_that_are_not_likely(self):
        mv_per_g = [f"{f!r},{9806.65 * a!r},{p!r},{9806.65 * ua!r},{up!r}" for f, a, p, ua, up, *_ in table_rows()]
        percent = [f"{f!r},{a!r},{p!r},1,1" for f, a, p, *_ in table_rows()]
        for rows, words in [(mv_per_g, "V/(m/s2) is more than usual accelerometers have; where it is mV/g"),
                            (percent, "where they are in percent, name them so")]:
            table = self.write([TablesThereAndBack.NAMES, *rows])
            result = self.run_program("report", "--points", table, *QUICK)
            self.assertEqual(result.returncode, 0)
            self.assert_one_line(result.stderr, f"{table}: ", words)
            text = " ".join(result.stdout.decode().split())
            self.assertIn(words, text)
            # It counts as a warning, beside each figure, too.
            self.assertRegex(text, "WARNING: (No unit of the amplitude|The uncertainties of the amplitude)")
            self.assertRegex(text, r"In band, constant delay taken out \* ")
            self.assertRegex(text, r"\* There is a warning below, on: units[.,]")
            warnings = json.loads(self.run_program("report", "--points", table, *QUICK, "--json").stdout)["warnings"]
            self.assertEqual([w["about"] for w in warnings][0], "units")
            self.assertIn(words, warnings[0]["text"])
        # Nothing is asked where the unit is named.
        named = self.write(["f_hz,amplitude [mV/g],phase_deg,u_amplitude,u_phase_deg", *mv_per_g])
        self.succeed("report", "--points", named, *QUICK)
        self.succeed("report", "--points", self.write([TablesThereAndBack.NAMES, *mv_per_g]), "--input-units", "mV/g",
                     *QUICK)
        # Where such uncertainties leave no device, too.
        rows = [f"{f!r},{a!r},{p!r},1,{up!r}" for f, a, p, _, up, *_ in table_rows(TABLES / "piezo_00.csv")]
        self.refuse_points([TablesThereAndBack.NAMES, *rows], None, "where they are in percent, name them so")

    def test_points_far_below_the_resonance(self):
        results = self.fit("handheld_160hz.csv")
        # 0.5 % (1 sigma) at each of five points.
        self.assertAlmostEqual(results["model"]["S"], 0.0102, delta=0.0102 * 0.005)
        self.assertEqual(results["fit"]["determined"], "S")
        for part in ["energy", "monte_carlo", "trend"]:
            self.assertIsNone(results[part])
        text = self.succeed("report", "--points", TABLES / "handheld_160hz.csv", "--out", "out")
        above = results["fit"]["f0_above"]
        self.assertIn(f"f0                        not determined, above {math.floor(above)} Hz by 2u\n", text)
        # 1/|K| S falls by (f/f0)^2, which 0.5 % hides to a tenth of f0 or so.
        self.assertTrue(2 * 160 < above < 50 * 160, above)
        self.assertEqual(self.files(), ["out", "out/report.txt", "out/results.json"])


class WarningsOfReports(Tables, ProgramTest):
    """What the text calls a warning is one in results.json, and the other way round."""

    def assert_warnings(self, arguments, *about):
        text = self.succeed("report", *arguments, "--out", "out")
        results = json.loads((self.directory / "out/results.json").read_text())
        self.assertEqual([warning["about"] for warning in results["warnings"]], list(about))
        # Each guard that disagrees says so in the text, beside what it has guarded; results.json says it once.
        parts = [results[name] for name in ["band", "uncertainty", "monte_carlo"]]
        parts.append((results["band"] or {}).get("matched"))
        guards = sum(bool(part and part.get("disagreements")) for part in parts)
        self.assertEqual(text.count("WARNING: in these trials"), guards)
        self.assertEqual(text.count("WARNING"), len(about) + max(guards - 1, 0))
        self.assertFalse(results["simulated"])

    def test_each_that_a_table_can_bring(self):
        short = ["--time", "0.001", "--trend", "none"]
        self.assert_warnings(["--points", TABLES / "plain.csv", "--trend", "none"])
        self.assert_warnings(["--points", TABLES / "plain.csv", *QUICK], "monte_carlo")
        self.assert_warnings(["--points", DATA / "djb_a1800v.csv", "--trend", "none"], "fit")
        self.assert_warnings(["--points", TABLES / "piezo_01.csv", *short], "damping")
        self.assert_warnings(["--points", TABLES / "handheld_160hz.csv"], "energy")
        self.assert_warnings(["--points", TABLES / "plain.csv", "--trend", "none", "--time", "0.0005"], "energy", "band")
        self.assert_warnings(["--points", TABLES / "plain.csv", "--trend", "none", "--cutoff", "5000"], "energy")
        # 2.4 % of the draws are below 0.0001.
        wide = ["--model", "1.037,4073,0.02,0.001,4,0.0101", *QUICK, "--time", "0.005", "--distribution", "normal"]
        self.assert_warnings(wide, "monte_carlo", "monte_carlo", "uncertainty")

    def test_uncertainties_that_are_too_large_for_a_linear_law(self):
        U = 0.5
        rows = [f"{f!r},{a!r},{p!r},{U * a!r},{57 * U!r}" for f, a, p, *_ in table_rows()]
        names = TablesThereAndBack.NAMES.replace("u_amplitude", "u_amplitude [V/(m/s2)]")
        self.assert_warnings(["--points", self.write([names, *rows]), *QUICK], "fit_draws", "monte_carlo", "monte_carlo")

    def test_certify_warns_of_the_same(self):
        for table, about, words in [
            (TABLES / "plain.csv", [], None),
            (DATA / "djb_a1800v.csv", ["fit"], "WARNING: chi2/dof is above what one fit in a hundred exceeds"),
            (TABLES / "piezo_01.csv", ["damping"], "WARNING: the points do not determine beta"),
            (TABLES / "plain.csv", [], "WARNING: T is much shorter than the settling time; give at least"),
        ]:
            with self.subTest(table=table.name, words=words):
                time = "0.0005" if words and "shorter" in words else "0.001"
                certify = ["certify", "--points", table, "--time", time, "--effort", "0.1"]
                proven = json.loads(self.succeed(*certify, "--json"))
                report = self.json_of("--points", table, "--time", time, *QUICK)
                self.assertEqual([w["about"] for w in proven["warnings"] if w["about"] != "energy"], about)
                # It has no trials, and no in-band error beside the one that it proves.
                known = [warning for warning in report["warnings"] if warning["about"] not in ("monte_carlo", "band")]
                self.assertEqual(proven["warnings"], known)
                self.assertEqual(proven["E_range"], report["fit"].get("E_range"))
                text = self.succeed(*certify)
                self.assertEqual(text.count("WARNING"), len(known))
                self.assertIn(words or "Proven", text)

    def test_certify_shortens_a_time_that_nobody_asked_for(self):
        quick = ["--effort", "0.1", "--rounds", "1"]
        for device in [["--model", "0.0102,55000,0.01"], ["--points", TABLES / "piezo_00.csv"],
                       ["--model", "0.0102,1000000,0.01"]]:
            with self.subTest(device=device):
                proven = json.loads(self.succeed("certify", *device, *quick, "--json"))
                words = f"T is {proven['T']!r} s, not the 0.002 s of emax report"
                self.assertIn(words, proven["warnings"][0]["text"])
                # It is the longest that the proof has room for, in three digits.
                self.refuse(["certify", *device, "--time", f"{1.02 * proven['T']:.6g}"], "emax: --time: ",
                            f"at most {proven['T']!r} s")
        device = ["--model", "0.0102,55000,0.01"]
        text = self.succeed("certify", *device, *quick)
        self.assertIn("WARNING: T is 0.00181 s, not the 0.002 s of emax report", text)
        self.assertIn("for 0.00181 s\n", text)
        self.assertNotIn("of emax report", self.succeed("certify", *device, *quick, "--time", "0.00181"))
        self.refuse(["certify", *device, "--time", "0.002"], "emax: --time: ", "at most 0.00181 s")

    def test_compare_refuses_a_sensitivity_alone(self):
        for name in ["plain.csv", "handheld_160hz.csv"]:
            results = self.succeed("report", "--points", TABLES / name, *QUICK, "--json")
            (self.directory / name).with_suffix(".json").write_text(results)
        self.refuse(["compare", "plain.json", "handheld_160hz.json"], "handheld_160hz.json",
                    "its points determine the sensitivity alone")

    def test_a_measurement_that_failed(self):
        self.run_program("report", "--bench-fault", "unplugged-device@4", "--out", "out")
        results = json.loads((self.directory / "out/results.json").read_text())
        self.assertEqual([warning["about"] for warning in results["warnings"]], ["measurement"])
        self.assertTrue(results["simulated"])
        self.assertTrue((self.directory / "out/report.txt").read_text().startswith("SIMULATION: "))


def table_rows(table=TABLES / "plain.csv"):
    lines = table.read_text().splitlines()[1:]
    return [[float(cell) for cell in line.split(",")] for line in lines]


class TablesThereAndBack(Tables, ProgramTest):
    def assert_same_fit(self, header, rows, delta=1e-12, separator=",", decimal="."):
        lines = [header] + [separator.join(f"{cell!r}".replace(".", decimal) for cell in row) for row in rows]
        results = self.json_of("--points", self.write(lines, end="\r\n"), *QUICK)
        expected = self.fit("plain.csv")
        for name in ["S", "f0", "beta", "uS", "uf0", "ubeta", "chi2"]:
            ratio = results["model"][name] / expected["model"][name]
            self.assertAlmostEqual(ratio, 1.0, delta=delta, msg=name)
        return results

    NAMES = "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg"

    def test_its_own_file(self):
        for name in ["plain.csv", "magnitude_only.csv"]:
            first = self.json_of("--points", TABLES / name, *QUICK, "--out", "out")
            second = self.json_of("--points", "out/frequency_response.csv", *QUICK)
            for part in ["model", "energy", "monte_carlo"]:
                first[part].pop("name", None), second[part].pop("name", None)
                self.assertEqual(first[part], second[part], (name, part))

    def test_a_sweep(self):
        """What its points share is in the file: with it the uncertainties are the same, too."""
        first = self.json_of(*QUICK, "--out", "out")
        table = (self.directory / "out/frequency_response.csv").read_text().splitlines()
        self.assertTrue(table[0].endswith(",u_common,level_mps2"))
        # The level is 1 m/s^2, reached within the 5 % at which the sweep goes on; it is also in the budget.
        levels = [row.split(",")[-1] for row in table[1:-1]]
        self.assertEqual([float(level) for level in levels],
                         [float(f"{row[-1]:.6g}") for row in first["bench"]["budget"]])
        self.assertTrue(all(0.94 <= float(level) <= 1.06 for level in levels))
        self.assertTrue(table[-1].startswith("# shared: skew="))
        second = self.json_of("--points", "out/frequency_response.csv", *QUICK, "--out", "again")
        for name in ["S", "f0", "beta", "uS", "uf0", "ubeta", "chi2"]:
            # 15 digits of the totals leave 12 of a part that is a thirtieth of them.
            self.assertAlmostEqual(second["model"][name] / first["model"][name], 1, delta=1e-10, msg=name)
        self.assertIn("with what all points have in common", second["fit"]["read_as"])
        again = (self.directory / "again/frequency_response.csv").read_text().splitlines()
        self.assertEqual(again[-1], table[-1])
        self.refuse(["report", "--points", "out/frequency_response.csv", "--reference-uncertainty", "0.5"],
                    "u_common", "expected one of them")
        # Without that line the uncertainties would be too small.
        bare = self.json_of("--points", self.write(table[:-1]), *QUICK)
        for name in ["uf0", "ubeta"]:
            self.assertLess(bare["model"][name], 0.99 * first["model"][name])

    def test_german_spreadsheet(self):
        header = "Frequenz [Hz];Empfindlichkeit [V/(m/s²)];Phase [Grad];U(A);U(Phase)"
        self.assert_same_fit(header, table_rows(), separator=";", decimal=",")

    def test_radians_and_kilohertz(self):
        rows = [[f / 1e3, a, math.radians(p), ua, math.radians(up)] for f, a, p, ua, up in table_rows()]
        # Conversions there and back round twice; the fit passes about 1e2 of that on.
        self.assert_same_fit("f [kHz],amplitude,phase [rad],u_amplitude,u_phase [rad]", rows, 1e-12)

    def test_millivolts_per_g_and_percent(self):
        rows = [[f, a * 9806.65, p, 100 * ua / a, up] for f, a, p, ua, up in table_rows()]
        self.assert_same_fit("f_hz,sens_mV_per_g,phase_deg,u_amplitude_percent,u_phase_deg", rows, 1e-12)

    def test_shuffled_with_every_row_twice(self):
        rows = 2 * table_rows()
        random.Random(1).shuffle(rows)
        results = self.assert_same_fit(self.NAMES, rows)
        self.assertIn("40 of them the mean of repeated rows", results["fit"]["read_as"])

    def test_header_as_a_comment(self):
        rows = [[f / 1e3, *rest] for f, *rest in table_rows()]
        self.assert_same_fit("# f_khz,amplitude,phase_deg,u_amplitude,u_phase_deg", rows)

    def test_delay_between_the_channels(self):
        rows = [[f, a, (p - 360 * f * 1e-5 + 180) % 360 - 180, ua, up] for f, a, p, ua, up in table_rows()]
        name = self.write([self.NAMES] + [",".join(map(repr, row)) for row in rows])
        results = self.json_of("--points", name, *QUICK, "--channel-delay", "1e-5")
        self.assertAlmostEqual(results["model"]["beta"], PLAIN["beta"], delta=1e-6)  # Its digits.
        # 0.53 ms is three turns at the highest frequency.
        rows = [[f, a, (p - 360 * f * 0.53e-3 + 180) % 360 - 180, ua, up] for f, a, p, ua, up in table_rows()]
        name = self.write([self.NAMES] + [",".join(map(repr, row)) for row in rows])
        text = self.succeed("report", "--points", name, *QUICK)
        self.assertIn("A delay of 0.53 ms of the device's channel would bring chi2/dof from", text)


class TablesAtTheConsole(Tables, ProgramTest):
    def ask(self, name, *queries):
        """The answers of each query until the next *OPC?, which is 1, and then the error of it."""
        rows = (TABLES / name).read_text().splitlines()[1:]
        lines = [f"TRAC:FRES:DATA {row}" for row in rows] + ["CALC:ENER:TIME 0.001"]
        for query in queries:
            lines += [query, "*OPC?", "SYST:ERR?"]
        answers = self.run_program("scpi", input="\n".join([*lines, ""]).encode()).stdout.decode().splitlines()
        found = []
        for _ in queries:
            end = answers.index("1")
            found.append((answers[0].split(",") if end else None, answers[end + 1]))
            answers = answers[end + 2:]
        return found

    NONE = '0,"No error"'

    def test_damping_that_is_left_open(self):
        report = self.fit("piezo_00.csv", "--time", "0.001")
        fit, known, trials = self.ask("piezo_00.csv", "CALC:IDEN?", "CALC:UNC?", "CALC:MCAR?")
        numbers = list(map(float, fit[0]))
        self.assertAlmostEqual(numbers[2], -0.0099, delta=1e-4)
        self.assertAlmostEqual(numbers[5], 0.0134, delta=1e-4)
        self.assertEqual(numbers[6:], [report["model"]["chi2"], report["model"]["dof"]])
        # The same range of E as in the report in place of both intervals; u is not a number (9.91E37 in SCPI).
        self.assertEqual(list(map(float, known[0])), [9.91e37] * 2 + 2 * report["fit"]["E_range"] + [0])
        self.assertEqual((fit[1], known[1]), (self.NONE, self.NONE))
        self.assertEqual(trials[0], None)
        self.assertIn("beta left open: nearer f0, or CALC:MOD", trials[1])

    def test_points_far_below_the_resonance(self):
        report = self.fit("handheld_160hz.csv")["model"]
        fit, energy, again = self.ask("handheld_160hz.csv", "CALC:IDEN?", "CALC:ENER?", "CALC:IDEN?")
        numbers = list(map(float, fit[0]))
        self.assertEqual(numbers[:6], [report["S"], 9.91e37, 9.91e37, report["uS"], 9.91e37, 9.91e37])
        self.assertEqual(numbers[7], 7)  # Five points, two equations each, three unknowns.
        self.assertEqual(fit[1], self.NONE)
        self.assertEqual(energy[0], None)
        self.assertIn("points give S alone: more, nearer to f0", energy[1])
        self.assertEqual(again, fit)


class TablesByChance(Tables, ByHand):
    """Devices far above their points, drawn 400 times each."""

    FREQUENCIES = [20, 31.5, 63, 125, 160, 250, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150, 4000, 5000, 6300,
                   8000, 10000]

    def draw(self, device, chance):
        s, f0, beta = device
        rows = []
        for f in self.FREQUENCIES:
            k = s / (1 + 2j * beta * f / f0 - (f / f0) ** 2)
            amplitude, phase = abs(k), math.degrees(cmath.phase(k))
            rows.append([f, amplitude * chance.gauss(1, 0.005), phase + chance.gauss(0, 0.5), 0.01 * amplitude, 1])
        return self.write([TablesThereAndBack.NAMES] + [",".join(map(repr, row)) for row in rows])

    DRAWS = 400
    # Of 400 at 95 % fewer than 367 happens twice in 1000.
    LEAST = 367

    def test_every_draw_gives_a_report_with_the_truth_in_its_interval(self):
        """Whether the points determine the damping is a matter of chance too, so that all draws count together."""
        chance = random.Random(5)
        common = ["--limit", "1", "--gain", "0.0102", "--time", "0.001", *QUICK]
        for device in [(0.0102, 55000, 0.005), (0.0102, 55000, 0.01), (0.0102, 30000, 0.01)]:
            true = self.json_of("--model", ",".join(map(str, device)), *common)["energy"]["E"]
            inside = 0
            for _ in range(self.DRAWS):
                results = self.json_of("--points", self.draw(device, chance), *common)
                is_open = results["fit"]["determined"] == "all but beta"
                low, high = results["fit"]["E_range"] if is_open else results["uncertainty"]["interval"]
                inside += low <= true <= high
            self.assertGreaterEqual(inside, self.LEAST, device)


class TablesThatAreRefused(Tables, ProgramTest):
    HEADER = "f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg"
    ROW = "100,1.03,-1,0.01,1"

    def test_units(self):
        rows = ["100,1.03,-1,0.01,1", "200,1.03,-2,0.01,1", "400,1.04,-4,0.01,1"]
        for header, unit in [
            ("f [rpm],amplitude,phase_deg,u_amplitude,u_phase_deg", "rpm"),
            ("f_hz,amplitude [lbf],phase_deg,u_amplitude,u_phase_deg", "lbf"),
            ("f_hz,amplitude,phase [arcmin],u_amplitude,u_phase_deg", "arcmin"),
            ("f_hz,amplitude,phase_deg,u_amplitude [furlong],u_phase_deg", "furlong"),
            ("f_hz,amplitude,phase_deg,u_amplitude,u_phase_percent", "percent"),
            ("f_hz,amplitude [dB re 1 lbf],phase_deg,u_db,u_phase_deg", "lbf"),
        ]:
            with self.subTest(unit=unit):
                self.refuse_points([header, *rows], 1, unit, "is not known", "expected")

    def test_headers(self):
        rows = [self.ROW] * 3
        self.refuse_points(["x,amplitude,phase_deg,u_amplitude,u_phase_deg", *rows], 1, "no name for the frequency")
        self.refuse_points(["f_hz,x,phase_deg,u_amplitude,u_phase_deg", *rows], 1, "no name for the amplitude")
        self.refuse_points(["f_hz,amplitude,sensitivity,u_amplitude,u_phase_deg", *rows], 1, "name the same quantity")
        self.refuse_points(["100,1.03,0.01", "200,1.03,0.01", "300,1.03,0.01"], 1, "3 columns and no header")

    def test_options(self):
        table = ["--points", TABLES / "plain.csv"]
        for option, value in [("--uncertainty", "1"), ("--uncertainty", "1%,2%"), ("--input-units", "furlong"),
                              ("--channel-delay", "2"), ("--damping", "1"), ("--damping", "0")]:
            self.refuse_option(option, value, "expected", device=table)
        self.refuse(["report", *table, "--uncertainty", "1%"], "uncertainties of its own")
        self.refuse(["report", "--points", TABLES / "mv_per_g.csv", "--input-units", "V/g"], "says mV/g")
        for option in [["--invert"], ["--channel-delay", "1e-6"], ["--uncertainty", "1%"], ["--damping", "0.1"]]:
            self.refuse(["report", *option], option[0], "no table")


if __name__ == "__main__":
    main()
