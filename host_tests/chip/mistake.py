"""Builds the image to be flashed with one deliberate mistake in a driver.

usage: mistake.py PATCH TREE IMAGE.ELF

PATCH changes one source of the project, TREE is the build tree of the image without the mistake. Only that source is
compiled, from a copy beside IMAGE.ELF, and the image is linked again. Of a header, the patch says "Compiled in:", and the
source that includes it. Exits with 1 and says why if the patch does not
apply or its result does not compile.
"""

import json
import os
import re
import shlex
import subprocess
import sys
from typing import NamedTuple

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


class Change(NamedTuple):
    old: str
    new: str


class Patch(NamedTuple):
    source: str  # Below the root of the project.
    unit: str  # What is compiled: the source, or that which includes it.
    changes: list[Change]


def read_patch(path: str) -> Patch:
    """A diff of one file; what stands before it are words."""
    with open(path, encoding="utf-8") as file:
        head, *hunks = re.split(r"^@@ .*\n", file.read(), flags=re.MULTILINE)
    target = re.search(r"^\+\+\+ b/(.*)$", head, flags=re.MULTILINE)
    if target is None or not hunks:
        sys.exit(f"{path}: no difference of a file in it")
    changes = []
    for hunk in hunks:
        lines = hunk.splitlines(keepends=True)
        old = "".join(line[1:] for line in lines if line[0] in " -")
        new = "".join(line[1:] for line in lines if line[0] in " +")
        changes.append(Change(old, new))
    unit = re.search(r"^Compiled in: (.*)$", head, flags=re.MULTILINE)
    return Patch(target[1], unit[1] if unit else target[1], changes)


def patched(path: str, patch: Patch) -> str:
    with open(os.path.join(ROOT, patch.source), encoding="utf-8") as file:
        text = file.read()
    for change in patch.changes:
        found = text.count(change.old)
        if found != 1:
            sys.exit(
                f"{path} does not apply any more: {patch.source} has these lines {found} times, not once.\n"
                f"{change.old}Mend the patch, so that it makes the same mistake in the driver of now."
            )
        text = text.replace(change.old, change.new)
    return text


def run(command: list[str], tree: str) -> None:
    done = subprocess.run(command, cwd=tree, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{shlex.join(command)}\n{done.stderr}")


def compile_command(tree: str, source: str, copy: str, built: str) -> list[str]:
    """That of the source itself, for its copy; warnings may come of the mistake."""
    with open(os.path.join(tree, "compile_commands.json"), encoding="utf-8") as file:
        commands = {entry["file"]: entry["command"] for entry in json.load(file)}
    words = shlex.split(commands[os.path.join(ROOT, source)])
    return [*words[: words.index("-o")], "-w", "-o", built, "-c", copy]


def link_command(tree: str, built: str, image: str) -> list[str]:
    """That of the image of the tree build/<board>, with this file in front of the library which has the one without the mistake."""
    product = f"emax_{os.path.basename(tree).replace('-', '_')}.elf"
    listed = subprocess.run(["ninja", "-t", "commands", product], cwd=tree, capture_output=True, text=True, check=True)
    link = listed.stdout.splitlines()[-1].split(" && ")[1]
    words = [word for word in shlex.split(link) if "-Map=" not in word and "--emit-relocs" not in word]
    words[words.index("-o") + 1] = image
    return [*words[:1], built, *words[1:]]


def main() -> int:
    path, tree, image = sys.argv[1:]
    patch = read_patch(path)
    stem = os.path.splitext(image)[0]
    built = stem + ".o"
    copy, first = stem + ".cpp", []
    if patch.unit != patch.source:
        copy, first = os.path.join(stem, patch.source.split("/include/")[1]), [f"-I{stem}"]
        os.makedirs(os.path.dirname(copy), exist_ok=True)
    with open(copy, "w", encoding="utf-8") as file:
        file.write(patched(path, patch))
    unit = os.path.join(ROOT, patch.unit) if first else copy
    compiler, *options = compile_command(tree, patch.unit, unit, built)
    run([compiler, *first, *options], tree)
    run(link_command(tree, built, image), tree)
    return 0


if __name__ == "__main__":
    sys.exit(main())
