"""results.json, report and page: fields as their schema says, and figures as calculations that share nothing with the program.

usage: test_results.py PROGRAM DATA_DIRECTORY [unittest arguments]
"""

import copy
import html
import json
import math
import pathlib
import re
import sys
from dataclasses import replace

import results_schema
from program_test import DATA, MODEL, QUICK, ProgramTest, main

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "reference"))
import reference

PAPER = "1.037,4073,0.3182"
U_PAPER = (0.003, 6.0, 0.0004)
LIMIT = 1.037
TABLE1 = ["--points", DATA / "djb_a1800v.csv"]


class Schema(ProgramTest):
    """Every report of a ProgramTest is held against the schema; here are those of each kind, and the check itself."""

    def made(self, *arguments):
        """The document, whose faults `run_program()` has looked for."""
        return json.loads(self.succeed("report", *arguments, "--json"))

    def test_each_criterion_and_method(self):
        for criterion in ["ise", "difference", "band"]:
            for method in ["best", "paper"]:
                for order in ["1", "10"]:
                    with self.subTest(criterion=criterion, method=method, order=order):
                        # A delayed filter of order 1 would start with a jump: that figure is refused.
                        delay = ["--reference-delay", "none"] if (criterion, order) == ("band", "1") else []
                        found = self.made(*MODEL, *QUICK, "--criterion", criterion, "--method", method, "--order", order,
                                          "--step", "2e-5", *delay)
                        self.assertEqual(found["band"]["matched"] is None, order == "1")
                        self.assertEqual(found["band"]["matched_refused"] is None, order == "10")
                        self.assertEqual(found["energy"]["criterion"], criterion)
                        self.assertEqual(found["energy"]["method"], method)
                        self.assertEqual(found["filter"]["order"], int(order))

    def test_each_source(self):
        self.assertEqual(self.made("--model", PAPER, "--trend", "none")["monte_carlo"], None)
        self.assertEqual(self.made(*TABLE1, *QUICK, "--device", "A 1800", "--note", "x")["labels"]["device"], "A 1800")
        self.assertEqual(self.made(*QUICK)["model"]["source"], "bench")
        self.assertEqual(self.made(*MODEL, "--trials", "1000", "--distribution", "normal", "--gain", "track",
                                   "--reference-delay", "2e-5")["monte_carlo"]["distribution"], "normal")
        self.assertTrue(self.made(*MODEL, "--adaptive", "--trend", "none")["monte_carlo"]["trials"] >= 1000)

    def test_what_points_leave_open(self):
        tables = DATA / "tables"
        damping = self.made("--points", tables / "piezo_00.csv", *QUICK, "--time", "0.001")
        self.assertEqual(damping["fit"]["determined"], "all but beta")
        resonance = self.made("--points", tables / "handheld_160hz.csv", *QUICK)
        self.assertEqual((resonance["fit"]["determined"], resonance["model"]["f0"]), ("S", None))

    def test_a_failed_measurement(self):
        result = self.run_program("report", "--bench-fault", "unplugged-reference@1", "--json", "--out", "out")
        self.assertEqual(result.returncode, 3)
        found = json.loads(result.stdout)
        self.assertEqual((found["model"], found["bench"]["fault"]["name"]), (None, "no reference"))

    def test_the_check_finds_damage(self):
        good = self.made(*TABLE1, *QUICK)
        damages = {
            "results: no band": lambda d: d.pop("band"),
            "results.band.matched: no delay_s": lambda d: d["band"]["matched"].pop("delay_s"),
            "results.energy: speed is not in the schema": lambda d: d["energy"].update(speed=1),
            "results.energy.T: 0 is outside of exclusiveMinimum 0": lambda d: d["energy"].update(T=0),
            "results.filter.order: 16 is outside of maximum 15": lambda d: d["filter"].update(order=16),
            "results.filter.order: 4.5 is not of type integer": lambda d: d["filter"].update(order=4.5),
            "results.energy.criterion: rms is outside of enum": lambda d: d["energy"].update(criterion="rms"),
            "results.uncertainty.interval: [1] is outside of minItems 2": lambda d: d["uncertainty"].update(interval=[1]),
            "results.model.covariance[2]": lambda d: d["model"]["covariance"][2].pop(),
            "results.simulated: None is not of type boolean": lambda d: d.update(simulated=None),
            "results.warnings[0].text: 3 is not of type string": lambda d: d["warnings"][0].update(text=3),
        }
        self.assertEqual(results_schema.faults(good), [])
        for words, damage in damages.items():
            with self.subTest(words):
                bad = copy.deepcopy(good)
                damage(bad)
                found = results_schema.faults(bad)
                self.assertEqual(len(found), 1, found)
                self.assertIn(words, found[0])
        self.assertEqual(results_schema.faults_of_text('{"E": NaN}'), ["NaN is no JSON"])
        with self.assertRaisesRegex(ValueError, "patternProperties"):
            results_schema.faults({}, {"type": "object", "patternProperties": {}})

    def test_every_field_says_what_it_is(self):
        rows = list(results_schema.rows(results_schema.SCHEMA))
        self.assertGreater(len(rows), 120)
        for name, _, words in rows:
            self.assertGreater(len(words), 0, name)

    def test_the_readme_has_the_fields(self):
        readme = (results_schema.DESK / "README.md").read_text(encoding="utf-8")
        self.assertIn(results_schema.table(), readme, "print it by results_schema.py")


