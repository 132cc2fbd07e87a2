"""Runs images of a board, by the program that its board.cmake declares for that."""

import json
import re
import subprocess
import sys
import threading
from pathlib import Path
from typing import NamedTuple

TIMEOUT_S = 1100
STACK_LINE = re.compile(r"stack: (\d+) of (\d+) bytes used")

# Work that goes through every part: sweep, fit, search, bound, trials, trend, report.
JOB = [
    "*RST",
    "SENS:SWE:FREQ 1000,2000,4000",
    "SENS:SWE:CYCL 3.000000000000000000000000001",  # More digits than one pass reads.
    "INIT:SWE;*OPC?",
    "CALC:MCAR:TRI 1000",
    "CALC:TREN? 0.001,0.002",
    "CALC:MCAR?",
    "CALC:REP?",
    "CALC:ENER:FPA?",
    "SYST:ERR?",
    "DIAG:MEM?",
]
REPORT = ["report", "--model", "1.037,4073,0.3182,0.003,6,0.0004", "--trials", "1000", "--trend", "0.001,0.002"]
COST = ["kernels", "energies-2", "sweep"]


class Board(NamedTuple):
    name: str
    tree: str
    core: str
    core_title: str  # In the tables, with
    clock_mhz: str  # the clock of a chip that has the core, and
    left_out: list[str]  # what is not counted.
    runner: list[str]  # Before an image and its arguments; empty if nothing runs it.
    instruction_ns: str  # Of the machine's time, while the counter counts.
    objdump: str
    interrupt_levels: list[str]  # The handlers of each priority.
    images: dict[str, list[str]]  # With the folders of their call graphs.

    @classmethod
    def read(cls, tree: str) -> "Board":
        return cls(tree=tree, **json.loads((Path(tree) / "images.json").read_text()))

    def path(self, image: str) -> str:
        return str(Path(self.tree) / f"{image}.elf")


def run_test_image(board: Board, image: str, arguments: list[str], counting: bool = False) -> tuple[str, int]:
    """What the image prints, and how much of its stack it has used."""
    options = ["--instruction-ns", board.instruction_ns] if counting else []
    command = [*board.runner, *options, board.path(image), *arguments]
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    used = STACK_LINE.search(done.stderr)
    if done.returncode != 0 or used is None:
        sys.exit(f"{image} {' '.join(arguments)}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout, int(used[1])


def run_product(board: Board, image: str) -> int:
    """How much of its stack a product has used after a whole job."""
    command = [*board.runner, board.path(image)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as emulator:
        timer = threading.Timer(TIMEOUT_S, emulator.kill)
        timer.start()
        try:
            answers = [ask(emulator, message) for message in JOB]
        finally:
            timer.cancel()
            emulator.kill()
    error, memory = answers[-2].decode(), answers[-1].decode()
    if not error.startswith("0,") or not re.fullmatch(r"\d+,\d+,\d+\s*", memory):
        sys.exit(f"{image}: SYST:ERR? answers '{error.strip()}', and DIAG:MEM? '{memory.strip()}'")
    return int(memory.split(",")[2])


def ask(emulator: "subprocess.Popen[bytes]", message: str) -> bytes:
    """Sends a message, and reads the answer if it is a query: a line, or a block of definite length and a line end."""
    emulator.stdin.write(f"{message}\n".encode())
    emulator.stdin.flush()
    if "?" not in message:
        return b""
    first = emulator.stdout.read(1)
    if first != b"#":
        return first + emulator.stdout.readline()
    digits = int(emulator.stdout.read(1))
    return emulator.stdout.read(int(emulator.stdout.read(digits))) + emulator.stdout.readline()


def measured_stack(board: Board, image: str) -> "int | None":
    """How much of its stack the image has used after work that goes through every part of it; None if nothing runs it."""
    if not board.runner:
        return None
    if image == f"emax_{board.name}":
        return run_product(board, image)
    arguments = REPORT if image.endswith("_report") else COST
    return run_test_image(board, image, arguments)[1]
