"""`emax report --instrument` as its user meets it: against `emax scpi` on a port and on a serial line, and against peers
that go wrong.

usage: test_instrument.py PROGRAM DATA_DIRECTORY [unittest arguments]
"""

import json
import os
import pty
import select
import signal
import socket
import subprocess
import threading
import time
import tty

from program_test import PATIENCE, PROGRAM, QUICK, ProgramTest, TcpInstrument, main, restore_signals


class SerialInstrument:
    """`emax scpi` behind a pseudo terminal, which stands for the serial line."""

    def __init__(self, *arguments: str):
        self.line, far_end = pty.openpty()
        tty.setraw(self.line)
        self.port = os.ttyname(far_end)
        self.far_end = far_end  # Held open: the line is there before and after its peer.
        self.process = subprocess.Popen([PROGRAM, "scpi", *arguments], stdin=self.line, stdout=self.line,
                                        stderr=subprocess.DEVNULL, preexec_fn=restore_signals)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()
        os.close(self.line)
        os.close(self.far_end)


class Peer:
    """A server on a port that does with its one connection what it is told."""

    def __init__(self, behave):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = f"127.0.0.1:{self.listener.getsockname()[1]}"
        self.thread = threading.Thread(target=self.serve, args=(behave,), daemon=True)
        self.thread.start()

    def serve(self, behave) -> None:
        peer, _ = self.listener.accept()
        with peer:
            behave(peer)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.listener.close()
        self.thread.join(PATIENCE)


def answer_lines(answers: dict[bytes, bytes]):
    """Answers each line that has one of these words with what belongs to it."""
    def behave(peer: socket.socket) -> None:
        with peer.makefile("rb") as lines:
            for line in lines:
                for word, answer in answers.items():
                    if word in line:
                        peer.sendall(answer)
                        break
    return behave


