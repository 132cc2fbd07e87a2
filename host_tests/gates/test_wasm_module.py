"""Proof that the gate on modules of WebAssembly refuses each fault.

usage: test_wasm_module.py GATES
"""

import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))
import wasm_module


def section(kind: int, content: bytes) -> bytes:
    return bytes([kind]) + bytes([len(content)]) + content


def name(text: str) -> bytes:
    return bytes([len(text)]) + text.encode()


def module(
    *, imports=("read",), exports=("emax_poll",), limits=b"\1\2\2", extra=b"", functions=("emax_poll",), feature="sign-ext"
):
    imported = b"".join(name("emax") + name(text) + b"\0\0" for text in imports)
    exported = b"".join(name(text) + b"\0\0" for text in exports) + name("memory") + b"\2\0"
    named = b"".join(bytes([i]) + name(text) for i, text in enumerate(functions))
    named = b"\1" + bytes([1 + len(named)]) + bytes([len(functions)]) + named
    return wasm_module.Module(
        b"\0asm\1\0\0\0"
        + section(2, bytes([len(imports)]) + imported)
        + section(5, b"\1" + limits)
        + section(7, bytes([len(exports) + 1]) + exported)
        + extra
        + section(0, name("name") + named)
        + section(0, name("target_features") + b"\1+" + name(feature))
    )


def complaints(has_heap=False, **parts):
    return wasm_module.breaches(module(**parts), {"emax.read"}, {"emax_poll", "memory"}, has_heap)


class Gate(unittest.TestCase):
    def test_passes_a_good_module(self):
        self.assertEqual(complaints(), [])

    def test_refuses_each_fault(self):
        for fault, parts in {
            "import emax.fetch, which is not expected": {"imports": ("read", "fetch")},
            "import emax.read is missing": {"imports": ()},
            "export emax_stop, which is not expected": {"exports": ("emax_poll", "emax_stop")},
            "export emax_poll is missing": {"exports": ()},
            "the memory may grow from 2 pages": {"limits": b"\1\2\3"},
            "the memory may grow from 3 pages": {"limits": b"\0\3"},
            "code that runs before the first call": {"functions": ("emax_poll", "_GLOBAL__sub_I_main.cpp")},
            "heap: malloc": {"functions": ("emax_poll", "malloc")},
            "heap: _Znwm": {"functions": ("emax_poll", "_Znwm")},
            "no names of functions, so nothing is known of a heap": {"functions": ()},
            "the target has simd128": {"feature": "simd128"},
        }.items():
            with self.subTest(fault):
                self.assertEqual(complaints(**parts), [fault])

    def test_refuses_a_start_function(self):
        self.assertEqual(complaints(extra=section(8, b"\0")), ["code that runs before the first call"])

    def test_permits_operators_where_strings_are(self):
        self.assertEqual(complaints(True, functions=("emax_poll", "_Znwm", "_ZdlPv")), [])
        self.assertEqual(complaints(True, functions=("emax_poll", "free")), ["heap: free"])

    def test_counts_the_bytes_without_names(self):
        self.assertEqual(module().bytes, module(functions=("emax_poll", "a_long_name_of_a_function")).bytes)


if __name__ == "__main__":
    unittest.main()
