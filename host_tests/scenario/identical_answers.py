"""Sends the same commands to the console of a board's product and to `emax scpi`, and demands the same answers.

usage: identical_answers.py PROGRAM "RUNNER... IMAGE"

Only *IDN? names the board.
"""

import shlex
import subprocess
import sys
import threading

# Each query has an answer of one line.
COMMANDS = """\
*IDN?
*TST?
CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004
CALC:MCAR:TRI 1000
CALC:ENER?
CALC:AERR?
CALC:IMP? 0.00001,0.0001,0.001
CALC:SETT?
CALC:MCAR?
CALC:MCAR:HIST?
CALC:MOD:NONSENSE 1
SYST:ERR?
INIT:SWE
*WAI
FETC:FRES?
CALC:IDEN?
DIAG:RAND? 3
SYST:ERR?
"""

# A product never ends by itself.
LONGEST_RUN_S = 300


def main() -> int:
    program, board_command = sys.argv[1:]
    expected = answers_of([program, "scpi"])
    got = answers_of(shlex.split(board_command))
    queries = [line for line in COMMANDS.splitlines() if "?" in line]
    if len(expected) != len(queries):
        sys.exit(f"{program} gave {len(expected)} answers to {len(queries)} queries")

    board = got[0].split(",")
    expected[0] = ",".join([*expected[0].split(",")[:1], *board[1:2], *expected[0].split(",")[2:]])
    different = 0
    for index, query in enumerate(queries):
        answer = got[index] if index < len(got) else "(no answer)"
        if answer != expected[index]:
            different += 1
            print(f"{query}\n  PC:    {expected[index]}\n  board: {answer}")
    if not different:
        print(f"{len(queries)} answers of {board[1]}: the same {sum(map(len, got))} characters as those of the PC")
    return 1 if different else 0


def answers_of(command: list[str]) -> list[str]:
    wanted = sum("?" in line for line in COMMANDS.splitlines())
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        timer = threading.Timer(LONGEST_RUN_S, process.kill)
        timer.start()
        process.stdin.write(COMMANDS)
        process.stdin.flush()
        answers = []
        for line in process.stdout:
            answers.append(line.rstrip("\r\n"))
            if len(answers) == wanted:
                break
        timer.cancel()
        process.kill()
    return answers


if __name__ == "__main__":
    sys.exit(main())
