"""What the tests of the program share: runs of it in an empty directory, and what they must do when it refuses.

usage: test_NAME.py PROGRAM DATA_DIRECTORY [unittest arguments]
"""

import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

import results_schema

PROGRAM, DATA = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()

MODEL = ["--model", "1.037,4073,0.3182,0.003,6,0.0004"]
QUICK = ["--trials", "1000", "--trend", "none"]
PATIENCE = 60.0  # Seconds that anything may take on a loaded machine.


def restore_signals() -> None:
    """Whoever runs the tests in the background may have SIGINT ignored, and children inherit that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class TcpInstrument:
    """`emax scpi --tcp 0`."""

    def __init__(self, *arguments: str):
        self.process = subprocess.Popen([PROGRAM, "scpi", "--tcp", "0", *arguments], stdin=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE, preexec_fn=restore_signals)
        line = self.process.stderr.readline().decode()
        self.port = re.search(r"([0-9.]+:\d+)\n$", line)[1]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()

    def ask(self, text: str) -> str:
        host, port = self.port.rsplit(":", 1)
        with socket.create_connection((host, int(port)), timeout=PATIENCE) as peer, peer.makefile("rb") as answers:
            peer.sendall(text.encode() + b"\n")
            return answers.readline().decode().rstrip("\n")


class ProgramTest(unittest.TestCase):
    """Each test runs in an empty directory of its own."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)

    def run_program(self, *arguments, **options) -> subprocess.CompletedProcess:
        settings = {"stdin": subprocess.DEVNULL} if "input" not in options else {}
        settings |= {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "timeout": 500, "cwd": self.directory}
        result = subprocess.run([PROGRAM, *map(str, arguments)], check=False, **(settings | options))
        self.check_results([*map(str, arguments)], result.stdout)
        return result

    def check_results(self, arguments, output) -> None:
        """Whatever results.json a report prints or leaves must be as its schema says."""
        if "report" not in arguments[:1]:
            return
        texts = [output] if "--json" in arguments and output else []
        if "--out" in arguments[:-1]:
            path = os.path.join(self.directory, arguments[arguments.index("--out") + 1], "results.json")
            texts += [pathlib.Path(path).read_bytes()] if os.path.isfile(path) else []
        for text in texts:
            self.assertEqual(results_schema.faults_of_text(text), [])

    def start_program(self, *arguments, **options) -> subprocess.Popen:
        settings = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        settings |= {"cwd": self.directory, "preexec_fn": restore_signals}
        process = subprocess.Popen([PROGRAM, *map(str, arguments)], **(settings | options))
        self.addCleanup(process.kill)
        return process

    def succeed(self, *arguments, **options) -> str:
        result = self.run_program(*arguments, **options)
        self.assertEqual((result.returncode, result.stderr), (0, b""))
        return result.stdout.decode("ascii")

    def json_of(self, *arguments):
        return json.loads(self.succeed("report", *arguments, "--json"))

    def files(self) -> list[str]:
        return sorted(str(path.relative_to(self.directory)) for path in self.directory.rglob("*"))

    def write(self, lines, name="points.csv", end="\n") -> str:
        content = lines if isinstance(lines, bytes) else "".join(line + end for line in lines).encode()
        (self.directory / name).write_bytes(content)
        return name

    def assert_one_line(self, text: bytes, *words: str) -> str:
        """Exactly one line of printable UTF-8; ours are ASCII, names of others are what they are."""
        line = text.decode()
        self.assertTrue(line.startswith("emax: ") and line.endswith("\n") and line[:-1].isprintable(), line)
        for word in words:
            self.assertIn(word, line)
        return line

    def refuse(self, arguments, *words, status=2, **options) -> str:
        """The program must refuse in one line that has these words, and must leave nothing behind."""
        before = self.files()
        result = self.run_program(*arguments, **options)
        self.assertEqual((result.returncode, result.stdout or b""), (status, b""), result.stderr)
        self.assertEqual(self.files(), before)
        return self.assert_one_line(result.stderr, *words)

    def refuse_option(self, option, value, *words, device=MODEL):
        arguments = [*device, option] + ([] if value is None else [value])
        return self.refuse(["report", *arguments, "--out", "out"], f"emax: {option}: ", *words)

    def refuse_points(self, lines, where, *words, end="\n"):
        """`where` is a line number, or None for the table as a whole."""
        name = self.write(lines, end=end)
        place = f"emax: {name}: " if where is None else f"emax: {name}:{where}: "
        return self.refuse(["report", "--points", name, "--out", "out"], place, *words)


def main() -> None:
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
