"""The page emax.html with an instrument at a serial port: a stand-in for the port, with a real console behind it.

usage: test_serial.py PROGRAM DATA_DIRECTORY EMAX.HTML "RUNNER... IMAGE" [unittest arguments]
"""

import json
import os
import select
import subprocess

from page_test import BOARD, PROGRAM, PageTest, main

# Bytes are characters of the same number on their way between the page and this script.
FAKE = """
(() => {
  let feed = null;
  const port = {
    async open({baudRate}) {
      if (baudRate !== 115200) {
        throw new Error('baud rate');
      }
      port.readable = new ReadableStream({start(controller) { feed = controller; }});
      port.writable = new WritableStream({write(bytes) { window.sent(String.fromCharCode(...bytes)); }});
    },
    async close() {},
    async setSignals() {},
  };
  window.fake = {
    receive(text) { feed.enqueue(Uint8Array.from(text, (character) => character.charCodeAt(0))); },
    unplug() { feed.error(new DOMException('The device has been lost.', 'NetworkError')); },
  };
  Object.defineProperty(navigator, 'serial', {value: {requestPort: async () => port}});
})();
"""
QUICK = [
    "CALC:MCAR:TRI 1000",
    "CALC:ENER:TIME 0.001",
    "CALC:TREN:TIME 0.0005,0.001",
    "SENS:SWE:REP 2",
    "SENS:SWE:FREQ 1000,2000,3000,4000,5000",
]


class SerialTest(PageTest):
    def setUp(self):
        super().setUp()
        self.process = None
        self.browser.call("Runtime.addBinding", name="sent")
        self.browser.call("Page.addScriptToEvaluateOnNewDocument", source=FAKE)

    def plug_in(self, command: list[str]) -> None:
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.addCleanup(self.stop_process, self.process)

    @staticmethod
    def stop_process(process) -> None:
        process.kill()
        process.wait()
        process.stdin.close()
        process.stdout.close()

    def between_looks(self) -> None:
        """What the page has sent goes to the instrument, and its answers to the page."""
        sent = [event for event in self.browser.events if event.get("method") == "Runtime.bindingCalled"]
        self.browser.events = [event for event in self.browser.events if event not in sent]
        if self.process is None:
            return
        for event in sent:
            self.process.stdin.write(event["params"]["payload"].encode("latin-1"))
        self.process.stdin.flush()
        ready, _, _ = select.select([self.process.stdout], [], [], 0.01)
        if ready:
            text = os.read(self.process.stdout.fileno(), 1 << 16).decode("latin-1")
            self.browser.evaluate(f"fake.receive({json.dumps(text)})")

    def connect(self) -> None:
        self.open()
        self.click("connect-serial")
        self.idle()


class SerialProgram(SerialTest):
    def test_sweeps_evaluates_stops_and_survives_the_plug(self):
        # In half of real time, so that there is a middle of a sweep.
        self.plug_in([PROGRAM, "scpi", "--pace", "0.5"])
        self.connect()
        self.assertEqual(self.text("problem"), "")
        self.assertIn("board at a serial port, emax,host,0,", self.text("connection"))
        for line in QUICK:
            self.speak(line)
        self.click("sweep")
        self.idle()
        self.assertEqual(self.text("problem"), "")
        script = "\n".join([*QUICK, "INIT;*WAI", "INIT:REP;*WAI", "FETC:JSON?"])
        expected = subprocess.run([PROGRAM, "scpi"], input=f"{script}\n", capture_output=True, text=True, check=True).stdout
        self.assertEqual(self.results()["energy"], json.loads(expected[expected.index("{") :])["energy"])

        # Not from 30 Hz on: what the shaker still does after that would count as drift in the sweep that follows at once.
        self.speak("SENS:SWE:FREQ " + ",".join(map(str, range(500, 4500, 100))))
        self.click("sweep")
        self.wait_for("document.querySelectorAll('#growing .dot').length >= 4")
        self.click("abort")
        self.idle()
        self.assertIn("stopped; the drive is at zero", self.text("problem"))

        self.click("sweep")
        self.wait_for("document.querySelectorAll('#growing .dot').length >= 4")
        self.browser.evaluate("fake.unplug()")
        self.idle()
        self.assertIn("the serial port is gone: The device has been lost.", self.text("problem"))
        self.assertIn("Not connected", self.text("connection"))
        self.process = None
        # The points of all three are kept, over a reload, too.
        self.open()
        sources = self.browser.evaluate(
            "[...document.querySelectorAll('#device-list tbody tr')].map((row) => row.cells[4].textContent)"
        )
        self.assertEqual(sources, ["sweep"] * 3)
        rows = self.saved("save-csv").splitlines()
        self.assertGreaterEqual(len(rows), 3)
        self.assertEqual([rows[0], rows[1].split(",")[0]], ["f_hz,amplitude,phase_deg", "500"])
        self.assertIn("broke off", self.text("certificate"))
        self.assertIn("simulated bench in this page", self.text("connection"))
        self.assert_quiet()

    def test_is_left_where_something_else_answers(self):
        answers = "*IDN*) echo other,thing,1,2;; *ERR*) echo '0,\"No error\";1999.0';;"
        self.plug_in(["sh", "-c", f"while read line; do case $line in {answers} esac; done"])
        self.connect()
        self.assertIn("this instrument says it is other,thing,1,2, not emax", self.text("problem"))
        self.assertEqual(self.text("connection"), "not connected")


class SerialBoard(SerialTest):
    def test_gives_the_digits_of_the_program(self):
        self.plug_in(BOARD)
        self.connect()
        self.assertEqual(self.text("problem"), "")
        for line in QUICK:
            self.speak(line)
        self.click("sweep")
        self.idle()
        self.assertEqual(self.text("problem"), "")
        script = "\n".join([*QUICK, "INIT;*WAI", "INIT:REP;*WAI", "FETC:JSON?"])
        expected = subprocess.run([PROGRAM, "scpi"], input=f"{script}\n", capture_output=True, text=True, check=True).stdout
        expected = json.loads(expected[expected.index("{") :])
        got = self.results()
        for part in ["model", "energy", "band", "uncertainty", "monte_carlo", "trend"]:
            self.assertEqual(got[part], expected[part], part)
        rows = [[float(cell) for cell in row.split(",")] for row in self.saved("save-csv").splitlines()[1:]]
        self.assertEqual(rows, [list(point.values()) for point in expected["points"]])
        self.assert_quiet()


if __name__ == "__main__":
    main()