class InstrumentSweeps(ProgramTest):
    def expect_the_same(self, instrument, bench: list[str], options: list[str]) -> None:
        """The first sweep of a bench that was just built is the one that `emax report` makes on it, digit for digit."""
        with instrument(*bench) as remote:
            got = self.succeed("report", "--instrument", remote.port, *options, *QUICK, "--json")
        self.assertEqual(got, self.succeed("report", *bench, *options, *QUICK, "--json"))
        self.assertEqual(json.loads(got)["bench"]["points"], 42)

    def test_by_socket(self) -> None:
        self.expect_the_same(TcpInstrument, [], [])

    def test_by_socket_with_other_settings(self) -> None:
        self.expect_the_same(TcpInstrument, ["--bench-seed", "7", "--bench-truth", "0.5,3000,0.4"],
                             ["--level", "2", "--cycles", "4", "--settle", "0.02", "--acceleration-limit", "30", "--drive-limit", "4",
                              "--order", "7", "--time", "0.003"])

    def test_by_socket_with_another_chain(self) -> None:
        """What sets a conditioner with its uncertainty, a table, and a level above the limit of before."""
        options = ["--level", "25", "--acceleration-limit", "40", "--device-gain", "1,0.3", "--reference-table", "10,0.1,9000,0.1",
                   "--mounting-uncertainty", "0.3", "--correction-skew", "1.25e-6,1e-8"]
        # The bench is made by these options, too; a limit of its own, so that the order of the settings matters.
        bench = [*options[4:], "--level", "1", "--acceleration-limit", "20"]
        with TcpInstrument(*bench) as remote:
            got = self.succeed("report", "--instrument", remote.port, *options, *QUICK, "--json")
        self.assertEqual(got, self.succeed("report", *options, *QUICK, "--json"))

    def test_by_serial_line(self) -> None:
        self.expect_the_same(SerialInstrument, ["--bench-seed", "3"], [])

    def test_a_fault_after_the_end_is_told(self) -> None:
        with TcpInstrument("--bench-fault", "dc-drift@1000") as remote:
            done = self.run_program("report", "--instrument", remote.port, *QUICK, "--json")
        self.assertEqual(done.returncode, 0)
        self.assert_one_line(done.stderr, "dc-drift did not strike: the sweep has ended after ", "give an earlier time")
        self.assertEqual(done.stdout.decode(), self.succeed("report", *QUICK, "--json"))

    def test_a_doubtful_sweep_is_no_failure(self) -> None:
        """The instrument has an error for it at its end; the report has its warning, as that of the same bench has here."""
        bench = ["--bench-fault", "gain-step@0.9"]
        options = ["--device-sensitivity", "0.5"]
        with TcpInstrument(*bench) as remote:
            got = self.run_program("report", "--instrument", remote.port, *options, *QUICK, "--json")
            errors = remote.ask("SYST:ERR:ALL?")
            again = self.run_program("report", "--instrument", remote.port, *options, *QUICK, "--json")
        self.assertEqual((got.returncode, got.stderr), (0, b""))
        self.assertEqual(got.stdout.decode(), self.succeed("report", *bench, *options, *QUICK, "--json"))
        self.assertEqual([line["about"] for line in json.loads(got.stdout)["warnings"]][-2:], ["measurement"] * 2)
        self.assertEqual(errors.count('-230,"Data corrupt or stale;'), 2, errors)
        self.assertEqual(again.returncode, 0, "what stood in the queue is nothing to the next one")

    def test_files(self) -> None:
        with TcpInstrument() as remote:
            self.succeed("report", "--instrument", remote.port, *QUICK, "--out", "remote")
        self.succeed("report", *QUICK, "--out", "local")
        names = [name for name in self.files() if name.startswith("local/")]
        self.assertIn("local/report.html", names)
        for name in names:
            other = name.replace("local", "remote")
            self.assertEqual((self.directory / other).read_bytes(), (self.directory / name).read_bytes(), name)

    def test_what_the_sweep_is_made_of_is_set(self) -> None:
        with TcpInstrument() as remote:
            remote.ask("SOUR:LEV 5;:SENS:SWE:FREQ 100,200,300;:SENS:SWE:CYCL 90;REP 3;SETT 0.5;:SYST:ERR?")
            result = json.loads(self.succeed("report", "--instrument", remote.port, *QUICK, "--json"))
            self.assertEqual(remote.ask("SENS:SWE:CYCL?;REP?;SETT?"), "3;5;1.0E-2")
        self.assertEqual((result["bench"]["level"], result["bench"]["points"]), (1, 42))

    # A limit for an amplifier, what a front end makes of the channels, and a reference: nobody may lose them by a report.
    BENCH = ("SOUR:LIM:VOLT 1", "SOUR:FULL 6", "SENS:REF:FULL 10.99", "SENS:DEV:FULL 10.98", "SOUR:LIM 2", "SENS:DEV:GAIN 1,0.2",
             "SENS:REF:TABL 10,0.1,9000,0.11", "SENS:CORR:SKEW 1.25E-6,1E-8", "SENS:MOUN:UNC 0.3")
    ASKED = "SOUR:LIM:VOLT?;:SOUR:FULL?;:SENS:REF:FULL?;:SENS:DEV:FULL?;:SOUR:LIM?;:SENS:DEV:GAIN?;:SENS:REF:TABL?;SENS?;" \
            ":SENS:CORR:SKEW?;:SENS:MOUN:UNC?"

    def test_the_bench_stays_as_the_instrument_was_told(self) -> None:
        with TcpInstrument() as remote:
            self.assertEqual(remote.ask(":" + ";:".join(self.BENCH) + ";:SYST:ERR?"), '0,"No error"')
            before = remote.ask(self.ASKED)
            self.run_program("report", "--instrument", remote.port, "--frequencies", "80,160,320", *QUICK)
            self.assertEqual(remote.ask(self.ASKED), before)
            self.assertEqual(before, "1;6;10.99;10.98;2;1,2.0E-1;10,1.0E-1,9000,1.1E-1;1.0E-1,5.0E-1;1.25E-6,1.0E-8;3.0E-1")

    def test_what_is_given_of_the_bench_is_set_even_if_it_is_the_default(self) -> None:
        with TcpInstrument() as remote:
            remote.ask(":" + ";:".join(self.BENCH) + ";:SYST:ERR?")
            self.run_program("report", "--instrument", remote.port, "--frequencies", "80,160,320", "--drive-limit", "5",
                             "--device-gain", "1.5", "--reference-uncertainty", "0.7", "--correction-skew", "0,0", *QUICK)
            self.assertEqual(remote.ask(self.ASKED),
                             "5;6;10.99;10.98;2;1.5,2.0E-1;10,1.0E-1,9000,1.1E-1;1.0E-1,7.0E-1;0,0;3.0E-1")
            self.run_program("report", "--instrument", remote.port, "--frequencies", "80,160,320",
                             "--reference-sensitivity", "0.2", *QUICK)
            self.assertEqual(remote.ask("SENS:REF:TABL?;SENS?"), "0,2.0E-1;2.0E-1,7.0E-1")

    def test_a_limit_below_the_level_of_before(self) -> None:
        with TcpInstrument() as remote:
            remote.ask("SOUR:LIM 40;LEV 25;:SYST:ERR?")
            self.succeed("report", "--instrument", remote.port, "--acceleration-limit", "3", *QUICK)
            self.assertEqual(remote.ask("SOUR:LIM?;LEV?"), "3;1")

    # Each pair of what limits one another, and what limits it by a rate: low and high.
    PAIRS = [
        ([("--drive-full-scale", 2), ("--drive-limit", 2)], [("--drive-full-scale", 10), ("--drive-limit", 5)]),
        ([("--drive-full-scale", 10), ("--drive-limit", 5)], [("--drive-full-scale", 100), ("--drive-limit", 50)]),
        ([("--drive-limit", 0.5), ("--slew", 300)], [("--drive-limit", 10), ("--slew", 5000)]),
        ([("--level", 1), ("--acceleration-limit", 2)], [("--level", 25), ("--acceleration-limit", 40)]),
    ]
    LIMITS = "SOUR:FULL?;:SOUR:LIM:VOLT?;:SOUR:SLEW?;:SOUR:LEV?;:SOUR:LIM?"

    def test_limits_rise_and_fall_in_either_order(self) -> None:
        """The simulated bench takes the same options, so no state on the way to them may be refused."""
        names = ["--drive-full-scale", "--drive-limit", "--slew", "--level", "--acceleration-limit"]
        quick = [*QUICK, "--frequencies", "80,160,320"]
        with TcpInstrument() as remote:
            for low, high in self.PAIRS:
                for wanted in (high, low[::-1], high[::-1], low)[:4 if low is self.PAIRS[0][0] else 2]:
                    with self.subTest(wanted):
                        options = [str(word) for pair in wanted for word in pair]
                        got = self.run_program("report", "--instrument", remote.port, *options, *quick)
                        self.assertNotIn(b"refuses", got.stderr)
                        self.assertIn(got.returncode, (0, 3))  # What the bench makes of them is another matter.
                        now = dict(zip(names, map(float, remote.ask(self.LIMITS).split(";"))))
                        self.assertEqual({name: now[name] for name, _ in wanted}, dict(wanted))
                remote.ask("*RST;:SYST:ERR?")


