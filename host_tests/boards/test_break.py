"""A break of the serial line is a device clear: half a message is forgotten, settings and errors stay.

usage: test_break.py IMAGE RUNNER...

The emulator takes the break of the telnet protocol for one of the line.
"""

import socket
import subprocess
import sys
import time

BREAK = b"\xff\xf3"
PATIENCE = 30.0


def connect(port: int) -> socket.socket:
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
        except ConnectionRefusedError:
            if time.monotonic() > end:
                raise
            time.sleep(0.05)


def ask(peer: socket.socket, line: bytes) -> str:
    peer.sendall(line + b"\n")
    answer = b""
    while not answer.endswith(b"\n"):
        piece = peer.recv(1)
        if not piece:
            break
        answer += piece
    return answer.decode(errors="replace").rstrip("\n")


def main() -> int:
    image, *runner = sys.argv[1:]
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with subprocess.Popen([*runner, "--console", f"telnet:{port}", image], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL) as process:
        try:
            with connect(port) as peer:
                # The emulator's own words about the protocol come first.
                assert "emax," in ask(peer, b"*IDN?")
                assert ask(peer, b"SENS:SWE:CYCL 5;CYCL?") == "5"
                peer.sendall(b"SENS:SWE:CYCL 1")
                time.sleep(0.5)
                peer.sendall(BREAK)
                time.sleep(0.5)
                answer = ask(peer, b"SENS:SWE:CYCL?;:SYST:ERR?")
        finally:
            process.kill()
    if answer != '5;0,"No error"':
        print(f"after the break: {answer}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
