"""`emax compare`: devices side by side, ranked only as far as their uncertainties carry."""

import csv
import html
import io
import json
import math
import os
import re
from xml.etree import ElementTree

from browser import Browser
from program_test import DATA, ProgramTest, main

ENERGY = ("--by", "energy")
SVG = "{http://www.w3.org/2000/svg}"
DEVICES = ["piezo_a", "piezo_b", "damped_c"]
CONDITIONS = {
    ("filter", "order"): (4, "filter order is 4, and 10 in"),
    ("filter", "cutoff"): (900, "cut-off is 900 Hz, and 1000 Hz in"),
    ("filter", "gain_mode"): ("track", "gain is track, and auto in"),
    ("energy", "a"): (1.5, "a is 1.5 m/s^2, and 1 m/s^2 in"),
    ("energy", "T"): (0.004, "T is 0.004 s, and 0.002 s in"),
    ("energy", "criterion"): ("difference", "criterion is difference, and ise in"),
    ("energy", "method"): ("paper", "method is paper, and best in"),
    ("uncertainty", "probability"): (0.9, "probability is 0.9, and 0.95 in"),
}


def figure(percent, u, unit, bound=None) -> dict:
    """An in-band figure in percent of S a; `unit` is T (S a)^2 in V^2 s."""
    energy = unit * (percent / 100) ** 2
    found = {"E": energy, "rms_percent": percent, "switch_times": [], "bound_percent": bound, "bound": None}
    u_energy = None if u is None or percent == 0 else 2 * energy * u / percent
    for suffix, value, standard in [("", energy, u_energy), ("_percent", percent, u)]:
        has_u = standard is not None
        found |= {
            "u" + suffix: standard,
            "U" + suffix: 2 * standard if has_u else None,
            "interval" + suffix: [value - 1.96 * standard, value + 1.96 * standard] if has_u else None,
        }
    return found


def result(energy=5e-3, u=1e-5, bound=None, device=None, serial=None, *, matched=1.0, band=5.0, u_band=0.01,
           S=2.0, a=1, refused=None, fit_warns=False, simulated=False) -> dict:
    """A results.json with what the comparison reads of it; `u` is that of E, `u_band` in percent of S a."""
    unit = 0.002 * (S * a) ** 2
    in_band = figure(band, u_band, unit) | {"matched": None, "matched_refused": refused}
    if refused is None:
        in_band["matched"] = figure(matched, u_band, unit) | {
            "delay_mode": "auto", "delay_s": 2.5e-5, "epsilon_percent": 1e-13}
    return {
        "version": "0.1.0",
        "labels": {"device": device, "serial": serial},
        "model": {"S": S},
        "filter": {"order": 10, "cutoff": 1000, "gain": S, "gain_mode": "auto"},
        "energy": {"criterion": "ise", "delay_mode": "none", "delay_s": 0, "method": "best", "T": 0.002, "a": a, "E": energy, "bound": bound},
        "band": in_band,
        "ideal": {"E": 5.08e-3, "rms_percent": 148.2106},
        "uncertainty": None
        if u is None
        else {"distribution": "normal", "probability": 0.95, "u": u, "U": 2 * u,
              "interval": [energy - 2 * u, energy + 2 * u], "shortest": [energy - 2 * u, energy + 2 * u], "redrawn": 0},
        "monte_carlo": None,
        "warnings": [{"about": "fit", "text": "chi2"}] if fit_warns else [],
        "simulated": simulated,
    }


def of_box(energy, u, distribution="box") -> dict:
    """A result as it was before the block of the uncertainty: with trials, and nothing of the band."""
    old = result(energy, None)
    for name in ["band", "ideal", "uncertainty", "warnings", "simulated"]:
        del old[name]
    old["monte_carlo"] = {"probability": 0.95, "distribution": distribution, "u": u,
                          "interval": [energy - u, energy + u]}
    return old


def ranks_of(energies, uncertainties) -> list[tuple[int, int]]:
    """Best and worst place of each, by counting those that k = 2 tells apart from it."""
    everyone = list(zip(energies, uncertainties))
    ranks = []
    for e, u in everyone:
        below = sum(e - other > 2 * math.hypot(u, v) for other, v in everyone)
        above = sum(other - e > 2 * math.hypot(u, v) for other, v in everyone)
        ranks.append((1 + below, len(everyone) - above))
    return ranks


class Comparing:
    def save(self, name, content) -> str:
        (self.directory / name).write_text(content if isinstance(content, str) else json.dumps(content))
        return name

    def compare(self, *results, by="energy"):
        names = [self.save(f"{i}.json", content) for i, content in enumerate(results)]
        return json.loads(self.succeed("compare", *names, "--by", by, "--json"))


class CompareDevices(Comparing, ProgramTest):
    def test_three_devices(self):
        """By the energy alone: reports without figures of the band are compared by that."""
        names = []
        for device in DEVICES:
            points = ["--points", DATA / f"devices/{device}.csv", "--reference-uncertainty", "0.5"]
            text = self.succeed("report", *points, "--limit", "1", "--trials", "20000", "--trend", "none", "--json")
            names.append(self.save(f"{device}.json", text))
        loaded = [json.loads((self.directory / name).read_text()) for name in names]
        found = json.loads(self.succeed("compare", *names, "--by", "energy", "--json"))
        # The parameters of a box have a standard deviation of u/sqrt(3).
        energies = {
            r["energy"]["E"]: (r.get("uncertainty") or {"u": math.sqrt(3) * r["monte_carlo"]["u"]})["u"] for r in loaded
        }
        ascending = sorted(energies)
        self.assertEqual([device["E"] for device in found["devices"]], ascending)
        self.assertEqual([device["file"] for device in found["devices"]][0], "damped_c.json")
        ranks = ranks_of(ascending, [energies[e] for e in ascending])
        self.assertEqual([(d["rank_best"], d["rank_worst"]) for d in found["devices"]], ranks)
        self.assertEqual(ranks, [(1, 1), (2, 3), (2, 3)])
        text = self.succeed("compare", *names, "--by", "energy")
        self.assertIn("damped_c.json and piezo_a.json: told apart", text)
        self.assertIn("piezo_a.json and piezo_b.json: CANNOT BE TOLD APART", text)
        self.assertLessEqual(max(map(len, text.splitlines())), 130)

    def test_ranks_and_pairs(self):
        energies, uncertainties = [5.00e-3, 5.05e-3, 5.10e-3, 6e-3], [2e-5, 2e-5, 2e-5, 1e-6]
        found = self.compare(*[result(e, u) for e, u in zip(energies, uncertainties)])
        expected = ranks_of(energies, uncertainties)
        # Neighbours cannot be told apart, the ends of the chain can.
        self.assertEqual(expected, [(1, 2), (1, 3), (2, 3), (4, 4)])
        self.assertEqual([(d["rank_best"], d["rank_worst"]) for d in found["devices"]], expected)
        self.assertEqual([pair["told_apart"] for pair in found["pairs"]], [False, False, True])
        self.assertAlmostEqual(found["pairs"][0]["difference"], 5e-5, delta=1e-18)
        self.assertAlmostEqual(found["pairs"][0]["U"], 2 * math.sqrt(2) * 2e-5, delta=1e-18)

    def test_uncertainty_of_the_box_where_there_is_no_other(self):
        found = self.compare(of_box(5e-3, 1e-5), of_box(6e-3, 2e-5, "normal"), result(7e-3, 3e-5))
        for device, u in zip(found["devices"], [math.sqrt(3) * 1e-5, 2e-5, 3e-5]):
            self.assertAlmostEqual(device["u"], u, delta=1e-18)
            self.assertAlmostEqual(device["U"], 2 * u, delta=1e-18)
        # An interval over the box is none of E.
        self.assertEqual([device["interval"] is None for device in found["devices"]], [True, False, False])
        text = " ".join(self.succeed("compare", *(f"{i}.json" for i in range(3)), "--by", "energy").split())
        self.assertIn("Note: u(E) is that over the box of the trials times the root of 3, without the correlation of S, f0 "
                      "and beta, for 0.json.", text)

    def test_figures(self):
        device = self.compare(result(8e-6), result(9e-6))["devices"][0]
        self.assertAlmostEqual(device["rms"], math.sqrt(8e-6 / 0.002), delta=1e-15)
        self.assertAlmostEqual(device["rms_percent"], 100 * math.sqrt(8e-6 / 0.002) / 2.0, delta=1e-12)

    def test_bound_proves_only_what_it_is_below(self):
        for bound, proven in [(5.4e-3, True), (5.6e-3, False), (None, False)]:
            with self.subTest(bound=bound):
                pairs = self.compare(result(5e-3, bound=bound), result(5.5e-3))["pairs"]
                self.assertEqual([pair["proven"] for pair in pairs], [proven])

    def test_no_rank_without_uncertainty(self):
        found = self.compare(result(5e-3, None), result(9e-3), result(2e-2))
        self.assertEqual([(d["rank_best"], d["rank_worst"]) for d in found["devices"]], [(1, 3), (1, 2), (2, 3)])
        self.assertIsNone(found["devices"][0]["u"])
        text = self.succeed("compare", "0.json", "1.json", *ENERGY)
        self.assertIn("CANNOT BE RANKED: no uncertainty is known for one of them", text)
        self.assertNotIn("nan", text)

    def test_equal_devices_share_a_rank(self):
        for by in ["matched", "band", "energy"]:
            found = self.compare(result(), result(), by=by)
            self.assertEqual([(d["rank_best"], d["rank_worst"]) for d in found["devices"]], [(1, 2), (1, 2)])

    def test_negative_energy_has_no_rms(self):
        both = [result(-1e-3), result(2e-3)]
        for each in both:
            each["energy"]["criterion"] = "difference"
        found = self.compare(*both)
        self.assertEqual([d["rms"] is None for d in found["devices"]], [True, False])
        self.assertNotIn("nan", self.succeed("compare", "0.json", "1.json", *ENERGY))

    def test_note_where_percent_disagrees(self):
        other = result(6e-3)
        other["model"]["S"] = 3.0
        self.compare(result(5e-3), other)
        self.assertIn("of S a the order is another one", self.succeed("compare", "0.json", "1.json", *ENERGY))
        # Not by a difference that the uncertainties do not carry.
        other["energy"]["E"] = 5.001e-3
        self.compare(result(5e-3), other)
        self.assertNotIn("another one", self.succeed("compare", "0.json", "1.json", *ENERGY))


