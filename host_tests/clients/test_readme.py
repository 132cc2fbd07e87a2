"""The examples of the README, run as they stand there, print what stands there.

usage: test_readme.py PROGRAM PROJECT_DIRECTORY
"""

import csv
import json
import math
import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile
import termios
import tty
import unittest
import xml.etree.ElementTree

import in_band_picture
from instruments import HostProgram

PROGRAM, PROJECT = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
README = (PROJECT / "README.md").read_text(encoding="utf-8")
DESK = (PROJECT / "firmware/desk/README.md").read_text(encoding="utf-8")
CLAIMS = (PROJECT / "host_tests/reference/README.md").read_text(encoding="utf-8")
SHOWN = PROJECT / "firmware/desk/pictures/readme"
ADDRESS = "TCPIP::127.0.0.1::5025::SOCKET"
# What PyVISA asks of pySerial, which need not be installed. The default speed is pySerial's own.
SERIAL = '''
import os, select, termios, tty
class SerialTimeoutException(IOError): pass
class Serial:
    def __init__(self, port, baudrate=9600, timeout=None, write_timeout=None):
        self.line, self.timeout = os.open(port, os.O_RDWR | os.O_NOCTTY), timeout
        tty.setraw(self.line)
        self.baudrate = baudrate
    def __setattr__(self, name, value):
        self.__dict__[name] = value
        if name == "baudrate":
            attributes = termios.tcgetattr(self.line)
            attributes[4:6] = [getattr(termios, f"B{value}")] * 2
            termios.tcsetattr(self.line, termios.TCSANOW, attributes)
    def read(self, count):
        return os.read(self.line, count) if select.select([self.line], [], [], self.timeout)[0] else b""
    def write(self, data):
        return os.write(self.line, data)
    def close(self):
        os.close(self.line)
'''


def texts_of(picture: pathlib.Path) -> list[str]:
    """The words in a picture."""
    root = xml.etree.ElementTree.parse(picture).getroot()
    return ["".join(text.itertext()).strip() for text in root.iter("{http://www.w3.org/2000/svg}text")]


class ReadmeTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)

    def run_line(self, command: str) -> subprocess.CompletedProcess:
        """A command of the README, run as if beside it, in an empty directory."""
        line = command.replace("build/host/emax", f"'{PROGRAM}'").replace("host_tests/", f"'{PROJECT}'/host_tests/")
        self.assertIn(PROGRAM, line)
        return subprocess.run(line, shell=True, cwd=self.directory, capture_output=True, text=True, timeout=500)

    def print_of(self, command: str) -> str:
        result = self.run_line(command)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return result.stdout

    def block_after(self, words: str, text: str = README) -> str:
        """The first block after these words."""
        self.assertEqual(text.count(words), 1, words)
        return re.search(r"^```\n((?:.*\n)*?)```$", text.split(words)[1], re.MULTILINE)[1]

    def assert_excerpt(self, excerpt: str, printed: str) -> None:
        """Each paragraph of the excerpt stands in what was printed, in this order; `...` leaves lines out."""
        place = 0
        for part in re.split(r"\n\n|^ *\.\.\.\n", excerpt, flags=re.MULTILINE):
            lines = part.strip("\n") + "\n"
            found = printed.find("\n" + lines, max(place - 1, 0))
            self.assertNotEqual(found, -1, lines)
            place = found + 1 + len(lines)

    def assert_shown(self, picture: str, drawn: pathlib.Path) -> None:
        links = [f"({SHOWN.relative_to(PROJECT)}/{picture})" in README, f"({SHOWN.relative_to(PROJECT / 'firmware/desk')}/{picture})" in DESK]
        self.assertIn(True, links)
        self.assertEqual(texts_of(SHOWN / picture), texts_of(drawn))
        shown, fresh = [path.read_text(encoding="utf-8") for path in [SHOWN / picture, drawn]]
        if re.search("<desc>.*</desc>", shown)[0] == re.search("<desc>.*</desc>", fresh)[0]:
            self.assertEqual(shown, fresh)  # Another gnuplot may set its lines elsewhere.

    def session(self, start: str) -> tuple[str, str]:
        """The one block that shows a command with that start: the command, and what it prints."""
        found = re.findall(rf"^```\n\$ ({re.escape(start)}.*)\n((?:.*\n)*?)```$", README, re.MULTILINE)
        self.assertEqual(len(found), 1, start)
        return found[0]

    def test_by_hand(self):
        command, printed = self.session("printf ")
        self.assertEqual(self.print_of(command), printed)

    def test_report_and_its_pictures(self):
        printed = self.print_of("build/host/emax report --out results")
        self.assert_excerpt(self.block_after("#the-report-line-by-line)):"), printed)
        self.assert_excerpt(self.block_after("without what was put in (shortened):", DESK), printed)
        drawn = sorted(path.name for path in (self.directory / "results").glob("*.svg"))
        self.assertEqual(len(drawn), 5)
        self.assertEqual(sorted(path.name for path in SHOWN.iterdir()), sorted(["comparison.svg", "in_band.csv", "in_band.svg", *drawn]))
        for picture in drawn:
            self.assert_shown(picture, self.directory / "results" / picture)

    def test_report_of_poor_data(self):
        command = "build/host/emax report --points host_tests/data/djb_a1800v.csv"
        self.assert_excerpt(self.block_after(f"`{command}`. Poor\ndata get a plain warning:"), self.print_of(command))

    def test_what_points_have_in_common(self):
        """The number that the texts give for the tables of the tour is the one that the bench they are from has."""
        parts = [float(part) for part in re.search(r"√\((.*)²\) = ", README)[1].split("² + ")]
        total, given = re.search(r"²\) = (\S+), given as (\S+):", README).groups()
        self.assertEqual(total, f"{math.hypot(*parts):.4f}")
        report = self.print_of("build/host/emax report --trials 1000 --trend none")
        reference, mounting, gains = parts
        for words in [f"V/(m/s^2), U = {reference:g} % (k = 2)", f"(device, U = {gains:g} %)", f"U = {mounting:g} %, with transverse"]:
            self.assertIn(words, report)
        for text in [README, DESK]:
            self.assertEqual(set(re.findall(r"--reference-uncertainty ([\d.]+)", text)), {given})
        self.assertLess(float(given), float(total))
        # With it the points scatter as much as they should.
        table = "host_tests/data/devices/piezo_a.csv"
        model = json.loads(self.print_of(f"build/host/emax report --points {table} --reference-uncertainty {given} --trials 1000 --json"))["model"]
        self.assertAlmostEqual(model["chi2"] / model["dof"], 1.0, delta=math.sqrt(2 / model["dof"]))

    def test_energy_of_each_order(self):
        start = "build/host/emax report --model 1.037,4073,0.3182 --trend none --order"
        table = CLAIMS.split(f"`{start} L`:")[1].split("\n\n")[1].splitlines()
        orders, energies, switches = [[cell.strip() for cell in table[row].split("|")[2:-1]] for row in [0, 2, 3]]
        self.assertEqual(orders, [str(order) for order in range(1, 16)])
        for order, energy, count in zip(orders, energies, switches, strict=True):
            with self.subTest(order=order):
                result = json.loads(self.print_of(f"{start} {order} --json"))["energy"]
                self.assertEqual((f"{1e3 * result['E']:.3f}", str(len(result["switch_times"]))), (energy, count))

    def test_fault(self):
        command, printed = self.session("build/host/emax report --bench-fault ")
        result = self.run_line(command)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (3, "", printed))

    def test_tour(self):
        printed = self.print_of(self.block_after("Without `--by`:"))
        self.assertEqual(printed, self.block_after("--out comparison\n```\n\nprints\n"))
        self.assert_shown("comparison.svg", self.directory / "comparison/comparison.svg")

    def test_both_figures_over_the_resonance(self):
        table = SHOWN / "in_band.csv"
        with open(table, encoding="ascii", newline="") as file:
            rows = {(row["f0/fc"], row["beta"]): row for row in csv.DictReader(file)}
        self.assertEqual(len(rows), len(in_band_picture.RATIOS) * len(in_band_picture.DAMPINGS))
        for ratio, damping in [(1, "0.7"), (3.15, "0.02"), (10, "0.7")]:
            band, matched = in_band_picture.figures(PROGRAM, ratio, damping)
            row = rows[f"{ratio:g}", damping]
            self.assertEqual(row["in_band_percent"], f"{band:.6g}")
            self.assertEqual(row["matched_percent"], "" if matched is None else f"{matched:.6g}")
        # DESIGN: 2 kHz, 0.7: 23.6 and 1.01 %; 8 kHz, 0.7: 6.007 and 0.0176 %.
        for key, figures in [(("2", "0.7"), (23.6, 1.01)), (("8", "0.7"), (6.007, 0.0176))]:
            for name, figure in zip(["in_band_percent", "matched_percent"], figures):
                self.assertAlmostEqual(float(rows[key][name]) / figure, 1.0, delta=0.003)
        drawn = self.directory / "in_band.svg"
        in_band_picture.draw(str(table), str(drawn))
        self.assert_shown("in_band.svg", drawn)

    def test_links_lead_somewhere(self):
        """Every file that a README links to is there, and so is the heading."""
        for readme in [path for path in sorted(PROJECT.rglob("README.md")) if "build" not in path.relative_to(PROJECT).parts]:
            text = re.sub(r"^```.*?^```", "", readme.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
            for link in re.findall(r"\]\(([^)\s]+)\)", text):
                name, _, heading = link.partition("#")
                if re.match("[a-z]+:", link) or name.startswith("build/"):
                    continue
                with self.subTest(readme=str(readme.relative_to(PROJECT)), link=link):
                    target = readme.parent / name if name else readme
                    self.assertTrue(target.exists())
                    if heading:
                        titles = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE)
                        anchors = [re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles]
                        self.assertIn(heading, anchors)

    def test_pyvisa(self):
        command, printed = self.session("python3 example.py ")
        self.assertEqual(command, f"python3 example.py {ADDRESS}")
        scripts = re.findall(r"^```python\n((?:.*\n)*?)```$", README, re.MULTILINE)
        self.assertEqual(len(scripts), 1)
        self.assertEqual(scripts[0].count("\n"), 12, "twelve lines")
        result = self.run_script(scripts[0])
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, printed, ""))
        # A fault ends it at once, and not with the patience of the client.
        result = self.run_script(scripts[0], "--bench-fault", "unplugged-device@3")
        self.assertEqual((result.returncode, result.stdout), (1, printed.splitlines()[0] + "\n"))
        self.assertRegex(result.stderr, r'^-240,"Hardware error;no device: [^"]*"\n$')
        # So does a sweep that ends well and whose E would be wrong.
        result = self.run_script(scripts[0], "--bench-fault", "gain-step@0.9")
        self.assertEqual((result.returncode, result.stdout), (1, printed.splitlines()[0] + "\n"))
        self.assertRegex(result.stderr, r'^-230,"Data corrupt or stale;check\'s ratio changed: [^"]*"\n$')

    def test_pyvisa_on_a_serial_line(self):
        """The same on a terminal in place of a board's line, at the speed that a board has."""
        script = re.search(r"^```python\n((?:.*\n)*?)```$", README, re.MULTILINE)[1]
        tools = self.directory / "serial/tools"
        tools.mkdir(parents=True)
        (tools.parent / "__init__.py").write_text(SERIAL)
        (tools / "__init__.py").write_text("")
        (tools / "list_ports.py").write_text("comports = list\n")
        board, line = pty.openpty()
        self.addCleanup(os.close, board)
        self.addCleanup(os.close, line)
        tty.setraw(line)
        instrument = subprocess.Popen([PROGRAM, "scpi"], stdin=board, stdout=board, cwd=self.directory)
        self.addCleanup(instrument.wait)
        self.addCleanup(instrument.kill)
        path = self.directory / "example.py"
        path.write_text(script)
        result = subprocess.run([sys.executable, "-W", "ignore", path, f"ASRL{os.ttyname(line)}::INSTR"], check=False,
                                capture_output=True, text=True, timeout=500)
        printed = self.session("python3 example.py ")[1]
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, printed, ""))
        self.assertEqual(termios.tcgetattr(line)[4:6], [termios.B115200] * 2)

    def run_script(self, script: str, *options: str) -> subprocess.CompletedProcess:
        instrument = HostProgram(PROGRAM, *options)
        self.addCleanup(instrument.close)
        path = self.directory / "example.py"
        path.write_text(script)
        address = ADDRESS.replace("5025", str(instrument.port))
        return subprocess.run([sys.executable, "-W", "ignore", path, address], check=False,
                              capture_output=True, text=True, timeout=500)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
