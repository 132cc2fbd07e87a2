"""Holds a module of WebAssembly against what the product promises.

usage: wasm_module.py --budget FLASH RAM STACK [--heap] [--imports NAME,...] --exports NAME,... MODULE

The module may import and export exactly these functions, beside its memory; that memory has one size and cannot grow,
and is within its budget, as are the bytes of the module without names. No code runs before the first call, no function
has the name of a heap's, with --heap but for the operators of C++, and no instruction is there that could multiply and
add with one rounding. Prints a line for each breach and exits with 1 if there is one.
"""

import argparse
import re
import sys
from pathlib import Path

import budgets

PAGE = 65536
CUSTOM, IMPORT, MEMORY, EXPORT, START = 0, 2, 5, 7, 8
FUNCTION, TABLE, MEMORY_KIND, GLOBAL = range(4)
HEAP = re.compile(r"_?(malloc|calloc|realloc|free|sbrk)(_r)?|dl(malloc|free)|aligned_alloc")
OPERATORS = re.compile(r"_Zn[wa].*|_Zd[la].*")
# Vectors, and with them relaxed ones, are where a fused instruction could come from.
FEATURES_WITH_FUSED = {"simd128", "relaxed-simd"}


class Reader:
    def __init__(self, data: bytes):
        self.data, self.at = data, 0

    def done(self) -> bool:
        return self.at >= len(self.data)

    def byte(self) -> int:
        self.at += 1
        return self.data[self.at - 1]

    def number(self) -> int:
        value = shift = 0
        while True:
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    def piece(self) -> bytes:
        size = self.number()
        self.at += size
        return self.data[self.at - size : self.at]

    def name(self) -> str:
        return self.piece().decode()


class Module:
    def __init__(self, data: bytes):
        if data[:8] != b"\0asm\1\0\0\0":
            sys.exit("this is no module of WebAssembly")
        self.imports: list[str] = []
        self.exports: list[str] = []
        self.memories: list[tuple[int, "int | None"]] = []
        self.names: list[str] = []
        self.features: list[str] = []
        self.has_start = False
        self.bytes = 8
        reader = Reader(data)
        reader.at = 8
        while not reader.done():
            begin = reader.at
            kind = reader.byte()
            self.take(kind, Reader(reader.piece()))
            if kind != CUSTOM:
                self.bytes += reader.at - begin

    def take(self, kind: int, section: Reader) -> None:
        if kind == CUSTOM:
            self.take_custom(section.name(), section)
        elif kind == IMPORT:
            for _ in range(section.number()):
                module, name, what = section.name(), section.name(), section.byte()
                self.imports.append(f"{module}.{name}" if what == FUNCTION else f"{module}.{name}, no function")
                if what != FUNCTION:
                    return  # Its description is of another form; the breach is noted.
                section.number()
        elif kind == MEMORY:
            for _ in range(section.number()):
                has_most = section.byte() & 1
                self.memories.append((section.number(), section.number() if has_most else None))
        elif kind == EXPORT:
            for _ in range(section.number()):
                name, what = section.name(), section.byte()
                section.number()
                self.exports.append(name if what in (FUNCTION, MEMORY_KIND) else f"{name}, no function")
        elif kind == START:
            self.has_start = True

    def take_custom(self, name: str, section: Reader) -> None:
        if name == "name":
            while not section.done():
                kind, names = section.byte(), Reader(section.piece())
                if kind == 1:  # Of functions.
                    for _ in range(names.number()):
                        names.number()
                        self.names.append(names.name())
        elif name == "target_features":
            for _ in range(section.number()):
                section.byte()
                self.features.append(section.name())


def breaches(module: Module, imports: set[str], exports: set[str], has_heap: bool) -> list[str]:
    complaints = []
    for what, found, permitted in [("import", module.imports, imports), ("export", module.exports, exports)]:
        complaints += [f"{what} {name}, which is not expected" for name in sorted(set(found) - permitted)]
        complaints += [f"{what} {name} is missing" for name in sorted(permitted - set(found))]
    if len(module.memories) != 1:
        complaints.append(f"{len(module.memories)} memories")
    complaints += [f"the memory may grow from {least} pages" for least, most in module.memories if most != least]
    if module.has_start or any(re.match(r"_GLOBAL__(sub_)?I_|__cxx_global_var_init", name) for name in module.names):
        complaints.append("code that runs before the first call")
    if not module.names:
        complaints.append("no names of functions, so nothing is known of a heap")
    for name in module.names:
        if HEAP.fullmatch(name) or (OPERATORS.fullmatch(name) and not has_heap):
            complaints.append(f"heap: {name}")
    complaints += [f"the target has {name}" for name in module.features if name in FEATURES_WITH_FUSED]
    return complaints


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    budgets.add_option(parser)
    parser.add_argument("--heap", action="store_true")
    parser.add_argument("--imports", default="")
    parser.add_argument("--exports", required=True)
    parser.add_argument("module", type=Path)
    arguments = parser.parse_args()

    module = Module(arguments.module.read_bytes())
    complaints = breaches(
        module,
        {f"emax.{name}" for name in arguments.imports.split(",") if name},
        set(arguments.exports.split(",")) | {"memory"},
        arguments.heap,
    )
    used = {"flash": module.bytes, "ram": PAGE * sum(least for least, _ in module.memories)}
    complaints += budgets.judge(arguments.budget, used)
    for complaint in complaints:
        print(f"{arguments.module.name}: {complaint}")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