class CompareInBand(Comparing, ProgramTest):
    """By the figures of the band, which do not depend on S and a."""

    def ranks(self, found) -> list[tuple]:
        return [(d["file"], d["rank_best"], d["rank_worst"]) for d in found["devices"]]

    def test_matched_is_the_default(self):
        one, other = result(5e-3, matched=2.0, band=3.0), result(4e-3, matched=1.0, band=6.0)
        self.save("0.json", one)
        self.save("1.json", other)
        by_default = self.succeed("compare", "0.json", "1.json", "--json")
        self.assertEqual(by_default, self.succeed("compare", "0.json", "1.json", "--by", "matched", "--json"))
        found = json.loads(by_default)
        self.assertEqual((found["asked_by"], found["ranked_by"]), ("matched", "matched"))
        self.assertEqual(self.ranks(found), [("1.json", 1, 1), ("0.json", 2, 2)])
        self.assertEqual(self.ranks(self.compare(one, other, by="band")), [("0.json", 1, 1), ("1.json", 2, 2)])
        self.assertEqual(self.ranks(self.compare(one, other, by="energy")), [("1.json", 1, 1), ("0.json", 2, 2)])

    def test_numbers_of_the_figure_that_ranks(self):
        files = [result(matched=1.196, band=5.755, u_band=0.004), result(matched=2.0, band=6.0, u_band=0.003)]
        files[0]["band"]["matched"]["bound_percent"] = 1.25
        device = self.compare(*files, by="matched")["devices"][0]
        self.assertEqual([device[name] for name in ["value", "u", "U", "bound"]], [1.196, 0.004, 0.008, 1.25])
        self.assertEqual(device["interval"], [1.196 - 1.96 * 0.004, 1.196 + 1.96 * 0.004])
        self.assertEqual([device[name] for name in ["matched_percent", "band_percent", "delay_s", "ideal_percent"]],
                         [1.196, 5.755, 2.5e-5, 148.2106])
        pair = self.compare(*files, by="band")["pairs"][0]
        self.assertAlmostEqual(pair["difference"], 0.245, delta=1e-15)
        self.assertAlmostEqual(pair["U"], 2 * 0.005, delta=1e-17)
        text = self.succeed("compare", "0.json", "1.json")
        # Two digits of U, and as many decimals of the rest.
        self.assertRegex(text, r"0\.json +1\.1960 +5\.7550 +\d+\.\d+ +0\.0080 +1\.1882 to 1\.2038 +1\.250\n")
        self.assertIn("an ideal sensor has 148.2 %", text)

    def test_ten_times_the_sensitivity_is_the_same_rank(self):
        files = [result(5e-3, matched=1.2), result(5e-1, 1e-3, matched=1.2, S=20.0, a=3), result(1e-6, matched=1.5, S=0.1)]
        found = self.compare(*files, by="matched")
        self.assertEqual(self.ranks(found), [("0.json", 1, 2), ("1.json", 1, 2), ("2.json", 3, 3)])
        self.save("1.json", result(5e-1, 1e-3, matched=1.2, S=20.0))
        found = self.compare(files[0], result(5e-1, 1e-3, S=20.0), by="energy")
        self.assertEqual(self.ranks(found), [("0.json", 1, 1), ("1.json", 2, 2)])

    def test_damping_in_percent_not_in_energy(self):
        """4073 Hz with beta 0.7 and 0.01 (0.13 and 1.62 % with the delay out): E favours the smaller S."""
        poor = result(1e-6, 1e-8, matched=1.62, band=1.65, S=0.01)
        good = result(5e-3, matched=0.13, band=11.75, S=1.0)
        self.assertEqual(self.ranks(self.compare(poor, good, by="matched")), [("1.json", 1, 1), ("0.json", 2, 2)])
        self.assertEqual(self.ranks(self.compare(poor, good, by="band")), [("0.json", 1, 1), ("1.json", 2, 2)])
        self.assertEqual(self.ranks(self.compare(poor, good, by="energy")), [("0.json", 1, 1), ("1.json", 2, 2)])

    def test_uncertainty_of_the_continued_filter_counts(self):
        files = [result(matched=1.0), result(matched=1.04)]
        self.assertTrue(self.compare(*files, by="matched")["pairs"][0]["told_apart"])
        for each in files:
            each["band"]["matched"]["epsilon_percent"] = 0.007
        pair = self.compare(*files, by="matched")["pairs"][0]
        self.assertEqual((pair["told_apart"], pair["epsilon"]), (False, 0.014))
        for each, bound in zip(files, [1.03, None]):
            each["band"]["matched"]["bound_percent"] = bound
        self.assertFalse(self.compare(*files, by="matched")["pairs"][0]["proven"])

    def test_matched_refused_for_one_is_refused_for_all(self):
        words = "epsilon is 3.9 % of the figure,\nabove 1 %"
        files = [result(matched=1.0, band=8.0), result(band=7.0, refused=words, device="B"), result(matched=3.0, band=6.0)]
        found = self.compare(*files, by="matched")
        self.assertEqual((found["asked_by"], found["ranked_by"]), ("matched", "band"))
        self.assertEqual(self.ranks(found), [("2.json", 1, 1), ("1.json", 2, 2), ("0.json", 3, 3)])
        self.assertEqual([d["matched_percent"] for d in found["devices"]], [3.0, None, 1.0])
        text = " ".join(self.succeed("compare", "0.json", "1.json", "2.json").split())
        self.assertIn("WARNING: All are ranked by the in-band error with the sensor's delay: there is no figure with the "
                      "delay taken out for B (epsilon is 3.9 % of the figure,?above 1 %).", text)
        self.assertIn("Ranked by in-band error with the sensor's delay", text)
        self.assertNotIn("All are ranked", self.succeed("compare", "0.json", "1.json", "2.json", "--by", "band"))

    def test_marked_devices_are_not_compared(self):
        """Two measurements of one device of which one has a bump of 1 %: chi-square warns of it."""
        files = [result(matched=1.0, device="good"), result(matched=1.5, device="bump", fit_warns=True),
                 result(matched=2.0, device="other")]
        for by in ["matched", "band", "energy"]:
            for i, each in enumerate(files):
                energy = (1 + i) * 1e-3
                each["energy"]["E"] = energy
                each["uncertainty"] |= {"interval": [energy - 2e-5, energy + 2e-5], "shortest": [energy - 2e-5, energy + 2e-5]}
                each["band"] |= figure(5.0 + i, 0.01, 0.002 * 4)
            found = self.compare(*files, by=by)
            self.assertEqual(self.ranks(found), [("0.json", 1, 2), ("1.json", 1, 3), ("2.json", 2, 3)])
            self.assertEqual([(p["compared"], p["told_apart"], p["proven"]) for p in found["pairs"]],
                             [(False, False, False)] * 2)
            self.assertEqual(found["pairs"][0]["not_compared"], "chi-square of the fit of bump warns")
            self.assertEqual([d["fit_warns"] for d in found["devices"]], [False, True, False])
            text = self.succeed("compare", "0.json", "1.json", "2.json", "--by", by)
            self.assertIn("good and bump: CANNOT BE TOLD APART: chi-square of the fit of bump warns", text)
            self.assertNotIn("told apart:", text)
            self.assertRegex(text, r"\n  1-3   bump    fit +\S")
            self.assertNotIn("SIMULATION", text)

    def test_simulated_bench(self):
        files = [result(matched=1.0, device="good"), result(matched=3.0, device="toy", simulated=True)]
        pair = self.compare(*files, by="matched")["pairs"][0]
        self.assertEqual((pair["told_apart"], pair["not_compared"]), (False, "the bench of toy was simulated"))
        files[1] = result(matched=3.0, device="toy", simulated=True, fit_warns=True)
        files[0]["band"]["matched"]["bound_percent"] = 1.1
        found = self.compare(*files, by="matched")
        self.assertEqual(self.ranks(found), [("0.json", 1, 2), ("1.json", 1, 2)])
        self.assertEqual([d["simulated"] for d in found["devices"]], [False, True])
        self.assertFalse(found["pairs"][0]["proven"])
        text = self.succeed("compare", "0.json", "1.json")
        self.assertIn("TOLD APART: chi-square of the fit of toy warns; the bench of toy", " ".join(text.split()))
        self.assertRegex(text, r"(?m)^COMPARISON OF .*\n  SIMULATION: not every result was measured on a real bench$")
        self.assertRegex(text, r"\n  1-2   toy     fit sim +\S")
        self.compare(files[1], files[1] | {"labels": {}}, by="matched")
        self.assertIn("SIMULATION: no result was measured", self.succeed("compare", "0.json", "1.json"))

    def test_open_damping_without_a_range(self):
        """It has the place of its figure, and none of the others is told apart from it."""
        for by in ["matched", "energy"]:
            found = self.compare(open_one(1.0), result(5e-3, matched=3.0, device="good"),
                                 result(9.5e-3, matched=9.0, device="poor"), by=by)
            self.assertEqual(self.ranks(found), [("0.json", 1, 3), ("1.json", 1, 2), ("2.json", 2, 3)])
            self.assertEqual([(p["compared"], p["told_apart"], p["proven"]) for p in found["pairs"]],
                             [(True, False, False), (True, True, False)])
            self.assertEqual([d["damping_open"] for d in found["devices"]], [True, False, False])
            text = self.succeed("compare", "0.json", "1.json", "2.json", "--by", by)
            self.assertIn("WARNING: Told apart from no other, because the points leave the damping open: open.", text)
            self.assertIn("open and good: CANNOT BE TOLD APART: the points of open leave its damping open, and no range of "
                          "the figure that ranks is known; emax report --damping takes the damping that a maker states",
                          " ".join(text.split()))
            self.assertRegex(text, r"\n  1-3   open    beta +\S")
            self.assertIsNone(found["devices"][0]["range"])

    def test_ranges_of_an_open_damping_rank(self):
        """Ahead is whose greatest figure is below the least of the other: 'good' has 3 +- 0.1, so from 2.9 on."""
        good, poor = result(5e-3, 5e-5, matched=3.0, u_band=0.05, device="good"), result(
            9.5e-3, 5e-5, matched=9.0, u_band=0.05, device="poor")
        for by, key, ends in [("matched", "matched", [(2.89, True), (2.91, False), (3.5, False)]),
                              ("energy", "energy", [(4.89e-3, True), (4.91e-3, False), (6e-3, False)])]:
            for most, is_ahead in ends:
                with self.subTest(by=by, most=most):
                    found = self.compare(open_one(1.0, **{key: [0.1 * most, most]}), good, poor, by=by)
                    self.assertEqual(self.ranks(found), [("0.json", 1, 1 if is_ahead else 2),
                                                         ("1.json", 2 if is_ahead else 1, 2), ("2.json", 3, 3)])
                    pair = found["pairs"][0]
                    self.assertEqual((pair["told_apart"], pair["proven"], pair["U"]), (is_ahead, False, None))
                    self.assertEqual(found["devices"][0]["range"], [0.1 * most, most])
                    text = " ".join(self.succeed("compare", "0.json", "1.json", "2.json", "--by", by).split())
                    self.assertIn("WARNING: The points leave the damping open: open.", text)
                    self.assertIn("what tells it apart is its range over these dampings", text)
                    verdict = "told apart" if is_ahead else "CANNOT BE TOLD APART"
                    self.assertRegex(text, f"open and good: {verdict}: open has [0-9.e-]+ to [0-9.e-]+ .* over the dampings that "
                                           "its points leave open, and good has ")
                    # An estimate does not put it behind what its range may reach below.
        found = self.compare(good, open_one(4.0, matched=[2.0, 6.0]), poor, by="matched")
        self.assertEqual(self.ranks(found), [("0.json", 1, 2), ("1.json", 1, 2), ("2.json", 3, 3)])
        found = self.compare(good, open_one(4.0, matched=[3.2, 6.0]), poor, by="matched")
        self.assertEqual(self.ranks(found), [("0.json", 1, 1), ("1.json", 2, 2), ("2.json", 3, 3)])

    def test_two_ranges_that_touch(self):
        for least, apart in [(2.01, True), (1.99, False)]:
            other = open_one(3.0, matched=[least, 4.0])
            found = self.compare(open_one(1.0, matched=[0.5, 2.0]), other, by="matched")
            self.assertEqual(found["pairs"][0]["told_apart"], apart)

    def test_ranges_that_are_none(self):
        for ends, words in [([2.0, 1.0], "ends below its beginning"), ("wide", "is no interval"), ([1.0], "is no interval")]:
            self.save("0.json", open_one(1.0, matched=ends))
            self.save("1.json", result(matched=3.0))
            self.refuse(["compare", "0.json", "1.json"], f"0.json: band.matched.range_percent {words}")

    def test_range_of_open_damping_in_percent(self):
        """sqrt(E/T)/(S a) as in a report: 1e-3 and 9e-3 V^2 s in 2 ms are 0.7071 and 2.121 V."""
        open_one = result(2e-3, None, matched=1.0, u_band=None, device="open", S=1.0, a=1) | {
            "fit": {"determined": "all but beta", "E_range": [1e-3, 9e-3]},
            "warnings": [{"about": "damping", "text": "the points do not determine beta"}]}
        self.compare(open_one, result(5e-3, matched=3.0, device="good", S=1.0, a=1), by="matched")
        self.assertIn("; over the range the paper's figure of open is 70.71 to 212.1 % of S a.",
                      " ".join(self.succeed("compare", "0.json", "1.json").split()))

    def test_marks_have_to_be_there(self):
        for name, words in [("warnings", "warnings is no list"), ("simulated", "simulated is neither true nor false")]:
            cut = result(matched=3.0)
            del cut[name]
            self.save("0.json", result(matched=1.0))
            self.save("1.json", cut)
            self.refuse(["compare", "0.json", "1.json"], f"1.json: {words}; expected a results.json of emax report")

    def test_warnings_of_the_reports(self):
        files = [result(matched=1.0, device="A"), result(matched=3.0, device="B"), result(matched=5.0, device="C")]
        files[0]["warnings"] = files[2]["warnings"] = [{"about": "fit_draws", "text": "u is \x1bdoubtful"}]
        found = self.compare(*files, by="matched")
        self.assertEqual(self.ranks(found), [("0.json", 1, 1), ("1.json", 2, 2), ("2.json", 3, 3)])
        text = self.succeed("compare", "0.json", "1.json", "2.json")
        self.assertEqual(text.count("WARNING"), 1)
        self.assertRegex(text, "WARNING: The report of A and C warns: u is .doubtful\\.")
        self.assertNotIn("\x1b", text)

    def test_other_warnings_are_no_marks(self):
        files = [result(matched=1.0), result(matched=3.0)]
        files[0]["warnings"] = [{"about": "monte_carlo", "text": "fit"}]
        self.assertTrue(self.compare(*files, by="matched")["pairs"][0]["told_apart"])

    def test_marks_of_results_that_have_none_yet(self):
        """chi2/dof against what one fit in a hundred exceeds (1.66 for 40 degrees of freedom), and the bench's truth."""
        for chi2, warns in [(1.5 * 40, False), (835.0 * 40, True)]:
            old = of_box(6e-3, 1e-5)
            old["model"] |= {"chi2": chi2, "dof": 40}
            self.assertEqual(self.compare(of_box(5e-3, 1e-5), old)["devices"][1]["fit_warns"], warns)
        old = of_box(6e-3, 1e-5) | {"bench": {"seed": 1, "truth": {"S": 1.0}}}
        self.assertEqual([d["simulated"] for d in self.compare(of_box(5e-3, 1e-5), old)["devices"]], [False, True])

    def test_no_uncertainty_in_band(self):
        found = self.compare(result(matched=1.0, u_band=None), result(matched=2.0), by="matched")
        self.assertEqual(self.ranks(found), [("0.json", 1, 2), ("1.json", 1, 2)])
        text = self.succeed("compare", "0.json", "1.json")
        self.assertIn("CANNOT BE RANKED", text)
        self.assertIn("Without both: its report has no", text)
        # The legend explains what there is.
        self.compare(result(matched=1.0, u_band=None), result(matched=2.0, u_band=None), by="matched")
        text = self.succeed("compare", "0.json", "1.json")
        self.assertRegex(text, r"U\(matched\), interval: none, as no report has an uncertainty")
        self.assertNotIn("expanded uncertainty (k = 2)", text)

    def test_ranks_are_explained_where_they_are_shared(self):
        self.compare(result(matched=1.0), result(matched=2.0), by="matched")
        self.assertNotIn("  rank: ", self.succeed("compare", "0.json", "1.json"))
        self.compare(result(matched=1.0), result(matched=1.0), by="matched")
        self.assertIn("  rank: 1-2 is first or second", self.succeed("compare", "0.json", "1.json"))

    def test_rounding_is_no_figure(self):
        noise = 7.7e-13
        self.compare(result(matched=1.2, u_band=noise), result(matched=1.2 + 2 * noise, u_band=noise), by="matched")
        text = self.succeed("compare", "0.json", "1.json", "--out", "cmp")
        self.assertIn("the difference is 0 but for rounding", text)
        self.assertRegex(text, r"0\.json +1\.200 +5\.000 +\S+ +0 +1\.200 to 1\.200 +-\n")
        page = (self.directory / "cmp" / "comparison.html").read_text(encoding="utf-8")
        for words in [text, page]:
            self.assertNotRegex(words, r"0\.0000000|e-1[0-9]|<sup>−1[0-9]")

    def test_a_delay_given_is_an_error_of_an_ideal_sensor(self):
        both = [result(matched=1.0), result(matched=2.0)]
        for each in both:
            each["band"]["matched"]["delay_mode"] = "given"
        self.compare(*both, by="matched")
        text = " ".join(self.succeed("compare", "0.json", "1.json").split())
        self.assertRegex(text, r"a delay of 25 us taken out, in percent of S a\. in band %: the same with the sensor's delay\. "
                               r"An ideal sensor has 0 there\.")


