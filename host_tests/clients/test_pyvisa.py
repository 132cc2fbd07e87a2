"""PyVISA takes the instrument through the whole job, as a lab's script would.

usage: test_pyvisa.py PROGRAM [unittest arguments]                              the program itself, by TCP
       test_pyvisa.py PROGRAM IMAGE RUNNER... -- [unittest arguments]   an image of a board, and what runs it

PROGRAM is always the one for this PC: its report is what every instrument must give.
"""

import os
import sys
import time
import unittest
import warnings

import pyvisa

import emax
from instruments import BoardImage, HostProgram

MODEL = "1.037,4073,0.3182,0.003,6,0.0004"
# For software double in an emulator; on the program none of it takes a second.
PATIENCE_MS = 300_000
TRIALS = "1000"
TREND = "0.002,0.004"

PROGRAM = ""
IMAGE: list[str] = []


class ClientTest(unittest.TestCase):
    """Each test meets an instrument that has just been switched on."""

    def setUp(self):
        instrument = BoardImage(IMAGE[1:], IMAGE[0]) if IMAGE else HostProgram(PROGRAM)
        self.addCleanup(instrument.close)
        manager = pyvisa.ResourceManager("@py")
        self.addCleanup(manager.close)
        self.visa = manager.open_resource(f"TCPIP::127.0.0.1::{instrument.port}::SOCKET", timeout=PATIENCE_MS,
                                          read_termination="\n", write_termination="\r\n")

    def numbers(self, query: str) -> list[float]:
        return self.visa.query_ascii_values(query)

    def assert_error(self, expected: str):
        """The oldest error is this one, and there is no other."""
        self.assertEqual(self.visa.query("SYST:ERR?"), expected)
        self.assertEqual(self.visa.query("SYST:ERR:COUN?"), "0")

    def assert_no_error(self):
        self.assertEqual(self.visa.query("SYST:ERR?"), '0,"No error"')

    def block(self, query: str) -> bytes:
        self.visa.write(query)
        self.assertEqual(self.visa.read_bytes(1), b"#")
        digits = int(self.visa.read_bytes(1))
        content = self.visa.read_bytes(int(self.visa.read_bytes(digits)))
        self.assertEqual(self.visa.read_bytes(1), b"\n")
        return content

    def report(self, *options: str) -> bytes:
        return emax.run("report", *options, program=PROGRAM)


class WholeJob(ClientTest):
    def test_from_sweep_to_report(self):
        self.assertEqual(len(self.visa.query("*IDN?").split(",")), 4)
        self.visa.write("*CLS;*ESE 1;:CALC:MCAR:TRI " + TRIALS)
        self.visa.write("INIT;*OPC")
        self.assertEqual(int(self.visa.query("STAT:OPER:COND?")) & 0b11000, 0b11000, "sweeping and measuring")
        self.assertEqual(self.visa.query("*OPC?"), "1")
        self.assertEqual(int(self.visa.query("*ESR?")) & 1, 1)
        points = self.numbers("FETC:FRES?")
        self.assertEqual((points[0], len(points)), (42, 1 + 5 * 42))
        fit = self.numbers("CALC:IDEN?")
        # What the simulated bench was built from, within four standard uncertainties.
        for value, truth, u in zip(fit, [1.037, 4073.0, 0.3182], fit[3:]):
            self.assertLess(abs(value - truth), 4 * u)
        energy = self.numbers("CALC:ENER?")
        self.assertEqual(len(energy), 4 + int(energy[3]))
        self.assertLess(energy[0], energy[2], "the bound")
        trials = self.numbers("CALC:MCAR?")
        self.assertEqual(trials[0], float(TRIALS))
        self.assertLess(abs(trials[6] / energy[0] - 1), 1e-3, "the mean")
        trend = self.numbers("CALC:TREN? " + TREND)
        self.assertEqual(trend[2], energy[0])
        self.assertLess(energy[0], trend[3])
        self.assertEqual(self.block("CALC:REP?"), self.report("--trials", TRIALS, "--trend", TREND))
        self.assert_no_error()

    def test_known_parameters(self):
        self.visa.write(f"CALC:MOD {MODEL};:CALC:MCAR:TRI {TRIALS}")
        # The best known to its 13 digits; E is flat there, so that the switch is known to about 1e-7 of its time.
        energy = self.numbers("CALC:ENER?")
        self.assertAlmostEqual(energy[0], 0.005115251359876, delta=5e-16)
        self.assertAlmostEqual(energy[4], 1.0474909417558e-3, delta=1e-10)
        self.numbers("CALC:TREN? " + TREND)
        self.visa.write("INIT:REP")
        self.assertEqual(self.visa.query("*OPC?"), "1")
        options = ["--model", MODEL, "--trials", TRIALS, "--trend", TREND]
        self.assertEqual(self.block("CALC:REP?"), self.report(*options))
        self.assert_no_error()


