"""Runs an image in its emulator and holds the stack that it has used against what the call graph proves.

usage: stack_measured.py --calls INDIRECT_CALLS.TXT --tree TREE IMAGE

TREE is the build tree of the image's board; its images.json says how the image is run. Exits with 1 if more was used
than is proven, which would be an error of the proof, or less than a third: then either the work of the run no longer
reaches the deep parts, or the proof counts chains that cannot be.
"""

import argparse
import sys

from image import Image
from run import Board, measured_stack
from stack import prove

LEAST_SHARE = 1 / 3


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--calls", required=True)
    parser.add_argument("--tree", required=True)
    parser.add_argument("image")
    arguments = parser.parse_args()

    board = Board.read(arguments.tree)
    linked = Image(board.path(arguments.image))
    proven = prove(linked, board.objdump, board.images[arguments.image], arguments.calls, board.interrupt_levels).bytes
    measured = measured_stack(board, arguments.image)
    print(f"{arguments.image}: {measured} bytes of stack measured, {proven} proven, {measured / proven:.0%}")
    if measured > proven:
        print("more than is proven")
        return 1
    if measured < LEAST_SHARE * proven:
        print("far less than is proven")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
