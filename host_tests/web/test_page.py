"""The page emax.html in a browser: links that run, tables, the simulated bench, what it keeps, hostile input, paper.

usage: test_page.py PROGRAM DATA_DIRECTORY EMAX.HTML "RUNNER... IMAGE" [unittest arguments]
"""

import json
import pathlib
import re
import subprocess
import urllib.parse

from page_test import DATA, PAGE, PROGRAM, PageTest, main

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
                self.assertIn(expected["fit"]["read_as"], self.text("certificate"))
                self.assertEqual(got["labels"]["device"], path.stem)
                for part in ["filter", "impulse_response", "energy", "band", "ideal", "uncertainty", "monte_carlo", "trend"]:
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
        self.drop(self.directory / "dealer.txt")
        self.assertTrue(self.text("problem").startswith('--uncertainty: "1%,half" given; expected'), self.text("problem"))
        self.fill("table-uncertainty", "1%,0.5deg")
        self.drop(self.directory / "dealer.txt")
        self.assertEqual(self.text("problem"), "")
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
        ranking = self.browser.evaluate("[...document.querySelectorAll('.ranking li')].map((item) => item.textContent)")
        ranked = json.loads(self.succeed("compare", "--json", *names))["devices"]
        self.assertEqual([line.split(": ")[1].split(",")[0] for line in ranking], [device["device"] for device in ranked])
        # Reports are those of the program but for the table's name; they are kept, and gone once deleted.
        self.open()
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#device-list tbody tr').length"), 3)
        self.browser.evaluate("window.confirm = () => true; document.querySelectorAll('#device-list button')[1].click()")
        self.open()
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#device-list tbody tr').length"), 2)
        self.assert_quiet()

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
        self.assertIn(re.sub(r'  "labels": \{[^}]*\},\n', "", text), expected)
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
        self.assertEqual(sorted(fields), sorted(learnt))
        order = "document.querySelector('[data-header=\"CALC:FILT:ORD\"]')"
        change = "(() => {{ const f = {}; f.value = '{}'; f.dispatchEvent(new Event('change')); }})()"
        self.browser.evaluate(change.format(order, "99"))
        self.wait_for(f"{order}.getAttribute('aria-invalid') === 'true'")
        self.assertEqual(self.browser.evaluate(f"{order}.value"), "10")
        self.assertIn('-222,"Data out of range', self.browser.evaluate(f"{order}.parentElement.textContent"))
        self.browser.evaluate(change.format(order, "4"))
        self.wait_for(f"!{order}.hasAttribute('aria-invalid')")
        self.open()
        self.assertEqual(self.browser.evaluate(f"{order}.value"), "4")
        self.assertEqual(self.speak("CALC:FILT:ORD?"), ["4"])
        self.click("defaults")
        self.idle()
        self.assertEqual(self.browser.evaluate(f"{order}.value"), "10")
        self.assert_quiet()


class Readers(PageTest):
    """Whoever reads it: by ear, by keyboard, on a phone, on paper."""

    def test_find_a_name_at_every_control(self):
        self.open(390)
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
