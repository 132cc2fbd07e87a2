"""The Digital Calibration Certificate that `--dcc` writes: its labels, its numbers, and PTB's schema where that is at hand.

usage: test_dcc.py PROGRAM DATA_DIRECTORY [unittest arguments]

EMAX_DCC_SCHEMA names a directory with dcc.xsd of version 3.2.1 (https://ptb.de/dcc/v3.2.1/dcc.xsd) and SI_Format.xsd of
version 2.1.0 (https://ptb.de/si/v2.1.0/SI_Format.xsd), whose licence is not ours.
"""

import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import xml.etree.ElementTree

from program_test import DATA, MODEL, QUICK, ProgramTest, main

DCC, SI = "{https://ptb.de/dcc}", "{https://ptb.de/si}"
TABLE = ["--points", DATA / "devices/piezo_a.csv", "--reference-uncertainty", "0.5"]
LABELS = {
    "device": "Piezo <A> & \"B\"", "serial": "47\n11", "operator": "J. Doe", "date": "2024-05-01", "certificate-number": "K-17",
    "laboratory": "Lab, Town", "country": "DE", "customer": "Somebody, Elsewhere",
}
MORE = {"place": "laboratory", "issue-date": "2024-05-03", "approved-by": "A. Chief", "maker": "M", "model-name": "A 1800", "reference-id": "no. 7", "conditions": "23 \u00b0C", "procedure": "P-4", "note": "as new"}


def options_of(labels: dict) -> list[str]:
    return [f"--{name}={value}" for name, value in labels.items()]


