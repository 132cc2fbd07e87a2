// Words, numbers and columns against the host's printf.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>

#include "support/string_sink.hpp"

namespace emax::app {
namespace {

using test::text_of;

std::string printed(char conversion, int digits, double value) {
  char text[512];
  if (conversion == 'f') {
    std::snprintf(text, sizeof text, "%.*f", digits, value);
  } else if (conversion == 'e') {
    std::snprintf(text, sizeof text, "%.*e", digits, value);
  } else {
    std::snprintf(text, sizeof text, "%.*g", digits, value);
  }
  return text;
}

double random_double(std::mt19937_64& random) {
  double value = 0.0;
  do {
    const std::uint64_t bits = random();
    std::memcpy(&value, &bits, sizeof value);
  } while (!std::isfinite(value));
  return value;
}

std::string one_line(const std::string& words, std::uint32_t most) {
  return text_of([&](TextWriter& out) { out.one_line(words.c_str(), most); });
}

TEST(TextWriter, WordsOfOthersInOneLine) {
  EXPECT_EQ(one_line("a \"b\" <c> & 'd'", 100), "a \"b\" <c> & 'd'");
  EXPECT_EQ(one_line("a\nb\r\nc\td", 100), "a b  c d");
  EXPECT_EQ(one_line("a\x01\x7F\xFF", 100), "a???");
  EXPECT_EQ(one_line("M\xC3\xBCller \xE2\x80\xAE", 100), "M\xC3\xBCller ?");
  EXPECT_EQ(one_line("", 3), "");
  EXPECT_EQ(one_line("abc", 3), "abc");
  EXPECT_EQ(one_line("abcd", 3), "abc ...");
  // Characters count, not bytes, and none is cut in two.
  EXPECT_EQ(one_line("\xC3\xBC\xC3\xBC\xC3\xBC\xC3\xBC", 3), "\xC3\xBC\xC3\xBC\xC3\xBC ...");
}

TEST(TextWriter, ColumnsCountCharacters) {
  EXPECT_EQ(text_of([](TextWriter& out) {
              out.left(6).text("M\xC3\xBCll").text("|").right(4).text("\xE2\x82\xAC").text("|");
              out.left(2).text("\xF0\x9F\x98\x80\xC3\xBC\xC3\xBC").text("|");
            }),
            "M\xC3\xBCll  |   \xE2\x82\xAC|\xF0\x9F\x98\x80\xC3\xBC\xC3\xBC|");
}

TEST(TextWriter, WordsAndLines) {
  EXPECT_EQ(text_of([](TextWriter& out) {
              const char part[] = {'c', 'd'};
              const char* nothing = nullptr;
              out.text("ab").text(Span<const char>(part)).text(nothing).text("").line();
            }),
            "abcd\n");
}

TEST(TextWriter, IntegersAsPrintf) {
  for (const std::uint64_t value :
       {std::uint64_t{0}, std::uint64_t{9}, std::uint64_t{10}, std::uint64_t{200000},
        std::numeric_limits<std::uint64_t>::max()}) {
    EXPECT_EQ(text_of([value](TextWriter& out) { out.integer(value); }), std::to_string(value));
  }
}

TEST(TextWriter, NumbersAsPrintf) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const double value = random_double(random);
    const int digits = static_cast<int>(random() % 17);
    EXPECT_EQ(text_of([&](TextWriter& out) { out.fixed(value, digits); }),
              printed('f', digits, value));
    EXPECT_EQ(text_of([&](TextWriter& out) { out.scientific(value, digits); }),
              printed('e', digits, value));
    EXPECT_EQ(text_of([&](TextWriter& out) { out.general(value, digits + 1); }),
              printed('g', digits + 1, value));
  }
  const double largest = std::numeric_limits<double>::max();
  EXPECT_EQ(text_of([&](TextWriter& out) { out.fixed(-largest, 17); }), printed('f', 17, -largest));
}

// The fewest digits, by trying all of them with the host's own conversions.
std::string shortest(double value) {
  for (int digits = 1; digits < 17; ++digits) {
    const std::string text = printed('g', digits, value);
    if (std::strtod(text.c_str(), nullptr) == value) {
      return text;
    }
  }
  return printed('g', 17, value);
}

std::size_t digits_in(const std::string& text) {
  std::size_t digits = 0;
  for (const char character : text.substr(0, text.find('e'))) {
    digits += character >= '0' && character <= '9' ? 1U : 0U;
  }
  return digits;
}

TEST(TextWriter, ExactReadsBackWithTheFewestDigits) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 2000; ++i) {
    const double value = random_double(random);
    const std::string text = text_of([&](TextWriter& out) { out.exact(value); });
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), value) << text;
    EXPECT_EQ(digits_in(text), digits_in(shortest(value))) << text;
  }
}

TEST(TextWriter, ExactNumbersOfEverydayLife) {
  const auto exact = [](double value) {
    return text_of([value](TextWriter& out) { out.exact(value); });
  };
  EXPECT_EQ(exact(0.1), "0.1");
  EXPECT_EQ(exact(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(exact(4073.0), "4073");
  EXPECT_EQ(exact(2e-6), "2e-06");
  EXPECT_EQ(exact(0.0), "0");
  EXPECT_EQ(exact(5e-324), "4.94065645841247e-324");
  EXPECT_EQ(exact(std::nan("")), "null");
  EXPECT_EQ(exact(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(exact(-std::numeric_limits<double>::infinity()), "null");
}

TEST(TextWriter, Columns) {
  EXPECT_EQ(text_of([](TextWriter& out) { out.left(6).text("ab").right(6).fixed(1.25, 1); }),
            "ab       1.2");
  EXPECT_EQ(text_of([](TextWriter& out) { out.right(2).text("long").text("|").left(0).text("x"); }),
            "long|x");
  EXPECT_EQ(text_of([](TextWriter& out) { out.right(4).integer(7).integer(7); }), "   77");
  EXPECT_EQ(text_of([](TextWriter& out) { out.spaces(70); }), std::string(70, ' '));
  EXPECT_EQ(text_of([](TextWriter& out) { out.left(50).text("").text("|"); }),
            std::string(50, ' ') + "|");
}

}  // namespace
}  // namespace emax::app
