"""A seeded random client talks to `emax scpi` over TCP and knows what every answer must be.

usage: test_random_client.py PROGRAM DATA_DIRECTORY [unittest arguments]
       test_random_client.py PROGRAM SECONDS SEED                            by hand, for as long as one likes

Messages of random units, in random case and with random white space, some wrong, arrive in random pieces and are answered
while more are sent. Answers must come whole and in order, each error must be in the queue, half messages of connections
that end must leave nothing behind, device clear and ABORt must act at once, and the program's memory must stay as it is.
"""

import os
import pathlib
import random
import re
import select
import socket
import subprocess
import sys
import time
import unittest

if __name__ == "__main__" and len(sys.argv) == 4 and sys.argv[2].isdigit():
    SECONDS, sys.argv[2] = int(sys.argv[2]), os.path.dirname(os.path.abspath(__file__))
else:
    SECONDS = 0

from program_test import PROGRAM, ProgramTest, main, restore_signals  # noqa: E402

ROUNDS = 1000  # About a minute with sanitizers on a machine with other work.
WINDOW_ROUNDS = 50  # Between two looks at the memory.
# The address sanitizer keeps what is freed for a while; it would look like a leak.
NO_QUARANTINE = ":".join(filter(None, [os.environ.get("ASAN_OPTIONS"), "quarantine_size_mb=0", "thread_local_quarantine_size_kb=0"]))
PATIENCE = 60.0
QUEUE = 16
BLANKS = " \t\x01\x0b\x1f\x00"  # A few of those that IEEE 488.2 has.


class Model:
    """What the instrument must hold."""

    def __init__(self):
        self.event_enable, self.service_enable, self.order, self.iterations = 0, 0, 10, 30
        self.errors: list[int] = []

    def error(self, code: int) -> None:
        if len(self.errors) < QUEUE:
            self.errors.append(code)
        else:
            self.errors[-1] = -350


class RandomTalk:
    def __init__(self, seed: int):
        self.random = random.Random(seed)
        self.model = Model()
        # Then trials run now and then, and nothing is set that they need, nor asked for what ABORt would end from behind.
        self.may_abort = True

    def units(self) -> list:
        """Each: text, the pattern of its answer or None, and its error or 0. Those that answer see the model of their turn."""
        model, draw = self.model, self.random

        def set_and_ask(name: str, member: str, low: int, high: int):
            value = draw.randint(low, high)
            if draw.random() < 0.5:
                return (f"{name} {value}", None, 0, lambda: setattr(model, member, value))
            return (f"{name}?", lambda: re.escape(str(getattr(model, member))), 0, None)

        def random_numbers():
            count = draw.choice([1, 2, 7, 40, 300])
            return (f":DIAG:RAND? {count}", lambda: r"[0-9.E-]+" + r",[0-9.E-]+" * (count - 1), 0, None)

        wrong = [(":NO:SUCH 1", -113), ("*ESE", -109), ("*ESE 256", -222), (":CALC:FILT:ORD 1,2", -108), (":CALC:FILT:ORD ISE", -141),
                 (":CALC:FILT:ORD #44000", -168), (":CALC:FILT:ORD (1,2)", -178), (":CALC:FILT:ORD '5'", -158),
                 (":CALC:ENER:TIME 1 HZ", -131), (":CALC:ENER:CRIT FAST", -224), (":CALC:FILT:ORD 5 S", -138), ("*ESE \"1", -158)]
        text, code = draw.choice(wrong)
        return draw.choice([
            lambda: set_and_ask("*ESE", "event_enable", 0, 255),
            (lambda: (":SYST:VERS?", lambda: r"1999\.0", 0, None)) if self.may_abort
            else lambda: set_and_ask(":CALC:FILT:ORD", "order", 1, 15),
            (lambda: set_and_ask("*SRE", "service_enable", 0, 63)) if self.may_abort
            else lambda: set_and_ask(":CALCulate:ENERgy:ITERations", "iterations", 1, 1000),
            lambda: ("*IDN?", lambda: r"emax,host,0,[0-9.]+", 0, None),
            lambda: (":SYST:VERS?", lambda: r"1999\.0", 0, None),
            # It would overtake what waits.
            (lambda: (":SYST:VERS?", lambda: r"1999\.0", 0, None)) if self.may_abort
            else lambda: (":SYST:PROG?", lambda: r'\d+,"[A-Za-z ]+"', 0, None),
            lambda: (":SYST:ERR:COUN?", lambda: str(len(model.errors)), 0, None),
            (lambda: (":ABOR", None, 0, None)) if self.may_abort else random_numbers,
            (lambda: (f":ABOR;:CALC:MOD 1,4000,0.{draw.randint(2, 8)},0.001,5,0.001;:INIT:MCAR", None, 0, None)) if self.may_abort else random_numbers,
            # Behind one that waits, the front of two messages could overtake before the rest of the first has its turn.
            (lambda: ("*ESE?", lambda: str(model.event_enable), 0, None)) if self.may_abort
            else lambda: ("*WAI", None, 0, None),
            lambda: (text, None, code, None),
            self.read_error,
            self.read_codes,
        ])()

    def read_error(self):
        def answer():
            code = self.model.errors.pop(0) if self.model.errors else 0
            return rf'{code},"[^\n]+"'
        return (":SYST:ERR?", answer, 0, None)

    def read_codes(self):
        def answer():
            codes = self.model.errors or [0]
            self.model.errors = []
            return ",".join(map(str, codes))
        return (":SYST:ERR:CODE:ALL?", answer, 0, None)

    def message(self) -> tuple[bytes, str]:
        """A line, and the pattern of its answer, empty for none."""
        texts, answers, stopped = [], [], False
        for _ in range(self.random.randint(1, 5)):
            text, answer, error, effect = self.units()
            texts.append(self.disguise(text))
            if stopped:
                continue
            if error:
                self.model.error(error)
            elif effect:
                effect()
            elif answer:
                answers.append(answer())
            # After a command error the rest of the message is not executed.
            stopped = -200 < error <= -100
        return ";".join(texts).encode() + self.random.choice([b"\n", b"\r", b"\r\n"]), ";".join(answers)

    def disguise(self, text: str) -> str:
        """The same in other letters, with white space where it may be."""
        draw = self.random
        if "'" not in text and '"' not in text:
            text = "".join(draw.choice([c.lower(), c.upper()]) for c in text) if draw.random() < 0.3 else text
        space = lambda: draw.choice(["", "", "", draw.choice(BLANKS)])
        return space() + text.replace(" ", " " + space(), 1) + (space() if '"' not in text else "")


