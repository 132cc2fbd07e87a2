"""What an image may take, in bytes: --budget FLASH RAM STACK."""

import argparse

KINDS = ("flash", "ram", "stack")


def add_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--budget", required=True, nargs=len(KINDS), type=int, metavar=tuple(map(str.upper, KINDS)))


def judge(budget: list[int], used: dict[str, int]) -> list[str]:
    """Prints what is left of the budget, and returns what is over."""
    limits = dict(zip(KINDS, budget))
    over = []
    for what, taken in used.items():
        left = limits[what] - taken
        print(f"{what}: {taken} of {limits[what]} bytes, {left} left")
        if left < 0:
            over.append(f"{what} is {-left} bytes over its budget")
    return over
