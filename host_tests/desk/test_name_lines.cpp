// Names of devices in lines of a limited width.
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "desk/cli/console.hpp"
#include "desk/compare/name_lines.hpp"

namespace emax::desk {
namespace {

using Lines = std::vector<std::string>;

Result device(const std::string& name, const std::string& serial = "") {
  Result result;
  result.device = name;
  result.serial = serial;
  return result;
}

TEST(Wrapped, BreaksAtBlanksAndElseWhereTheLineEnds) {
  EXPECT_EQ(wrapped("", 8, 3), Lines{""});
  EXPECT_EQ(wrapped("ab cd", 8, 3), Lines{"ab cd"});
  EXPECT_EQ(wrapped("abcd efgh", 8, 3), (Lines{"abcd", "efgh"}));
  EXPECT_EQ(wrapped("abcdefgh ij", 8, 3), (Lines{"abcdefgh", "ij"}));
  EXPECT_EQ(wrapped("abcdefghij", 8, 3), (Lines{"abcdefgh", "ij"}));
  // A blank near the start would leave a line nearly empty.
  EXPECT_EQ(wrapped("a bcdefghij", 8, 3), (Lines{"a bcdefg", "hij"}));
  EXPECT_EQ(wrapped("abcd    efgh  ", 6, 3), (Lines{"abcd  ", "efgh  "}));
}

TEST(Wrapped, CutsTheEndAndNothingElse) {
  EXPECT_EQ(wrapped("abcd efgh ijkl", 4, 3), (Lines{"abcd", "efgh", "ijkl"}));
  EXPECT_EQ(wrapped("abcd efgh ijklm", 4, 3), (Lines{"abcd", "efgh", "i..."}));
  EXPECT_EQ(wrapped("abcdefgh", 4, 1), (Lines{"a..."}));
}

TEST(Wrapped, TearsNoCharacter) {
  const std::string name = "\u00FC\u20AC\U0001F600\u00FC\u20AC\U0001F600";
  EXPECT_EQ(wrapped(name, 4, 2), (Lines{"\u00FC\u20AC\U0001F600\u00FC", "\u20AC\U0001F600"}));
  EXPECT_EQ(wrapped(name, 4, 1), Lines{"\u00FC..."});
  // In a picture such characters are broad.
  EXPECT_EQ(width_of("a\u6F22", Typeface::kMonospaced), 2.0);
  EXPECT_EQ(width_of("a\u6F22", Typeface::kProportional), 3.0);
}

TEST(NameLines, KeepTheSerialNumberOfALongName) {
  EXPECT_EQ(name_lines(device("piezo", "17"), 10, 2), Lines{"piezo 17"});
  EXPECT_EQ(name_lines(device("a long name", "17"), 10, 2), (Lines{"a long", "name 17"}));
  EXPECT_EQ(name_lines(device("a very long name of a device", "17"), 10, 2),
            (Lines{"a very ...", "17"}));
  EXPECT_EQ(name_lines(device("a very long name of a device"), 10, 2),
            (Lines{"a very", "long na..."}));
  EXPECT_EQ(name_lines(device("name\n", "1\x1b"), 10, 2), Lines{"name? 1?"});
}

TEST(ShortName, FitsAndCutsOnlyEnds) {
  EXPECT_EQ(short_name_of(device("accelerometer", "4711"), 18), "accelerometer 4711");
  EXPECT_EQ(short_name_of(device("accelerometer", "4711"), 17), "accelerom... 4711");
  EXPECT_EQ(short_name_of(device("accelerometer"), 12), "accelerom...");
  for (const std::size_t most : {12U, 13U, 40U}) {
    const std::string name =
        short_name_of(device(std::string(300, 'x'), std::string(300, '9')), most);
    EXPECT_LE(characters_in(name), most);
    EXPECT_NE(name.find("x... 9"), std::string::npos) << name;
  }
}

TEST(List, NamesFiveAndCountsTheRest) {
  const Result a = device("a");
  EXPECT_EQ(list_of({&a}), "a");
  EXPECT_EQ(list_of({&a, &a}), "a and a");
  EXPECT_EQ(list_of({&a, &a, &a, &a, &a, &a}), "a, a, a, a, a and a");
  EXPECT_EQ(list_of({&a, &a, &a, &a, &a, &a, &a}), "a, a, a, a, a and 2 others");
}

}  // namespace
}  // namespace emax::desk
