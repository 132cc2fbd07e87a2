"""`emax scpi` as its user meets it: on standard input, on a port, and stopped by Ctrl-C.

usage: test_scpi.py PROGRAM DATA_DIRECTORY [unittest arguments]
"""

import os
import re
import signal
import socket
import subprocess
import time

from program_test import DATA, PROGRAM, ProgramTest, main, restore_signals

MODEL = "1.037,4073,0.3182,0.003,6,0.0004"
PATIENCE = 60.0  # Seconds that anything may take on a loaded machine.


def run(*arguments: str, text: bytes = b"") -> subprocess.CompletedProcess:
    return subprocess.run([PROGRAM, "scpi", *arguments], input=text, capture_output=True, timeout=PATIENCE,
                          check=False)


def block_of(answer: bytes) -> bytes:
    """The bytes of the definite-length block that the answer begins with."""
    assert answer[:1] == b"#", answer[:20]
    digits = int(answer[1:2])
    length = int(answer[2:2 + digits])
    assert answer[2 + digits + length:] == b"\n", answer[-20:]
    return answer[2 + digits:2 + digits + length]


class ScpiPipe(ProgramTest):
    def test_three_lines(self) -> None:
        done = run(text=b"*IDN?\nCALC:MOD 1.037,4073,0.3182,0.003,6,0.0004\nCALC:ENER?\nSYST:ERR?\n")
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        lines = done.stdout.decode().splitlines()
        self.assertEqual(len(lines), 3)
        self.assertRegex(lines[0], r"^emax,host,0,\d+\.\d+\.\d+$")
        self.assertRegex(lines[1], r"^5\.1152513598\d*E-3,")
        self.assertEqual(lines[2], '0,"No error"')

    def test_every_line_end_and_none(self) -> None:
        for end in (b"\n", b"\r", b"\r\n"):
            done = run(text=b"SYST:VERS?" + end + b"SYST:VERS?" + end)
            self.assertEqual(done.stdout, b"1999.0\n1999.0\n")
        self.assertEqual(run(text=b"SYST:VERS?").stdout, b"1999.0\n")
        self.assertEqual(run(text=b"").stdout, b"")

    def test_the_end_of_the_input_waits_for_queries(self) -> None:
        done = run(text=b"INIT;*OPC?\nTRAC:FRES:POIN?\nINIT:ENER\n")
        self.assertEqual(done.stdout, b"1\n42\n")
        self.assertEqual(done.returncode, 0)

    def test_long_lines_noise_and_zero_bytes(self) -> None:
        noise = bytes(range(1, 256)).replace(b"\n", b"").replace(b"\r", b"").replace(b"#", b"")
        text = b"A" * 40_000 + b"\n" + noise + b"\n\0\n*CLS\n*IDN?\n"
        done = run(text=text)
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stdout, rb"^emax,host,0,[^\n]*\n$")
        errors = run(text=b"A" * 40_000 + b"\nSYST:ERR?\n").stdout
        self.assertEqual(errors[:5], b"-363,")

    def test_a_thousand_errors(self) -> None:
        done = run(text=b"NO:SUCH\n" * 1000 + b"SYST:ERR:COUN?\n*IDN?\n")
        self.assertEqual(done.stdout.splitlines()[0], b"16")

    def test_a_reader_that_pauses_gets_all_answers(self) -> None:
        """More than pipe and console hold, for longer than a peer has that sends and never reads."""
        count = 20_000
        (self.directory / "many").write_bytes(b"*IDN?\n" * count)
        with open(self.directory / "many", "rb") as many, \
                subprocess.Popen([PROGRAM, "scpi"], stdin=many, stdout=subprocess.PIPE) as process:
            time.sleep(3.0)
            lines = process.stdout.read().splitlines()
            self.assertEqual(process.wait(timeout=PATIENCE), 0)
        self.assertEqual(len(lines), count)
        self.assertEqual(len(set(lines)), 1)

    def test_progress_keeps_its_turn_among_ordinary_queries(self) -> None:
        answers = run(text=b"*IDN?\n" * 100 + b"SYST:PROG?\n*ESE?\n").stdout.splitlines()
        self.assertEqual(answers[-2:], [b'100,"idle"', b"0"])
        self.assertEqual(len(answers), 102)

    def test_a_reader_that_goes_away(self) -> None:
        with subprocess.Popen([PROGRAM, "scpi"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE) as process:
            process.stdout.close()
            process.stdin.write(b"DIAG:RAND? 100000\n")
            process.stdin.close()
            self.assertEqual(process.wait(timeout=PATIENCE), 3)
            self.assertEqual(process.stderr.read(), b"")


    def test_a_reader_that_goes_away_while_a_query_is_computed(self) -> None:
        with subprocess.Popen([PROGRAM, "scpi"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE) as process:
            process.stdin.write(f"CALC:MOD {MODEL};:CALC:MCAR:TRI 1000000000;*IDN?;:CALC:MCAR?\n".encode())
            process.stdin.flush()
            self.assertEqual(process.stdout.read(5), b"emax,")
            process.stdout.close()
            self.assertEqual(process.wait(timeout=PATIENCE), 3)
            self.assertEqual(process.stderr.read(), b"")


class ScpiReport(ProgramTest):
    def expect_report(self, arguments: list[str], scpi_arguments: list[str], text: str) -> None:
        expected = subprocess.run([PROGRAM, "report", *arguments], capture_output=True, timeout=PATIENCE,
                                  check=True).stdout
        answer = run(*scpi_arguments, text=text.encode()).stdout
        self.assertEqual(block_of(answer), expected)

    def test_of_a_sweep(self) -> None:
        self.expect_report(["--trials", "2000"], [], "CALC:MCAR:TRI 2000\nINIT;*WAI\nCALC:REP?\n")

    def test_of_a_bench_with_options(self) -> None:
        bench = ["--bench-seed", "7", "--bench-truth", "0.5,3000,0.4", "--level", "2"]
        self.expect_report(["--trials", "2000", *bench], bench, "CALC:MCAR:TRI 2000\nINIT;*WAI\nCALC:REP?\n")

    def test_of_a_model(self) -> None:
        self.expect_report(["--model", MODEL, "--trials", "2000", "--time", "0.003", "--order", "7"], [],
                           f"CALC:MOD {MODEL}\nCALC:MCAR:TRI 2000\nCALC:ENER:TIME 3ms;:CALC:FILT:ORD 7\nCALC:REP?\n")

    def test_with_labels(self) -> None:
        labels = {"device": "Piezo A", "serial": "47\"11", "operator": "it's me", "date": "today", "note": "none"}
        arguments = [word for name, text in labels.items() for word in ("--" + name, text)]
        strings = ",".join('"' + text.replace('"', '""') + '"' for text in labels.values())
        self.expect_report(["--model", MODEL, "--trials", "1000", *arguments], [],
                           f"CALC:MOD {MODEL};:CALC:MCAR:TRI 1000;:CALC:REP? {strings}\n")
        self.expect_report(["--model", MODEL, "--trials", "1000", "--serial", "4711"], [],
                           f"CALC:MOD {MODEL};:CALC:MCAR:TRI 1000;:CALC:REP? '','4711'\n")
        errors = run(text=b"CALC:REP? 4711;:SYST:ERR?\nCALC:REP? 'a','b','c','d','e','f'\nSYST:ERR:CODE:ALL?\n").stdout
        self.assertEqual(errors, b"-128,-108\n")

    def test_of_the_papers_method(self) -> None:
        self.expect_report(["--model", MODEL, "--trials", "1000", "--method", "paper"], [],
                           f"CALC:MOD {MODEL}\nCALC:MCAR:TRI 1000\nCALC:ENER:METH PAP\nINIT:REP\n*WAI\nCALC:REP?\n")

    def test_of_points(self) -> None:
        lines = (DATA / "djb_a1800v.csv").read_text().splitlines()[1:]
        text = "".join(f"TRAC:FRES:DATA {line}\n" for line in lines)
        answer = run(text=(text + "CALC:MCAR:TRI 2000\nCALC:REP?\n").encode()).stdout
        report = subprocess.run([PROGRAM, "report", "--points", str(DATA / "djb_a1800v.csv"), "--trials", "2000"],
                                capture_output=True, timeout=PATIENCE, check=True).stdout
        # All but the name of the file and what was understood of it.
        expected = re.sub(rb"measured points: [^\n]*", b"measured points", report)
        expected = re.sub(rb"\n +read as [^\n]*", b"", expected)
        # The program marks figures that a warning concerns; a board has no room for that.
        expected, marks = re.subn(rb"(\n  (?:In band|The paper)[^\n*]*) \* ", rb"\1   ", expected)
        expected = re.sub(rb"\n  \* There is a warning below, on: fit.", b"", expected)
        self.assertEqual(marks, 3)
        self.assertEqual(block_of(answer), expected)


class ScpiFaults(ProgramTest):
    def test_are_errors_that_say_what_to_check(self) -> None:
        done = run("--bench-fault", "swapped-channels@1", text=b"INIT;*OPC?;:SYST:ERR?;ERR?\n")
        self.assertRegex(done.stdout.decode(), r'^1;-240,"Hardware error;[a-z ]+: [^"]+";0,"No error"\n$')


    def test_that_have_not_struck_are_told_beside_the_answers(self) -> None:
        done = run("--bench-fault", "gain-step@1000", text=b"INIT;*OPC?\nINIT;*OPC?\n")
        self.assertEqual(done.stdout, b"1\n1\n")
        self.assert_one_line(done.stderr, "gain-step did not strike: the sweep has ended after ")


class ScpiStore(ProgramTest):
    def test_a_file_keeps_settings_and_the_last_identification(self) -> None:
        store = ["--store", str(self.directory / "store")]
        first = run(*store, text=b"CALC:ENER:TIME 3ms;*SAV 2\nINIT;*WAI;:CALC:IDEN?\n")
        self.assertEqual((first.returncode, first.stderr), (0, b""))
        second = run(*store, text=b"CALC:IDEN?\nCALC:ENER:TIME?;*RCL 2;TIME?\n")
        self.assertEqual(second.stdout, first.stdout + b"2.0E-3;3.0E-3\n")
        self.assertEqual(run(text=b"*RCL 2;:SYST:ERR?\n").stdout[:5], b"-230,")

    def test_a_closed_output_does_not_end_in_the_file(self) -> None:
        store = ["--store", str(self.directory / "store")]
        with subprocess.Popen([PROGRAM, "scpi", *store], stdin=subprocess.PIPE, stderr=subprocess.PIPE,
                              preexec_fn=lambda: os.close(1)) as process:
            _, errors = process.communicate(b"CALC:FILT:ORD 4;*SAV 1\n*IDN?\n", timeout=PATIENCE)
        self.assertEqual(process.returncode, 3)
        self.assert_one_line(errors, "standard output")
        self.assertEqual(run(*store, text=b"*RCL 1;:CALC:FILT:ORD?\n").stdout, b"4\n")

    def test_another_file_is_left_as_it_is(self) -> None:
        (self.directory / "notes").write_bytes(b"my notes\n")
        done = run("--store", str(self.directory / "notes"), text=b"*SAV 1\n")
        self.assertEqual(done.returncode, 2)
        self.assert_one_line(done.stderr, "--store")
        self.assertEqual((self.directory / "notes").read_bytes(), b"my notes\n")


class ScpiOptions(ProgramTest):
    def test_bad_ones_are_refused_in_one_line(self) -> None:
        for arguments in (["--tcp", "70000"], ["--tcp"], ["--pace", "0"], ["--pace", "fast"], ["--pase", "1"],
                          ["--trials", "1000"], ["now"], ["--commands=1"], ["--tcp", "0", "--tcp", "0"],
                          ["--bench-fault", "earthquake"]):
            with self.subTest(arguments=arguments):
                done = run(*arguments)
                self.assertEqual(done.returncode, 2)
                self.assertEqual(done.stdout, b"")
                self.assertRegex(done.stderr.decode(), r"^emax: [^\n]*(expected |did you mean|--help lists them)[^\n]*\n$")

    def test_help(self) -> None:
        done = run("--help")
        self.assertEqual(done.returncode, 0)
        for option in ("--tcp [ADDRESS:]PORT", "--pace X", "--commands", "--bench-fault"):
            self.assertIn(option, done.stdout.decode())
        self.assertLessEqual(max(len(line) for line in done.stdout.decode().splitlines()), 80)

    def test_pace_of_one_is_real_time(self) -> None:
        text = b"SWE:FREQ 500,1000,2000\nINIT;*OPC?\n"
        begin = time.monotonic()
        self.assertEqual(run(text=text).stdout, b"1\n")
        fast = time.monotonic() - begin
        begin = time.monotonic()
        self.assertEqual(run("--pace", "1", text=text).stdout, b"1\n")
        paced = time.monotonic() - begin
        # Three frequencies and two checks take 0.1 s each or more, with the silence before them.
        self.assertGreater(paced, 0.5)
        self.assertGreater(paced, fast)


class ScpiCtrlC(ProgramTest):
    def test_leads_the_drive_to_zero(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen([PROGRAM, "scpi", "--pace", "1"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, preexec_fn=restore_signals) as process:
                process.stdin.write(b"INIT\n*IDN?\n")
                process.stdin.flush()
                process.stdout.readline()
                time.sleep(0.3)
                process.send_signal(number)
                self.assertEqual(process.wait(timeout=PATIENCE), 130)
                self.assertEqual(process.stderr.read(), b"emax: stopped during the sweep, drive at zero\n")


class Client:
    """One connection; text lines both ways."""

    def __init__(self, port: int):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
        self.file = self.socket.makefile("rb")

    def send(self, text: str) -> None:
        self.socket.sendall(text.encode() + b"\n")

    def ask(self, text: str) -> str:
        self.send(text)
        return self.file.readline().decode().rstrip("\n")

    def close(self) -> None:
        self.file.close()
        self.socket.close()


class Server:
    def __init__(self, *arguments: str):
        self.process = subprocess.Popen([PROGRAM, "scpi", "--tcp", "0", *arguments], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=restore_signals)
        line = self.process.stderr.readline().decode()
        self.port = int(re.fullmatch(r"emax: listening on 127\.0\.0\.1:(\d+)\n", line)[1])

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()


class ScpiTcp(ProgramTest):
    def test_a_session(self) -> None:
        with Server() as server:
            client = Client(server.port)
            self.assertEqual(client.ask("CALC:MOD 1.037,4073,0.3182;:CALC:ENER?").split(",")[3], "1")
            client.close()

    def test_settings_stay_for_the_next_client(self) -> None:
        with Server() as server:
            for order in range(2, 12):
                client = Client(server.port)
                client.send(f"CALC:FILT:ORD {order}")
                client.close()
                client = Client(server.port)
                self.assertEqual(client.ask("CALC:FILT:ORD?"), str(order))
                client.close()

    def test_a_second_client_is_refused_without_a_word(self) -> None:
        with Server() as server:
            first = Client(server.port)
            self.assertNotEqual(first.ask("*IDN?"), "")
            second = Client(server.port)
            self.assertEqual(second.file.read(), b"", "a sentence would be taken for an answer")
            second.close()
            self.assertNotEqual(first.ask("*IDN?"), "")
            first.close()
            third = Client(server.port)
            self.assertNotEqual(third.ask("*IDN?"), "")
            third.close()

    def test_a_client_that_goes_in_the_middle(self) -> None:
        with Server() as server:
            for text in ("CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004;:CALC:MCAR:TRI 100000000;:CALC:MCAR?",
                         "DIAG:RAND? 1000000", "CALC:ENER?;*ID", "INIT;*OPC?", "TRAC:FRES:DATA #210"):
                client = Client(server.port)
                client.send(text)
                time.sleep(0.1)
                client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")  # A reset.
                client.close()
                client = Client(server.port)
                self.assertRegex(client.ask("*IDN?"), r"^emax,host,")
                client.send("ABOR;*CLS")
                client.close()

    def test_a_client_that_only_closes_its_side_gets_its_answers(self) -> None:
        with Server() as server:
            client = Client(server.port)
            client.socket.sendall(b"INIT;*OPC?\nTRAC:FRES:POIN?\n")
            client.socket.shutdown(socket.SHUT_WR)
            self.assertEqual(client.file.read(), b"1\n42\n")
            client.close()

    def test_abort_and_progress_overtake_a_query_that_computes(self) -> None:
        with Server() as server:
            client = Client(server.port)
            client.send(f"CALC:MOD {MODEL};:CALC:MCAR:TRI 100000000;:CALC:MCAR?")
            time.sleep(0.2)
            self.assertRegex(client.ask("SYST:PROG?"), r'^\d+,"[A-Za-z ]+"$')
            begin = time.monotonic()
            client.send("ABOR")
            self.assertEqual(client.ask("SYST:ERR?"), '-200,"Execution error;aborted"')
            self.assertLess(time.monotonic() - begin, 10.0)
            client.close()

    def test_a_client_that_never_reads(self) -> None:
        with Server("--pace", "1") as server:
            client = Client(server.port)
            client.socket.setblocking(False)
            client.socket.send(b"INIT\n")
            text = b"DIAG:RAND? 1000000\n" + b"*IDN?\n" * 100
            end = time.monotonic() + 2.0
            while time.monotonic() < end:
                try:
                    client.socket.send(text)
                except BlockingIOError:
                    time.sleep(0.01)
            client.socket.close()
            client.file.close()
            other = Client(server.port)
            self.assertRegex(other.ask("*IDN?"), r"^emax,host,")
            other.send("ABOR")
            other.close()

    def test_a_client_that_goes_with_more_behind_its_query_than_there_is_room_for(self) -> None:
        for linger in (b"\0\0\0\0\0\0\0\0", b"\1\0\0\0\0\0\0\0"):
            with Server() as server:
                client = Client(server.port)
                client.send(f"CALC:MOD {MODEL};:CALC:MCAR:TRI 1000000000;:CALC:MCAR?")
                client.send("*IDN?\n" * 2000)
                time.sleep(0.2)
                client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)
                client.close()
                other = Client(server.port)
                self.assertRegex(other.ask("*IDN?"), r"^emax,host,")
                other.close()

    def test_a_new_client_waits_for_the_end_of_one_that_has_gone(self) -> None:
        with Server("--pace", "1") as server:
            client = Client(server.port)
            client.send("INIT;*OPC?")
            time.sleep(0.2)
            client.close()
            time.sleep(1.5)  # Longer than one may be stuck that does not read its answers.
            other = Client(server.port)
            self.assertEqual(other.ask("STAT:OPER:COND?"), "24", "what INITiate has started goes on")
            other.close()

    def test_a_client_is_refused_for_one_that_reads_nothing_more(self) -> None:
        with Server() as server:
            client = Client(server.port)
            client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            client.send("DIAG:RAND? 1000000")
            client.socket.shutdown(socket.SHUT_WR)
            other = Client(server.port)
            self.assertEqual(other.file.read(), b"")
            other.close()
            client.close()

    def test_half_a_line_of_a_client_that_is_gone_is_not_executed(self) -> None:
        with Server() as server:
            for linger in (b"\0\0\0\0\0\0\0\0", b"\1\0\0\0\0\0\0\0"):
                client = Client(server.port)
                client.socket.sendall(b"SOUR:LEV 2;LEV?\nSOUR:LEV 10")  # The rest would be E-3.
                self.assertEqual(client.file.readline(), b"2\n")
                client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)
                client.close()
                other = Client(server.port)
                self.assertEqual(other.ask("SOUR:LEV?"), "2")
                self.assertEqual(other.ask("SYST:ERR?"), '0,"No error"')
                other.close()

    def test_opc_survives_its_connection(self) -> None:
        with Server("--pace", "4") as server:
            client = Client(server.port)
            client.send("*CLS;INIT;*OPC")
            client.close()
            client = Client(server.port)
            self.assertEqual(client.ask("*ESR?"), "0")
            client.close()
            deadline = time.monotonic() + PATIENCE
            events = "0"
            while events == "0" and time.monotonic() < deadline:
                time.sleep(0.05)
                client = Client(server.port)
                events = client.ask("*ESR?")
                client.close()
            self.assertEqual(events, "1")

    def test_device_clear_and_abort_end_an_answer_without_end(self) -> None:
        with Server() as server:
            client = Client(server.port)
            for end, errors in ((b"\x03", "0"), (b"ABOR\n", "1")):
                client.send("DIAG:RAND? 1000000")
                self.assertNotEqual(client.file.read(100), b"")
                client.socket.sendall(end + b"*IDN?\n")
                line = client.file.readline()
                while not line.startswith(b"emax,"):
                    self.assertRegex(line, rb"^[0-9.,E-]*\n$")
                    self.assertLess(line.count(b","), 900_000)
                    line = client.file.readline()
                self.assertEqual(client.ask("SYST:ERR:COUN?"), errors)
                client.send("*CLS")
            client.close()

    def test_a_stray_block_does_not_make_it_deaf(self) -> None:
        with Server() as server:
            client = Client(server.port)
            client.send("SOUR:LEV #44000")
            client.send("ABOR")
            self.assertRegex(client.ask("SYST:ERR?"), '^-168,"Block data not allowed')
            client.close()

    def test_a_slow_bench_has_a_quick_console(self) -> None:
        """A block of 64 frames of a bench at a thousandth of its speed takes 0.64 s; 200 units would take 128 s."""
        with Server("--pace", "0.001") as server:
            client = Client(server.port)
            client.send("INIT")
            begin = time.monotonic()
            self.assertEqual(client.ask(";".join(["*ESE?"] * 200)), ";".join(["0"] * 200))
            self.assertLess(time.monotonic() - begin, 12.8, "a tenth of that")
            self.assertEqual(client.ask("STAT:OPER:COND?"), "24")
            client.close()

    def test_addresses(self) -> None:
        for address, listens in (("127.0.0.2:0", "127.0.0.2"), ("0.0.0.0:0", "0.0.0.0"), ("127.0.0.1:0", "127.0.0.1")):
            process = subprocess.Popen([PROGRAM, "scpi", "--tcp", address], stdin=subprocess.DEVNULL,
                                       stderr=subprocess.PIPE, preexec_fn=restore_signals)
            self.addCleanup(process.communicate)
            self.addCleanup(process.kill)
            found = re.fullmatch(r"emax: listening on ([0-9.]+):(\d+)\n", process.stderr.readline().decode())
            self.assertEqual(found[1], listens)
            with socket.create_connection((listens, int(found[2])), timeout=PATIENCE) as peer:
                peer.sendall(b"SYST:VERS?\n")
                self.assertEqual(peer.makefile("rb").readline(), b"1999.0\n")
        for wrong in ("localhost:0", "1.2.3:0", ":0", "127.0.0.1:", "127.0.0.1:65536", "256.0.0.1:5"):
            self.refuse(["scpi", "--tcp", wrong], "--tcp: ", "expected")

    def test_a_port_that_is_taken(self) -> None:
        with Server() as server:
            done = run("--tcp", str(server.port))
            self.assertEqual(done.returncode, 2)
            self.assertRegex(done.stderr.decode(), r"^emax: --tcp: port \d+ of 127\.0\.0\.1: [^\n]+\n$")


class ScpiCommands(ProgramTest):
    """The table in firmware/README.md is the one that the parser uses."""

    def test_the_readme_has_the_table(self) -> None:
        done = run("--commands")
        self.assertEqual(done.returncode, 0)
        text = (DATA.parent.parent / "firmware" / "README.md").read_text()
        found = re.search(r"<!-- commands -->\n(.*?)<!-- /commands -->", text, re.DOTALL)
        self.assertIsNotNone(found, "firmware/README.md has no table of commands")
        self.assertEqual(found[1].strip() + "\n", done.stdout.decode(),
                         "put the output of `emax scpi --commands` between the marks of firmware/README.md")


if __name__ == "__main__":
    main()