def one_sided(percent, high, low=0.0) -> dict:
    """What a matched figure at the low end of its interval has: a half-normal distribution above it."""
    u = (high - percent) / 1.96 * math.sqrt(1 - 2 / math.pi)
    return {"rms_percent": percent, "u_percent": u, "U_percent": 2 * u, "shortest_percent": [low, high],
            "interval_percent": [percent + 0.016 * high, 1.14 * high]}


class CompareOnOneSide(Comparing, ProgramTest):
    """Figures that their delay leaves at one end of their intervals."""

    def pair(self, *others) -> dict:
        files = [result(matched=1.0) for _ in others]
        for file, other in zip(files, others):
            file["band"]["matched"] |= other
        return self.compare(*files, by="matched")["pairs"][0]

    def test_told_apart_by_intervals(self):
        both_sides = figure(0.020, 0.0001, 1.0)
        # Zou and Donner: 0.0199 - sqrt(0.0239^2 + 0.0002^2) and the like.
        for first, second, low, apart in [
            (one_sided(0.0001, 0.024), both_sides, 0.0199 - math.hypot(0.0239, 0.0002), False),
            (one_sided(0.0001, 0.018), both_sides, 0.0199 - math.hypot(0.0179, 0.0002), True),
            (both_sides, one_sided(0.0203, 0.05, 0.0203), 0.0003 - 0.0002, True),
            (both_sides, one_sided(0.0201, 0.05, 0.0201), 0.0001 - 0.0002, False),
            (one_sided(0.0001, 0.024), one_sided(0.023, 0.05, 0.023), 0.0229 - 0.0239, False),
        ]:
            with self.subTest(first=first["rms_percent"], second=second["rms_percent"]):
                pair = self.pair(first, second)
                self.assertEqual(pair["told_apart"], apart)
                self.assertAlmostEqual(pair["interval"][0], low, delta=1e-12)

    def test_small_probabilities_tell_no_more_apart_than_u(self):
        files = [result(matched=1.0), result(matched=1.0)]
        files[0]["band"]["matched"] |= one_sided(0.0001, 0.010)
        files[1]["band"]["matched"] |= figure(0.0115, 0.0001, 1.0)
        files[0]["band"]["matched"]["U_percent"] = 0.012
        self.assertTrue(self.compare(*files, by="matched")["pairs"][0]["told_apart"])
        for file in files:
            file["uncertainty"]["probability"] = 0.8
        self.assertFalse(self.compare(*files, by="matched")["pairs"][0]["told_apart"])

    def test_words_page_and_picture(self):
        files = [result(matched=1.0, device="A"), result(matched=1.0, device="B")]
        files[0]["band"]["matched"] |= one_sided(0.0001385, 0.0239)
        files[1]["band"]["matched"] |= figure(0.01991, 0.0001, 1.0)
        for i, file in enumerate(files):
            self.save(f"{i}.json", file)
        text = self.succeed("compare", "0.json", "1.json", "--out", "out")
        self.assertRegex(text, r"\n  1-2   A +0\.0001385 .* - +0 to 0\.024 +-\n")
        self.assertIn("its interval from -0.0040 to 0.020 % of S a", " ".join(text.split()))
        self.assertIn("The delay taken out stays that of the estimate", " ".join(text.split()))
        page = (self.directory / "out/comparison.html").read_text(encoding="utf-8")
        self.assertIn("<dt>Least error found (interval)</dt><dd>0.0001385 (0 to 0.024) % of S&nbsp;a</dd>", page)
        headline = page[page.index('<dl class="headline">'):page.index("</dl>")]
        self.assertNotRegex(headline, "[\u2212-]0|0\\.0+[ <]")
        # Value, ends of the bar, bound, and row; the lower end no lower than the axis.
        script = (self.directory / "out/comparison.gp").read_text(encoding="utf-8")
        value, low, high = map(float, re.search(r"END\n(\S+) (\S+) (\S+) ", script).groups())
        axis = [float(end) for end in re.search(r"xrange \[(\S+):(\S+)\]", script).groups()]
        self.assertEqual((value, high), (0.0001385, 0.0239))
        self.assertTrue(axis[0] <= low < value and high < axis[1])