class RandomClient:
    def __init__(self, seed: int, check):
        self.talk = RandomTalk(seed)
        self.random = random.Random(seed + 1)
        self.check = check
        self.process = subprocess.Popen([PROGRAM, "scpi", "--tcp", "0"], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                        preexec_fn=restore_signals, env={**os.environ, "ASAN_OPTIONS": NO_QUARANTINE})
        line = self.process.stderr.readline().decode()
        self.port = int(line.rsplit(":", 1)[1])
        self.connect()

    def close(self) -> None:
        self.peer.close()
        self.process.kill()
        self.process.communicate()

    def connect(self) -> None:
        self.peer = socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE)
        self.input = b""

    def resident_kib(self) -> int:
        text = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", text)[1])

    def fill(self) -> None:
        piece = self.peer.recv(self.random.choice([1, 10, 100, 65536]))
        if not piece:
            raise AssertionError(f"the program has gone: {self.process.poll()}")
        self.input += piece

    def line(self) -> str:
        while b"\n" not in self.input:
            self.fill()
        line, self.input = self.input.split(b"\n", 1)
        return line.decode()

    def converse(self) -> None:
        """Sends some messages in pieces, reads now and then, and compares all answers."""
        self.talk.may_abort = self.random.random() < 0.5
        if not self.talk.may_abort:
            # What is left in the queue may start trials anew.
            self.peer.sendall(b"ABOR\nSYST:VERS?\n")
            self.check(self.line() == "1999.0", "nothing else is to be answered")
            self.peer.sendall(b"ABOR\n")
        messages = [self.talk.message() for _ in range(self.random.randint(1, 12))]
        rest = b"".join(text for text, _ in messages)
        while rest:
            count = min(len(rest), self.random.choice([1, 3, 20, 200, 5000]))
            if select.select([], [self.peer], [], 0.0)[1]:
                sent = self.peer.send(rest[:count])
                rest = rest[sent:]
            if self.random.random() < 0.3 and select.select([self.peer], [], [], 0.0)[0]:
                self.fill()
        for text, pattern in messages:
            if pattern:
                line = self.line()
                if not re.fullmatch(pattern, line):
                    self.peer.sendall(b"\nSYST:ERR:ALL?\n")
                    raise AssertionError(f"{text!r}\n is answered by {line[:300]!r}\n expected {pattern[:300]!r}\n"
                                         f" what follows: {self.line()!r} {self.line()!r}")

    def clear(self) -> None:
        """Device clear, or ABORt, in the middle of an answer without end."""
        self.peer.sendall(b"DIAG:RAND? 1000000\n")
        while len(self.input) < self.random.randint(1, 20_000):
            self.fill()
        if self.random.random() < 0.5:
            self.peer.sendall(b"NO;NO;NO\x03")
        else:
            self.peer.sendall(b"ABOR\n")
            self.talk.model.error(-200)
        self.peer.sendall(b"SYST:VERS?\n")
        numbers = 0
        line = self.line()
        while line != "1999.0":
            self.check(re.fullmatch(r"[0-9.,E-]*", line), line[:100])
            numbers += line.count(",")
            line = self.line()
        self.check(numbers < 900_000, "it was ended")

    def leave(self) -> None:
        """Goes with half a message, which is not executed, once all before it is."""
        self.peer.sendall(b"SYST:VERS?\n")
        self.check(self.line() == "1999.0", "nothing else is to be answered")
        self.peer.sendall(self.random.choice([b"*ESE 77", b"NO:SUCH", b"CALC:FILT:ORD 3;*ESE", b"\"", b"#49999", b""]))
        if self.random.random() < 0.5:
            self.peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")  # A reset.
        self.peer.close()
        self.connect()

    def refuse_a_second_one(self) -> None:
        with socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE) as other:
            self.check(other.recv(100) == b"", "a second client is refused without a word")

    def round(self) -> None:
        act = self.random.random()
        if act < 0.02:
            self.clear()
        elif act < 0.06:
            self.leave()
        elif act < 0.07:
            self.refuse_a_second_one()
        else:
            self.converse()

    def run(self, goes_on) -> int:
        """Returns the number of rounds."""
        rounds, sizes_kib = 0, []
        while goes_on(rounds):
            self.round()
            rounds += 1
            if rounds % WINDOW_ROUNDS == 0:
                sizes_kib.append(self.resident_kib())
        self.check(is_plateau(sizes_kib), f"memory grows: {sizes_kib} KiB, each {WINDOW_ROUNDS} rounds later")
        self.check(self.process.poll() is None, "it still runs")
        return rounds