def derivatives(system, switches, steps):
    """dE/dS, dE/df0, dE/dbeta of a signal; at its best switches the times' own changes do not count."""
    def energy(**change):
        sensor = replace(system.sensor, **change)
        return reference.switching_energy(replace(system, sensor=sensor), switches, 2e-3, LIMIT)

    slopes = []
    for name, step in steps.items():
        at = getattr(system.sensor, name)
        slopes.append((energy(**{name: at + step}) - energy(**{name: at - step})) / (2.0 * step))
    return slopes


class FigureValues(ProgramTest):
    # DESIGN: closed form at refined switches, found twice. S = a = gain = 1.037.
    def assert_relative(self, value, expected, tolerance, words=""):
        self.assertAlmostEqual(value / expected, 1.0, delta=tolerance, msg=words)

    def test_energies_and_switches(self):
        cases = [
            # order, T, in band, delay taken out; to the digits that are published
            ("10", "0.002", 7.66114200e-6, 3.30567639e-7),
            ("10", "0.010", 1.61813435e-4, 1.09936666e-5),
            ("4", "0.002", 2.02966723e-5, 1.49396682e-6),
        ]
        for order, time, band, matched in cases:
            with self.subTest(order=order, time=time):
                found = self.json_of("--model", PAPER, "--order", order, "--time", time, "--trend", "none")["band"]
                self.assertGreater(found["E"], band * (1 - 1e-8))
                self.assertGreater(found["matched"]["E"], matched * (1 - 1e-8))
                self.assert_relative(found["E"], band, 1e-8)
                self.assert_relative(found["matched"]["E"], matched, 1e-8)
                for figure in [found, found["matched"]]:
                    self.assertGreater(figure["bound"], figure["E"])
                    self.assert_relative(figure["rms"], math.sqrt(figure["E"] / float(time)), 1e-15)
                    self.assert_relative(figure["rms_percent"], 100 * figure["rms"] / (1.037 * LIMIT), 1e-14)
                    self.assertEqual(figure["switches"], len(figure["switch_times"]))
                if time == "0.002" and order == "10":
                    self.assertEqual([round(t, 9) for t in found["switch_times"]], [0.000639919])
                    for t, known in zip(found["matched"]["switch_times"], [0.365145378e-3, 0.946493860e-3]):
                        # A third switch near the end moves these two by less than this.
                        self.assertAlmostEqual(t, known, delta=2e-9)
                if time == "0.010":
                    self.assertEqual((found["switches"], found["matched"]["switches"]), (16, 18))

    def test_percents_of_sensors(self):
        # DESIGN, the table of section 2: order 10, 1 kHz, T = 2 ms; to half of the last digit.
        table = {
            PAPER: ((148.7, 0.05), (5.755, 5e-4), (1.196, 5e-4)),
            "1,8000,0.7": ((146.3, 0.05), (6.007, 5e-4), (0.0176, 5e-5)),
            "1,30000,0.7": ((147.7, 0.05), (1.608, 5e-4), (0.00059, 5e-6)),
            "1,4073,0.7": (None, (11.75, 5e-3), (0.13, 5e-3)),
            "1,4073,0.01": (None, (1.65, 5e-3), (1.62, 5e-3)),
            "1,2000,0.7": (None, (23.6, 0.05), (1.01, 5e-3)),
            "1,2000,0.3": (None, (13.1, 0.05), (5.18, 5e-3)),
        }
        for model, (paper, band, matched) in table.items():
            with self.subTest(model):
                found = self.json_of("--model", model, "--trend", "none")
                S, a = found["model"]["S"], found["energy"]["a"]
                percents = [100 * found["energy"]["rms"] / (S * a), found["band"]["rms_percent"],
                            found["band"]["matched"]["rms_percent"]]
                for value, expected in zip(percents, (paper, band, matched)):
                    if expected is not None:
                        self.assertAlmostEqual(value, expected[0], delta=1.0001 * expected[1])

    def test_ideal_sensor(self):
        found = self.json_of("--model", PAPER, "--trend", "none")["ideal"]
        self.assert_relative(found["E"], 5.080404e-3, 1e-7)
        self.assertAlmostEqual(found["rms_percent"], 148.21, delta=0.005)
        longer = self.json_of("--model", PAPER, "--trend", "none", "--time", "0.01")["ideal"]
        self.assertAlmostEqual(longer["rms_percent"], 179.34, delta=0.005)
        # Ever faster switching: the whole signal is left, 100 % of S a.
        first = self.json_of("--model", PAPER, "--trend", "none", "--order", "1")["ideal"]
        self.assert_relative(first["rms_percent"], 100.0, 1e-12)
        band = self.json_of("--model", PAPER, "--trend", "none", "--criterion", "band")["ideal"]
        self.assertEqual((band["E"], band["rms_percent"]), (0, 0))

    def test_uncertainties_are_those_of_the_derivatives(self):
        # u of a figure that is nearly linear in the parameters: the root of the sum of (dE/dp u(p))^2, by quadrature.
        # 20000 trials know a standard deviation to 0.5 %, and an end of the interval to 0.02 u; curvature adds less.
        found = self.json_of("--model", PAPER + ",0.003,6,0.0004", "--trials", "20000", "--trend", "none")
        sensor = reference.Accelerometer(1.037, 4073.0, 0.3182)
        energy = reference.System(sensor, 10, 1000.0, 1.037)
        steps = {"S": 1e-4, "f0": 1.0, "beta": 1e-4}
        slopes = derivatives(energy, found["energy"]["switch_times"], steps)
        u = math.hypot(*(slope * standard for slope, standard in zip(slopes, U_PAPER)))
        known = found["uncertainty"]
        self.assert_relative(known["u"], u, 0.025)
        self.assertAlmostEqual(known["U"], 2 * known["u"], delta=1e-12 * u)
        self.assertAlmostEqual(known["interval"][0], found["energy"]["E"] - 1.96 * u, delta=0.1 * u)
        self.assertAlmostEqual(known["interval"][1], found["energy"]["E"] + 1.96 * u, delta=0.1 * u)
        self.assertEqual((known["redrawn"], known["disagreements"]), (0, 0))
        # A uniform box has a third of the variance.
        self.assert_relative(found["monte_carlo"]["u"], u / math.sqrt(3.0), 0.025)
        del steps["S"]
        for figure, delay in [(found["band"], 0.0), (found["band"]["matched"], 0.3182 / (math.pi * 4073.0))]:
            system = reference.System(sensor, 10, 1000.0, 1.037, "band", delay)
            slopes = derivatives(system, figure["switch_times"], steps)
            u = math.hypot(*(slope * standard for slope, standard in zip(slopes, U_PAPER[1:])))
            with self.subTest(delay=delay):
                self.assert_relative(figure["u"], u, 0.025)
                self.assert_relative(figure["u_percent"], 0.5 * figure["rms_percent"] * u / figure["E"], 0.03)
                self.assertAlmostEqual(figure["interval"][0], figure["E"] - 1.96 * u, delta=0.1 * u)
                self.assertEqual(figure["U_percent"], 2 * figure["u_percent"])
                self.assertEqual(figure["disagreements"], 0)

    def test_uncertainty_of_the_papers_percent_is_without_that_of_the_scale(self):
        # Of 100 sqrt(E/T)/(S a) with S the sensor's own: d ln(sqrt(E)/S) = dE/(2 E) - dS/S, by quadrature. The row has
        # two digits.
        options = ["--model", PAPER + ",0.003,6,0.0004", "--trials", "20000", "--trend", "none"]
        sensor = reference.Accelerometer(1.037, 4073.0, 0.3182)
        found = self.json_of(*options)
        slopes = derivatives(reference.System(sensor, 10, 1000.0, 1.037), found["energy"]["switch_times"],
                             {"S": 1e-4, "f0": 1.0, "beta": 1e-4})
        energy = found["energy"]["E"]
        relative = [slope / (2 * energy) for slope in slopes]
        relative[0] -= 1 / 1.037
        expected = 2 * 148.72 * math.hypot(*(slope * u for slope, u in zip(relative, U_PAPER)))
        row = r"The paper's figure, sqrt\(E/T\) +\S+ +(\S+) "
        told = float(re.search(row, self.succeed("report", *options)).group(1))
        self.assertAlmostEqual(told, expected, delta=0.005 + 0.03 * expected)
        # A gain that follows S leaves of it a factor.
        only_s = ["--model", PAPER + ",0.003,0,0", "--gain", "track", *options[2:]]
        for more in [[], ["--distribution", "normal"], ["--threads", "1"]]:
            self.assertEqual(re.search(row, self.succeed("report", *only_s, *more)).group(1), "0")

    def test_figure_at_the_end_of_its_interval(self):
        # With the delay of the estimate taken out a trial has the error of a delay that is left: x(t - dt) instead of
        # x(t), which is as large as the error with the whole delay times |dt| over it. So the figure is that of 0.7 %
        # of it and less, and its 95 % end at 1.96 u of the delay beta/(pi f0).
        options = ["--model", "1,60000,0.7,0.003,300,0.01", "--limit", "1", "--trials", "20000", "--trend", "none"]
        band = self.json_of(*options)["band"]
        matched = band["matched"]
        end = 1.96 * band["rms_percent"] * math.hypot(0.01 / 0.7, 300 / 60000)
        self.assertAlmostEqual(matched["shortest_percent"][1], end, delta=0.03 * end)
        self.assertLess(matched["rms_percent"], matched["interval_percent"][0], "what made this necessary")
        text = self.succeed("report", *options, "--out", "out")
        row = re.search(r"  In band, constant delay taken out +(\S+) +(\S+) to (\S+) +0\.0001418\n", text)
        self.assertAlmostEqual(float(row.group(1)), matched["rms_percent"], delta=1e-7)
        self.assertEqual(float(row.group(2)), 0.0)
        self.assertAlmostEqual(float(row.group(3)), end, delta=0.03 * end + 0.001)
        self.assertIn("+-U says too little", text)
        self.assertIn("the same in all trials", text, "the delay stays at the estimate")
        # The body says the same as the table, and so does results.json.
        body = text[text.index("  Delay taken out"):]
        body = body[:body.index("  Guard")]
        self.assertNotRegex(body, r"U \(k = 2\)|Symmetric|Shortest")
        low, high = map(float, re.search(r"Interval, in place of U +(\S+) to (\S+) V\^2 s", body).groups())
        self.assertEqual(matched["instead_of_U_percent"][0], min(matched["shortest_percent"][0], matched["rms_percent"]))
        self.assertEqual(matched["instead_of_U_percent"][1], max(matched["shortest_percent"][1], matched["rms_percent"]))
        for energy, percent in zip([low, high], matched["instead_of_U_percent"]):
            self.assertAlmostEqual(100 * math.sqrt(energy / 0.002), percent, delta=1e-6 * percent)
        self.assertIsNone(band["instead_of_U_percent"], "U is the one to use there")
        self.assertIn("None exceeds: proven at the estimates", text)
        page = html.unescape((self.directory / "out" / "report.html").read_text(encoding="utf-8"))
        self.assertRegex(page, r"0\.0001385 % of.S.a; 95 % interval 0 to 0\.02\d %")
        for words in [text, page]:
            self.assertNotRegex(words, r"[ >]0\.0+[ <]")

    def test_no_figure_is_printed_above_its_bound(self):
        # The digits of a figure are those of its U, which here are fewer than those of its bound.
        sharp = "0.0102,50000,0.02,0.0001,200,0.002"
        for time in ["0.0003", "0.0005", "0.001"]:
            text = self.succeed("report", "--model", sharp, "--time", time, "--trials", "2000", "--trend", "none")
            rows = re.findall(r"^  (?:In band|The paper's figure).*?  \*? *(\d\S*) {2,}(?:\S+|\S+ to \S+) {2,}(\d\S*)$", text, re.M)
            self.assertGreaterEqual(len(rows), 2, text)
            for found, bound in rows:
                self.assertLessEqual(float(found), float(bound), text)

    def test_page_of_figures_next_to_nothing(self):
        self.succeed("report", "--model", "1,4073,0.3,0.05,100,0.05", "--time", "1e-5", "--trials", "2000",
                     "--trend", "none", "--out", "out")
        page = html.unescape((self.directory / "out" / "report.html").read_text(encoding="utf-8"))
        self.assertNotRegex(page, r"[ >]0\.0+ %")

    def test_guard_of_a_figure_in_band_is_told_there(self):
        found = self.json_of("--model", "0.0102,50000,0.02,0.0001,200,0.004", "--gain", "0.0102", "--trials", "2000",
                             "--time", "0.003", "--trend", "none")
        self.assertGreater(found["band"]["disagreements"], 0, "what this is about")
        self.assertEqual(found["monte_carlo"]["disagreements"], 0)
        self.assertEqual([w["about"] for w in found["warnings"] if "full search" in w["text"]], ["band"])

    def test_short_time_in_band(self):
        # Order 10 at 300 Hz rings 1000/300 times as long as at 1 kHz, where the README says 4.5084 ms with the delay out.
        found = self.json_of("--model", PAPER, "--cutoff", "300", "--trend", "none")
        self.assertAlmostEqual(found["band"]["settling_time_s"], 0.014, delta=0.0015)
        self.assertEqual([w["about"] for w in found["warnings"]], ["band"])
        self.assertEqual(found["warnings"][0]["least_time_s"], found["band"]["settling_time_s"])
        text = self.succeed("report", "--model", PAPER, "--cutoff", "300", "--trend", "none", "--out", "out")
        self.assertIn("There is a warning below, on: band.", text)
        # The leading figure's is as much longer as the README's 4.5084 ms are than its 4.1812 ms.
        self.assertRegex(text[text.index("with its delay\n  E"):], r"WARNING: T is much shorter [^:]*: give a T of 14\.\d ms or more")
        page = (self.directory / "out" / "report.html").read_text(encoding="utf-8")
        self.assertRegex(page, r"settling time of the in-band error; give at least that time, 15(\.\d)? ms")
        # Long enough, and none.
        self.assertEqual(self.json_of("--model", PAPER, "--cutoff", "300", "--time", "0.015", "--trend", "none")["warnings"], [])

    def test_time_below_the_settling_time_in_band_is_noted(self):
        found = self.json_of("--model", PAPER, "--trend", "none")
        self.assertEqual(found["warnings"], [], "half of it is no warning")
        settling_ms = 1e3 * found["band"]["settling_time_s"]
        self.assertGreater(settling_ms, 2.0)
        text = self.succeed("report", "--model", PAPER, "--trend", "none")
        in_band = text[text.index("IN-BAND ERROR"):]
        self.assertIn(f"5 % settling, in band     {settling_ms:.6f} ms", in_band)
        self.assertRegex(in_band, r"Note: T is shorter than the settling time in band, so the error has not developed within\n"
                                  rf"  T: give a T of {math.ceil(settling_ms * 100) / 100} ms or more")
        # That of the figure that leads, from the README, stands on the page; the text is that of a board, which has no time for it.
        self.assertNotIn("4.508", in_band)
        self.succeed("report", "--model", PAPER, "--trend", "none", "--out", "out")
        page = (self.directory / "out" / "report.html").read_text(encoding="utf-8")
        self.assertRegex(page, r"(?s)In-band error.*4\.508\d+ ms.*give a T of 4\.51 ms or more")
        enough = self.succeed("report", "--model", PAPER, "--trend", "none", "--time", "0.0046")
        self.assertNotIn("settling time in band", enough)

    def test_whose_chi_square_it_is(self):
        table = (DATA / "devices/piezo_a.csv").read_text()
        (self.directory / "t.csv").write_text(table + "# shared: leak=0.01\n")
        words = "with crosstalk, linearity and skew fitted, too, so not of the estimates above\n"
        self.assertIn(words, self.succeed("report", "--points", "t.csv", "--trend", "none", "--trials", "1000"))
        self.assertNotIn(words, self.succeed("report", "--points", DATA / "devices/piezo_a.csv", "--trend", "none", "--trials", "1000"))

    def test_delay_that_is_too_long_in_numbers(self):
        most = f"(at most {1e6 / (2 * math.pi * 1000):.1f} us)"
        self.refuse(["report", "--model", PAPER, "--criterion", "band", "--reference-delay", "1e-3"], most)

    def test_ideal_sensor_with_a_delay_given(self):
        # A sensor of 2 MHz and beta = 0.5 has a delay of 0.08 us and no other error that 100 us would not hide.
        options = ["--criterion", "band", "--reference-delay", "1e-4", "--trend", "none"]
        ideal = self.json_of("--model", PAPER, *options)["ideal"]
        fast = self.json_of("--model", "1.037,200000,0.05", *options)["band"]["matched"]
        self.assertAlmostEqual(ideal["rms_percent"], fast["rms_percent"], delta=0.002 * fast["rms_percent"])
        text = self.succeed("report", "--model", PAPER, *options)
        head = text[:text.index("WHAT WAS PUT IN")]
        self.assertIn("In band, given delay taken out", head)
        self.assertNotIn("constant delay", text)
        self.assertRegex(head, rf"The first of an ideal sensor, K = S +{ideal['rms_percent']:.2f} ")
        self.assertRegex(head, r"0 for an ideal sensor\n  with S = G, the filter's gain, but not with a delay given\.")
        # Without a number the delay is the sensor's own, and an ideal one has none.
        self.assertEqual(self.json_of("--model", PAPER, "--criterion", "band", "--trend", "none")["ideal"]["E"], 0)

    def test_star_at_the_rows_that_a_warning_is_about(self):
        text = self.succeed("report", "--model", PAPER, "--cutoff", "300", "--trend", "none")
        stars = re.findall(r"^  (In band, .*?|The .*?) {2,}(\*?) +[\d.]+ ", text[:text.index("WHAT WAS")], re.MULTILINE)
        self.assertEqual(stars, [("In band, constant delay taken out", "*"), ("In band, with its delay", "*"),
                                 ("The paper's figure, sqrt(E/T)", ""), ("The same of an ideal sensor, K = S", "")])

    def test_damping_left_open_has_no_uncertainty(self):
        found = self.json_of("--points", DATA / "tables" / "piezo_00.csv", *QUICK, "--time", "0.001")
        self.assertIsNone(found["model"]["ubeta"])
        self.assertEqual(len(found["fit"]["beta_range"]), 2)

    def test_delay_none_leads_with_the_delay(self):
        text = self.succeed("report", "--model", PAPER, "--trend", "none", "--reference-delay", "none", "--out", "out")
        self.assertLess(text.index("In band, with its delay"), text.index("In band, constant delay taken out"))
        page = (self.directory / "out" / "report.html").read_text(encoding="utf-8")
        self.assertRegex(page, r'class="first"><dt>Worst in-band error, with its delay')

    def test_one_uncertainty_of_the_in_band_error(self):
        for delay in ["auto", "none"]:
            found = self.json_of("--model", PAPER + ",0.003,6,0.0004", "--trials", "5000", "--trend", "none", "--criterion",
                                 "band", "--reference-delay", delay)
            figure = found["band"] if delay == "none" else found["band"]["matched"]
            self.assertEqual(found["uncertainty"]["U"], figure["U"])
            self.assertEqual(found["uncertainty"]["interval"], figure["interval"])

    def test_error_that_rounding_hides_leaves_those_in_band(self):
        # As good as the filter, a Butterworth one of order 2 with beta = 0.5^0.5: 1e-8 of its output is left.
        options = ["report", "--model", "0.1,1000,0.7071068", "--order", "2", "--trend", "none", "--time"]
        done = self.run_program(*options, "0.02", "--json")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr.decode(), r"^emax: --model: .* rounding hides it; .*; so E, trials and "
                                               r"trend are those of --criterion band\n$")
        found = json.loads(done.stdout)
        self.assertEqual((found["energy"]["criterion"], found["energy"]["delay_mode"]), ("band", "none"))
        # At f0 = fc K is -j/(2 beta), |K - 1| = 1.5^0.5, and the filter lets half of the power through: a sine of a leaves
        # an rms of 1.5^0.5/2 of a, and the worst signal has more.
        self.assertGreater(found["band"]["rms_percent"], 61.2)
        text = self.run_program(*options, "0.02").stdout.decode()
        self.assertIn("  WARNING: E, trials and trend are those of --criterion band: rounding hides the error asked for\n", text)
        self.assertNotRegex(text[:text.index("WHAT WAS PUT IN")], r"\*", "the figures of the band are as good as any")
        self.assertEqual([(w["about"], w["text"]) for w in found["warnings"]],
                         [("energy", "E, trials and trend are those of --criterion band: rounding hides the error asked for")])
        self.run_program(*options, "0.02", "--out", "out")
        page = html.unescape((self.directory / "out" / "report.html").read_text(encoding="utf-8"))
        self.assertRegex(page, r'class="warns"><dt>1 warning</dt><dd><ul><li>.*E, trials and trend are those of')
        self.assertNotIn("No warnings.", page)
        # Not where T is at fault, too: the words say so.
        self.refuse([*options, "1e-9"], "take a longer time, or")

    def test_refusal_of_a_time_too_short(self):
        text = self.succeed("report", "--model", "1,4073,0.3182", "--time", "1e-5", "--trend", "none")
        self.assertIn("T is too short beside the settling time for so small an error to develop; take a longer one.", text)
        # 4.1833 ms in results.json of the same device at 2 ms; by the envelope of the slowest pole 4.2 ms.
        self.assertRegex(text, r"take a longer one\.\n  The settling time is 4\.1\d+ ms\.\n")
        self.assertNotIn("order,", text[text.index("THE FIGURES"):text.index("WHAT WAS PUT IN")])

    def test_interval_in_the_place_of_u_of_the_energy(self):
        # A u(f0) of half of f0; trials with less energy than the filter, whose difference has no root.
        for options, row, is_below in [
                (["--model", "1,4073,0.3,0,2200,0.25"], r"The paper's figure, sqrt\(E/T\)", False),
                # Without u(S): each trial is in percent of its own S a.
                (["--model", "1,1000,0.5,0,300,0.1", "--criterion", "difference", "--gain", "1"],
                 r"The energy difference, sqrt\(E/T\)", True)]:
            common = [*options, "--trials", "2000", "--trend", "none"]
            text = self.succeed("report", *common, "--out", "out")
            found = json.loads((self.directory / "out" / "results.json").read_text(encoding="utf-8"))["uncertainty"]
            self.assertIs(found["U_percent"] is None, is_below)
            low, high = (100.0 * math.sqrt(max(end, 0.0) / 0.002) for end in found["shortest"])  # S = a = 1.
            shown = re.search(row + r" +(?:\* +)?[\d.]+ +([\d.]+) to ([\d.]+) ", text)
            self.assertTrue(shown, text[:2000])
            for end, given, least in [(low, float(shown[1]), high / 100), (high, float(shown[2]), high / 100)]:
                self.assertAlmostEqual(given, end, delta=max(least, 1.0))
            self.assertLessEqual(float(shown[1]), low)
            self.assertGreaterEqual(float(shown[2]), high)
            page = (self.directory / "out" / "report.html").read_text(encoding="utf-8")
            self.assertRegex(page, r"√\(E/T\)</dt><dd>[^<]*95 % interval ")

    def test_certify_says_how_long_a_time_it_takes(self):
        # 1000 cells, 10 for each period of 4073 Hz. Before the search, which would take minutes.
        device = ["certify", "--model", "1,4073,0.3182", "--effort", "0.1", "--rounds", "1", "--time"]
        self.refuse([*device, "1"], "emax: --time: ", "more cells than there is room for; expected at most 0.0245 s")
        self.succeed(*device, "0.0245")

    def test_certify_prints_a_gap_that_is_not_nothing(self):
        text = self.succeed("certify", "--model", "1,25000,0.02", "--criterion", "band", "--effort", "0.5", "--rounds", "5")
        self.assertRegex(text, r"\nGap +< 0\.001 % of the energy reached\n")

    def test_certify_names_the_device_in_all_digits(self):
        text = self.succeed("certify", "--model", "1,4073,0.99999995", "--rounds", "1")
        self.assertRegex(text, r"^Device .* beta = 0\.99999995\n")

    def test_certify_names_what_its_numbers_are(self):
        quick = ["certify", "--model", "1,4073,0.3182", "--rounds", "1"]
        text = self.succeed(*quick, "--criterion", "difference")
        self.assertIn("sqrt(E/T)   ", text)
        self.assertNotIn("RMS error", text)
        text = self.succeed(*quick, "--criterion", "band", "--order", "15", "--reference-delay", "none")
        self.assertRegex(" ".join(text.split()), r"give at least the settling time, 6\.\d\d? ms")

    def test_delays_are_told(self):
        quick = ["--model", PAPER, "--trend", "none"]
        of_sensor = 0.3182 / (math.pi * 4073.0)
        for options, energy, matched in [
            ([], ("none", 0.0), ("auto", of_sensor)),
            (["--criterion", "band"], ("auto", of_sensor), ("auto", of_sensor)),
            (["--criterion", "band", "--reference-delay", "none"], ("none", 0.0), ("auto", of_sensor)),
            (["--criterion", "band", "--reference-delay", "2e-5"], ("given", 2e-5), ("given", 2e-5)),
            (["--reference-delay", "2e-5"], ("none", 0.0), ("given", 2e-5)),
        ]:
            with self.subTest(options):
                found = self.json_of(*quick, *options)
                for part, (mode, time) in [(found["energy"], energy), (found["band"]["matched"], matched)]:
                    self.assertEqual(part["delay_mode"], mode)
                    self.assertAlmostEqual(part["delay_s"], time, delta=1e-15)
                self.assertIsNone(found["band_refused"])
        found = self.json_of(*quick, "--gain", "0")
        self.assertIsNone(found["band"])
        self.assertIn("gain above 0", found["band_refused"])

    def test_normal_trials_are_made_once(self):
        found = self.json_of(*MODEL, "--trials", "5000", "--trend", "none", "--distribution", "normal")
        box = self.json_of(*MODEL, "--trials", "5000", "--trend", "none")
        for name in ["u", "interval", "shortest"]:
            self.assertEqual(found["uncertainty"][name], found["monte_carlo"][name])
            self.assertEqual(found["uncertainty"][name], box["uncertainty"][name])
        self.assertNotEqual(found["monte_carlo"]["u"], box["monte_carlo"]["u"])
        text = [self.succeed("report", *MODEL, "--trials", "5000", "--trend", "none", *more) for more in
                ([], ["--distribution", "normal"])]
        # The paper's figure with its U, too, which comes of the roots of the trials' energies.
        rows = [re.search(r"The paper's figure.*", words).group() for words in text]
        self.assertEqual(rows[0], rows[1])


