#!/usr/bin/env -S python3 -B
"""Runs an image in QEMU as if it were a program of this PC, with the image's exit status.

usage: qemu.py QEMU [OPTION...] run [--console null|tcp:PORT|telnet:PORT] [--instruction-ns N] IMAGE [ARGUMENT...]

QEMU and its options choose the machine. The console of the board is standard input and output, or nothing, or a port of
this PC on which the machine waits for its client; by telnet a client can send a break. With --instruction-ns every instruction takes N ns of the machine's
time, whatever the speed of the PC; N is a power of two.
"""

import argparse
import os
import signal
import sys


def main() -> None:
    split = sys.argv.index("run")
    machine = sys.argv[1:split]
    parser = argparse.ArgumentParser(usage=__doc__.splitlines()[2].removeprefix("usage: "))
    parser.add_argument("--console", default="stdio")
    parser.add_argument("--instruction-ns", type=int)
    parser.add_argument("image")
    parser.add_argument("arguments", nargs=argparse.REMAINDER)
    given = parser.parse_args(sys.argv[split + 1 :])

    command = [*machine, "-display", "none", "-monitor", "none", "-serial", console(given.console)]
    command += ["-semihosting-config", "enable=on,target=native"]
    if given.instruction_ns:
        command += ["-icount", f"shift={given.instruction_ns.bit_length() - 1}"]
    if given.arguments:
        command += ["-append", " ".join(given.arguments)]
    # Python ignores it, and what takes its place would inherit that.
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    os.execvp(command[0], [*command, "-kernel", given.image])


def console(where: str) -> str:
    if where.startswith("tcp:"):
        return f"tcp:127.0.0.1:{where.removeprefix('tcp:')},server=on,wait=on,nodelay=on"
    if where.startswith("telnet:"):
        return f"telnet:127.0.0.1:{where.removeprefix('telnet:')},server=on,wait=on,nodelay=on"
    return where


if __name__ == "__main__":
    main()