def is_plateau(sizes_kib: list[int]) -> bool:
    """Whether memory that grows has only been touched for the first time: static memory by a command that had not come
    before, now and then, 1.6 MiB in all as seen, and the program has no 4 MiB more of it. What leaks grows in most
    windows."""
    late = sizes_kib[len(sizes_kib) // 4:]
    steps = sorted(after - before for before, after in zip(late, late[1:]))
    return not steps or (steps[len(steps) // 2] <= 4 and late[-1] - late[0] < 4096)


class Plateau(unittest.TestCase):
    def test_first_touches_are_none_and_leaks_are_one(self) -> None:
        flat = [5000] * 20
        self.assertTrue(is_plateau([]) and is_plateau([5000]) and is_plateau(flat))
        self.assertTrue(is_plateau(flat[:10] + [6600] * 10), "a first touch")
        self.assertTrue(is_plateau([4000, 4500, 4800, 4900, *flat]), "the first rounds")
        self.assertFalse(is_plateau([5000 + 8 * i for i in range(20)]), "160 bytes in each round of fifty")
        self.assertFalse(is_plateau(flat[:10] + [9200] * 10), "more than there is")


class RandomClients(ProgramTest):
    def test_every_answer_is_whole_right_and_in_its_turn(self) -> None:
        client = RandomClient(20201, self.assertTrue)
        self.addCleanup(client.close)
        self.assertEqual(client.run(lambda rounds: rounds < ROUNDS), ROUNDS)


def by_hand(seconds: int, seed: int) -> None:
    def check(holds, words) -> None:
        if not holds:
            raise AssertionError(words)
    end = time.monotonic() + seconds
    client = RandomClient(seed, check)
    try:
        rounds = client.run(lambda _: time.monotonic() < end)
    finally:
        client.close()
    print(f"seed {seed}: {rounds} rounds in {seconds} s, every answer right, memory flat")


if __name__ == "__main__":
    if SECONDS:
        by_hand(SECONDS, int(sys.argv[3]))
    else:
        main()