class DigitalCertificate(ProgramTest):
    def certificate(self, *arguments):
        result = self.run_program("report", *arguments, *QUICK, "--dcc", "c.xml", "--out", "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        missing = [f"--{name}" for name in ["maker", "model-name", "procedure", "place", "issue-date", "approved-by", "reference-id", "conditions"]
                   if not any(str(argument).startswith(f"--{name}=") for argument in arguments)]
        is_item = "--points" in arguments  # Else parameters, or the simulated bench.
        self.assertEqual(result.stderr.decode(), "" if not (missing and is_item) else
                         f"emax: --certificate-number: ISO/IEC 17025 also asks for {', '.join(missing)}\n")
        self.assert_valid(self.directory / "c.xml")
        return xml.etree.ElementTree.parse(self.directory / "c.xml").getroot()

    def assert_valid(self, path: pathlib.Path):
        """By PTB's schema, with what it imports beside it; a signature is of no kind here, as there is none."""
        given = os.environ.get("EMAX_DCC_SCHEMA")
        if given is None or shutil.which("xmllint") is None:
            return
        schema = self.directory / "schema"
        schema.mkdir(exist_ok=True)
        text = (pathlib.Path(given) / "dcc.xsd").read_text(encoding="utf-8")
        text = re.sub(r'schemaLocation="[^"]*SI_Format.xsd"', 'schemaLocation="SI_Format.xsd"', text)
        text = re.sub(r'schemaLocation="[^"]*xmldsig[^"]*"', 'schemaLocation="signature.xsd"', text)
        (schema / "dcc.xsd").write_text(text, encoding="utf-8")
        shutil.copy(pathlib.Path(given) / "SI_Format.xsd", schema)
        (schema / "signature.xsd").write_text(
            '<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema" targetNamespace="http://www.w3.org/2000/09/xmldsig#">'
            '<xs:element name="Signature"/></xs:schema>')
        command = ["xmllint", "--nonet", "--noout", "--schema", schema / "dcc.xsd", path]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, f"{path} validates\n"))

    def test_schema_is_at_hand(self):
        if "EMAX_DCC_SCHEMA" not in os.environ or shutil.which("xmllint") is None:
            self.skipTest("set EMAX_DCC_SCHEMA to a directory with PTB's dcc.xsd and SI_Format.xsd, and install xmllint")
        # It refuses what is no certificate.
        self.certificate(*TABLE, *options_of(LABELS))
        text = (self.directory / "c.xml").read_text(encoding="utf-8")
        (self.directory / "bad.xml").write_text(text.replace("2024-05-01", "May"), encoding="utf-8")
        with self.assertRaises(AssertionError):
            self.assert_valid(self.directory / "bad.xml")

    def test_labels_are_its_administrative_data(self):
        root = self.certificate(*TABLE, *options_of(LABELS | MORE))
        self.assertEqual((root.tag, root.get("schemaVersion")), (DCC + "digitalCalibrationCertificate", "3.2.1"))
        data = root.find(DCC + "administrativeData")

        def words(*path) -> str:
            return data.find("/".join(DCC + name for name in path)).text

        self.assertEqual(words("coreData", "uniqueIdentifier"), "K-17")
        self.assertEqual(words("coreData", "countryCodeISO3166_1"), "DE")
        self.assertEqual(words("coreData", "beginPerformanceDate"), "2024-05-01")
        self.assertEqual(words("items", "item", "name", "content"), LABELS["device"])
        self.assertEqual(words("items", "item", "model"), "A 1800")
        self.assertEqual(words("items", "item", "manufacturer", "name", "content"), "M")
        self.assertEqual(words("items", "item", "identifications", "identification", "value"), "47 11")
        self.assertEqual(words("calibrationLaboratory", "contact", "name", "content"), "Lab, Town")
        self.assertEqual(words("respPersons", "respPerson", "person", "name", "content"), "J. Doe")
        self.assertEqual(words("customer", "name", "content"), "Somebody, Elsewhere")
        everything = "\n".join(root.itertext())
        for text in ["no. 7", "23 \u00b0C", "P-4", "as new", "the item tested only", "coverage factor k = 2"]:
            self.assertIn(text, everything)
        self.assertNotIn("SIMULATION", everything)

    def quantities(self, root) -> dict:
        found = {}
        for quantity in root.iter(DCC + "quantity"):
            real = quantity.find(SI + "real")
            if real is not None:
                U = real.find(f"{SI}expandedUnc/{SI}uncertainty")
                name = quantity.find(f"{DCC}name/{DCC}content").text
                found[name] = (float(real.find(SI + "value").text), None if U is None else float(U.text), real.find(SI + "unit").text)
        return found

    def assert_rounded(self, value: float, U: float, exact_value: float, exact_U: float):
        """U has two digits, and the value the same decimals: each off by half a unit of U's second digit at most."""
        unit = 10.0 ** (math.floor(math.log10(exact_U)) - 1)
        self.assertLessEqual(abs(value - exact_value), 0.501 * unit)
        self.assertLessEqual(abs(U - exact_U), 0.501 * unit)
        self.assertAlmostEqual(U / unit, round(U / unit), delta=1e-6)
        self.assertAlmostEqual(value / unit, round(value / unit), delta=1e-6)

    def test_numbers_are_those_of_the_results(self):
        root = self.certificate(*TABLE, *options_of(LABELS))
        results = json.loads((self.directory / "out/results.json").read_text())
        model, energy, band = results["model"], results["energy"], results["band"]
        found = self.quantities(root)
        sensitivity = "\\volt\\metre\\tothe{-1}\\second\\tothe{2}"
        expected = {
            "Sensitivity": (model["S"], 2 * model["uS"], sensitivity),
            "Natural frequency": (model["f0"], 2 * model["uf0"], "\\hertz"),
            "Damping ratio": (model["beta"], 2 * model["ubeta"], "\\one"),
            "Largest energy found of the error of signals within the limit":
                (energy["E"], results["uncertainty"]["U"], "\\volt\\tothe{2}\\second"),
            "Worst rms error in band, constant delay taken out, of sensitivity times limit":
                (band["matched"]["rms_percent"], band["matched"]["U_percent"], "\\percent"),
            "Worst rms error in band, with its delay, of sensitivity times limit":
                (band["rms_percent"], band["U_percent"], "\\percent"),
            "Length of the signals": (energy["T"], None, "\\second"),
        }
        for name, (value, expanded, unit) in expected.items():
            with self.subTest(name):
                self.assertEqual(found[name][1] is None, expanded is None)
                if expanded is None:
                    self.assertAlmostEqual(found[name][0] / value, 1.0, delta=1e-12)
                else:
                    self.assert_rounded(*found[name][:2], value, expanded)
                self.assertEqual(found[name][2], unit)

    def test_interval_in_the_place_of_U(self):
        """Where U says too little, as with a well damped sensor of high f0, the schema's interval stands in its place, and says so."""
        root = self.certificate("--model", "1,8000,0.7,0.003,80,0.02", "--criterion", "band", *options_of(LABELS))
        results = json.loads((self.directory / "out/results.json").read_text())
        matched, known = results["band"]["matched"], results["uncertainty"]
        self.assertIsNotNone(matched["instead_of_U_percent"])
        found = {quantity.find(f"{DCC}name/{DCC}content").text: quantity for quantity in root.iter(DCC + "quantity")}
        energy, percent = results["energy"]["E"], matched["rms_percent"]
        expected = {
            "Largest energy found of the in-band error of signals within the limit":
                (energy, known["u"], min(known["shortest"][0], energy), max(known["shortest"][1], energy)),
            "Worst rms error in band, constant delay taken out, of sensitivity times limit":
                (percent, matched["u_percent"], *matched["instead_of_U_percent"]),
        }
        for name, numbers in expected.items():
            with self.subTest(name):
                self.assertIn("in the place of U", found[name].find(f"{DCC}description/{DCC}content").text)
                real = found[name].find(SI + "real")
                self.assertIsNone(real.find(SI + "expandedUnc"))
                interval = real.find(SI + "coverageInterval")
                parts = [real.find(SI + "value"), *(interval.find(SI + part) for part in ["standardUnc", "intervalMin", "intervalMax"])]
                value, u, low, high = (float(part.text) for part in parts)
                self.assert_rounded(value, u, *numbers[:2])
                # Outwards, by less than one of u's second digit.
                unit = 10.0 ** (math.floor(math.log10(numbers[1])) - 1)
                self.assertTrue(0 <= numbers[2] - low < 1.001 * unit or low == 0.0, (low, numbers[2]))
                self.assertTrue(0 <= high - numbers[3] < 1.001 * unit, (high, numbers[3]))
                self.assertEqual(interval.find(SI + "coverageProbability").text, "0.95")
        with_delay = found["Worst rms error in band, with its delay, of sensitivity times limit"]
        self.assertIsNone(with_delay.find(DCC + "description"))
        self.assertIsNotNone(with_delay.find(f"{SI}real/{SI}expandedUnc"))

    def test_response_is_the_table(self):
        root = self.certificate(*TABLE, *options_of(LABELS))
        lists = {quantity.find(f"{DCC}name/{DCC}content").text: quantity.find(SI + "realListXMLList")
                 for quantity in root.iter(DCC + "quantity") if quantity.find(SI + "realListXMLList") is not None}
        self.assertEqual(list(lists), ["Frequency", "Amplitude", "Phase"])
        rows = [line.split(",") for line in TABLE[1].read_text().splitlines() if line[0].isdigit()]

        def numbers(name, *path):
            return [float(number) for number in lists[name].find("/".join(SI + part for part in path)).text.split()]

        for value, row in zip(numbers("Frequency", "valueXMLList"), rows, strict=True):
            self.assertAlmostEqual(value, float(row[0]), delta=1e-12 * value)
        for name, column, expanded in [("Amplitude", 1, 3), ("Phase", 2, 4)]:
            uncertainties = numbers(name, "expandedUncXMLList", "uncertaintyXMLList")
            for value, U, row in zip(numbers(name, "valueXMLList"), uncertainties, rows, strict=True):
                self.assert_rounded(value, U, float(row[column]), float(row[expanded]))
        # As many decimals as U, zeros too.
        values, uncertainties = (lists["Amplitude"].find("/".join(SI + part for part in path)).text.split()
                                 for path in [["valueXMLList"], ["expandedUncXMLList", "uncertaintyXMLList"]])
        for value, U in zip(values, uncertainties, strict=True):
            self.assertEqual(len(value.partition(".")[2]), len(U.partition(".")[2]), (value, U))

    def statements(self, root) -> dict:
        found = {}
        for statement in root.iter(DCC + "statement"):
            name, words = (statement.find(f"{DCC}{part}/{DCC}content").text for part in ["name", "declaration"])
            found.setdefault(name, []).append(words)
        return found

    def test_warnings_and_quality_of_the_fit(self):
        """What warns on the page warns here, and --birge widens all U alike."""
        table = ["--points", DATA / "djb_a1800v.csv"]
        root = self.certificate(*table, *options_of(LABELS))
        results = json.loads((self.directory / "out/results.json").read_text())
        self.assertGreater(results["model"]["chi2"], 50 * results["model"]["dof"])
        self.assertEqual(len(self.statements(root)["Warning"]), len(results["warnings"]))
        self.assertIn("chi2/dof is above", self.statements(root)["Warning"][0])
        ratio = f"{math.sqrt(results['model']['chi2'] / results['model']['dof']):.3g}"
        # What follows from it, and no claim of a distribution that the fit belies.
        for words in [self.statements(root)["Warning"][0], self.statements(root)["Uncertainty"][0]]:
            self.assertIn(f"too small by about the Birge ratio, {ratio}", words)
        self.assertIn("the estimates themselves are not sure", self.statements(root)["Warning"][0])
        self.assertIn("95.45 % do not hold", self.statements(root)["Uncertainty"][0])
        self.assertEqual(list(root.iter(SI + "distribution")), [])
        self.assertEqual(results["model"]["u_factor"], 1)
        plain = self.quantities(root)
        self.assertAlmostEqual(plain["Chi-square"][0], results["model"]["chi2"], delta=0.0006)
        birge = plain["Birge ratio"][0]
        self.assertAlmostEqual(birge, math.sqrt(results["model"]["chi2"] / results["model"]["dof"]), delta=0.0006)
        root = self.certificate(*table, "--birge", *options_of(LABELS))
        wide = self.quantities(root)
        for name in ["Sensitivity", "Natural frequency", "Largest energy found of the error of signals within the limit"]:
            # Both have two digits; E is nearly linear over so narrow a range.
            self.assertAlmostEqual(wide[name][1] / plain[name][1] / birge, 1.0, delta=0.1, msg=name)
        self.assertIn(f"times the Birge ratio, {ratio}; U of each point is as stated", self.statements(root)["Uncertainty"][0])
        self.assertNotIn("too small by", self.statements(root)["Uncertainty"][0])
        widened = json.loads((self.directory / "out/results.json").read_text())["model"]
        self.assertAlmostEqual(widened["u_factor"], math.sqrt(widened["chi2"] / widened["dof"]), delta=1e-12 * widened["u_factor"])
        self.assertEqual(widened["uS"], results["model"]["uS"], "the factor is not in it")
        self.assertIn("Birge ratio", "".join(root.find(f".//{DCC}measurementResults").itertext()))

    def test_found_is_not_proven(self):
        root = self.certificate(*TABLE, *options_of(LABELS))
        names = [quantity.find(f"{DCC}name/{DCC}content").text for quantity in root.iter(DCC + "quantity")]
        self.assertFalse([name for name in names if "any signal" in name])
        self.assertIn("leaves the search out", self.statements(root)["Uncertainty"][0])

    def test_what_amplitudes_have_in_common(self):
        """0.5 % of the reference at k = 2; the table states nothing else that is common."""
        found = {quantity.find(f"{DCC}name/{DCC}content").text: quantity for quantity in
                 self.certificate(*TABLE, *options_of(LABELS)).iter(DCC + "quantity")}
        self.assertIn("holds 0.5 % (k = 2) that all have in common", found["Amplitude"].find(f"{DCC}description/{DCC}content").text)
        self.assertIsNone(found["Phase"].find(DCC + "description"))
        alone = self.certificate(*TABLE[:2], *options_of(LABELS))
        self.assertNotIn("in common: one effect", "".join(alone.itertext()))

    def test_distribution_is_that_of_the_parameters(self):
        """Normal as stated; an error is another function of them, with an interval of its own."""
        root = self.certificate(*TABLE, *options_of(LABELS))
        normal = {quantity.find(f"{DCC}name/{DCC}content").text for quantity in root.iter(DCC + "quantity")
                  if quantity.find(f".//{SI}distribution") is not None}
        self.assertEqual(normal, {"Sensitivity", "Natural frequency", "Damping ratio"})

    def test_a_short_time_is_noted(self):
        """For the paper's sensor the leading error settles in 4.5084 ms, as the README says."""
        statements = self.statements(self.certificate(*TABLE, *options_of(LABELS)))
        self.assertRegex(statements["Length of the signals"][0], r"T = 2 ms is shorter than the settling time .*, 4\.5\d+ ms")
        self.assertNotIn("Length of the signals", self.statements(self.certificate(*TABLE, "--time", "0.005", *options_of(LABELS))))

    def test_chi_square_with_stated_crosstalk(self):
        def description(path):
            root = self.certificate("--points", path, "--reference-uncertainty", "0.5", *options_of(LABELS))
            return next(quantity.find(f"{DCC}description/{DCC}content") for quantity in root.iter(DCC + "quantity")
                        if quantity.find(f"{DCC}name/{DCC}content").text == "Chi-square")

        self.assertIsNone(description(TABLE[1]))
        (self.directory / "t.csv").write_text(TABLE[1].read_text() + "# shared: leak=0.01\n")
        self.assertIn("not of the estimates printed", description(self.directory / "t.csv").text)

    def test_numbers_are_short(self):
        root = self.certificate(*TABLE, *options_of(LABELS))
        for element in root.iter():
            if element.tag.startswith(SI) and element.text and "ist" not in element.tag and re.fullmatch(r"[-0-9.e]+", element.text.strip()):
                digits = re.sub(r"e.*|[-.]", "", element.text.strip()).lstrip("0")
                self.assertLessEqual(len(digits), 15, element.tag)
        # k = 2 covers erf(sqrt(2)) of a normal distribution.
        covered = [element.text for element in root.iter(SI + "coverageProbability")]
        covered += [element.text for element in root.iter(SI + "coverageProbabilityXMLList")]
        self.assertEqual(set(covered), {f"{math.erf(math.sqrt(2.0)):.4f}"})

    def test_shared_effects_are_in_U_of_each_point(self):
        """A table that says crosstalk, as the tables of this program do."""
        text = TABLE[1].read_text()
        (self.directory / "t.csv").write_text(text + "# shared: leak=0.01\n")

        def expanded(path):
            root = self.certificate("--points", path, "--reference-uncertainty", "0.5", *options_of(LABELS))
            return [[float(U) for U in one.text.split()] for one in root.iter(SI + "uncertaintyXMLList")]

        plain, shared = expanded(TABLE[1]), expanded(self.directory / "t.csv")
        rows = [[float(cell) for cell in line.split(",")[:3]] for line in text.splitlines() if line[0].isdigit()]
        for i, (_, amplitude, phase) in enumerate(rows):
            # u = 0.01 beside K: along K it changes the amplitude, across it the phase. U has two digits in both tables,
            # so half a unit each, and K is that of the fit.
            along, across = (abs(part(math.radians(phase))) * 0.02 for part in [math.cos, math.sin])
            unit = 10.0 ** (math.floor(math.log10(shared[0][i])) - 1)
            self.assertAlmostEqual(shared[0][i], math.hypot(plain[0][i], along), delta=1.5 * unit)
            unit = 10.0 ** (math.floor(math.log10(shared[1][i])) - 1)
            self.assertAlmostEqual(shared[1][i], math.hypot(plain[1][i], math.degrees(across / amplitude)), delta=1.5 * unit)

    def test_computed_from_parameters_is_no_calibration(self):
        root = self.certificate(*MODEL, *options_of(LABELS | MORE))
        statements = self.statements(root)
        self.assertIn("no item was tested", statements["Validity"][0])
        self.assertTrue(statements["Traceability"][0].startswith("None"))
        self.assertIsNone(root.find(f".//{DCC}measuringEquipment"))
        table = self.certificate(*TABLE, *options_of(LABELS | MORE))
        self.assertIsNotNone(table.find(f".//{DCC}measuringEquipment"))
        self.assertIn("table, as it was provided", self.statements(table)["Validity"][0])

    def test_who_signs_and_where(self):
        root = self.certificate(*TABLE, *options_of(LABELS))
        data = root.find(DCC + "administrativeData")
        self.assertEqual(data.find(f"{DCC}coreData/{DCC}performanceLocation").text, "other")
        self.assertIsNone(data.find(f".//{DCC}mainSigner"))
        self.assertIsNone(data.find(f".//{DCC}issueDate"))
        self.assertIn("except with the written approval of the issuing laboratory", self.statements(root)["Reproduction"][0])
        data = self.certificate(*TABLE, *options_of(LABELS | MORE)).find(DCC + "administrativeData")
        self.assertEqual(data.find(f"{DCC}coreData/{DCC}performanceLocation").text, "laboratory")
        self.assertEqual(data.find(f"{DCC}coreData/{DCC}issueDate").text, "2024-05-03")
        signer = [person for person in data.iter(DCC + "respPerson") if person.find(DCC + "mainSigner") is not None]
        self.assertEqual([person.find(f"{DCC}person/{DCC}name/{DCC}content").text for person in signer], ["A. Chief"])
        self.refuse(["report", *MODEL, "--dcc", "c.xml", *options_of(LABELS | {"issue-date": "May"})], "--issue-date: ", "YYYY-MM-DD")

    def test_a_simulation_says_so(self):
        root = self.certificate(*options_of(LABELS))
        self.assertTrue(root.find(f".//{DCC}uniqueIdentifier").text.startswith("SIMULATION "))
        self.assertIn("no real sensor was measured", "".join(root.itertext()))
        # No item was tested, whatever the labels are.
        root = self.certificate(*options_of(LABELS | MORE))
        self.assertNotIn("ISO 16063-21", "".join(root.itertext()))
        self.assertIsNone(root.find(f".//{DCC}measuringEquipment"))
        statements = self.statements(root)
        self.assertIn("no item was tested", statements["Validity"][0])
        self.assertTrue(statements["Traceability"][0].startswith("None"))

    def test_what_is_not_known_is_not_there(self):
        found = self.quantities(self.certificate("--model", "1.037,4073,0.3182", *options_of(LABELS)))
        self.assertEqual([expanded for _, expanded, _ in found.values()], [None] * len(found))
        open_damping = self.certificate("--points", DATA / "tables/piezo_00.csv", "--time", "0.001", *options_of(LABELS))
        self.assertNotIn("Damping ratio", self.quantities(open_damping))

    def test_refused(self):
        self.refuse(["report", *MODEL, "--dcc", "c.xml"], "--dcc: ", "expected also --device, --serial", "--customer")
        for name, value, words in [("date", "1 May", "YYYY-MM-DD"), ("date", "2024-13-01", "YYYY-MM-DD"), ("country", "Germany", "two capital")]:
            self.refuse(["report", *MODEL, "--dcc", "c.xml", *options_of(LABELS | {name: value})], f"--{name}: ", words)
        for name in LABELS:
            labels = {key: value for key, value in LABELS.items() if key != name}
            self.refuse(["report", *MODEL, "--dcc", "c.xml", *options_of(labels)], f"expected also --{name}\n")
        self.refuse(["report", *MODEL, "--dcc", "no/c.xml", *options_of(LABELS)], "no/c.xml", status=2)


if __name__ == "__main__":
    main()
