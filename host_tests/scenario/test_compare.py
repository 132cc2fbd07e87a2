"""`emax compare`: devices side by side, ranked only as far as their uncertainties carry."""

import csv
import html
import io
import json
import math
import os
import re
from xml.etree import ElementTree

from program_test import DATA, ProgramTest, main

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
    ("monte_carlo", "probability"): (0.9, "probability is 0.9, and 0.95 in"),
    ("monte_carlo", "distribution"): ("normal", "distribution is normal, and box in"),
}


def result(energy=5e-3, u=1e-5, bound=None, device=None, serial=None) -> dict:
    """A results.json with what the comparison reads of it."""
    return {
        "version": "0.1.0",
        "labels": {"device": device, "serial": serial},
        "model": {"S": 2.0},
        "filter": {"order": 10, "cutoff": 1000, "gain": 2.0, "gain_mode": "auto"},
        "energy": {"criterion": "ise", "method": "best", "T": 0.002, "a": 1, "E": energy, "bound": bound},
        "monte_carlo": None
        if u is None
        else {"probability": 0.95, "distribution": "box", "u": u, "interval": [energy - 2 * u, energy + 2 * u]},
    }


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

    def compare(self, *results, options=("--json",)):
        names = [self.save(f"{i}.json", content) for i, content in enumerate(results)]
        return json.loads(self.succeed("compare", *names, *options))


class CompareDevices(Comparing, ProgramTest):
    def test_three_devices(self):
        names = []
        for device in DEVICES:
            points = ["--points", DATA / f"devices/{device}.csv", "--reference-uncertainty", "0.5"]
            text = self.succeed("report", *points, "--limit", "1", "--trials", "20000", "--trend", "none", "--json")
            names.append(self.save(f"{device}.json", text))
        loaded = [json.loads((self.directory / name).read_text()) for name in names]
        found = json.loads(self.succeed("compare", *names, "--json"))
        # The parameters of a box have a standard deviation of u/sqrt(3).
        energies = {r["energy"]["E"]: math.sqrt(3) * r["monte_carlo"]["u"] for r in loaded}
        ascending = sorted(energies)
        self.assertEqual([device["E"] for device in found["devices"]], ascending)
        self.assertEqual([device["file"] for device in found["devices"]][0], "damped_c.json")
        ranks = ranks_of(ascending, [energies[e] for e in ascending])
        self.assertEqual([(d["rank_best"], d["rank_worst"]) for d in found["devices"]], ranks)
        self.assertEqual(ranks, [(1, 1), (2, 3), (2, 3)])
        text = self.succeed("compare", *names)
        self.assertIn("damped_c.json and piezo_a.json: told apart", text)
        self.assertIn("piezo_a.json and piezo_b.json: CANNOT BE TOLD APART", text)
        self.assertLessEqual(max(map(len, text.splitlines())), 130)

    def test_ranks_and_pairs(self):
        energies, uncertainties = [5.00e-3, 5.05e-3, 5.10e-3, 6e-3], [1.2e-5, 1.2e-5, 1.2e-5, 1e-6]
        found = self.compare(*[result(e, u) for e, u in zip(energies, uncertainties)])
        expected = ranks_of(energies, [math.sqrt(3) * u for u in uncertainties])
        # Neighbours cannot be told apart, the ends of the chain can.
        self.assertEqual(expected, [(1, 2), (1, 3), (2, 3), (4, 4)])
        self.assertEqual([(d["rank_best"], d["rank_worst"]) for d in found["devices"]], expected)
        self.assertEqual([pair["told_apart"] for pair in found["pairs"]], [False, False, True])
        self.assertAlmostEqual(found["pairs"][0]["difference"], 5e-5, delta=1e-18)
        self.assertAlmostEqual(found["pairs"][0]["expanded"], 2 * math.sqrt(6) * 1.2e-5, delta=1e-18)

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
        text = self.succeed("compare", "0.json", "1.json")
        self.assertIn("CANNOT BE RANKED: no uncertainty of E is known for one of them", text)
        self.assertNotIn("nan", text)

    def test_equal_devices_share_a_rank(self):
        found = self.compare(result(), result())
        self.assertEqual([(d["rank_best"], d["rank_worst"]) for d in found["devices"]], [(1, 2), (1, 2)])

    def test_negative_energy_has_no_rms(self):
        both = [result(-1e-3), result(2e-3)]
        for each in both:
            each["energy"]["criterion"] = "difference"
        found = self.compare(*both)
        self.assertEqual([d["rms"] is None for d in found["devices"]], [True, False])
        self.assertNotIn("nan", self.succeed("compare", "0.json", "1.json"))

    def test_note_where_percent_disagrees(self):
        other = result(6e-3)
        other["model"]["S"] = 3.0
        self.compare(result(5e-3), other)
        self.assertIn("in percent of S a the order is another one", self.succeed("compare", "0.json", "1.json"))
        # Not by a difference that the uncertainties do not carry.
        other["energy"]["E"] = 5.001e-3
        self.compare(result(5e-3), other)
        self.assertNotIn("another one", self.succeed("compare", "0.json", "1.json"))