class InstrumentFaults(ProgramTest):
    def test_a_fault_of_its_sweep_keeps_what_was_measured(self) -> None:
        bench = ["--bench-fault", "unplugged-device@4"]
        with TcpInstrument(*bench) as remote:
            got = self.run_program("report", "--instrument", remote.port, "--out", "remote")
        expected = self.run_program("report", *bench, "--out", "local")
        self.assertEqual((got.returncode, got.stdout, got.stderr), (3, expected.stdout, expected.stderr))
        self.assertIn(b"15 of 42 points kept", got.stderr)
        self.assertEqual((self.directory / "remote/frequency_response.csv").read_bytes(),
                         (self.directory / "local/frequency_response.csv").read_bytes())

    def test_a_setting_that_it_refuses(self) -> None:
        with TcpInstrument() as remote:
            self.refuse(["report", "--instrument", remote.port, "--level", "25"], "--level", "-221", "refuses")

    def test_one_that_is_at_work(self) -> None:
        with TcpInstrument("--pace", "1") as remote:
            remote.ask("INIT;:SYST:ERR?")
            self.refuse(["report", "--instrument", remote.port], "at work already", "ABORt", status=3)
            self.assertEqual(remote.ask("STAT:OPER:COND?"), "24", "its sweep goes on")

    def test_what_is_no_emax(self) -> None:
        with Peer(answer_lines({b"*IDN": b"OTHER,1,2,3;0\n" * 20})) as peer:
            self.refuse(["report", "--instrument", peer.port], "OTHER,1,2,3;0", "expected an emax", status=3)

    def test_one_that_goes_away(self) -> None:
        for answers in ({b"*IDN": b"emax,x,0,1;0\n"}, {b"*IDN": b"emax,x,0,1;0\n", b"CLS": b'0,"No error"\n'}):
            def behave(peer, answers=answers):
                with peer.makefile("rb") as lines:
                    for line in lines:
                        word = [word for word in answers if word in line]
                        if not word:
                            return
                        peer.sendall(answers[word[0]])
            with Peer(behave) as peer:
                self.refuse(["report", "--instrument", peer.port], "the connection was closed", status=3)

    def test_patience_has_an_end(self) -> None:
        """10 s for all of an answer, however many bytes of it come one by one; what came is named."""
        def talk_on(peer: socket.socket) -> None:
            with peer.makefile("rb") as lines:
                lines.readline()
                peer.sendall(b"emax,x,0,1;0\n")
                lines.readline()
                try:
                    while True:
                        peer.sendall(b"a")
                        time.sleep(0.2)
                except OSError:  # The program has gone.
                    pass
        cases = [(answer_lines({b"*IDN": b"emax,x,0,1;0\n"}), "no answer for 10 s"),
                 (answer_lines({b"*IDN": b"OTHER,1,2,3\n"}), 'answers "OTHER,1,2,3" to *IDN?; expected an emax'),
                 (answer_lines({b"*IDN": b"OTHER,1,2,3"}), 'answers "OTHER,1,2,3" to *IDN?; expected an emax'),
                 (talk_on, 'no end of an answer within 10 s; it begins with "aaa')]
        begin = time.monotonic()
        peers = [Peer(behave) for behave, _ in cases]
        programs = [self.start_program("report", "--instrument", peer.port) for peer in peers]
        for program, peer, (_, words) in zip(programs, peers, cases):
            output, errors = program.communicate(timeout=PATIENCE)
            self.assertEqual((program.returncode, output), (3, b""))
            self.assert_one_line(errors, words)
            with peer:
                pass
        self.assertLess(time.monotonic() - begin, 30.0)

    def test_one_that_is_lost_in_its_sweep(self) -> None:
        """The points that it has told until then are kept, and it is said that they have no uncertainties yet."""
        with TcpInstrument("--pace", "1") as remote:
            process = self.start_program("report", "--instrument", remote.port, "--out", "out")
            time.sleep(4.5)
            remote.process.kill()
            output, errors = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 3)
        self.assert_one_line(errors, "the connection was closed", "without uncertainties", "interrupted_points.csv")
        rows = output.decode().splitlines()
        self.assertEqual(rows[0], "f_hz,amplitude,phase_deg")
        self.assertGreater(len(rows), 3)
        self.assertIn(f"; {len(rows) - 1} points,".encode(), errors)
        self.assertEqual((self.directory / "out/interrupted_points.csv").read_bytes(), output)
        self.succeed("report", *QUICK, "--out", "whole")
        table = (self.directory / "whole/frequency_response.csv").read_text().splitlines()
        for kept, measured in zip(rows[1:], table[1:]):
            for one, other in zip(kept.split(","), measured.split(",")):
                self.assertAlmostEqual(float(one), float(other), delta=1e-12 * abs(float(other)))

    def test_one_whose_answer_is_no_sweep(self) -> None:
        talk = {b"*IDN": b"emax,x,0,1;0\n", b"LEV?": b"1\n", b"SYST:ERR": b'0,"No error"\n', b"PROG": b'100,"idle";0;0\n'}
        for json_answer, words in ((b"#15{\"a\":\n", "no JSON"), (b"#12{}\n", "does not tell the setting"),
                                   (b"1\n", "not answered with a block")):
            with Peer(answer_lines(talk | {b"JSON": json_answer})) as peer:
                self.refuse(["report", "--instrument", peer.port], words, status=3)

    def test_ports_that_are_none(self) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        self.write(["not a line"], name="file")
        for name in (f"127.0.0.1:{port}", "127.0.0.1", ":5025", "127.0.0.1:", "/dev/no-such-line", "/dev/null", "./file",
                     "no-such-host.invalid:5025", "127.0.0.1:0", f"127.0.0.1:{port + 65536}", "127.0.0.1:+5025"):
            self.refuse(["report", "--instrument", name], "--instrument: ", "expected HOST:PORT")

    def test_options_that_exclude_each_other(self) -> None:
        self.refuse(["report", "--instrument", "a:1", "--model", "1,4000,0.3"], "excludes --model")
        self.refuse(["report", "--instrument", "a:1", "--points", "x.csv"], "excludes --points")
        self.refuse(["report", "--instrument", "a:1", "--bench-seed", "2"], "--bench-seed", "simulated bench")


