// UTF-8 against the table of RFC 3629, and what may stand in a line.
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "emax/app/base/utf8.hpp"

namespace emax::app {
namespace {

std::vector<std::uint32_t> codes_of(const char* text) {
  std::vector<std::uint32_t> codes;
  for (Character next = first_character(text); next.length > 0; next = first_character(text)) {
    codes.push_back(next.code);
    text += next.length;
  }
  return codes;
}

using Codes = std::vector<std::uint32_t>;

TEST(Utf8, ExamplesOfTheRfc) {
  // RFC 3629, section 7.
  EXPECT_EQ(codes_of("A\xE2\x89\xA2\xCE\x91."), (Codes{0x41, 0x2262, 0x391, 0x2E}));
  EXPECT_EQ(codes_of("\xED\x95\x9C\xEA\xB5\xAD\xEC\x96\xB4"), (Codes{0xD55C, 0xAD6D, 0xC5B4}));
  EXPECT_EQ(codes_of("\xEF\xBB\xBF\xF0\xA3\x8E\xB4"), (Codes{0xFEFF, 0x233B4}));
  EXPECT_TRUE(codes_of("").empty());
}

TEST(Utf8, FirstAndLastOfEachLength) {
  EXPECT_EQ(codes_of("\x01\x7F"), (Codes{0x01, 0x7F}));
  EXPECT_EQ(codes_of("\xC2\x80\xDF\xBF"), (Codes{0x80, 0x7FF}));
  EXPECT_EQ(codes_of("\xE0\xA0\x80\xED\x9F\xBF\xEE\x80\x80\xEF\xBF\xBF"),
            (Codes{0x800, 0xD7FF, 0xE000, 0xFFFF}));
  EXPECT_EQ(codes_of("\xF0\x90\x80\x80\xF4\x8F\xBF\xBF"), (Codes{0x10000, 0x10FFFF}));
}

TEST(Utf8, EveryByteThatIsNotValidCountsForItself) {
  const Codes one = {kReplacement};
  const Codes two = {kReplacement, kReplacement};
  const Codes three = {kReplacement, kReplacement, kReplacement};
  EXPECT_EQ(codes_of("\x80"), one);                    // A continuation alone.
  EXPECT_EQ(codes_of("\xFF\xFE"), two);                // Never in UTF-8.
  EXPECT_EQ(codes_of("\xC0\x80"), two);                // Zero in two bytes.
  EXPECT_EQ(codes_of("\xC1\xBF"), two);                // 0x7F in two bytes.
  EXPECT_EQ(codes_of("\xE0\x9F\xBF"), three);          // 0x7FF in three bytes.
  EXPECT_EQ(codes_of("\xED\xA0\x80"), three);          // A surrogate.
  EXPECT_EQ(codes_of("\xF4\x90\x80\x80").size(), 4U);  // 0x110000.
  EXPECT_EQ(codes_of("\xE2\x89"), two);                // Cut off at the end of the text.
  EXPECT_EQ(codes_of("\xE2\x89x"), (Codes{kReplacement, kReplacement, 'x'}));
}

TEST(Utf8, Printable) {
  for (const std::uint32_t code : {0x20U, 0x7EU, 0xA0U, 0xE9U, 0x2027U, 0x202FU, 0x1F600U}) {
    EXPECT_TRUE(is_printable(code)) << code;
  }
  // Control characters, separators of lines and paragraphs, and what turns the writing around.
  for (const std::uint32_t code : {0x00U, 0x1FU, 0x7FU, 0x80U, 0x9FU, 0x2028U, 0x2029U, 0x202AU,
                                   0x202EU, 0x2066U, 0x2069U, 0xFEFFU}) {
    EXPECT_FALSE(is_printable(code)) << code;
  }
}

}  // namespace
}  // namespace emax::app
