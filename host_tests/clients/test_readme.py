"""The examples of the README, run as they stand there, print what stands there.

usage: test_readme.py PROGRAM README
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from instruments import HostProgram

PROGRAM, README = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).read_text()
ADDRESS = "TCPIP::127.0.0.1::5025::SOCKET"


class ReadmeTest(unittest.TestCase):
    def session(self, start: str) -> tuple[str, str]:
        """The one block that shows a command with that start: the command, and what it prints."""
        found = re.findall(rf"^```\n\$ ({re.escape(start)}.*)\n((?:.*\n)*?)```$", README, re.MULTILINE)
        self.assertEqual(len(found), 1, start)
        return found[0]

    def test_by_hand(self):
        command, printed = self.session("printf ")
        line = command.replace("build/host/emax", f"'{PROGRAM}'")
        self.assertNotEqual(line, command)
        result = subprocess.run(line, shell=True, check=True, stdout=subprocess.PIPE, timeout=60)
        self.assertEqual(result.stdout.decode(), printed)

    def test_pyvisa(self):
        command, printed = self.session("python3 example.py ")
        self.assertEqual(command, f"python3 example.py {ADDRESS}")
        scripts = re.findall(r"^```python\n((?:.*\n)*?)```$", README, re.MULTILINE)
        self.assertEqual(len(scripts), 1)
        self.assertEqual(scripts[0].count("\n"), 10, "ten lines")
        instrument = HostProgram(PROGRAM)
        self.addCleanup(instrument.close)
        with tempfile.TemporaryDirectory() as directory:
            script = pathlib.Path(directory) / "example.py"
            script.write_text(scripts[0])
            address = ADDRESS.replace("5025", str(instrument.port))
            result = subprocess.run([sys.executable, "-W", "ignore", script, address], check=True,
                                    stdout=subprocess.PIPE, timeout=100)
        self.assertEqual(result.stdout.decode(), printed)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
