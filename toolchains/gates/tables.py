"""The tables that programs keep in a README, between two markers."""

import re
import sys
from pathlib import Path

FOOTPRINT = "footprint"


def markers(name: str) -> tuple[str, str]:
    return f"<!-- table {name} -->", f"<!-- end of table {name} -->"


def text(readme: str, name: str) -> str:
    begin, end = markers(name)
    whole = Path(readme).read_text()
    if whole.count(begin) != 1 or whole.count(end) != 1 or whole.index(begin) > whole.index(end):
        sys.exit(f"{readme}: expected one '{begin}' and after it one '{end}'")
    return whole[whole.index(begin) + len(begin) : whole.index(end)]


def replace(readme: str, name: str, new: str) -> None:
    old = text(readme, name)
    begin, _ = markers(name)
    whole = Path(readme).read_text()
    Path(readme).write_text(whole.replace(begin + old, f"{begin}\n{new.strip()}\n", 1))


def rows(readme: str, name: str) -> list[list[str]]:
    """The cells of the table, without its head."""
    lines = [line for line in text(readme, name).splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def number(cell: str) -> "int | None":
    """The first number of a cell, which may have blanks between its thousands."""
    match = re.match(r"\d+( \d{3})*", cell)
    return int(match[0].replace(" ", "")) if match else None


def grouped(value: int) -> str:
    return f"{value:,}".replace(",", " ")


def footprint(readme: str) -> dict[str, dict[str, int]]:
    """Flash and RAM of each image, as the README has them."""
    found = {}
    for image, flash, ram, *_ in rows(readme, FOOTPRINT):
        found[image.strip("`")] = {"flash": number(flash) or 0, "ram": number(ram) or 0}
    return found
