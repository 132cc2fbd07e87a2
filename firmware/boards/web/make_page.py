"""Puts the page, its style, its scripts and the two modules into one file that needs nothing else.

usage: make_page.py FOLDER INSTRUMENT.WASM DESK.WASM OUTPUT.HTML

The file's policy permits just its own script and style, by their hashes, and nothing from anywhere else.
"""

import base64
import hashlib
import sys
from pathlib import Path

# In this order: each uses what stands before it.
SCRIPTS = [
    "ports.js",
    "scpi.js",
    "desk.js",
    "plot.js",
    "keep.js",
    "report.js",
    "settings.js",
    "pictures.js",
    "files.js",
    "certificate.js",
    "job.js",
    "app.js",
    "run.js",
    "main.js",
]
POLICY = (
    "default-src 'none'; script-src {script} 'wasm-unsafe-eval'; style-src {style}; worker-src blob:; img-src data:; "
    "base-uri 'none'; form-action 'none'"
)
CUSTOM = 0


def main() -> int:
    folder, instrument, desk, output = map(Path, sys.argv[1:])
    style = (folder / "style.css").read_text(encoding="utf-8")
    pieces = [(folder / name).read_text(encoding="utf-8") for name in SCRIPTS]
    script = "(() => {\n'use strict';\n\n" + "\n".join(pieces) + "})();\n"
    worker = (folder / "worker.js").read_text(encoding="utf-8")
    for text in (script, worker):
        if "</script" in text.lower() or "<!--" in text:
            sys.exit("make_page: a script has what would end it")
    page = (folder / "page.html").read_text(encoding="utf-8")
    for mark, content in {
        "@POLICY@": POLICY.format(script=hash_of(script), style=hash_of(style)),
        "@STYLE@": style,
        "@WORKER@": worker,
        "@INSTRUMENT@": encoded(instrument),
        "@DESK@": encoded(desk),
        "@SCRIPT@": script,
    }.items():
        if page.count(mark) != 1:
            sys.exit(f"make_page: page.html has {page.count(mark)} of {mark}, not one")
        page = page.replace(mark, content)
    output.write_text(page, encoding="utf-8")
    print(f"{output.name}: {len(page.encode())} bytes")
    return 0


def hash_of(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def encoded(module: Path) -> str:
    return base64.b64encode(without_names(module.read_bytes())).decode()


def without_names(module: bytes) -> bytes:
    """The module without what only people and gates read."""
    kept, at = module[:8], 8
    while at < len(module):
        begin, kind = at, module[at]
        size = shift = 0
        at += 1
        while True:
            byte = module[at]
            at += 1
            size |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                break
        at += size
        if kind != CUSTOM:
            kept += module[begin:at]
    return kept


if __name__ == "__main__":
    sys.exit(main())