class FigureWords(ProgramTest):
    def test_report_and_page(self):
        text = self.succeed("report", "--model", PAPER + ",0.003,6,0.0004", "--trials", "20000", "--out", "out")
        page = html.unescape((self.directory / "out" / "report.html").read_text(encoding="utf-8"))
        page = re.sub(r"<[^>]*>", "|", page)
        # DESIGN: 1.196, 5.755, 148.7 and an ideal sensor's 148.2; U and bounds are looked at elsewhere.
        rows = [
            (r"  In band, constant delay taken out +1\.196 +0\.01\d +1\.\d+\n", "constant delay taken out (U, k = 2)",
             r"1\.196 % ± 0\.01\d %"),
            (r"  In band, with its delay +5\.755 +0\.02\d +5\.\d+\n", "Worst in-band error, with its delay",
             r"5\.755 % ± 0\.02\d %"),
            (r"  The paper's figure, sqrt\(E/T\) +148\.7\d +0\.\d\d +15\d\.\d\n", "The paper's figure, √(E/T)",
             r"148\.7\d % ± 0\.\d\d % of.S.a"),
        ]
        for line, name, value in rows:
            with self.subTest(name):
                self.assertRegex(text, line)
                self.assertRegex(page, re.escape(name) + r"\|+" + value)
        self.assertRegex(text, r"  The same of an ideal sensor, K = S +148\.2 +- +-\n")
        places = [text.index(row) for row in ("In band, constant delay", "In band, with its", "The paper's figure",
                                              "WHAT WAS PUT IN", "IN-BAND ERROR", "UNCERTAINTY OF E", "MONTE CARLO OF")]
        self.assertEqual(places, sorted(places), "the figures lead")
        in_band = text[text.index("IN-BAND ERROR"):text.index("UNCERTAINTY OF E")]
        for words in ["7.66114200e-06 V^2 s", "+a from the start, 1 switch, at (ms)\n                               0.639919",
                      "= 5.755 % of S a", "3.30567639e-07 V^2 s", "0.365145   0.946494", "= 1.196 % of S a",
                      # beta/(pi f0) = 24.868 us
                      "24.868 us, beta/(pi f0), the sensor's at low frequency", "u(S)/S = 0.289 %"]:
            self.assertIn(words, in_band)
        # DESIGN: u(E) is about 1.1e-5 over the box, and root 3 times that of normal parameters.
        self.assertRegex(text[text.index("UNCERTAINTY OF E"):text.index("MONTE CARLO OF")],
                         r"u\(E\); U \(k = 2\) +1\.[89]e-05;")
        self.assertRegex(text, r"none exceeds\n")
        self.assertIn("THE FIGURES (at the estimates;", text)
        for line in re.findall(r".*proven.*", text):
            self.assertIn("at the estimates", line)
        self.assertRegex(text, r"Std deviation over box +1\.1e-05 V\^2 s|Std deviation over box +1\.1\de-05")

    def test_in_band_figures_have_their_names_and_order(self):
        """Those of the table that leads the report, in front of the numbers that they are about."""
        names = {"matched": "In band, constant delay taken out", "band": "In band, with its delay"}
        for options, order in [([], ["matched", "band"]), (["--reference-delay", "none"], ["band", "matched"]),
                               (["--reference-delay", "2e-5"], ["given", "band"])]:
            with self.subTest(order=order):
                text = self.succeed("report", "--model", PAPER, "--trend", "none", *options)
                in_band = text[text.index("IN-BAND ERROR"):text.index("UNCERTAINTY OF E")]
                expected = [names.get(name, "In band, given delay taken out") for name in order]
                self.assertEqual(re.findall(r"^  (In band, .*)$", in_band, re.MULTILINE), expected)
                self.assertEqual(re.findall(r"^  (In band, .*?)  ", text[:text.index("WHAT WAS PUT IN")], re.MULTILINE), expected)
                found = self.json_of("--model", PAPER, "--trend", "none", *options)["band"]
                energies = [(found if name == "band" else found["matched"])["E"] for name in order]
                printed = re.findall(r"^  E  +(\S+) V\^2 s$", in_band, re.MULTILINE)
                self.assertEqual(printed, [f"{energy:.8e}" for energy in energies])

    def test_approximation_that_no_digit_shows_is_not_told(self):
        for order, is_told in [(10, False), (4, True)]:
            matched = self.json_of("--model", PAPER, "--trend", "none", "--order", order)["band"]["matched"]
            self.assertEqual(matched["epsilon_percent"] > 5e-6 * matched["rms_percent"], is_told)
            text = self.succeed("report", "--model", PAPER, "--trend", "none", "--order", order)
            self.assertNotIn("true delay", text)
            told = re.findall(r"  Approximation +of the delay: the true rms may differ by (\S+) % of S a\n", text)
            self.assertEqual(told, [f"{matched['epsilon_percent']:.2g}"] if is_told else [])

    def test_many_switches_are_counted_and_some_shown(self):
        options = ["--model", PAPER, "--trend", "none", "--time", "0.04"]
        switches = self.json_of(*options)["band"]["switches"]
        self.assertGreater(switches, 60)
        text = self.succeed("report", *options)
        block = text[text.index("  In band, with its delay\n"):]
        block = block[block.index("  Signal"):block.index("  Upper bound")].splitlines()
        self.assertEqual(block[0].split(None, 1)[1], f"+a from the start, {switches} switches, the first 60, at (ms)")
        self.assertEqual([len(line.split()) for line in block[1:]], [6] * 10)
        self.assertLessEqual(max(map(len, block)), 98)

    def test_page_of_the_in_band_error(self):
        self.succeed("report", "--model", PAPER + ",0.003,6,0.0004", "--trials", "1000", "--trend", "none", "--criterion", "band",
                     "--out", "out")
        page = html.unescape((self.directory / "out" / "report.html").read_text(encoding="utf-8"))
        for words in ["in-band error with the sensor's delay of 24.868", "k of the in-band error",
                      "what the filter passes of the sensor's response less that of an ideal sensor"]:
            self.assertIn(words, page)
        for words in ["k = ka", "less that of the reference filter", "sensor minus filter", "The paper's E"]:
            self.assertNotIn(words, page)

    def test_page_of_the_energy_difference(self):
        self.succeed("report", "--model", PAPER, "--trend", "none", "--criterion", "difference", "--out", "out")
        page = html.unescape((self.directory / "out" / "report.html").read_text(encoding="utf-8"))
        for words in ["The energy difference, as √(E/T)", "The energy difference is no error", "one between the limits may have"]:
            self.assertIn(words, page)
        self.assertNotIn("The paper's figure", page)


if __name__ == "__main__":
    main()
