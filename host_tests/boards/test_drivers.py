"""Plays the peer of the image `drivers`: console, clock, store and watchdog of a board.

usage: test_drivers.py IMAGE WATCHDOG RUNNER...

WATCHDOG is `watchdog` or `none`, whatever the board has.
"""

import re
import sys
import unittest

from image import Image

# As in the source of the image.
ECHOED = 2000
FLOOD = 5000
RECEIVE_ROOM = 1024

# Of the machine's time, whatever the speed of the PC.
NS_PER_INSTRUCTION = 1024
EXACT_TIME = ["--instruction-ns", str(NS_PER_INSTRUCTION)]


class DriversTest(unittest.TestCase):
    image_path = ""
    has_watchdog = True
    runner: list[str] = []

    def test_console(self):
        with Image(self.runner, self.image_path, "console") as image:
            self.check_echo(image)
            self.check_flood(image)
            self.assertEqual(image.end(), (0, ""))

    def test_time(self):
        with Image(self.runner, self.image_path, "time", EXACT_TIME) as image:
            self.assertEqual(image.line(), "other reset")
            self.check_clock(image, 1_000_000)
            self.check_clock(image, 200_000_000)
            if self.has_watchdog:
                self.check_bite(image)
            else:
                self.check_reset(image)
            self.assertEqual(image.end(), (0, ""))

    def check_echo(self, image):
        sent = bytes(range(256)) * (ECHOED // 256 + 1)
        for begin in range(0, ECHOED, 500):
            piece = sent[begin : min(begin + 500, ECHOED)]
            image.send(piece)
            self.assertEqual(image.receive(len(piece)), piece)

    def check_flood(self, image):
        self.assertEqual(image.line(), "flood")
        sent = bytes((7 * i + i // 256) % 256 for i in range(FLOOD))
        image.send(sent)
        self.assertEqual(image.line(), f"lost {FLOOD - RECEIVE_ROOM} kept {RECEIVE_ROOM}")
        self.assertEqual(image.receive(RECEIVE_ROOM), sent[:RECEIVE_ROOM])

    def check_clock(self, image, instructions):
        match = re.fullmatch(rf"{instructions} instructions took (\d+) us", image.line())
        self.assertIsNotNone(match)
        # The two readings, what is around them and one interrupt take less than two hundred instructions.
        self.assertAlmostEqual(int(match[1]), instructions * NS_PER_INSTRUCTION / 1000, delta=200)

    def check_bite(self, image):
        self.assertEqual(image.line(), "hang")
        self.assertEqual(image.line(), "")
        self.assertRegex(image.line(), r"^fault: watchdog, drive at zero, .*pc=0x(?!0{8})[0-9a-f]{8} ")
        self.assertEqual(image.line(), "watchdog reset, record kept")

    def check_reset(self, image):
        self.assertEqual(image.line(), "no watchdog; reset")
        self.assertEqual(image.line(), "other reset, record kept")


if __name__ == "__main__":
    DriversTest.image_path, watchdog, *DriversTest.runner = sys.argv[1:]
    DriversTest.has_watchdog = watchdog == "watchdog"
    unittest.main(argv=sys.argv[:1], verbosity=2)
