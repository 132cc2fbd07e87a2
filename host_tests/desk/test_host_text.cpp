// Names of others in lines and columns of the program's, and bounds in a few digits.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>
#include <string>

#include "desk/cli/console.hpp"
#include "desk/files/rounding.hpp"
#include "desk/report/failure_words.hpp"
#include "support/string_sink.hpp"

namespace emax::desk {
namespace {

using app::TextWriter;
using test::text_of;

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) {
    all += text;
  }
  return all;
}

TEST(InLine, JoinsSentencesBySemicolons) {
  EXPECT_EQ(in_line(""), "");
  EXPECT_EQ(in_line("The points leave beta open."), "the points leave beta open");
  EXPECT_EQ(in_line("Degrees were taken. As radians they fit, with beta = 0.5. A delay does not."),
            "degrees were taken; as radians they fit, with beta = 0.5; a delay does not");
  EXPECT_EQ(in_line("Nothing is known. S alone is. T = 2 ms is too long."),
            "nothing is known; S alone is; T = 2 ms is too long");
}

TEST(Printable, LeavesWhatStandsInALineAsItIs) {
  EXPECT_EQ(printable(""), "");
  EXPECT_EQ(printable("a b/'\"\\c"), "a b/'\"\\c");
  EXPECT_EQ(printable("Pr\u00FCfling \u03A9 \U0001F600"), "Pr\u00FCfling \u03A9 \U0001F600");
}

TEST(Printable, ReplacesWhatDoesNot) {
  EXPECT_EQ(printable("a\nb\tc\x1B[1m\x7F"), "a?b?c?[1m?");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
  // A second set of control characters, an end of line, and what turns the direction of writing.
  EXPECT_EQ(printable("a\u0085b\u2028c\u202Ed"), "a?b?c?d");
}

TEST(Printable, IsValidUtf8WhateverItIsGiven) {
  EXPECT_EQ(printable("a\xFF\xC3"), "a??");
  EXPECT_EQ(printable("\xC3(\xE2\x82"), "?(??");
}

TEST(Printable, CountsCharactersAndTearsNone) {
  for (const std::string character : {"x", "\u00FC", "\u20AC", "\U0001F600"}) {
    EXPECT_EQ(printable(repeated(character, 200)), repeated(character, 200));
    EXPECT_EQ(printable(repeated(character, 201)), repeated(character, 200) + "...");
  }
}

TEST(CharactersIn, CountsNoBytes) {
  EXPECT_EQ(characters_in(""), 0U);
  EXPECT_EQ(characters_in("abc"), 3U);
  EXPECT_EQ(characters_in("\u00FC\u20AC\U0001F600"), 3U);
}

TEST(RoundedUp, IsNeverBelowAndLessThanOneDigitAbove) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> exponent(-12.0, 12.0);
  for (int i = 0; i < 10'000; ++i) {
    const double value = std::pow(10.0, exponent(random));
    const int decimals = static_cast<int>(random() % 7);
    const double shown = rounded_up(value, decimals);
    const std::string text = text_of([&](TextWriter& out) { out.scientific(shown, decimals); });
    const double read = std::strtod(text.c_str(), nullptr);
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - decimals);
    EXPECT_GE(read, value) << text;
    EXPECT_LT(read, value + 1.001 * unit) << text;
  }
}

TEST(RoundedUp, LeavesWhatHasSoFewDigits) {
  EXPECT_EQ(rounded_up(0.0051184, 4), 0.0051184);
  EXPECT_EQ(text_of([](TextWriter& out) { out.scientific(rounded_up(5.83761994e-3, 4), 4); }),
            "5.8377e-03");
  EXPECT_EQ(text_of([](TextWriter& out) { out.scientific(rounded_up(9.99991e-3, 4), 4); }),
            "1.0000e-02");
}

}  // namespace
}  // namespace emax::desk
