"""Fails for names of tests that make a list of them hard to read: long ones, and bytes of a parameter.

usage: names_of_tests.py CTEST BUILD_DIRECTORY
"""

import re
import subprocess
import sys

listing = subprocess.run([sys.argv[1], "-N"], cwd=sys.argv[2], stdout=subprocess.PIPE, check=True).stdout
names = re.findall(r"^ *Test +#\d+: (.*)$", listing.decode(errors="replace"), re.MULTILINE)
bad = [name for name in names if not re.fullmatch("[!-~]{1,90}", name)]
sys.exit("\n".join(bad) or (0 if names else "no tests"))
