"""Checks that freestanding objects and archives need nothing that a microcontroller lacks.

usage: symbols.py --readelf READELF FILE...

Whatever the files leave undefined between them must be on the short list below, and no object may have code that
runs before main, thread-local storage, guards of function-local statics, or exception tables. Prints one line for
each breach and exits with 1 if there is one.
"""

import argparse
import re
import subprocess
import sys

# Compilers call these for copies of structs and arrays, and every freestanding environment has them.
ALLOWED = {"memcpy", "memmove", "memset", "memcmp", "_GLOBAL_OFFSET_TABLE_"}

# Stands for what `meaning()` finds by reading the name: an operator new or delete that a class has of its own.
CLASS_HEAP = "operator new or delete of a class"
# What an undefined symbol means, first match first.
FAMILIES = [
    (CLASS_HEAP, "heap"),
    (r"malloc|calloc|realloc|free|aligned_alloc|posix_memalign|_?sbrk|_Zn[wa].*|_Zd[la].*", "heap"),
    (r"__cxa_guard_.*", "guard of a function-local static"),
    (r"__cxa_atexit|atexit|__dso_handle", "destructor of a static object"),
    (r"__cxa_.*|_Unwind_.*|__gxx_personality.*|_ZSt\d+__throw_.*|_ZSt9terminatev", "exceptions"),
    (r"v?(f|s|sn|d|as)?printf|puts|putchar|f?puts|fwrite|fputc|.*scanf|std(in|out|err)|_ZSt4c(out|err|in)", "stdio"),
    (
        r"a?(sin|cos|tan)h?f?l?|atan2f?l?|sincosf?l?|(exp|exp2|exp10|expm1|log|log2|log10|log1p|pow|sqrt|cbrt|hypot)f?l?"
        r"|(fma|fmod|floor|ceil|round|trunc|rint|nearbyint|l?lround|l?lrint|ldexp|frexp|scalbl?n|modf)f?l?"
        r"|(fabs|fmin|fmax|copysign|remainder|erfc?|[tl]gamma)f?l?",
        "libm",
    ),
]
SECTIONS = [
    (r"\.(preinit_array|init_array|ctors|init)(\..*)?", "code that runs before main"),
    (r"\.(fini_array|dtors|fini)(\..*)?", "code that runs after main"),
    (r"\.(tdata|tbss)(\..*)?", "thread-local storage"),
    (r"\.gcc_except_table(\..*)?", "exception tables"),
]
DEFINED = [
    (CLASS_HEAP, "heap"),
    (r"_GLOBAL__(sub_)?[ID]_.*", "code that runs before main"),
    (r"_ZGV.*", "guard of a function-local static"),
    (r"__emutls_.*", "thread-local storage"),
]

FILE_LINE = re.compile(r"File: (.*)")
SECTION_LINE = re.compile(r"\s*\[\s*\d+\]\s+(\S+)\s+\S+\s+[0-9a-f]+\s+[0-9a-f]+\s+([0-9a-f]+)")
SYMBOL_LINE = re.compile(r"\s*\d+:\s+[0-9a-f]+\s+\S+\s+(\S+)\s+(\S+)\s+\S+\s+(\S+)\s+([^\s@]+)")


class Object:
    def __init__(self, name: str):
        self.name = name
        self.sections: list[str] = []
        self.defined: list[str] = []
        self.undefined: list[str] = []


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--readelf", required=True)
    parser.add_argument("files", nargs="+", metavar="FILE")
    arguments = parser.parse_args()

    objects = [found for file in arguments.files for found in read(arguments.readelf, file)]
    if not any(found.defined for found in objects):
        sys.exit("symbols: no object defines anything; nothing was checked")
    complaints = breaches(objects)
    for complaint in complaints:
        print(complaint)
    print(f"{len(objects)} objects, {len(complaints)} breaches")
    return 1 if complaints else 0


def read(readelf: str, file: str) -> list[Object]:
    listing = subprocess.run(
        [readelf, "--sections", "--symbols", "--wide", file], capture_output=True, text=True, check=True
    ).stdout
    short = file.rsplit("/", 1)[-1]
    objects = [Object(short)]
    for line in listing.splitlines():
        if match := FILE_LINE.match(line):
            member = match[1].rsplit("(", 1)[-1].rstrip(")") if "(" in match[1] else ""
            objects.append(Object(f"{short}({member})" if member else short))
        elif match := SECTION_LINE.match(line):
            if int(match[2], 16) > 0:
                objects[-1].sections.append(match[1])
        elif match := SYMBOL_LINE.match(line):
            kind, binding, place, name = match[1], match[2], match[3], match[4]
            del kind, binding
            (objects[-1].undefined if place == "UND" else objects[-1].defined).append(name)
    return [found for found in objects if found.sections or found.defined or found.undefined]


def breaches(objects: list[Object]) -> list[str]:
    provided = ALLOWED.union(*(found.defined for found in objects))
    complaints = []
    for found in objects:
        for name in sorted(set(found.undefined) - provided):
            complaints.append(f"{found.name}: needs {name}: {meaning(FAMILIES, name) or 'not on the list of permitted symbols'}")
        for name in sorted(set(found.defined)):
            if reason := meaning(DEFINED, name):
                complaints.append(f"{found.name}: has {name}: {reason}")
        for name in sorted(set(found.sections)):
            if reason := meaning(SECTIONS, name):
                complaints.append(f"{found.name}: has section {name}: {reason}")
    return complaints


def meaning(table: list[tuple[str, str]], name: str) -> "str | None":
    if is_class_heap(name):
        name = CLASS_HEAP
    return next((reason for pattern, reason in table if re.fullmatch(pattern, name)), None)


def is_class_heap(name: str) -> bool:
    """Whether a mangled name is that of an operator new or delete within a class."""
    return name.startswith("_ZN") and re.search(r"(n[wa]|d[la])E", without_identifiers(name)) is not None


def without_identifiers(name: str) -> str:
    """A mangled name without the names in it, each of which stands behind its length, and without numbers."""
    kept = ""
    at = 0
    while at < len(name):
        if number := re.compile(r"L[a-z]n?\d+E").match(name, at):
            at = number.end()
        elif length := re.compile(r"[1-9]\d*").match(name, at):
            at = length.end() + int(length[0])
            kept += "."
        else:
            kept += name[at]
            at += 1
    return kept


if __name__ == "__main__":
    sys.exit(main())