class CompareOutput(Comparing, ProgramTest):
    def test_csv_and_odd_labels(self):
        odd = 'say "hi", <b>&amp;</b>\nnext'
        self.compare(result(5e-3, device=odd, serial="12;3"), result(6e-3, None, device="x" * 10_000))
        text = self.succeed("compare", "0.json", "1.json", "--csv", *ENERGY)
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
        self.assertEqual([row["device"] for row in rows], [odd.replace("\n", " "), "x" * 10_000])
        self.assertEqual([row["serial"] for row in rows], ["12;3", ""])
        self.assertEqual([float(row["E"]) for row in rows], [5e-3, 6e-3])
        self.assertEqual([row["u"] for row in rows][1], "")
        text = self.succeed("compare", "0.json", "1.json", *ENERGY)
        self.assertIn('say "hi", <b>&amp;</b>?next 12;3', text)
        self.assertLess(len(text), 4000)

    def test_labels_are_no_formulas_and_no_control_characters(self):
        odd = ["=cmd|' /C calc'!A0", "+1", "-2", "@SUM(1)", " =3", "a\x1b[31mb\tc\x7f", "\u0085\u202e=4"]
        self.compare(*(result((5 + i) * 1e-3, device=name, serial=name) for i, name in enumerate(odd)))
        names = [f"{i}.json" for i in range(len(odd))]
        text = self.run_program("compare", *names, "--csv").stdout.decode()
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
        expected = ["'" + name for name in odd[:-2]] + ["a [31mb c ", "'  =4"]
        self.assertEqual(sorted(row["device"] for row in rows), sorted(expected))
        self.assertEqual(sorted(row["serial"] for row in rows), sorted(expected))
        self.assertFalse(any(ord(c) < 32 for c in text.replace("\n", "")))

    def test_formulas_behind_any_blank_are_text(self):
        odd = {"\t=1": "' =1", "\r\n+2": "'  +2", "\u00a0@3": "'\u00a0@3", " \u2003\u3000-4": "' \u2003\u3000-4",
               "\uff1d5": "'\uff1d5", "\u2009x=6": "\u2009x=6"}
        self.compare(*(result((5 + i) * 1e-3, device=name) for i, name in enumerate(odd)))
        text = self.run_program("compare", *(f"{i}.json" for i in range(len(odd))), "--csv").stdout.decode()
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
        self.assertEqual(sorted(row["device"] for row in rows), sorted(odd.values()))

    def test_csv_has_the_figure_that_ranks_and_the_others(self):
        files = [result(5e-3, bound=6e-3, matched=1.5, S=3.0, fit_warns=True, simulated=True), result(6e-3, matched=2.0, S=1.5)]
        self.compare(*files)
        for by, value, unit in [("matched", "1.5", "value"), ("band", "5", "value"), ("energy", "0.005", "E")]:
            rows = list(csv.DictReader(io.StringIO(self.succeed("compare", "0.json", "1.json", "--csv", "--by", by))))
            row = next(row for row in rows if row["file"] == "0.json")
            self.assertEqual((row["ranked_by"], row["value"], row[unit]), (by, value, value))
            self.assertEqual((row["matched_percent"], row["band_percent"], row["E"]), ("1.5", "5", "0.005"))
            self.assertEqual((row["S"], row["a"], row["mark"]), ("3", "1", "fit sim"))
            self.assertEqual(float(row["U"]), 2 * float(row["u"]))
            self.assertLess(float(row["low"]), float(row["value"]))
            self.assertEqual(row["bound"], "0.006" if by == "energy" else "")

    def test_columns_stand_below_one_another(self):
        long = "a long name " * 5
        names = ["\u00c4\u00d6\u00dc \u0416\u2126", "plain", long + "17", long + "18", "\U0001F600" * 300]
        columns = [("E in V^2 s", r"5\.\d{3}e-03"), ("U(E)", r"2\.0e-05"), ("bound", r"6\.000e-03")]
        for count in [5, 120]:  # Ranks of up to seven characters.
            for i in range(count):
                self.save(f"{i}.json", result(5e-3 + 1e-9 * i, bound=6e-3, device=names[i % 5], fit_warns=i == 3))
            text = self.run_program("compare", *(f"{i}.json" for i in range(count)), *ENERGY).stdout.decode()
            lines = text.splitlines()
            self.assertLessEqual(max(map(len, lines)), 130)
            head = next(line for line in lines if line.startswith("  rank"))
            rows = [line for line in lines if re.search(r"e-03 to 5\.", line)]
            self.assertEqual(len(rows), count)
            for row in rows:
                # The end of each heading is that of its numbers.
                for title, number in columns:
                    self.assertRegex(row[: head.index(title) + len(title)], f" {number}$")
            # A name goes on below, to its end.
            table = text.split("  rank ")[1].split("\n\n")[0]
            self.assertRegex(table, r"\n +(a long |long |name |a )+17[ \n]")
            self.assertNotIn("...a", table)

    def test_bound_in_fewer_digits_is_a_bound(self):
        self.compare(result(bound=5.12341e-3), result(6e-3))
        self.assertIn(" 5.124e-03", self.succeed("compare", "0.json", "1.json", *ENERGY))

    def test_files(self):
        self.compare(result(), result(6e-3))
        printed = self.succeed("compare", "0.json", "1.json", "--out", "out")
        self.assertEqual((self.directory / "out/comparison.txt").read_text(), printed)
        self.assertEqual(sorted(os.listdir(self.directory / "out")), [
            "comparison.csv", "comparison.gp", "comparison.html", "comparison.json", "comparison.svg",
            "comparison.txt"])
        for option, name in [("--csv", "comparison.csv"), ("--json", "comparison.json")]:
            self.assertEqual((self.directory / "out" / name).read_text(),
                             self.succeed("compare", "0.json", "1.json", option))

    def test_full_disk(self):
        self.compare(result(), result(6e-3))
        with open("/dev/full", "wb") as full:
            self.refuse(["compare", "0.json", "1.json"], "standard output: No space left", status=3, stdout=full)

    def test_help(self):
        text = self.succeed("compare", "--help")
        self.assertLessEqual(max(map(len, text.splitlines())), 80)
        for option in ["--by FIGURE", "--csv", "--json", "--out DIR"]:
            self.assertIn(f"  {option} ", text)
        self.assertIn("(default matched)", text)
        self.assertIn("comparison.html", text)


