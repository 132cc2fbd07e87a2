"""The instruments that the client tests talk to: the program on a loopback port, or an image that runs on this PC.

Both are started here, in a directory of their own, and are spoken to over TCP.
"""

import pathlib
import re
import signal
import socket
import subprocess
import time

START_S = 30.0


def restore_signals() -> None:
    """Whoever runs the tests in the background may have SIGINT ignored, and children inherit that."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def wait_for(port: int) -> None:
    """Until somebody listens; an emulator says nothing when it does. Does not connect: it would take that for the client."""
    deadline = time.monotonic() + START_S
    wanted = f":{port:04X} "
    while time.monotonic() < deadline:
        if any(wanted in line and " 0A " in line for line in pathlib.Path("/proc/net/tcp").read_text().splitlines()):
            return
        time.sleep(0.02)
    raise TimeoutError(f"nobody listens on port {port}")


class HostProgram:
    """`emax scpi --tcp 0`, which chooses a port and names it on standard error."""

    def __init__(self, program: str, *options: str):
        self.process = subprocess.Popen([program, "scpi", "--tcp", "0", *options], stdin=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE, preexec_fn=restore_signals)
        line = self.process.stderr.readline().decode()
        found = re.fullmatch(r"emax: listening on 127\.0\.0\.1:(\d+)\n", line)
        if found is None:
            self.close()
            raise RuntimeError(f"the program says {line!r}")
        self.port = int(found[1])

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
        self.process.stderr.close()


class BoardImage:
    """An image whose console is a socket; the emulated core waits until a client is there."""

    def __init__(self, runner: list[str], image: str):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.process = subprocess.Popen([*runner, "--console", f"tcp:{self.port}", image], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_for(self.port)

    def close(self) -> None:
        self.process.kill()
        self.process.wait()