class InstrumentStops(ProgramTest):
    def test_ctrl_c_ends_the_sweep_of_the_instrument_first(self) -> None:
        with TcpInstrument("--pace", "1") as remote:
            process = self.start_program("report", "--instrument", remote.port, "--out", "out")
            deadline = time.monotonic() + PATIENCE
            # A second client is refused while the first one is there.
            while time.monotonic() < deadline and remote.process.poll() is None:
                time.sleep(0.5)
                try:
                    answer = remote.ask("STAT:OPER:COND?")
                except ConnectionError:
                    answer = ""
                if answer == "":
                    break
            time.sleep(1.0)
            process.send_signal(signal.SIGINT)
            output, errors = process.communicate(timeout=PATIENCE)
            self.assertEqual((process.returncode, output), (130, b""))
            self.assert_one_line(errors, "stopped during the sweep of the instrument", "drive to zero")
            self.assertEqual(remote.ask("STAT:OPER:COND?"), "0")
            self.assertEqual(self.files(), ["out"] if (self.directory / "out").exists() else [])

    def test_progress_on_a_terminal(self) -> None:
        terminal, far_end = pty.openpty()
        with TcpInstrument("--pace", "4") as remote:
            process = self.start_program("report", "--instrument", remote.port, *QUICK, stderr=far_end)
            os.close(far_end)
            shown = b""
            threading.Thread(target=process.stdout.read, daemon=True).start()
            while select.select([terminal], [], [], PATIENCE)[0]:
                try:
                    shown += os.read(terminal, 4096)
                except OSError:  # The program has ended.
                    break
            self.assertEqual(process.wait(timeout=PATIENCE), 0)
        os.close(terminal)
        self.assertRegex(shown.decode(), r"emax: sweep of the instrument, \d+ %, \d+ s")


if __name__ == "__main__":
    main()
