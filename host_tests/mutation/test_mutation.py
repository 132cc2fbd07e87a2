"""Shows what the mutator changes and what it leaves alone, and that a changed file is the one of before afterwards.

usage: test_mutation.py
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from bench import Changed, copy_tree, run
from changes import Change, apply, changed_line, changes_of
from mutate import EQUIVALENTS, ROOT, drawn, equivalents, listed

FUNCTION = """\
// a < b: no code.
#include <cstddef>
template <typename T, int N = 3>
int f(const char* text, T&& other) {
  static_assert(1 < 2, "3 < 4");
  const int count = 5;
  if (count < g(text)) {
    other.take(count + 1);
    return true;
  }
  total += 0.5 * count;  // 7 < 8
  return other == '9' && ok ? 2.0 : text;
}
"""


def after(kind: str, text: str = FUNCTION) -> list[str]:
    return [changed_line(text, change)[1] for change in changes_of(text) if change.kind == kind]


class Changes(unittest.TestCase):
    def test_each_kind_changes_what_it_should(self) -> None:
        self.assertEqual(
            after("cmp"),
            ["if (count <= g(text)) {", "if (count >= g(text)) {", "return other != '9' && ok ? 2.0 : text;"],
        )
        self.assertEqual(after("logic"), ["return other == '9' || ok ? 2.0 : text;"])
        self.assertEqual(
            after("arith"),
            ["other.take(count - 1);", "total -= 0.5 * count;  // 7 < 8", "total += 0.5 / count;  // 7 < 8"],
        )
        self.assertEqual(after("off1"), ["other.take(count);"])
        self.assertEqual(after("int"), ["const int count = 6;", "other.take(count + 2);"])
        self.assertEqual(
            after("const"), ["total += 0.55 * count;  // 7 < 8", "return other == '9' && ok ? 2.2 : text;"]
        )
        self.assertEqual(after("neg"), ["if (!(count < g(text))) {"])
        self.assertEqual(after("ret"), ["return false;"])
        self.assertEqual(after("choice"), ["return other == '9' && ok ? text : 2.0;"])
        self.assertEqual(after("del"), [";", ";  // 7 < 8"])

    def test_other_numbers(self) -> None:
        self.assertEqual(after("int", "x = 0x1.8p-3;"), ["x = 0x1.8p-4;"])
        self.assertEqual(after("int", "x = 0x10U;"), ["x = 0x11U;"])
        self.assertEqual(after("int", "x = 1'000;"), ["x = 1001;"])
        self.assertEqual(after("const", "x = 0.0;"), ["x = 0.1;"])

    def test_declarations_and_ends_are_no_statements(self) -> None:
        for line in ("const int a = b;", "return f(a);", "break;", "double x(1);", "auto& y = z;"):
            self.assertEqual(after("del", "{\n" + line), [], line)
        for line in ("x = y;", "f(a);", "a.b(c);", "a->b = c;", "++i;", "(void)f(a);", "x[2] += 1;"):
            self.assertEqual(after("del", "{\n" + line), [";"], line)
        self.assertEqual(after("del", "a +\nf(b);"), [], "the end of a longer one")

    def test_a_change_is_made_where_it_was_found_only(self) -> None:
        change = next(c for c in changes_of(FUNCTION) if c.kind == "neg")
        changed = apply(FUNCTION, change).split("\n")
        for number, (line, original) in enumerate(zip(changed, FUNCTION.split("\n")), 1):
            self.assertEqual(line == original, number != change.line)
        with self.assertRaises(ValueError):
            apply(FUNCTION, Change("neg", 1, 0, "if", "!if"))


class Trees(unittest.TestCase):
    def test_a_file_is_the_one_of_before_in_any_case(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "a.cpp"
            file.write_bytes(b"one\r\ntwo")
            with self.assertRaises(KeyError), Changed(file, "three"):
                self.assertEqual(file.read_text(), "three")
                raise KeyError
            self.assertEqual(file.read_bytes(), b"one\r\ntwo")

    def test_the_copy_is_what_the_tree_is(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            tree, copy = Path(folder) / "tree", Path(folder) / "copy"
            (tree / "sub").mkdir(parents=True)
            subprocess.run(["git", "init", "-q", str(tree)], check=True)
            (tree / "sub" / "a.cpp").write_text("a")
            (tree / "b.cpp").write_text("b")
            self.assertEqual(copy_tree(tree, copy), 2)
            self.assertEqual(copy_tree(tree, copy), 0)
            (copy / "b.cpp").write_text("left by a program that was killed")
            (tree / "sub" / "a.cpp").unlink()
            self.assertEqual(copy_tree(tree, copy), 2)
            self.assertEqual([str(f.relative_to(copy)) for f in copy.rglob("*.cpp")], ["b.cpp"])
            self.assertEqual((copy / "b.cpp").read_text(), "b")
            self.assertEqual((tree / "b.cpp").read_text(), "b")

    def test_what_hangs_is_ended(self) -> None:
        self.assertIsNone(run([sys.executable, "-c", "while True: pass"], 0.2, ROOT))
        self.assertEqual(run([sys.executable, "-c", "raise SystemExit(3)"], 60.0, ROOT), 3)


class Lists(unittest.TestCase):
    def test_a_seed_gives_one_order(self) -> None:
        first = [mutant.title for mutant in drawn(["hal"], [], 5)]
        self.assertEqual(first, [mutant.title for mutant in drawn(["hal"], [], 5)])
        other = [mutant.title for mutant in drawn(["hal"], [], 6)]
        self.assertNotEqual(first, other)
        self.assertEqual(sorted(first), sorted(other))

    def test_a_report_can_be_gone_through_again(self) -> None:
        mutant = drawn(["hal"], [], 5)[0]
        with tempfile.TemporaryDirectory() as folder:
            report = Path(folder) / "report"
            moved = mutant.title.replace(f":{mutant.line} ", f":{mutant.line + 3} ")
            report.write_text(f"survived {moved}\nkilled {mutant.title}\nsurvived hal/src/a.cpp:1 cmp | no such => line\n")
            found = list(listed(report))
        self.assertEqual(len(found), 2)
        self.assertEqual(found[0].before, mutant.before)
        self.assertIn(mutant.after, found[0].text)
        self.assertEqual(found[1], "gone: survived hal/src/a.cpp:1 cmp | no such => line")

    def test_equivalents_are_of_lines_that_there_are(self) -> None:
        for path, before, changed in equivalents(EQUIVALENTS):
            lines = [line.strip() for line in (ROOT / path).read_text().split("\n")]
            self.assertIn(before, lines, path)
            self.assertNotEqual(before, changed)


if __name__ == "__main__":
    unittest.main()
