"""Runs clang-tidy over all sources of a folder at once: most of its time goes by in the headers that they share.

usage: tidy_folder.py CLANG_TIDY CONFIGURATION TREE OUTPUT SOURCE...

CONFIGURATION is the file .clang-tidy, TREE a build tree with compile_commands.json, OUTPUT the file to write that
includes the sources. They must be compiled alike, and what is of one of them alone must have a name of its own.
"""

import json
import shlex
import subprocess
import sys
from pathlib import Path


def main() -> int:
    clang_tidy, configuration, tree, output, *sources = sys.argv[1:]
    commands = json.loads((Path(tree) / "compile_commands.json").read_text(encoding="utf-8"))
    options = {command["file"]: options_of(command["command"]) for command in commands}
    for source in sources:
        if options.get(source, []) != options.get(sources[0]):
            sys.exit(f"tidy_folder: {source} is not compiled as {sources[0]} is; give it a test of its own")
    path = Path(output)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join(f'#include "{source}"\n' for source in sources), encoding="utf-8")
    checks = "--checks=-clang-analyzer-*,-bugprone-suspicious-include"
    return subprocess.run([clang_tidy, "--quiet", f"--config-file={configuration}", checks, output, "--",
                           *options[sources[0]]], check=False).returncode


def options_of(command: str) -> list[str]:
    """Those of a command of the compiler, without its source and its output."""
    words = shlex.split(command)[1:]
    left_out = {position + step for position, word in enumerate(words) if word in ("-o", "-c") for step in (0, 1)}
    return [word for position, word in enumerate(words) if position not in left_out]


if __name__ == "__main__":
    sys.exit(main())