def open_one(value, matched=None, energy=None):
    """A report whose points leave the damping open, with ranges of its figures or without."""
    found = result(2e-3, None, matched=value, u_band=None, bound=2.1e-3, device="open") | {
        "fit": {"determined": "all but beta"} | ({} if energy is None else {"E_range": energy}),
        "warnings": [{"about": "damping", "text": "the points do not determine beta"}]}
    found["band"]["matched"] |= {"bound_percent": 1.01 * value} | ({} if matched is None else {"range_percent": matched})
    return found


class ComparePictures(Comparing, ProgramTest):
    def test_bar_of_an_open_damping(self):
        for ends, words in [([0.5, 2.0], ["over the dampings left open", "the same, and its range over the dampings left open"]),
                            (None, ["damping not known", "the same, told apart from no other"])]:
            drawn = self.draw(open_one(1.0, matched=ends), result(matched=3.0))
            for each in words:
                self.assertIn(each, drawn)
            low, high = ends or (1.0, 1.0)
            self.assertRegex((self.directory / "out/comparison.gp").read_text(), rf"\n1 {low:g} {high:g} 1.01 ")
        drawn = self.draw(open_one(1.0, matched=[0.5, 2.0]), open_one(3.0))
        self.assertIn("the same, or its range, or told apart from no other: see its name", drawn)

    def draw(self, *results, options=()):
        names = [self.save(f"{i}.json", content) for i, content in enumerate(results)]
        done = self.run_program("compare", *names, "--out", "out", *options)
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        root = ElementTree.parse(self.directory / "out/comparison.svg").getroot()
        return ["".join(text.itertext()).strip() for text in root.iter(SVG + "text")]

    def test_names_and_axis(self):
        odd = "it's <b>\u03b2 & 'co'</b>"
        drawn = self.draw(result(5e-3, bound=5.5e-3, device=odd), result(6e-3, None, device="'quoted'"), options=ENERGY)
        self.assertIn("1-2  " + odd, drawn)
        self.assertIn("1-2  'quoted'", drawn)
        self.assertIn("E in 10\u207b\u00b3 V\u00b2 s", drawn)
        drawn = self.draw(result(matched=1.0), result(matched=2.0))
        self.assertIn("1  0.json", drawn)
        self.assertIn("rms error in % of S\u00b7a", drawn)

    def test_names_are_wrapped_and_cut_at_the_end_only(self):
        long = "Accelerometer of a maker with a rather long name, type 4711"
        drawn = self.draw(result(matched=1.0, device=long, serial="SN 12"), result(matched=2.0, device="\u00fc" * 300))
        at = next(i for i, line in enumerate(drawn) if line.startswith("1  "))
        self.assertEqual(" ".join(drawn[at:at + 3]), "1  " + long + " SN 12")
        # A name without blanks: 200 characters of it, and that there was more.
        lines = [line.strip("2 ") for line in drawn if "\u00fc" in line]
        self.assertEqual([line.strip("\u00fc") for line in lines], [""] * (len(lines) - 1) + ["\u2026"])
        self.assertAlmostEqual(sum(map(len, lines)), 200, delta=3)

    def test_lines_begin_with_a_quote(self):
        """gnuplot 5.4 reads a doubled quote at the start of a string as its end."""
        drawn = self.draw(result(matched=1.0, device="a" * 26 + " 'b' c"), result(matched=2.0, device="''"))
        self.assertIn("'b' c", drawn)
        self.assertIn("2  ''", drawn)

    def test_axis_is_logarithmic_where_values_span_decades(self):
        for largest, logarithmic in [(0.29, False), (0.31, True), (30.0, True)]:
            drawn = self.draw(result(matched=0.01, u_band=0.02), result(matched=largest, u_band=1e-4))
            script = (self.directory / "out/comparison.gp").read_text()
            self.assertEqual("set logscale x" in script, logarithmic)
        # Marks of four decades, and the bar that would go below 0 ends on the axis.
        numbers = [float(text) for text in drawn if re.fullmatch(r"[0-9.]+", text)]
        self.assertTrue({0.01, 0.1, 1, 10} <= set(numbers), numbers)
        row = script.split("$devices << END\n")[1].splitlines()[0].split()
        self.assertEqual(float(row[0]), 0.01)
        self.assertTrue(0 < float(row[1]) < 0.01)
        # Nothing below 0 on it.
        self.draw(result(matched=0.0), result(matched=1.0))
        self.assertNotIn("set logscale x", (self.directory / "out/comparison.gp").read_text())

    def test_marks(self):
        drawn = self.draw(result(matched=1.0, fit_warns=True), result(matched=1.1), result(matched=1.2, simulated=True))
        for words in ["fit warns: not told apart", "simulated: not told apart", "the same, told apart from no other"]:
            self.assertIn(words, drawn)
        self.assertTrue(drawn[0].startswith("SIMULATION: ") or any(d.startswith("SIMULATION: ") for d in drawn))
        drawn = self.draw(result(matched=1.0), result(matched=1.1))
        self.assertFalse(any("compared" in line or "SIMULATION" in line for line in drawn), drawn)
        drawn = self.draw(result(matched=1.0, fit_warns=True), result(matched=1.1, fit_warns=True))
        self.assertIn("the same, told apart from no other", drawn)

    def test_conditions(self):
        both = [result(-5e-3), result(6e-3)]
        for each in both:
            each["energy"] |= {"criterion": "difference", "method": "paper"}
        self.draw(*both, options=ENERGY)
        picture = (self.directory / "out/comparison.svg").read_text(encoding="utf-8")
        self.assertIn("filter of order 10, 1000 Hz, energy difference, paper's method<", html.unescape(picture))
        self.assertRegex(picture, r">\s*\u2212\d")  # The axis has minus signs.
        self.assertNotRegex(picture, r">\s*-\d")

    def test_picture_of_many_shows_the_first(self):
        drawn = self.draw(*(result(matched=1.0 + i, u_band=1e-3) for i in range(50)))
        self.assertIn("40  39.json", drawn)
        self.assertNotIn("41  40.json", drawn)

    def test_names_are_whole(self):
        """In the picture, on the page, in the text: up to 240 characters, in lines."""
        name, serial = "Piezoelectric shear accelerometer of the second laboratory, mounted on the large", "4711/2024-05-01/B"
        drawn = self.draw(result(matched=1.0, device=name, serial=serial), result(matched=1.001, device=name, serial="4712"))
        self.assertEqual(drawn.count("\u2026"), 0)
        page = html.unescape((self.directory / "out/comparison.html").read_text(encoding="utf-8"))
        text = " ".join((self.directory / "out/comparison.txt").read_text(encoding="utf-8").split())
        for where in [page, text]:
            self.assertIn(f"{name} {serial} and {name} 4712", where)
        self.assertNotIn("...", text)

    def test_no_gnuplot(self):
        self.compare(result(), result(6e-3))
        done = self.run_program("compare", "0.json", "1.json", "--out", "out", env={"PATH": "/nowhere"})
        self.assertEqual(done.returncode, 0)
        self.assert_one_line(done.stderr, "gnuplot")
        self.assertNotIn("comparison.svg", os.listdir(self.directory / "out"))
        self.assertIn("comparison.gp", os.listdir(self.directory / "out"))
        page = (self.directory / "out/comparison.html").read_text(encoding="utf-8")
        self.assertIn("No picture: gnuplot was missing", page)
        self.assertTrue(page.endswith("</html>\n"))


