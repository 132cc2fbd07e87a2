"""Shows what the command counts: a small program whose branches are known, and what an entry of the list permits.

usage: test_counts.py CXX GCOV
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from counts import Source, add_report, counts_of_tree, of_choices
from coverage import UNCOVERED, Entry, judge, read_entries, table_of

CXX, GCOV = sys.argv[1], sys.argv[2]
ROOT = Path(__file__).resolve().parents[2]

HEADER = """\
template <typename T>
inline T larger(T a, T b) {
  return a < b ? b : a;
}
"""
FIRST = """\
#include <string>
#include "larger.hpp"
int second(int);
std::string text(int number) {
  if (number > 3 && number < 5) {
    return std::string("four");
  }
  switch (number) {
    case 1:
      return "one";
    case 2:
      return "two";
    default:
      return "many";
  }
}
int main() {
  return text(1).empty() || text(9).empty() || larger(1, 2) != 2 || second(0) != 7 ? 1 : 0;
}
"""
SECOND = """\
#include "larger.hpp"
int never(int a) {
  return a > 0 ? 1 : 2;
}
int second(int a) {
  return larger(7.0, 2.0 + a) > 6.5 ? larger(7, a) : 0;
}
"""


def branch(count: int, throw: bool = False, fallthrough: bool = False) -> dict:
    return {"count": count, "throw": throw, "fallthrough": fallthrough}


class KnownProgram(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        root = Path(folder.name).resolve()
        for name, content in (("larger.hpp", HEADER), ("first.cpp", FIRST), ("second.cpp", SECOND)):
            (root / name).write_text(content)
        for name in ("first", "second"):
            subprocess.run([CXX, "-std=c++17", "-O0", "--coverage", "-c", f"{name}.cpp"], cwd=root, check=True)
        subprocess.run([CXX, "--coverage", "first.o", "second.o", "-o", "program"], cwd=root, check=True)
        subprocess.run(["./program"], cwd=root, check=True)
        cls.sources = counts_of_tree(GCOV, root, root)

    def test_only_files_below_the_root_count(self) -> None:
        self.assertEqual(sorted(self.sources), ["first.cpp", "larger.hpp", "second.cpp"])

    def test_choices_count_and_calls_that_may_throw_do_not(self) -> None:
        first = self.sources["first.cpp"]
        counts: dict[int, list[int]] = {}
        for line, count in first.branches:
            counts.setdefault(line, []).append(count)
        # 1 and 9: 9 > 3, but not < 5; one each of `case 1` and the default, none of `case 2`.
        self.assertEqual({line: sorted(found) for line, found in counts.items() if line != 18},
                         {5: [0, 1, 1, 1], 8: [0, 1, 1]})
        self.assertEqual(first.branches_left()[5], 1)
        self.assertEqual([first.lines[line] for line in (5, 6, 10, 12, 14)], [2, 0, 1, 0, 1])

    def test_a_template_is_covered_by_all_its_uses_together(self) -> None:
        # int 1, 2 takes b; double 7, 2 takes a.
        header = self.sources["larger.hpp"]
        self.assertEqual(header.branches_run, 2)
        self.assertEqual(len(header.branches), 2)
        self.assertEqual(header.lines[3], 3)

    def test_what_is_never_called_is_there(self) -> None:
        second = self.sources["second.cpp"]
        self.assertEqual(second.lines[3], 0)
        self.assertEqual(second.branches_left(), {3: 2, 6: 1})
        self.assertEqual((len(second.lines), second.lines_run), (4, 2))


class Reports(unittest.TestCase):
    def test_pairs_of_a_call_go_whichever_comes_first(self) -> None:
        call = [branch(4, fallthrough=True), branch(0, throw=True)]
        choice = [branch(1, fallthrough=True), branch(3)]
        self.assertEqual(of_choices(call + choice), [1, 3])
        self.assertEqual(of_choices(choice + call), [1, 3])
        self.assertEqual(of_choices(choice + call[::-1]), [1, 3])
        self.assertEqual(of_choices(call), [])

    def test_the_same_function_in_two_objects_is_one(self) -> None:
        sources = {"a.hpp": Source()}
        for name, counts in (("f<int>", [0, 5]), ("f<double>", [2, 0])):
            add_report(sources, {
                "current_working_directory": "/tree/build",
                "files": [{
                    "file": "../a.hpp",
                    "functions": [{"name": name, "start_line": 3, "start_column": 5}],
                    "lines": [{"line_number": 4, "count": sum(counts), "function_name": name,
                               "branches": [branch(count) for count in counts]}],
                }],
            }, Path("/tree"))
        self.assertEqual([count for _, count in sources["a.hpp"].branches], [2, 5])
        self.assertEqual(sources["a.hpp"].lines, {4: 7})


class Listed(unittest.TestCase):
    def result(self, entries: list[Entry]):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "hal").mkdir()
            (Path(folder) / "hal" / "a.cpp").write_text("  if (a) {\n  }\n  if (a) {\n")
            source = Source()
            source.add(1, 1, None, [0, 1])
            source.add(3, 0, None, [0, 0])
            return judge({"hal/a.cpp": source, "other/b.cpp": Source()}, entries, Path(folder))

    def test_without_entries_all_are_left(self) -> None:
        result = self.result([])
        self.assertEqual(result.left, ["hal/a.cpp:1: 1 | if (a) {", "hal/a.cpp:3: 2 | if (a) {"])
        row = result.rows["hal"][0]
        self.assertEqual(row.cells, ["hal/a.cpp", "2", "1", "4", "1", "0", "3", "25.0 %"])

    def test_an_entry_permits_as_many_as_it_says(self) -> None:
        result = self.result([Entry("hal/a.cpp", 2, "if (a) {", "why")])
        self.assertEqual((result.left, result.stale), (["hal/a.cpp:3: 1 | if (a) {"], []))
        self.assertEqual(result.rows["hal"][0].listed, 2)

    def test_entries_that_do_not_fit_are_told(self) -> None:
        result = self.result([Entry("hal/a.cpp", 4, "if (a) {", "why"), Entry("hal/a.cpp", 1, "if (b) {", "why"),
                              Entry("hal/gone.cpp", 1, "if (a) {", "why")])
        self.assertEqual(result.left, [])
        self.assertEqual(result.stale, ["hal/a.cpp | if (a) {: 1 more than never ran",
                                        "hal/a.cpp | if (b) {: 1 more than never ran", "hal/gone.cpp: no such file has run"])

    def test_the_table_begins_with_the_areas(self) -> None:
        lines = table_of(self.result([])).splitlines()
        self.assertEqual(lines[2], "| **hal** | 2 | 1 | 4 | 1 | 0 | 3 | 25.0 % |")
        self.assertEqual(lines[6], "| `hal/a.cpp` | 2 | 1 | 4 | 1 | 0 | 3 | 25.0 % |")

    def test_entries_are_read_and_the_lines_are_there(self) -> None:
        self.assertEqual(read_entries("# no\n\na.cpp | 2 | x | y || z | why not\n"), [Entry("a.cpp", 2, "x | y || z", "why not")])
        with self.assertRaises(SystemExit):
            read_entries("a.cpp | x | why\n")
        for entry in read_entries(UNCOVERED.read_text()):
            self.assertIn(entry.text, [line.strip() for line in (ROOT / entry.path).read_text().split("\n")], entry.path)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
