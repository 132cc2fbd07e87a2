"""Demands of the image `fault` that each fault is reported with the drive at zero, and ends in its exit status.

usage: test_fault.py IMAGE NM RUNNER...
"""

import re
import subprocess
import sys
import unittest

from image import Image

# kFaultStatus of fault_report.hpp.
FAULT_STATUS = 70


class FaultTest(unittest.TestCase):
    image_path = ""
    nm = ""
    runner: list[str] = []

    def report_of(self, kind: str) -> tuple[str, dict[str, int]]:
        """The name of the fault and its numbers."""
        with Image(self.runner, self.image_path, kind) as image:
            status, text = image.end()
        self.assertEqual(status, FAULT_STATUS, text)
        match = re.fullmatch(r"\nfault: ([\w ]+), drive at zero,((?: \w+=0x[0-9a-f]{8})+)\n", text)
        self.assertIsNotNone(match, repr(text))
        return match[1], {name: int(value, 16) for name, value in re.findall(r"(\w+)=(\w+)", match[2])}

    def symbols(self) -> dict[str, tuple[int, int]]:
        """Address and size of each function."""
        listing = subprocess.run([self.nm, "-S", self.image_path], capture_output=True, text=True, check=True).stdout
        rows = re.findall(r"^([0-9a-f]+) ([0-9a-f]+) [Tt] (\w+)$", listing, re.MULTILINE)
        return {name: (int(address, 16), int(size, 16)) for address, size, name in rows}

    def assert_pc_in(self, function: str, numbers: dict[str, int]) -> None:
        address, size = self.symbols()[function]
        address &= ~1  # The mark of Thumb code.
        self.assertTrue(address <= numbers["pc"] < address + size, f"{numbers['pc']:x} is not in {function}")

    def test_trap(self):
        name, numbers = self.report_of("trap")
        self.assertIn(name, ("UsageFault", "breakpoint", "illegal instruction"))
        self.assert_pc_in("fail_by_trap", numbers)

    def test_access_to_nothing(self):
        name, numbers = self.report_of("bus")
        self.assertIn(name, ("BusFault", "store access"))
        self.assert_pc_in("fail_by_bus", numbers)
        self.assertEqual(numbers.get("bfar", numbers.get("mtval")), 0xF0000000)

    def test_write_to_code(self):
        name, numbers = self.report_of("code")
        self.assertIn(name, ("MemManage", "store access"))
        self.assert_pc_in("fail_by_code", numbers)

    def test_stack_overflow(self):
        name, _ = self.report_of("stack")
        self.assertEqual(name, "stack overflow")

    def test_no_fault(self):
        with Image(self.runner, self.image_path, "nothing") as image:
            self.assertEqual(image.end(), (2, ""))


if __name__ == "__main__":
    FaultTest.image_path, FaultTest.nm, *FaultTest.runner = sys.argv[1:]
    unittest.main(argv=sys.argv[:1], verbosity=2)