class ComparePage(Comparing, ProgramTest):
    NASTY = "\"q\" 'q' <b>&amp; <script>alert(1)</script> ^2 +- 1e-05 \u202e \\n javascript:x http://example.org/"

    def page(self, *results, options=()) -> str:
        names = [self.save(f"{i}.json", content) for i, content in enumerate(results)]
        done = self.run_program("compare", *names, "--out", "out", *options)
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        return (self.directory / "out/comparison.html").read_text(encoding="utf-8")

    def test_figures_and_verdicts(self):
        page = self.page(result(matched=1.196, u_band=0.004, device="DJB A/1800/V"), result(matched=2.0, device="B"))
        self.assertIn("<title>Comparison of 2 accelerometers - emax</title>", page)
        self.assertIn("<dt>Smallest error</dt><dd>DJB A/1800/V</dd>", page)
        self.assertIn("<dd>1.1960 ± 0.0080 % of S&nbsp;a</dd>", page)
        self.assertIn("<th scope=\"row\">DJB A/1800/V and B</th><td>told apart: the difference is 0.804 % of S a", page)
        self.assertIn("<svg", page)
        self.assertNotIn("SIMULATION", page)
        page = self.page(result(matched=1.196, device="A"), result(matched=1.197, device="B"))
        self.assertIn("<dt>Smallest error: the results do not say which one's</dt><dd>A or B</dd>", page)
        self.assertIn("<strong>CANNOT BE TOLD APART</strong>", page)

    def test_powers_of_ten_as_in_print(self):
        page = self.page(result(5e-3, 1e-5), result(6e-3, 1e-5), options=ENERGY)
        self.assertIn("<td>5.000 × 10<sup>−3</sup></td>", page)
        self.assertNotRegex(html.unescape(page.split("<main>")[1].split("<svg")[0]), r"\de-\d")

    def test_marks_are_at_the_top(self):
        page = self.page(result(matched=1.0, device="A"), result(matched=2.0, device="B", simulated=True),
                         result(matched=3.0, device="C", fit_warns=True))
        self.assertIn("<title>Comparison of 3 accelerometers (simulation) - emax</title>", page)
        self.assertIn("<body class=\"marked\">\n<div class=\"banner\" role=\"note\">SIMULATION: not every result was measured",
                      page)
        self.assertIn("<p class=\"warning\">Told apart from no other, because chi-square of the fit warns: C.", page)
        self.assertIn("<strong>CANNOT BE TOLD APART</strong>: the bench of B was simulated.", page)
        self.assertNotIn("told apart:", page)

    def test_nasty_labels_and_nothing_from_outside(self):
        page = self.page(result(matched=1.0, device=self.NASTY, serial=self.NASTY, refused="<i>\n" + self.NASTY),
                         result(matched=1.0001, device=self.NASTY + "2", fit_warns=True))
        for part in ["<script", "<b>", "<i>", "<link rel=\"style", "@import", "url(http", " src=", " onload", "\u202e"]:
            self.assertNotIn(part, page.replace("xlink:href", ""))
        self.assertNotRegex(page, r"(?:href|src)\s*=\s*[\"'](?!#|data:,)")
        cell = page.split("class=\"name\">")[2].split("</th>")[0]
        shown = self.NASTY.replace("\u202e", "?")
        self.assertEqual(html.unescape(cell)[:40], shown[:40])
        with Browser() as browser:
            for width in [1000, 390]:
                browser.open(self.directory / "out/comparison.html", width)
                self.assertEqual(browser.complaints(), [])
                self.assertEqual(len(browser.requests()), 1)
                self.assertLessEqual(browser.evaluate("document.documentElement.scrollWidth"), width)
                self.assertEqual(browser.evaluate("document.scripts.length"), 0)
            self.assertIn(shown[:30], browser.evaluate("document.querySelector('.numbers tbody th').textContent"))

    def test_prints_on_a4(self):
        self.page(*(result(matched=1.0 + i, device=f"Accelerometer {i}", fit_warns=i == 1) for i in range(12)))
        with Browser() as browser:
            browser.open(self.directory / "out/comparison.html", 680)  # What A4 has between its margins.
            browser.call("Emulation.setEmulatedMedia", media="print")
            for part in [".wide", "main"]:
                wide = browser.evaluate(f"document.querySelector('{part}').scrollWidth")
                self.assertLessEqual(wide, browser.evaluate(f"document.querySelector('{part}').clientWidth"))
            pdf = browser.pdf()
        # 210 mm by 297 mm in points of 1/72 inch.
        boxes = re.findall(rb"/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\]", pdf)
        self.assertTrue(boxes)
        for box in boxes:
            self.assertAlmostEqual(float(box[0]), 595.3, delta=1)
            self.assertAlmostEqual(float(box[1]), 841.9, delta=1)
        self.assertLessEqual(len(boxes), 4)

    def test_two_and_three_devices_are_one_sheet(self):
        with Browser() as browser:
            for count in (2, 3):
                self.page(*(result(matched=1.0 + i, device=f"Device {i}") for i in range(count)))
                browser.open(self.directory / "out/comparison.html", 680)
                self.assertEqual(len(re.findall(rb"/Type\s*/Page\b", browser.pdf())), 1, count)


