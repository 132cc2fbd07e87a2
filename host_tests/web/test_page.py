"""The page emax.html in a browser: links that run, tables, the simulated bench, what it keeps, hostile input, paper.

usage: test_page.py PROGRAM DATA_DIRECTORY EMAX.HTML "RUNNER... IMAGE" [unittest arguments]
"""

import datetime
import json
import pathlib
import re
import subprocess
import urllib.parse

from page_test import DATA, PAGE, PROGRAM, PageTest, main

import results_schema

FIGURES = "[...document.querySelectorAll('#certificate > .wide tbody tr')].map((r) => [...r.cells].map((c) => c.textContent))"
PARTS = ["filter", "impulse_response", "energy", "band", "ideal", "uncertainty", "monte_carlo", "trend", "warnings"]
README = pathlib.Path(__file__).resolve().parents[2] / "README.md"
MODEL = "CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004"
EVERYTHING = f"""\
*TST?
{MODEL}
CALC:MCAR:TRI 1000
CALC:REP?
FETC:JSON?
CALC:ENER:TIME 10 ms;CRIT DIFF
CALC:ENER?
CALC:ENER:FPA?
CALC:MOD:NONSENSE 1
*RST
SENS:SWE:FREQ 200,1000,2000,4000,5000
INIT
FETC:FRES?
CALC:IDEN?
CALC:MCAR?
CALC:MCAR:HIST?
CALC:IMP? 0.00001,0.0001
DIAG:RAND? 3
*SAV 1;*RCL 1
*LRN?
SYST:ERR:ALL?
"""


class Links(PageTest):
    def test_answer_as_the_program_does_byte_by_byte(self):
        expected = subprocess.run([PROGRAM, "scpi"], input=EVERYTHING, capture_output=True, text=True, check=True).stdout
        answers = self.run_link(EVERYTHING)
        self.assertEqual(answers, expected)
        self.assertGreater(len(answers), 10_000)
        self.assertEqual(self.text("run-state"), "done")
        self.assert_quiet()

    def test_tell_what_was_refused(self):
        self.assertEqual(self.run_link("*IDN?\nNONSENSE\n"), "emax,web,0,0.1.0\n")
        self.assertEqual(self.text("run-state"), 'done, with errors: -113,"Undefined header;NONSENSE"')
        # Markup stays text, and a percent sign that is none is taken as it stands.
        self.run_link("<img src=x onerror=alert(1)>\n")
        self.assertEqual(self.text("lines"), "<img src=x onerror=alert(1)>\n")
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#run img').length"), 0)
        self.browser.open(PAGE, fragment="#run=*IDN?%zz")
        self.wait_for("document.getElementById('run-state').textContent.startsWith('done')")
        self.assert_quiet()

    def test_lead_to_the_whole_page(self):
        self.run_link("*IDN?\n")
        self.assertIs(self.browser.evaluate("document.getElementById('job').hidden"), True)
        self.click("leave-run")
        self.wait_for("document.body?.dataset.busy === 'no'")
        self.assertIs(self.browser.evaluate("document.getElementById('job').hidden"), False)
        self.assertIs(self.browser.evaluate("document.getElementById('run').hidden"), True)
        self.assertIn("Connected", self.text("connection"))

    def test_of_the_readme_run(self):
        links = re.findall(r"emax\.html#run=([^\s`)\"]+)", README.read_text(encoding="utf-8"))
        self.assertGreaterEqual(len(links), 1)
        for link in links:
            lines = urllib.parse.unquote(link)
            expected = subprocess.run([PROGRAM, "scpi"], input=f"{lines}\n", capture_output=True, text=True, check=True).stdout
            self.assertEqual(self.run_link(lines), expected.replace("emax,host,", "emax,web,"))
            self.assertEqual(self.text("run-state"), "done")