class Refusals(ClientTest):
    def test_errors_are_queued_and_said(self):
        self.visa.write("ABCD 1")
        self.assert_error('-113,"Undefined header;ABCD"')
        self.visa.write("CALC:FILT:ORD 16")
        code, words = self.visa.query("SYST:ERR?").split(",", 1)
        self.assertEqual(code, "-222", words)
        self.assertEqual(self.numbers("CALC:FILT:ORD?"), [10.0])
        self.visa.write("FETC:FRES?")
        code, words = self.visa.query("SYST:ERR?").split(",", 1)
        self.assertEqual(code, "-230")
        self.assertIn("INIT", words)
        self.assertEqual(int(self.visa.query("*ESR?")) & 0b110000, 0b110000, "command and execution error")

    def test_self_test(self):
        self.assertEqual(self.visa.query("*TST?"), "0")


class Interruptions(ClientTest):
    def abort(self, start: str, active: int):
        """Starts, sees it at work, aborts it; no more than the patience of a client may pass."""
        self.visa.write(start)
        self.assertEqual(int(self.visa.query("STAT:OPER:COND?")) & active, active)
        self.assertRegex(self.visa.query("SYST:PROG?"), r'^[0-9.e+-]+,".+"$')
        self.visa.write("ABOR")
        self.visa.timeout = 2000
        self.assertEqual(self.visa.query("*OPC?"), "1")
        self.assertEqual(int(self.visa.query("STAT:OPER:COND?")) & active, 0)
        self.visa.timeout = PATIENCE_MS

    def test_abort_sweep(self):
        # Many periods, so that it runs even on the fastest machine.
        self.visa.write("SENS:SWE:CYCL 1000")
        self.abort("INIT", 0b1000)
        self.assertEqual(self.visa.query("*OPC?"), "1")
        self.visa.write("*RST")
        self.visa.write("INIT")
        self.assertEqual(self.visa.query("*OPC?"), "1")
        self.assertEqual(self.numbers("FETC:FRES?")[0], 42)
        self.assert_no_error()

    def test_abort_trials_from_behind_a_waiting_query(self):
        self.visa.write(f"CALC:MOD {MODEL};:CALC:MCAR:TRI 100000000")
        energy = self.visa.query("CALC:ENER?")
        self.visa.write("INIT:MCAR;*OPC?")
        time.sleep(0.2)
        self.assertRegex(self.visa.query("SYST:PROG?"), r'^[0-9.e+-]+,".+"$')
        self.visa.write("ABOR")
        self.visa.timeout = 2000
        self.assertEqual(self.visa.read(), "1", "*OPC? answers when the operation has ended")
        self.assertEqual(self.visa.query("CALC:ENER?"), energy, "what was there stays")


class FrontEnd(ClientTest):
    """`emax report --instrument` has the instrument measure and evaluates on the PC: the same results, byte for byte."""

    def setUp(self):
        self.instrument = BoardImage(IMAGE[1:], IMAGE[0]) if IMAGE else HostProgram(PROGRAM)
        self.addCleanup(self.instrument.close)

    def test_report(self):
        options = ["--trials", TRIALS, "--trend", "none", "--level", "2", "--json"]
        got = self.report("--instrument", f"127.0.0.1:{self.instrument.port}", *options)
        self.assertEqual(got, self.report(*options))


def main() -> None:
    global PROGRAM, IMAGE
    PROGRAM, rest = os.path.abspath(sys.argv[1]), sys.argv[2:]
    if rest and os.path.exists(rest[0]):
        end = rest.index("--")
        IMAGE, rest = rest[:end], rest[end + 1:]
    warnings.simplefilter("ignore", ResourceWarning)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