class CompareOutput(Comparing, ProgramTest):
    def test_labels_are_no_formulas_and_no_control_characters(self):
        odd = ["=cmd|' /C calc'!A0", "+1", "-2", "@SUM(1)", " =3", "a\x1b[31mb\tc\x7f"]
        self.compare(*(result((5 + i) * 1e-3, device=name, serial=name) for i, name in enumerate(odd)))
        names = [f"{i}.json" for i in range(len(odd))]
        text = self.succeed("compare", *names, "--csv")
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
        expected = ["'" + name for name in odd[:-1]] + ["a [31mb c "]
        self.assertEqual(sorted(row["device"] for row in rows), sorted(expected))
        self.assertEqual(sorted(row["serial"] for row in rows), sorted(expected))
        self.assertFalse(any(ord(c) < 32 for c in text.replace("\n", "")))

    def test_csv_and_odd_labels(self):
        odd = 'say "hi", <b>&amp;</b>\nnext'
        self.compare(result(5e-3, device=odd, serial="12;3"), result(6e-3, None, device="x" * 10_000))
        rows = list(csv.DictReader(io.StringIO(self.succeed("compare", "0.json", "1.json", "--csv"), newline="")))
        self.assertEqual([row["device"] for row in rows], [odd.replace("\n", " "), "x" * 10_000])
        self.assertEqual([row["serial"] for row in rows], ["12;3", ""])
        self.assertEqual([float(row["E"]) for row in rows], [5e-3, 6e-3])
        self.assertEqual([row["u"] for row in rows][1], "")
        text = self.succeed("compare", "0.json", "1.json")
        self.assertIn('say "hi", <b>&amp;</b>?next 12;3', text)
        self.assertLess(len(text), 3000)

    def test_columns_stand_below_one_another(self):
        long = "a long name " * 5
        names = ["\u00c4\u00d6\u00dc \u0416\u2126", "plain", long + "17", long + "18", "\U0001F600" * 300]
        columns = [("E in V^2 s", r"5\.\d{8}e-03"), ("u(E)", r"1\.73e-05"), ("bound", r"6\.0000e-03")]
        for count in [5, 120]:  # Ranks of up to seven characters.
            for i in range(count):
                self.save(f"{i}.json", result(5e-3 + 1e-9 * i, bound=6e-3, device=names[i % 5]))
            text = self.run_program("compare", *(f"{i}.json" for i in range(count))).stdout.decode()
            lines = text.splitlines()
            self.assertLessEqual(max(map(len, lines)), 130)
            head = next(line for line in lines if line.startswith("  rank"))
            rows = [line for line in lines if re.search(r"e-03 to 5\.", line)]
            self.assertEqual(len(rows), count)
            for row in rows:
                # The end of each heading is that of its numbers.
                for title, number in columns:
                    self.assertRegex(row[: head.index(title) + len(title)], f" {number}$")
            # The serial number at the end of a name is still there.
            self.assertTrue(any(re.search(r"\.\.\.[a-z ]*long name 17 ", row) for row in rows), rows[2])

    def test_bound_in_fewer_digits_is_a_bound(self):
        self.compare(result(bound=5.12341e-3), result(6e-3))
        self.assertIn(" 5.1235e-03 ", self.succeed("compare", "0.json", "1.json"))

    def test_files(self):
        self.compare(result(), result(6e-3))
        printed = self.succeed("compare", "0.json", "1.json", "--out", "out")
        self.assertEqual((self.directory / "out/comparison.txt").read_text(), printed)
        self.assertEqual(sorted(os.listdir(self.directory / "out")), [
            "comparison.csv", "comparison.gp", "comparison.json", "comparison.svg", "comparison.txt"])
        for option, name in [("--csv", "comparison.csv"), ("--json", "comparison.json")]:
            self.assertEqual((self.directory / "out" / name).read_text(),
                             self.succeed("compare", "0.json", "1.json", option))

    def test_picture(self):
        odd = "it's <b>\u03b2 & 'co'</b>"
        self.compare(result(5e-3, bound=5.5e-3, device=odd), result(6e-3, None, device="\u00fc" * 100))
        self.run_program("compare", "0.json", "1.json", "--out", "out")
        drawn = ["".join(text.itertext()).strip()
                 for text in ElementTree.parse(self.directory / "out/comparison.svg").iter(SVG + "text")]
        self.assertIn("1-2  " + odd, drawn)
        self.assertIn("1-2  " + "\u00fc" * 11 + "..." + "\u00fc" * 10, drawn)
        self.assertIn("E in mV\u00b2 s", drawn)

    def test_picture_says_the_conditions(self):
        both = [result(-5e-3), result(6e-3)]
        for each in both:
            each["energy"] |= {"criterion": "difference", "method": "paper"}
        self.compare(*both)
        self.succeed("compare", "0.json", "1.json", "--out", "out")
        picture = (self.directory / "out/comparison.svg").read_text(encoding="utf-8")
        self.assertIn("filter of order 10, 1000 Hz, energy difference, paper's method<", html.unescape(picture))
        self.assertRegex(picture, r">\s*\u2212\d")  # The axis has minus signs.
        self.assertNotRegex(picture, r">\s*-\d")

    def test_picture_of_many_shows_the_first(self):
        for i in range(50):
            self.save(f"{i}.json", result(5e-3 + 1e-4 * i, 1e-6))
        self.succeed("compare", *(f"{i}.json" for i in range(50)), "--out", "out")
        picture = (self.directory / "out/comparison.svg").read_text()
        self.assertIn("40  39.json", picture)
        self.assertNotIn("41  40.json", picture)

    def test_no_gnuplot(self):
        self.compare(result(), result(6e-3))
        done = self.run_program("compare", "0.json", "1.json", "--out", "out", env={"PATH": "/nowhere"})
        self.assertEqual(done.returncode, 0)
        self.assert_one_line(done.stderr, "gnuplot")
        self.assertNotIn("comparison.svg", os.listdir(self.directory / "out"))
        self.assertIn("comparison.gp", os.listdir(self.directory / "out"))

    def test_full_disk(self):
        self.compare(result(), result(6e-3))
        with open("/dev/full", "wb") as full:
            self.refuse(["compare", "0.json", "1.json"], "standard output: No space left", status=3, stdout=full)

    def test_help(self):
        text = self.succeed("compare", "--help")
        self.assertLessEqual(max(map(len, text.splitlines())), 80)
        for option in ["--csv", "--json", "--out DIR"]:
            self.assertIn(f"  {option} ", text)


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
                self.refuse(["compare", "a.json", "b.json", "--out", "out"], "emax: b.json: " + words, "a.json",
                            "expected the same conditions")

    def test_trials_differ_behind_a_device_without_any(self):
        for name, value in [("probability", 0.9), ("distribution", "normal")]:
            other = result(7e-3)
            other["monte_carlo"][name] = value
            for file, each in zip("abc", [result(5e-3, None), result(6e-3), other]):
                self.save(file, each)
            self.refuse(["compare", "a", "b", "c"], f"emax: c: {name} is {value}", "in b")
        self.save("c", result(7e-3))
        self.assertIn("interval (95 %)", self.succeed("compare", "a", "b", "c"))
        conditions = json.loads(self.succeed("compare", "a", "b", "c", "--json"))["conditions"]
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
        for cut in range(len(whole)):
            self.save("b.json", whole[:cut])
            self.refuse(["compare", "a.json", "b.json"], f"emax: b.json:1:{cut + 1}: " if cut == 0 else "emax: b.json:")
        wrong = {
            "[" * 100: "nested too deep",
            '{"version": "0.1.0", "version": "0.1.0"}': "a name for the second time",
            '{"version": 01}': "expected ',' or '}'",
            '{"version": 1e999}': "a number too large",
            '{"version": "\\ud800"}': "half of a surrogate pair",
            '{"version": "\\x"}': "an unknown escape",
            '{"version": "\t"}': "a control character in a string",
            "{}": "version is no text",
            "[]": "version is no text",
            whole + "x": "expected the end",
        }
        for content, words in wrong.items():
            with self.subTest(content=content[:40]):
                self.save("b.json", content)
                self.refuse(["compare", "a.json", "b.json"], words)

    def test_missing_members(self):
        self.save("a.json", result())
        for group, name in [*CONDITIONS, ("model", "S"), ("filter", "gain"), ("monte_carlo", "interval")]:
            with self.subTest(member=name):
                other = result()
                del other[group][name]
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