class Tables(PageTest):
    """A table dropped on the page is read and computed as `emax report --points` does it, to the last digit."""

    def test_give_the_digits_of_the_program(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000;:CALC:ENER:TIME 0.0005;:CALC:TREN:TIME 0.0005,0.0006")
        options = ["--trials", "1000", "--time", "0.0005", "--trend", "0.0005,0.0006"]
        for name in ["khz.csv", "mv_per_g.csv", "tabs_decimal_comma.csv", "magnitude_only.csv", "utf16.txt", "piezo_01.csv"]:
            with self.subTest(name):
                path = DATA / "tables" / name
                expected = self.json_of("--points", path, *options)
                self.drop(path)
                self.assertEqual(self.text("problem"), "")
                got = self.results()
                self.assertEqual(results_schema.faults(got), [])
                self.assertEqual(got["model"]["name"], name)
                self.assertEqual(got["fit"]["read_as"], expected["fit"]["read_as"])
                self.assertIn(expected["fit"]["read_as"], self.text("certificate"))
                printed = self.succeed("report", "--points", path, *options).replace(str(path), name)
                put_in = printed[printed.index("\nWHAT WAS PUT IN") : printed.index("\nFIT")]
                self.assertIn(put_in, self.saved("save-report"))
                self.assertEqual(got["labels"]["device"], path.stem)
                for part in PARTS:
                    self.assertEqual(got[part], expected[part], part)
                for parameter in ["S", "f0", "beta", "uS", "uf0", "ubeta", "covariance", "chi2", "dof"]:
                    self.assertEqual(got["model"][parameter], expected["model"][parameter], parameter)
        self.assert_quiet()

    def test_are_refused_in_the_words_of_the_program(self):
        self.open()
        for name, content in {
            "empty.csv": b"",
            "words.csv": b"there is no table here\n",
            "short.csv": b"f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg\n100,1,0,0.01,1\n",
            "unit.csv": b"f_hz,amplitude [furlong],phase_deg,u_amplitude,u_phase_deg\n1,1,0,1,1\n",
            "dealer.txt": (DATA / "tables" / "dealer_export_tabs_comma.txt").read_bytes(),
        }.items():
            with self.subTest(name):
                path = self.directory / name
                path.write_bytes(content)
                line = self.refuse(["report", "--points", name], name).removeprefix("emax: ").rstrip("\n")
                self.drop(path)
                self.assertEqual(self.text("problem"), line)
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#device-list tbody tr').length"), 0)
        # What the table does not say can be said, and said wrongly.
        self.fill("table-uncertainty", "1%,half")
        self.assertIs(self.browser.evaluate("document.getElementById('table-says').open"), True)
        self.drop(self.directory / "dealer.txt")
        self.assertTrue(self.text("problem").startswith('--uncertainty: "1%,half" given; expected'), self.text("problem"))
        self.fill("table-uncertainty", "1%,0.5deg")
        self.drop(self.directory / "dealer.txt")
        self.assertEqual(self.text("problem"), "")
        self.assert_quiet()

    def test_that_are_workbooks_are_named_as_such(self):
        self.open()
        for name, begin in {"book.xlsx": b"PK\x03\x04", "old.xls": b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"}.items():
            path = self.directory / name
            path.write_bytes(begin + bytes(range(256)))
            self.drop(path)
            self.assertTrue(self.text("problem").startswith(f"{name}: a workbook, not a table as text; in Excel, save it as CSV"))
        self.click("close-problem")
        self.assertIs(self.browser.evaluate("document.getElementById('notice').hidden"), True)

    def test_have_their_warnings_and_all_their_figures(self):
        self.open()
        # Too short a time and too few trials: a warning on each, and figures that are marked.
        self.speak("CALC:MCAR:TRI 1000;:CALC:ENER:TIME 0.0005;:CALC:TREN:TIME 0.0005,0.0006")
        self.drop(DATA / "tables" / "khz.csv")
        warnings = self.browser.evaluate("[...document.querySelectorAll('#certificate > .warning')].map((p) => p.textContent)")
        self.assertEqual(
            [re.sub(r"of [\d.]+ ms", "of T ms", warning) for warning in warnings],
            # Of the paper's error, and of the one in band.
            [
                "Warning: T is much shorter than the settling time, so the error has not developed within T: give a T of T ms or"
                " more.",
                "Warning: T is much shorter than the settling time in band, so the error has not developed within T: give a T of T ms"
                " or more.",
                "Warning: fewer trials than rule (3) asks for; the intervals and the maximum are less certain than their"
                " digits say.",
            ],
        )
        report = self.saved("save-report")
        rows = self.browser.evaluate(FIGURES)
        printed = report.split("none exceeds\n")[1].split("\n  Note:")[0].splitlines()
        self.assertEqual([line.replace("*", " ").split() for line in printed],
                         [" ".join(row).replace("*", " ").split() for row in rows])
        self.assertEqual([" *" in row[0] for row in rows], ["*" in line for line in printed])

    def test_stop_as_one_and_wait_for_their_evaluation(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000000")
        names = ["plain.csv", "khz.csv", "mv_per_g.csv"]
        self.click_at("1 of 3: plain.csv: computing: ", "abort")
        self.drop(*(DATA / "tables" / name for name in names))
        problem = self.text("problem")
        self.assertTrue(problem.startswith("plain: stopped before its figures were known"), problem)
        self.assertTrue(problem.endswith("not read: khz.csv, mv_per_g.csv"), problem)
        self.open()
        self.assertIn("Not evaluated yet", self.text("certificate"))
        self.speak("CALC:MCAR:TRI 1000")
        self.browser.evaluate("document.getElementById('again').focus()")
        self.click("again")
        self.idle()
        self.assertEqual(self.text("problem"), "")
        self.assertEqual(self.browser.evaluate("document.activeElement.id"), "result")
        self.assertNotIn("Not evaluated yet", self.text("certificate"))
        self.assert_quiet()

    def test_stop_whatever_is_done_with_them(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000;:CALC:TREN:TIME 0.001,0.002")
        tables = [DATA / "tables" / name for name in ["plain.csv", "khz.csv"]]
        # Before there is anything to stop: what was read is kept, and nothing is computed.
        self.click_at("reading plain.csv", "abort")
        self.drop(*tables)
        problem = self.text("problem")
        self.assertTrue(problem.startswith("plain: stopped before its figures were known"), problem)
        self.assertTrue(problem.endswith("not read: khz.csv"), problem)
        self.assertIn("Not evaluated yet", self.text("certificate"))
        # Once all is computed: that is kept, too.
        self.click_at("fetching", "abort")
        self.drop(*tables)
        self.assertEqual(self.text("problem"), "stopped; not read: khz.csv")
        before = self.results()
        self.assertEqual(before["labels"]["device"], "plain (2)")
        # What was known before stays known.
        self.click_at("computing: ", "abort")
        self.click("again")
        self.idle()
        self.assertEqual(self.text("problem"), "plain (2): stopped; its figures are those of before")
        self.assertEqual(self.results(), before)
        self.assert_quiet()

    def test_that_are_far_too_large_are_refused(self):
        self.open()
        row = "{},1,0,0.01,1\n"
        for name, content, words in [
            ("big.csv", row.format(1) * 800_000, "big.csv: larger than 1 MiB; expected a table of at most 1024 points"),
            ("big.json", '{"version": "' + "x" * 10_000_000, "big.json: larger than 1 MiB; expected a results.json of emax"),
        ]:
            path = self.directory / name
            path.write_text(content, encoding="ascii")
            self.drop(path)
            self.assertEqual(self.text("problem"), words)
        path = self.directory / "long.csv"
        path.write_text("".join(row.format(100 + i) for i in range(1500)), encoding="ascii")
        line = self.refuse(["report", "--points", path.name], path.name).removeprefix("emax: ").rstrip("\n")
        self.drop(path)
        self.assertEqual(self.text("problem"), line)
        # Beyond the memory of the module that reads, which begins anew with the next table.
        longest = self.directory / "longest.csv"
        longest.write_text("1,2\n" * 200_000, encoding="ascii")
        self.drop(longest, path)
        self.assertEqual(self.text("problem"), f"longest.csv: this takes more memory than the page has for it — {line}")
        self.assert_quiet()

    def test_give_the_sensitivity_alone_where_they_say_no_more(self):
        self.open()
        self.drop(DATA / "tables" / "handheld_160hz.csv")
        self.assertIn("points give S alone", self.text("problem"))
        self.assertIn("S = 0.0102096 V/(m/s²), U = 5.6 × 10⁻⁵ (k = 2)", self.text("certificate"))


class Devices(PageTest):
    def test_are_compared_as_the_program_compares_them(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000")
        self.drop(*(DATA / "devices" / name for name in ["piezo_a.csv", "piezo_b.csv", "damped_c.csv"]))
        self.assertEqual(self.text("problem"), "")
        names = []
        for row in range(3):
            self.browser.evaluate(f"document.querySelectorAll('#device-list tbody tr')[{row}].querySelector('button').click()")
            self.idle()
            text = self.saved("save-json")
            names.append(json.loads(text)["labels"]["device"])
            (self.directory / names[-1]).write_text(text, encoding="utf-8")
        self.assertEqual(names, ["piezo_a", "piezo_b", "damped_c"])
        self.submit("compare")
        self.wait_for("document.querySelector('#comparison pre') !== null")
        self.idle()
        page = self.browser.evaluate("document.querySelector('#comparison pre').textContent")
        self.assertEqual(page, self.succeed("compare", *names))
        self.assertEqual(self.saved("save-comparison"), self.succeed("compare", "--csv", *names))
        self.assertEqual(self.browser.evaluate("caught.arrayBuffer().then((bytes) => [...new Uint8Array(bytes).slice(0, 3)])"),
                         [0xEF, 0xBB, 0xBF])  # UTF-8, said to Excel; as a text it is not there.
        ranking = self.browser.evaluate("[...document.querySelectorAll('.ranking li')].map((item) => item.textContent)")
        ranked = json.loads(self.succeed("compare", "--json", *names))["devices"]
        self.assertEqual([line.split(": ")[1].split(",")[0] for line in ranking], [device["device"] for device in ranked])
        for line, device in zip(ranking, ranked):
            value, expanded = map(float, re.search(r", ([\d.]+) ± ([\d.]+) %\u00a0of\u00a0S\u00a0a", line).groups())
            digits = len(re.search(r"\.(\d+) ±", line)[1])
            self.assertAlmostEqual(value, device["value"], delta=0.5001 * 10**-digits)
            self.assertAlmostEqual(expanded, device["U"], delta=0.05 * device["U"])
            self.assertEqual("chi-square" in line, device["fit_warns"])
        self.browser.evaluate("window.print = () => { window.printed = document.body.className; }")
        self.click("print-comparison")
        self.assertEqual(self.browser.evaluate("window.printed"), "comparing")
        self.browser.evaluate("document.body.classList.add('comparing')")
        paper = self.directory / "comparison.pdf"
        paper.write_bytes(self.browser.pdf())
        words = subprocess.run(["pdftotext", "-layout", paper, "-"], capture_output=True, text=True, check=True).stdout
        for line in ranking:
            self.assertIn(line.split(",")[0], words)
        self.assertNotIn("Frequency response", words)
        # Reports are those of the program but for the table's name; they are kept, and gone once deleted.
        self.open()
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#device-list tbody tr').length"), 3)
        self.browser.evaluate("window.confirm = () => true; document.querySelectorAll('#device-list button')[1].click()")
        self.open()
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#device-list tbody tr').length"), 2)
        self.assert_quiet()

    def test_begin_without_the_labels_of_the_one_before(self):
        # Somewhere it is another day than in Greenwich.
        utc = datetime.datetime.now(datetime.timezone.utc)
        zone, hours = ("Pacific/Kiritimati", 14) if utc.hour >= 10 else ("Etc/GMT+12", -12)
        self.browser.call("Emulation.setTimezoneOverride", timezoneId=zone)
        self.open()
        self.speak("CALC:MCAR:TRI 1000;:SENS:SWE:FREQ 200,1000,2000,4000,5000")
        first = {"device": "sensor B", "serial": "4711", "operator": "Meier", "date": "2001-02-03", "note": "after the repair"}
        for label, value in first.items():
            self.fill(f"label-{label}", value)
        self.assertEqual(self.text("labels-of"), "Labels of the next device.")
        self.drop(DATA / "tables" / "plain.csv")
        self.assertIn("Labels of plain, the device whose result is below.", self.text("labels-of"))
        self.fill("label-device", "sensor B")
        self.assertIn("Labels of sensor B,", self.text("labels-of"))
        self.assertEqual(self.results()["labels"], first)
        self.drop(DATA / "tables" / "plain.csv")
        self.assertEqual(self.results()["labels"], {**dict.fromkeys(first), "device": "plain", "operator": "Meier"})
        self.drop(DATA / "tables" / "plain.csv")
        self.assertEqual(self.results()["labels"]["device"], "plain (2)")
        self.click("sweep")
        self.idle()
        labels = self.results()["labels"]
        day = (datetime.datetime.now(datetime.timezone.utc) + datetime.timedelta(hours=hours)).date().isoformat()
        self.assertEqual({**labels, "device": None}, {**dict.fromkeys(first), "operator": "Meier", "date": day})
        self.assertIn(f"Sweep of {day}", labels["device"])

    def test_come_back_from_their_results(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000")
        self.drop(DATA / "devices" / "piezo_a.csv")
        path = self.directory / "results.json"
        path.write_text(self.saved("save-json"), encoding="utf-8")
        cells = "[...document.querySelectorAll('#device-list tbody tr')].map((row) => row.cells[{}].textContent)"
        before = self.browser.evaluate(cells.format(3))
        self.assertRegex(before[0], r"^[\d.]+ ± [\d.]+$")
        self.drop(path)
        self.assertEqual(self.text("problem"), "")
        self.assertEqual(self.browser.evaluate(cells.format(3)), before * 2)
        self.assertEqual(self.browser.evaluate(cells.format(1)), ["piezo_a", "piezo_a (2)"])
        self.assertIn(before[0], self.text("certificate"))
        self.assertEqual(self.saved("save-json"), path.read_text(encoding="utf-8"))
        # The figures of the report, to its digits; a comparison names both as they are called here.
        alone = self.browser.evaluate(FIGURES)
        self.submit("compare")
        self.wait_for("!document.getElementById('comparison').hidden")
        self.idle()
        ranking = self.browser.evaluate("[...document.querySelectorAll('.ranking li')].map((item) => item.textContent)")
        self.assertEqual(sorted(line.split(",")[0] for line in ranking), ["1–2: piezo_a", "1–2: piezo_a (2)"])
        self.browser.evaluate("document.querySelector('#device-list .show').click()")
        self.idle()
        self.assertEqual([row[1:] for row in alone], [row[1:] for row in self.browser.evaluate(FIGURES)])
        # A name that is none, and a file that only looks like one.
        results = json.loads(path.read_text(encoding="utf-8"))
        path.write_text(json.dumps({**results, "labels": {"device": {"a": 1}, "serial": [2]}}), encoding="utf-8")
        self.drop(path)
        self.assertEqual(self.text("problem"), "")
        self.assertEqual(self.browser.evaluate(cells.format(1))[2], "results")
        path.write_text(json.dumps({"version": results["version"], "model": results["model"]}), encoding="utf-8")
        self.drop(path)
        self.assertTrue(self.text("problem").startswith("results.json: holds no maximum energy"), self.text("problem"))
        path.write_text(json.dumps({**results, "trend": {"points": [1, 2]}}), encoding="utf-8")
        self.drop(path)
        self.assertTrue(self.text("problem").startswith("results.json: not as emax writes it"), self.text("problem"))
        self.assertEqual(len(self.browser.evaluate(cells.format(1))), 3)
        self.assert_quiet()

    def test_have_an_interval_where_u_says_too_little(self):
        options = ["--model", "1,60000,0.7,0.003,300,0.01", "--limit", "1", "--trials", "1000", "--trend", "none"]
        printed = re.search(r"  In band, constant delay taken out +\*? +(\S+) +(\S+ to \S+) +(\S+)\n", self.succeed("report", *options))
        path = self.directory / "results.json"
        path.write_text(self.succeed("report", *options, "--json"), encoding="utf-8")
        self.open()
        self.drop(path)
        self.assertEqual(tuple(self.browser.evaluate(FIGURES)[0][1:]), printed.groups())
        listed = self.browser.evaluate("document.querySelector('#device-list tbody tr').cells[3].textContent")
        self.assertEqual(listed, f"{printed.group(1)} ({printed.group(2)})")
        self.assert_quiet()

    def test_are_gone_once_deleted(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000;:CALC:FILT:ORD 9")
        self.drop(*(DATA / "devices" / name for name in ["piezo_a.csv", "piezo_b.csv"]))
        self.submit("compare")
        self.wait_for("!document.getElementById('comparison').hidden")
        self.idle()
        boxes = "[...document.querySelectorAll('#device-list input')].map((box) => box.checked)"
        self.browser.evaluate("document.querySelector('#device-list input').click()")
        self.open()
        self.assertEqual(self.browser.evaluate(boxes), [False, True])
        self.browser.evaluate("document.querySelector('#device-list input').click()")
        self.submit("compare")
        self.wait_for("!document.getElementById('comparison').hidden")
        self.idle()
        self.browser.evaluate("window.confirm = () => true")
        # Not while it is computed.
        self.speak("CALC:MCAR:TRI 1000000")
        self.click("again")
        self.wait_for("document.getElementById('stage').textContent.startsWith('computing')")
        self.browser.evaluate("document.querySelectorAll('#device-list .delete')[1].click()")
        self.assertIn("something is running", self.text("problem"))
        self.click("abort")
        self.idle()
        self.assertEqual(len(self.browser.evaluate(boxes)), 2)
        self.browser.evaluate("document.querySelectorAll('#device-list .delete')[1].click()")
        state = ("[document.getElementById('comparison').hidden, document.getElementById('result').hidden, document.title,"
                 " document.getElementById('label-device').value, document.activeElement.id]")
        self.assertEqual(self.browser.evaluate(state), [True, True, "emax", "", "device-list"])
        self.assertEqual(len(self.browser.evaluate(boxes)), 1)
        self.click("delete-all")
        self.wait_for("document.body?.dataset.busy === 'no' && document.querySelectorAll('#device-list input').length === 0")
        self.idle()
        self.assertEqual(self.speak("CALC:FILT:ORD?"), ["10"])
        self.assertEqual(self.browser.evaluate("Object.keys(localStorage).filter((k) => k.includes('device.'))"), [])

    def test_stay_until_the_page_is_closed_where_the_browser_keeps_nothing(self):
        forbidden = (
            "Object.defineProperty(window, 'localStorage',"
            " {get() { throw new DOMException('It is forbidden.', 'SecurityError'); }});"
        )
        script = self.browser.call("Page.addScriptToEvaluateOnNewDocument", source=forbidden)["identifier"]
        self.open()
        self.speak("CALC:MCAR:TRI 1000;:CALC:TREN:TIME 0.001,0.002")
        self.drop(*(DATA / "devices" / name for name in ["piezo_a.csv", "piezo_b.csv"]))
        self.assertIn("the browser does not keep this: It is forbidden.; it is gone once the page is closed", self.text("problem"))
        self.submit("compare")
        self.wait_for("!document.getElementById('comparison').hidden")
        self.idle()
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('.ranking li').length"), 2)
        self.assert_quiet()
        self.browser.call("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
        # The same where it is full, until there is room again.
        names = "[...document.querySelectorAll('#device-list tbody tr')].map((row) => row.cells[1].textContent)"
        self.open()
        self.speak("CALC:MCAR:TRI 1000;:CALC:TREN:TIME 0.001,0.002")
        self.drop(DATA / "devices" / "piezo_a.csv")
        self.browser.evaluate(
            "(() => { for (let size = 1 << 22; size >= 1; size >>= 1) { try { for (let i = 0; ; ++i) {"
            " localStorage.setItem(`full.${size}.${i}`, 'x'.repeat(size)); } } catch {} } })()"
        )
        self.drop(DATA / "devices" / "piezo_b.csv")
        self.assertIn("it is gone once the page is closed", self.text("problem"))
        self.assertEqual(self.browser.evaluate(names), ["piezo_a", "piezo_b"])
        self.browser.evaluate(
            "Object.keys(localStorage).filter((k) => k.startsWith('full')).forEach((k) => localStorage.removeItem(k))"
        )
        self.browser.evaluate("window.confirm = () => true; document.querySelector('#device-list .delete').click()")
        self.open()
        self.assertEqual(self.browser.evaluate(names), ["piezo_b"])
        self.assert_quiet()

    def test_by_their_parameters_need_numbers_with_points(self):
        self.open()
        for field, value in {"model-s": "1,037", "model-f0": "4073", "model-beta": "0.3"}.items():
            self.fill(field, value)
        self.submit("model")
        self.idle()
        self.assertTrue(self.text("problem").startswith('S: "1,037" has a comma; write a point'), self.text("problem"))
        self.fill("model-s", "1.037")
        self.fill("model-us", "0.003")
        self.submit("model")
        self.idle()
        self.assertTrue(self.text("problem").startswith('u(f0): "" is no number'), self.text("problem"))
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#device-list tbody tr').length"), 0)

    def test_with_hostile_names_stay_text(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000")
        content = (DATA / "tables" / "plain.csv").read_bytes().splitlines(keepends=True)
        name = "<img src=x onerror=alert(1)>\"'&;$(x)`\u202e#?%41.csv"
        path = self.directory / name
        path.write_bytes(b"".join(content))
        self.drop(path)
        self.assertEqual(self.text("problem"), "")
        nasty = "</script><b>\"; *RST; CALC:MOD 1,2,3 \u2028 \U0001d11e '" + "n" * 300
        for label in ["device", "serial", "operator", "date", "note"]:
            self.fill(f"label-{label}", nasty)
        self.assertEqual(self.results()["labels"]["note"], nasty)
        self.assertIn(f"\n  Serial number             {nasty}\n", self.saved("save-report"))
        header = b"f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg,<script>alert(1)</script>\n"
        path = self.directory / "column.csv"
        path.write_bytes(header + b"".join(line.rstrip() + b",1\n" for line in content if line[:1].isdigit()))
        self.drop(path)
        self.assertIn("not used: <script>alert(1)</script>", self.text("certificate"))
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('main img, main b, main script').length"), 0)
        self.open()
        self.assertIn("column", self.text("certificate"))
        self.assert_quiet()


class Bench(PageTest):
    def test_of_the_page_is_that_of_the_program(self):
        self.open()
        lines = ["CALC:MCAR:TRI 1000", "SENS:SWE:FREQ 200,1000,2000,4000,5000", "CALC:TREN:TIME 0.001,0.002"]
        for line in lines:
            self.speak(line)
        self.click("sweep")
        self.idle()
        self.assertEqual(self.text("problem"), "")
        script = "\n".join([*lines, "INIT;*WAI", "INIT:REP;*WAI", "CALC:REP?", "FETC:JSON?"])
        expected = subprocess.run([PROGRAM, "scpi"], input=f"{script}\n", capture_output=True, text=True, check=True).stdout
        report = self.saved("save-report")
        self.assertIn(report.split("\n\nWHAT WAS PUT IN")[1], expected)
        # As the program has it, labels and all.
        front = report.split("\nTHE FIGURES")[0]
        labels = [f"--{key}={self.results()['labels'][key]}" for key in ["device", "date"]]
        printed = self.succeed("report", "--trials", "1000", "--trend", "none", *labels)
        self.assertEqual(front, printed.split("\nTHE FIGURES")[0])
        text = self.saved("save-json")
        self.assertEqual(results_schema.faults_of_text(text), [])
        # The points and the sweep are the front end's.
        whole = json.loads(expected[expected.rindex('{\n  "version"') :].rstrip())
        self.assertEqual(set(whole) - set(json.loads(text)), {"points", "sweep"})
        rest = re.sub(r'\n  "points": .*?\n(?=  "model")', "\n", expected, flags=re.DOTALL)
        self.assertIn(re.sub(r'  "labels": \{[^}]*\},\n', "", text), rest)
        self.assertIn("Simulation", self.text("certificate"))
        self.assertTrue(self.browser.evaluate("document.title").startswith("Simulation - "))
        # Evaluated again from what the browser kept, it stays simulated, and the same.
        self.open()
        self.click("again")
        self.idle()
        self.assertIs(self.results()["simulated"], True)
        # But for the last bits of phases that have become degrees.
        energy = json.loads(text)["energy"]["E"]
        self.assertAlmostEqual(self.results()["energy"]["E"] / energy, 1.0, delta=1e-12)
        self.assert_quiet()

    def test_gives_the_figures_of_a_sweep_in_doubt_with_the_doubt(self):
        self.open()
        for line in ["CALC:MCAR:TRI 1000", "SENS:SWE:FREQ 200,1000,2000,4000,5000", "CALC:TREN:TIME 0.001", "DEV:SENS 1.5"]:
            self.speak(line)
        self.click("sweep")
        self.idle()
        self.assertRegex(self.text("problem"), r"^Sweep of .*: -230.*DEV:SENS")
        # S of the bench is 1.037.
        self.assertAlmostEqual(self.results()["model"]["S"], 1.037, delta=0.02)
        self.assertIn("Maximum energy", self.text("certificate"))
        self.assert_quiet()

    def test_stops_at_once_and_loses_nothing(self):
        self.open()
        self.fill("sim-pace", "1")
        self.submit("simulated")
        self.idle()
        self.click("sweep")
        self.wait_for("document.querySelectorAll('#growing .dot').length >= 6")
        self.click("abort")
        self.idle()
        stopped = re.match(r"stopped; the drive is at zero\. (\d+) points were measured and are kept\.", self.text("problem"))
        self.assertTrue(3 <= int(stopped[1]) < 42, stopped[0])
        self.open()
        rows = self.saved("save-csv").splitlines()
        self.assertEqual(len(rows) - 1, int(stopped[1]))
        self.assertTrue(rows[1].startswith("30,"), rows[1])
        # A reload in mid-sweep keeps the points up to there.
        self.click("sweep")
        self.wait_for("document.querySelectorAll('#growing .dot').length >= 6")
        self.open()
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#device-list tbody tr').length"), 2)
        self.assert_quiet()

    def test_is_cleared_in_the_middle_of_an_answer(self):
        self.open()
        self.fill("line", "CALC:MOD 1.037,4073,0.3182;:CALC:ENER:TIME 0.05;:CALC:TREN? 0.05,0.06,0.07,0.08,0.09,0.1")
        self.submit("speak")
        self.click("clear")
        self.wait_for("document.getElementById('log').textContent.includes('cleared')")
        self.assertEqual(self.speak("*IDN?"), ["emax,web,0,0.1.0"])
        self.assert_quiet()

    def test_settings_are_the_instruments(self):
        self.open()
        # What limits others is freed first: the last value of each holds, and begins with a colon.
        whole = [part for part in self.speak("*LRN?")[0].split(";") if part.startswith(":")]
        learnt = {part.split(" ")[0]: part for part in whole}.values()
        fields = self.browser.evaluate(
            "[...document.querySelectorAll('#settings-list [data-header]')].map((f) => `:${f.dataset.header} ${f.value}`)"
        )

        def numbers(line):
            return [float(part) if re.match(r"-?[\d.]+", part) else part for part in re.split("[ ,]", line)]

        self.assertEqual(sorted(map(numbers, fields)), sorted(map(numbers, learnt)))
        self.assertEqual([field for field in fields if re.search(r"\dE", field)], [])
        order = "document.querySelector('[data-header=\"CALC:FILT:ORD\"]')"
        change = "(() => {{ const f = {}; f.value = '{}'; f.dispatchEvent(new Event('change')); }})()"
        self.browser.evaluate(change.format(order, "99"))
        self.wait_for(f"{order}.getAttribute('aria-invalid') === 'true'")
        self.assertEqual(self.browser.evaluate(f"{order}.value"), "10")
        self.assertIn('-222,"Data out of range', self.browser.evaluate(f"{order}.parentElement.textContent"))
        # A field is for a value, the console for lines.
        self.speak("SENS:SWE:REP 3")
        self.browser.evaluate(change.format(order, "5;*RST"))
        self.wait_for(f"{order}.parentElement.textContent.includes('one value is expected')")
        self.assertEqual(self.browser.evaluate(f"{order}.value"), "10")
        self.assertEqual(self.speak("CALC:FILT:ORD?;:SENS:SWE:REP?"), ["10;3"])
        self.browser.evaluate(change.format(order, "4"))
        self.assertEqual(self.speak("CALC:FILT:ORD?"), ["4"])
        self.assertIs(self.browser.evaluate(f"{order}.hasAttribute('aria-invalid')"), False)
        self.open()
        self.assertEqual(self.browser.evaluate(f"{order}.value"), "4")
        self.assertEqual(self.speak("CALC:FILT:ORD?"), ["4"])
        # What is mounted is another thing than what is asked about it.
        self.speak("SENS:DEV:SENS 5;:SENS:SWE:REP 4")
        adaptive = "document.querySelector('[data-header=\"CALC:MCAR:ADAP\"]')"
        self.assertEqual(self.browser.evaluate(f"[{adaptive}.type, {adaptive}.checked]"), ["checkbox", False])
        self.browser.evaluate(f"{adaptive}.click()")
        self.assertEqual(self.speak("CALC:MCAR:ADAP?"), ["1"])
        self.fill("sim-s", "2.5")
        self.submit("simulated")
        self.idle()
        self.assertEqual(self.text("problem"), "")
        self.assertEqual(self.speak("CALC:FILT:ORD?;:SENS:SWE:REP?;:CALC:MCAR:ADAP?"), ["4;4;1"])
        self.assertNotEqual(self.speak("SENS:DEV:SENS?"), ["5"])
        self.fill("sim-f0", "4073,5")
        self.submit("simulated")
        self.idle()
        self.assertTrue(self.text("problem").startswith('f0: "4073,5" has a comma'), self.text("problem"))
        self.click("defaults")
        self.idle()
        self.assertEqual(self.browser.evaluate(f"{order}.value"), "10")
        self.assert_quiet()


class Readers(PageTest):
    """Whoever reads it: by ear, by keyboard, on a phone, on paper."""

    def test_find_a_name_at_every_control(self):
        self.open(390)
        names = [node["name"]["value"] for node in self.browser.call("Accessibility.getFullAXTree")["nodes"]
                 if node.get("role", {}).get("value") == "heading"]
        numbered = [name for name in names if re.match(r"\d\. ", name)]
        self.assertEqual([int(name[0]) for name in numbered], list(range(1, 6)), names)
        self.speak("CALC:MCAR:TRI 1000")
        self.drop(DATA / "tables" / "plain.csv")
        self.browser.evaluate("document.querySelectorAll('details').forEach((part) => { part.open = true; })")
        self.browser.evaluate("new Promise((resolve) => setTimeout(resolve, 100))")
        tree = self.browser.call("Accessibility.getFullAXTree")["nodes"]
        roles = {"button", "textbox", "combobox", "checkbox", "link", "image", "progressbar"}
        nodes = [node for node in tree if not node["ignored"] and node.get("role", {}).get("value") in roles]
        self.assertGreater(len(nodes), 60)
        self.assertEqual([node for node in nodes if not node.get("name", {}).get("value", "").strip()], [])
        self.assertLessEqual(self.browser.evaluate("document.documentElement.scrollWidth"), 390)
        edges = ("[...document.querySelectorAll('#device-list button, #certificate .numbers th')]"
                 ".filter((part) => !part.closest('.numbers-of-plot')).map((part) => part.getBoundingClientRect().right)")
        self.assertLessEqual(max(self.browser.evaluate(edges)), 390)
        self.assert_quiet()

    def test_read_values_with_the_arrow_keys(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000")
        self.drop(DATA / "tables" / "plain.csv")
        self.browser.evaluate("document.querySelector('.plot').focus()")
        for key in ["Home", "ArrowRight"]:
            self.browser.call("Input.dispatchKeyEvent", type="keyDown", key=key)
        first = [line for line in (DATA / "tables" / "plain.csv").read_text().splitlines() if line[:1].isdigit()][1]
        frequency, amplitude = map(float, first.split(",")[:2])
        values = self.browser.evaluate("document.querySelector('.values').textContent")
        begin = f"frequency {frequency:.5g} Hz · measured {amplitude:.5g} V/(m/s²) · fitted "
        self.assertTrue(values.startswith(begin), values)

    def test_see_the_error_and_the_bound(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000;:CALC:TREN:TIME 0.002,0.003")
        self.drop(DATA / "tables" / "plain.csv")
        energy = self.results()["energy"]
        # Every value of a picture stands in its table, which is made once it is opened.
        self.browser.evaluate("document.querySelectorAll('.numbers-of-plot').forEach((part) => { part.open = true; })")
        self.wait_for("document.querySelectorAll('.numbers-of-plot table').length === 5")
        tables = self.browser.evaluate(
            "[...document.querySelectorAll('.numbers-of-plot table')].map((table) => [...table.rows].map((row) =>"
            " [...row.cells].map((cell) => cell.textContent)))"
        )

        def number(cell):
            mantissa, _, power = cell.replace("\u2212", "-").partition(" × 10")
            digits = power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
            return float(mantissa) * 10.0 ** int(digits or 0)

        head, *rows = tables[1]
        column = head.index("error: y in V")
        error = [(1e-3 * number(row[0]), number(row[column])) for row in rows if row[column]]
        self.assertAlmostEqual(error[-1][0], energy["T"], delta=1e-9)
        area = sum((t1 - t0) * (y0 * y0 + y1 * y1) / 2 for (t0, y0), (t1, y1) in zip(error, error[1:]))
        self.assertAlmostEqual(area / energy["E"], 1.0, delta=0.01)
        drawn = self.browser.evaluate(
            "[...document.querySelectorAll('#certificate .dot.s2')].map((dot) => getComputedStyle(dot).stroke)"
        )
        self.assertEqual(len(drawn), 1)
        self.assertNotEqual(drawn[0], "none")
        # How many trials came to which energy, as the program's file has it.
        head, *rows = tables[3]
        self.assertEqual(head, ["E in V² s", "trials: trials"])
        self.succeed("report", "--points", DATA / "tables" / "plain.csv", "--trials", "1000", "--trend", "none", "--out", "out")
        lines = (self.directory / "out" / "histogram.csv").read_text(encoding="ascii").splitlines()[1:]
        bins = [list(map(float, line.split(","))) for line in lines]
        self.assertEqual([int(row[1]) for row in rows], [count for _, _, count in bins])
        for row, (low, high, _) in zip(rows, bins):
            self.assertAlmostEqual(number(row[0]) / (0.5 * (low + high)), 1.0, delta=1e-5)  # Six digits.
        drawn = self.browser.evaluate("document.querySelectorAll('#certificate .column').length")
        self.assertEqual(drawn, len(bins))
        head, *rows = tables[4]
        column = head.index("none exceeds: E in V² s")
        bounds = [number(row[column]) for row in rows if row[column]]
        self.assertEqual(len(bounds), 1)
        self.assertAlmostEqual(bounds[0] / energy["bound"], 1.0, delta=1e-5)

    def test_see_ticks_apart_from_each_other_and_from_the_axis(self):
        self.open(390)
        # Energies of some 1e-9 V^2 s, and a response that hardly changes.
        self.speak("CALC:MCAR:TRI 1000;:SENS:SWE:FREQ 30,60,90,120,150")
        for field, value in {"model-s": "0.001", "model-f0": "4073", "model-beta": "0.3"}.items():
            self.fill(field, value)
        self.submit("model")
        self.idle()
        self.drop(DATA / "tables" / "plain.csv")
        for row in range(2):
            self.browser.evaluate(f"document.querySelectorAll('#device-list .show')[{row}].click()")
            self.idle()
            pictures = self.browser.evaluate(
                "[...document.querySelectorAll('#certificate svg')].map((svg) => [...svg.querySelectorAll('text')].map((text) => {"
                " const box = text.getBoundingClientRect(), frame = svg.getBoundingClientRect();"
                " return {words: text.textContent, anchor: text.getAttribute('text-anchor'), name: text.matches('.axis-name'),"
                " title: text.matches('.panel-title'),"
                " left: box.left - frame.left, right: box.right - frame.left, upright: box.height > box.width}; }))"
            )
            self.assertGreater(len(pictures), 1)
            for texts in pictures:
                axis = max(text["right"] for text in texts if text["name"] and text["upright"])
                for text in texts:
                    if text["anchor"] == "end" and not text["title"]:
                        self.assertGreaterEqual(text["left"], axis - 1.0, text)
                        self.assertLessEqual(len(text["words"]), 7, text)
        # The first points of a sweep hardly differ: their ticks still do.
        self.click("sweep")
        self.idle()
        ticks = self.browser.evaluate(
            "(() => { const texts = [...document.querySelector('#certificate svg').querySelectorAll('[text-anchor=end]')];"
            " const heights = texts.map((text) => text.y.baseVal[0].value);"
            " const end = heights.findIndex((height, i) => i > 0 && height > heights[i - 1]);"  # The panel below begins.
            " return texts.slice(0, end).map((text) => text.textContent); })()"
        )
        self.assertGreaterEqual(len(ticks), 3)
        self.assertEqual(len(set(ticks)), len(ticks), ticks)

    def test_print_a_certificate(self):
        self.open()
        self.speak("CALC:MCAR:TRI 1000")
        self.drop(DATA / "tables" / "plain.csv")
        self.fill("label-device", "Device 4711")
        self.browser.evaluate("document.querySelector('#certificate .whole').open = true")
        path = self.directory / "certificate.pdf"
        path.write_bytes(self.browser.pdf())
        words = subprocess.run(["pdftotext", "-layout", path, "-"], capture_output=True, text=True, check=True).stdout
        found = self.browser.evaluate("document.querySelector('.headline dd').textContent").replace("\u00a0", " ")
        conditions = "Butterworth low-pass, order 10, cutoff 1000 Hz"
        for expected in ["Device 4711", found, conditions, "Frequency response", "MONTE CARLO OF THE PAPER", "40 points"]:
            self.assertIn(expected, words.replace("\u00a0", " "))
        for control in ["Start the sweep", "Save report.txt", "Speak SCPI"]:
            self.assertNotIn(control, words)


if __name__ == "__main__":
    main()