class CompareRefusals(Comparing, ProgramTest):
    def test_arguments(self):
        self.save("a.json", result())
        self.save("b.json", result())
        for arguments, words in {
            (): "no file; expected two or more results.json of emax report",
            ("a.json",): "a single file; expected two",
            ("a.json", "a.json"): "a.json: given twice",
            ("a.json", "b.json", "--jsn"): "--jsn: no option of emax compare; did you mean --json?",
            ("a.json", "b.json", "--json", "--csv"): "--json: excludes --csv",
            ("a.json", "b.json", "--out"): "--out: no value",
            ("a.json", "b.json", "--out", "o", "--out=p"): "--out: given twice",
            ("a.json", "missing.json"): "missing.json: No such file",
            ("a.json", "."): "Is a directory",
            ("a.json", "b.json", "--out", "a.json/such/directory"): "--out: a.json/such/directory",
            ("a.json", "b.json", "--by", "xi"): '--by: "xi" given; expected matched, band or energy',
            ("a.json", "b.json", "--by"): "--by: no value; expected matched, band or energy",
        }.items():
            with self.subTest(arguments=arguments):
                self.refuse(["compare", *arguments], words)

    def test_hundreds_of_thousands_of_names(self):
        # Compared with one another, these took nine minutes; the program's time limit here is 100 s.
        text = '{"version":"0.1.0",' + ",".join(f'"{i}":0' for i in range(300_000)) + "}"
        self.save("many.json", text)
        self.save("other.json", result())
        self.refuse(["compare", "many.json", "other.json"], "many.json: holds no maximum energy")
        self.save("twice.json", text[:-1] + ',"7":1}')
        self.refuse(["compare", "twice.json", "other.json"], "twice.json:1:", "a name for the second time")

    def test_unequal_conditions(self):
        self.save("a.json", result())
        for (group, name), (value, words) in CONDITIONS.items():
            with self.subTest(condition=name):
                other = result(6e-3)
                other[group][name] = value
                self.save("b.json", other)
                for by in ["matched", "band", "energy"] if name != "a" else ["energy"]:
                    self.refuse(["compare", "a.json", "b.json", "--out", "out", "--by", by], "emax: b.json: " + words,
                                "a.json", "expected the same conditions")

    def test_criterion_in_words(self):
        for criterion, words in [("ise", "integral-square error"), ("difference", "energy difference"),
                                 ("band", "in-band error with the sensor's constant delay taken out"), ("\n\u00fc", "?\u00fc")]:
            both = [result(), result(6e-3)]
            for name, each in zip("ab", both):
                each["energy"] |= {"criterion": criterion, "delay_mode": "auto"}
                self.save(name, each)
            printed = self.run_program("compare", "a", "b").stdout.decode()
            self.assertRegex(printed, rf"\n  Criterion +{re.escape(words)}, the best signal found\n")

    def test_delays_that_differ(self):
        """One and the same device is not told apart from itself by what the user allows it."""
        given = [result(matched=1.2), result(matched=1.1), result(matched=1.1)]
        for each, time in zip(given[1:], [2e-5, 3e-5]):
            each["band"]["matched"] |= {"delay_mode": "given", "delay_s": time}
        for name, each in zip("abc", given):
            self.save(name, each)
        self.refuse(["compare", "a", "b"], "emax: b: the delay taken out is 2e-05 s, and auto in a", "--reference-delay")
        self.refuse(["compare", "b", "c"], "emax: c: the delay taken out is 3e-05 s, and 2e-05 s in b")
        # It does not rank by the others, but the column is there.
        for by in ["band", "energy"]:
            text = " ".join(self.succeed("compare", "a", "b", "--by", by).split())
            self.assertIn('WARNING: The figures under "matched %" cannot be compared: different delays were taken out, ', text)
            self.assertIn("a delay of 20 us for b", text)
        self.save("c", given[1])
        text = self.succeed("compare", "b", "c")
        self.assertNotIn("WARNING", text)
        self.assertIn("in-band error with a delay of 20 us taken out, worst rms in % of S a", text)
        self.assertNotIn("the sensor's constant delay", text)
        devices = json.loads(self.succeed("compare", "b", "c", "--json"))["devices"]
        self.assertEqual([(d["delay_mode"], d["delay_s"]) for d in devices], [("given", 2e-5)] * 2)
        row = next(csv.DictReader(io.StringIO(self.succeed("compare", "b", "c", "--csv"))))
        self.assertEqual((row["delay_mode"], float(row["delay_s"])), ("given", 2e-5))

    def test_delays_of_an_energy_in_band(self):
        both = [result(6e-6, 1e-8), result(3e-7, 1e-9)]
        for each, mode in zip(both, ["none", "auto"]):
            each["energy"] |= {"criterion": "band", "delay_mode": mode, "delay_s": 0 if mode == "none" else 2.5e-5}
        for name, each in zip("ab", both):
            self.save(name, each)
        self.refuse(["compare", "a", "b", *ENERGY], "emax: b: the delay taken out is auto, and none in a")
        self.assertNotIn("WARNING", self.succeed("compare", "a", "b"))
        self.save("b", both[0] | {"energy": both[0]["energy"] | {"E": 7e-6}})
        text = self.succeed("compare", "a", "b", *ENERGY)
        self.assertRegex(text, r"\n  Criterion +in-band error with the sensor's delay, the best")
        self.assertNotIn("paper's %", text)  # It would be one of the two figures in band.
        self.assertNotIn("paper's criterion", text)

    def test_words_of_the_energy_difference(self):
        both = [result(5e-3), result(6e-3)]
        for name, each in zip("ab", both):
            each["energy"]["criterion"] = "difference"
            self.save(name, each)
        text = self.succeed("compare", "a", "b", *ENERGY)
        self.assertIn("sqrt(E/T) %: root of the largest energy difference over T", text)
        for words in ["paper's", "rms error, sqrt"]:
            self.assertNotIn(words, text)

    def test_ideal_sensor_of_another_gain(self):
        both = [result(), result(6e-3, matched=2.0)]
        for name, each in zip("ab", both):
            each["filter"] |= {"gain_mode": "fixed", "gain": 2.1}
            self.save(name, each)
        text = " ".join(self.succeed("compare", "a", "b").split())
        self.assertIn("An ideal sensor has 0 if its S is the filter's gain.", text)
        self.assertIn("At the estimates no signal has more than the bound.", text)

    def test_what_is_below_zero_is_refused(self):
        self.save("a", result())
        for place, name in [(("band",), "rms_percent"), (("band",), "u_percent"), (("band", "matched"), "rms_percent"),
                            (("band", "matched"), "bound_percent"), (("band", "matched"), "delay_s"), (("energy",), "E"),
                            (("uncertainty",), "u"), (("model",), "S"), (("energy",), "T")]:
            with self.subTest(place=place, name=name):
                other = result()
                inner = other
                for part in place:
                    inner = inner[part]
                inner[name] = -1.0
                self.save("b", other)
                self.refuse(["compare", "a", "b"], f"emax: b: {'.'.join(place)}.{name} is below 0; expected")

    def test_what_cannot_be_is_refused(self):
        self.save("a", result())
        matched = ("band", "matched")
        for place, name, value, words in [
            (matched, "bound_percent", 0.9, "is below the figure"), (("energy",), "bound", 4.9e-3, "is below the figure"),
            (matched, "interval_percent", [3, 2], "ends below its beginning"),
            (("uncertainty",), "interval", [6e-3, 5e-3], "ends below its beginning"),
            (matched, "rms_percent", 1e308, "is beyond 1e150"), (("model",), "S", 0, "is 0"), (("energy",), "a", 0, "is 0"),
            (("energy",), "T", 0, "is 0"), (("uncertainty",), "probability", 0, "is 0"),
            (("uncertainty",), "probability", 1, "is 1 or more"), (("filter",), "order", 0, "is 0"),
        ]:
            with self.subTest(place=place, name=name, value=value):
                other = result()
                inner = other
                for part in place:
                    inner = inner[part]
                inner[name] = value
                self.save("b", other)
                self.refuse(["compare", "a", "b"], f"emax: b: {'.'.join(place)}.{name} {words}; expected")

    def test_times_that_differ_in_the_last_digit(self):
        self.save("a", result())
        other = result()
        other["energy"]["T"] = 0.0020000000000000005
        self.save("b", other)
        self.refuse(["compare", "a", "b"], "b: T is 0.0020000000000000005 s, and 0.002")

    def test_devices_of_one_name_have_their_files_beside_it(self):
        self.compare(result(5e-3, device="a"), result(6e-3, device="a"), result(7e-3, device="b"))
        text = self.succeed("compare", "0.json", "1.json", "2.json", *ENERGY)
        self.assertRegex(text, r"\n  1     a \(0.json\) +")
        self.assertIn("a (1.json) and b: told apart", text)

    def test_in_band_energies_of_several_delays(self):
        files = [result(matched=1.0), result(matched=2.0)]
        for file, mode in zip(files, ["auto", "none"]):
            file["energy"] |= {"criterion": "band", "delay_mode": mode}
        self.compare(*files, by="matched")
        text = self.succeed("compare", "0.json", "1.json")
        self.assertIn("in-band error, for some with a delay taken out and for some without", text)
        self.refuse(["compare", "0.json", "1.json", *ENERGY], "the delay taken out is none, and auto in")

    def test_time_that_a_warning_asks_for(self):
        files = [result(matched=1.0, device="A"), result(matched=3.0)]
        files[0]["warnings"] = [{"about": "band", "text": "T is short; give the settling time", "least_time_s": 0.0140021}]
        self.compare(*files, by="matched")
        self.assertIn("The report of A warns: T is short; give the settling time, 14.1 ms.",
                      self.succeed("compare", "0.json", "1.json"))

    def test_results_without_figures_of_the_band(self):
        self.save("a.json", result())
        self.save("b.json", of_box(6e-3, 1e-5))
        for by in ["matched", "band"]:
            self.refuse(["compare", "a.json", "b.json", "--by", by],
                        "emax: b.json: holds no in-band figures", "run emax report anew, or give --by energy")
        self.assertIn("b.json", self.succeed("compare", "a.json", "b.json", *ENERGY))
        self.save("b.json", result() | {"band": None, "band_refused": "The filter has a gain of 0."})
        self.refuse(["compare", "a.json", "b.json"], "emax: b.json: holds no in-band figures, as its report says why: The "
                    "filter has a gain of 0. Leave it out, or give --by energy")

    def test_probability_behind_a_device_without_any(self):
        other = result(7e-3)
        other["uncertainty"]["probability"] = 0.9
        for file, each in zip("abc", [result(5e-3, None), result(6e-3), other]):
            self.save(file, each)
        self.refuse(["compare", "a", "b", "c", *ENERGY], "emax: c: probability is 0.9", "in b")
        self.save("c", result(7e-3))
        self.assertIn("interval (95 %)", self.succeed("compare", "a", "b", "c", *ENERGY))
        conditions = json.loads(self.succeed("compare", "a", "b", "c", "--json", *ENERGY))["conditions"]
        self.assertEqual(conditions["probability"], 0.95)

    def test_fixed_gain(self):
        both = [result(), result(6e-3)]
        for each, gain in zip(both, [2.0, 2.1]):
            each["filter"] |= {"gain_mode": "fixed", "gain": gain}
        for name, each in zip("ab", both):
            self.save(name, each)
        self.refuse(["compare", "a", "b"], "gain is 2.1 V/(m/s^2), and 2 V/(m/s^2) in a")

    def test_other_version(self):
        self.save("a.json", result())
        self.save("b.json", result() | {"version": "9.9.9"})
        self.refuse(["compare", "a.json", "b.json"], "b.json: written by emax 9.9.9", "run emax report anew")

    def test_failed_measurement(self):
        self.save("a.json", result())
        text = self.run_program("report", "--bench-fault", "unplugged-device@4", "--json").stdout.decode()
        self.save("b.json", text)
        self.refuse(["compare", "a.json", "b.json"], "b.json: holds no maximum energy, its measurement has failed")

    def test_broken_files(self):
        self.save("a.json", result())
        whole = json.dumps(result())
        for cut in range(0, len(whole), 3):  # Each takes a run of the program.
            self.save("b.json", whole[:cut])
            self.refuse(["compare", "a.json", "b.json"], "emax: b.json:1:" if cut > 0 else "emax: b.json: the file is empty; expected a results.json")
        wrong = {
            "[" * 100: "nested too deep",
            '{"version": "0.1.0", "version": "0.1.0"}': "a name for the second time",
            " \n\t\r\n": "b.json: the file is empty; expected a results.json",
            "emax report, version 0.1.0": "b.json:1:1: not JSON, a value is missing; expected a results.json",
            "{version: 1}": "1:2: not JSON, a name in quotation marks is missing;",
            '{"version" 1}': "a ':' is missing",
            '{"version": 01}': "a ',' or '}' is missing",
            '{"version": [1 2]}': "a ',' or ']' is missing",
            '{"version": 1.}': "a digit is missing",
            '{"version": "\\u12"}': "four hexadecimal digits are missing",
            '{"version": 1e999}': "a number too large",
            '{"version": "\\ud800"}': "half of a surrogate pair",
            '{"version": "\\x"}': "an unknown escape",
            '{"version": "\t"}': "a control character in a string",
            "{}": "b.json: holds no version; expected",
            "[]": "b.json: holds no version; expected",
            whole + "x": "something stands behind its end",
        }
        for content, words in wrong.items():
            with self.subTest(content=content[:40]):
                self.save("b.json", content)
                self.refuse(["compare", "a.json", "b.json"], words)

    def test_missing_members(self):
        self.save("a.json", result())
        matched = [("band.matched", name) for name in ["rms_percent", "U_percent", "epsilon_percent", "delay_s"]]
        for group, name in [*CONDITIONS, ("model", "S"), ("filter", "gain"), ("uncertainty", "interval"),
                            ("band", "rms_percent"), *matched]:
            for replace in [None, "text"]:
                with self.subTest(group=group, member=name, replace=replace):
                    other = result()
                    place = other["band"]["matched"] if group == "band.matched" else other[group]
                    place[name] = {} if replace else None
                    self.save("b.json", other)
                    self.refuse(["compare", "a.json", "b.json"], f"b.json: {group}.{name} is no ")

    def test_large_file(self):
        self.save("a.json", result())
        with open("/dev/zero", "rb") as endless:
            self.refuse(["compare", "a.json", "-"], "standard input: larger than 4 MiB", stdin=endless)

    def test_utf8_and_escapes(self):
        both = [result(device="M\u00fcller \U0001F600"), result(6e-3)]
        self.save("0.json", both[0])
        self.save("1.json", both[1])
        escaped = self.run_program("compare", "0.json", "1.json", "--csv").stdout.decode()
        (self.directory / "0.json").write_text(json.dumps(both[0], ensure_ascii=False), encoding="utf-8")
        plain = self.run_program("compare", "0.json", "1.json", "--csv").stdout.decode()
        self.assertIn("M\u00fcller \U0001F600,", escaped)
        self.assertEqual(escaped, plain)

    def test_names_are_characters_everywhere(self):
        self.save("pr\u00fcf.json", result(device="M\u00fcller \U0001F600", serial="\u2116 7"))
        self.save("1.json", result(6e-3))
        found = json.loads(self.succeed("compare", "pr\u00fcf.json", "1.json", "--json"))["devices"][0]
        self.assertEqual([found[name] for name in ["device", "serial", "file"]],
                         ["M\u00fcller \U0001F600", "\u2116 7", "pr\u00fcf.json"])


if __name__ == "__main__":
    main()
