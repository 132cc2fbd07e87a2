"""Holds the flash and the static memory of a linked image against its budget.

usage: footprint.py --budget FLASH RAM STACK [--recorded README.MD] IMAGE

Flash is code, constants and the values that variables start with. Static memory is all variables, without the stack and
without .store, which stands in for a flash memory of records. With a README that has the table of the footprints, prints by how much the image has
changed since. Exits with 1 if the image is over a budget.
"""

import argparse
import sys

import budgets
import tables
from image import SHT_NOBITS, Image

LEFT_OUT = (".stack", ".store")


def used(image: Image) -> dict[str, int]:
    allocated = [section for section in image.sections if section.is_allocated and section.name not in LEFT_OUT]
    return {
        "flash": sum(section.size for section in allocated if section.kind != SHT_NOBITS),
        "ram": sum(section.size for section in allocated if section.is_writable),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    budgets.add_option(parser)
    parser.add_argument("--recorded")
    parser.add_argument("image")
    arguments = parser.parse_args()

    image = Image(arguments.image)
    taken = used(image)
    if taken["flash"] == 0:
        sys.exit(f"footprint: {image.path} has no code")
    over = budgets.judge(arguments.budget, taken)
    if arguments.recorded and (row := tables.footprint(arguments.recorded).get(image.name)):
        for what, now in taken.items():
            print(f"{what}: {now - row[what]:+} bytes since the table in {arguments.recorded}")
    for complaint in over:
        print(f"{image.name}: {complaint}")
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
