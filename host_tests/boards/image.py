"""A test image that runs: its console as two pipes, and its exit status."""

import subprocess
import threading

# A hang ends here, so that the test can still say where it was.
LONGEST_RUN_S = 50


class Image:
    """RUNNER OPTION... PATH ARGUMENT, as board.cmake declares it."""

    def __init__(self, runner: list[str], path: str, argument: str, options: list[str] | None = None):
        self.process = subprocess.Popen(
            [*runner, *(options or []), path, argument], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, bufsize=0
        )
        self.timer = threading.Timer(LONGEST_RUN_S, self.process.kill)
        self.timer.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.timer.cancel()
        self.process.kill()
        self.process.communicate()

    def send(self, data: bytes) -> None:
        self.process.stdin.write(data)

    def receive(self, count: int) -> bytes:
        """Waits until there are so many bytes, or the end."""
        data = b""
        while len(data) < count:
            piece = self.process.stdout.read(count - len(data))
            if not piece:
                break
            data += piece
        return data

    def line(self) -> str:
        """Waits for the end of the line."""
        data = b""
        while not data.endswith(b"\n"):
            byte = self.process.stdout.read(1)
            if not byte:
                break
            data += byte
        return data.decode(errors="replace").rstrip("\n")

    def end(self) -> tuple[int, str]:
        """The exit status, and what was printed after what has been read."""
        rest, _ = self.process.communicate()
        self.timer.cancel()
        return self.process.returncode, rest.decode(errors="replace")
