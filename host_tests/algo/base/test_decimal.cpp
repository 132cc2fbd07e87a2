// decimal.hpp against the C library of the host, byte for byte and bit for bit.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>

#include "emax/base/decimal.hpp"

namespace emax {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kMax = std::numeric_limits<double>::max();
constexpr double kLeast = std::numeric_limits<double>::denorm_min();

std::uint64_t bits_of(double x) { return __builtin_bit_cast(std::uint64_t, x); }

Span<const char> span_of(const std::string& text) { return {text.data(), text.size()}; }

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t word() { return engine_(); }
  int below(int limit) { return static_cast<int>(engine_() % static_cast<unsigned>(limit)); }
  double finite_pattern() {
    for (;;) {
      const auto x = __builtin_bit_cast(double, engine_());
      if (std::isfinite(x)) {
        return x;
      }
    }
  }
  /// What reports are made of: few digits, or any number of ordinary size.
  double ordinary() {
    const double whole = static_cast<double>(static_cast<std::int64_t>(engine_()) >> below(63));
    return whole / std::pow(10.0, below(19));
  }

 private:
  std::mt19937_64 engine_;
};

enum class Form { kGeneral, kScientific, kFixed };

std::size_t format(Form form, double value, int digits, Span<char> text) {
  switch (form) {
    case Form::kGeneral:
      return format_general(value, digits, text);
    case Form::kScientific:
      return format_scientific(value, digits, text);
    case Form::kFixed:
      return format_fixed(value, digits, text);
  }
  return 0;
}

std::size_t print(Form form, double value, int digits, char* text, std::size_t size) {
  int length = 0;
  switch (form) {
    case Form::kGeneral:
      length = std::snprintf(text, size, "%.*g", digits, value);
      break;
    case Form::kScientific:
      length = std::snprintf(text, size, "%.*e", digits, value);
      break;
    case Form::kFixed:
      length = std::snprintf(text, size, "%.*f", digits, value);
      break;
  }
  return static_cast<std::size_t>(length);
}

constexpr std::size_t kLongest = 328;  // decimal.hpp: "-", 309 digits, ".", 17 decimals.

testing::AssertionResult formats_like_printf(Form form, double value, int digits) {
  char ours[kLongest];
  char theirs[kLongest + 1];
  const std::size_t length = format(form, value, digits, ours);
  const std::size_t expected = print(form, value, digits, theirs, sizeof theirs);
  if (length == expected && std::memcmp(ours, theirs, length) == 0) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "digits " << digits << ": \"" << std::string(ours, length)
                                     << "\" is not \"" << theirs << '"';
}

testing::AssertionResult formats_like_printf_in_all_forms(double value, int digits) {
  for (const Form form : {Form::kGeneral, Form::kScientific, Form::kFixed}) {
    const int permitted = form == Form::kGeneral && digits == 0 ? 1 : digits;
    if (const auto result = formats_like_printf(form, value, permitted); !result) {
      return result;
    }
  }
  return testing::AssertionSuccess();
}

/// strtod's value and length; where strtod finds nothing, kSyntax; where it overflows,
/// kInvalidArgument.
testing::AssertionResult parses_like_strtod(const std::string& text) {
  char* end = nullptr;
  const double expected = std::strtod(text.c_str(), &end);
  const auto length = static_cast<std::size_t>(end - text.c_str());
  const Status status = length == 0            ? Status::kSyntax
                        : std::isinf(expected) ? Status::kInvalidArgument
                                               : Status::kOk;
  const ParsedNumber parsed = parse_decimal(span_of(text));
  if (parsed.status == status && parsed.length == length &&
      bits_of(parsed.value) == bits_of(expected)) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure()
         << '"' << text.substr(0, 60) << "\": status " << static_cast<int>(parsed.status)
         << ", length " << parsed.length << ", value " << std::hexfloat << parsed.value
         << ", expected " << static_cast<int>(status) << ", " << length << ", " << expected;
}

TEST(DecimalFormat, RandomPatternsLikePrintf) {
  Random random(1);
  for (int i = 0; i < 300000; ++i) {
    const double value = random.finite_pattern();
    const auto form = static_cast<Form>(i % 3);
    const int digits = form == Form::kGeneral ? 1 + random.below(17) : random.below(18);
    ASSERT_TRUE(formats_like_printf(form, value, digits));
  }
}

TEST(DecimalFormat, OrdinaryNumbersLikePrintf) {
  Random random(2);
  for (int i = 0; i < 700000; ++i) {
    const double value = random.ordinary();
    const auto form = static_cast<Form>(i % 3);
    const int digits = form == Form::kGeneral ? 1 + random.below(17) : random.below(18);
    ASSERT_TRUE(formats_like_printf(form, value, digits));
  }
}

TEST(DecimalFormat, PowersOfTwoAndTenAndTheirNeighbours) {
  for (int exponent = -1074; exponent <= 1023; ++exponent) {
    const double power = std::ldexp(1.0, exponent);
    for (const double value : {std::nextafter(power, 0.0), power, -std::nextafter(power, kInf)}) {
      for (const int digits : {0, 1, 6, 15, 16, 17}) {
        ASSERT_TRUE(formats_like_printf_in_all_forms(value, digits));
      }
    }
  }
  for (int exponent = -323; exponent <= 308; ++exponent) {
    const double power = std::strtod(("1e" + std::to_string(exponent)).c_str(), nullptr);
    for (const double value : {std::nextafter(power, 0.0), power, std::nextafter(power, kInf)}) {
      for (int digits = 0; digits <= 17; ++digits) {
        ASSERT_TRUE(formats_like_printf_in_all_forms(value, digits));
      }
    }
  }
}

TEST(DecimalFormat, TiesGoToEven) {
  // Multiples of 2^-k end in a 5: exactly halfway at k - 1 decimals.
  for (int k = 1; k <= 17; ++k) {
    for (int i = 1; i < 400; ++i) {
      const double value = std::ldexp(static_cast<double>(i), -k);
      for (int digits = 0; digits <= 17; ++digits) {
        ASSERT_TRUE(formats_like_printf_in_all_forms(value, digits));
      }
    }
  }
  char text[kLongest];
  EXPECT_EQ(std::string(text, format_fixed(0.5, 0, text)), "0");
  EXPECT_EQ(std::string(text, format_fixed(1.5, 0, text)), "2");
  EXPECT_EQ(std::string(text, format_fixed(2.5, 0, text)), "2");
  EXPECT_EQ(std::string(text, format_fixed(0.125, 2, text)), "0.12");
  EXPECT_EQ(std::string(text, format_scientific(25.0, 0, text)), "2e+01");
  EXPECT_EQ(std::string(text, format_general(35.0, 1, text)), "4e+01");
  // Large whole numbers end in a 5 as well: the digits dropped are whole.
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const double value = static_cast<double>(5 * (random.word() >> (12 + random.below(50))));
    ASSERT_TRUE(formats_like_printf_in_all_forms(value, random.below(18)));
  }
}

TEST(DecimalFormat, EdgesOfTheRange) {
  for (const double value : {0.0,
                             -0.0,
                             kLeast,
                             -kLeast,
                             0x0.fffffffffffffp-1022,
                             0x1p-1022,
                             kMax,
                             -kMax,
                             9007199254740993.0,
                             9007199254740992.0,
                             1e22,
                             1e23,
                             9.995,
                             9.5,
                             99.5,
                             0.95,
                             999999.5,
                             9999995.0,
                             0.0001,
                             0.00001,
                             0.000099999999999,
                             123456789012345678.0,
                             kInf,
                             -kInf}) {
    for (int digits = 0; digits <= 17; ++digits) {
      ASSERT_TRUE(formats_like_printf_in_all_forms(value, digits)) << value;
    }
  }
}

TEST(DecimalFormat, NanHasNoSign) {
  char text[8];
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::quiet_NaN()}) {
    for (const Form form : {Form::kGeneral, Form::kScientific, Form::kFixed}) {
      EXPECT_EQ(std::string(text, format(form, value, 3, text)), "nan");
    }
  }
}

TEST(DecimalFormat, ShortTextStaysUntouched) {
  for (const double value : {0.0, -1.0 / 3.0, 12345.678, -1e-300, kMax, -kMax, kInf, -kInf}) {
    for (const Form form : {Form::kGeneral, Form::kScientific, Form::kFixed}) {
      for (const int digits : {1, 9, 17}) {
        char theirs[kLongest + 1];
        const std::size_t length = print(form, value, digits, theirs, sizeof theirs);
        std::string text(length + 1, '#');
        EXPECT_EQ(format(form, value, digits, Span<char>(text.data(), length - 1)), 0U);
        EXPECT_EQ(text, std::string(length + 1, '#'));
        EXPECT_EQ(format(form, value, digits, Span<char>(text.data(), length)), length);
        EXPECT_EQ(text, std::string(theirs, length) + '#');
      }
    }
  }
  EXPECT_EQ(format_general(1.0, 6, {}), 0U);
}

TEST(DecimalFormat, RefusesDigitsOutsideTheRange) {
  std::string text(400, '#');
  const Span<char> span(text.data(), text.size());
  for (const int digits :
       {-1, 18, 1000, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    for (const Form form : {Form::kGeneral, Form::kScientific, Form::kFixed}) {
      EXPECT_EQ(format(form, 1.5, digits, span), 0U);
    }
  }
  EXPECT_EQ(format_general(1.5, 0, span), 0U);
  EXPECT_EQ(text, std::string(400, '#'));
}

TEST(DecimalFormat, StatedSizesAreEnough) {
  char text[kLongest];
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const double value =
        i % 2 == 0 ? -kMax / std::ldexp(1.0, random.below(60)) : -random.finite_pattern();
    const int digits = random.below(18);
    EXPECT_NE(format_general(value, digits == 0 ? 17 : digits, Span<char>(text, 24)), 0U);
    EXPECT_NE(
        format_scientific(value, digits, Span<char>(text, static_cast<std::size_t>(digits) + 8)),
        0U);
    EXPECT_NE(format_fixed(value, digits, Span<char>(text, kLongest)), 0U);
  }
}

TEST(DecimalParse, RoundTripWith17Digits) {
  Random random(5);
  for (int i = 0; i < 400000; ++i) {
    const double value = i % 2 == 0 ? random.finite_pattern() : random.ordinary();
    char text[24];
    const std::size_t length = format_general(value, 17, text);
    const ParsedNumber parsed = parse_decimal({text, length});
    ASSERT_EQ(parsed.status, Status::kOk);
    ASSERT_EQ(parsed.length, length);
    ASSERT_EQ(bits_of(parsed.value), bits_of(value)) << std::string(text, length);
  }
}

TEST(DecimalParse, RandomDigitsLikeStrtod) {
  Random random(6);
  for (int i = 0; i < 500000; ++i) {
    std::string text = random.below(4) == 0 ? "-" : "";
    const int digits = 1 + random.below(i % 8 == 0 ? 60 : 20);
    const int point = random.below(digits + 1);
    for (int k = 0; k < digits; ++k) {
      if (k == point) {
        text += '.';
      }
      text += static_cast<char>('0' + random.below(10));
    }
    if (random.below(3) != 0) {
      text += 'e' + std::to_string(random.below(i % 2 == 0 ? 60 : 700) - (i % 2 == 0 ? 30 : 360));
    }
    ASSERT_TRUE(parses_like_strtod(text));
  }
}

TEST(DecimalParse, AnyTextLikeStrtod) {
  // Neither "x" nor "inf" can come out of this alphabet, so strtod reads decimal numbers only.
  constexpr char kAlphabet[] = "0123456789..eE+-0159";
  Random random(7);
  for (int i = 0; i < 300000; ++i) {
    std::string text;
    for (int k = random.below(12); k >= 0; --k) {
      text += kAlphabet[random.below(sizeof kAlphabet - 1)];
    }
    ASSERT_TRUE(parses_like_strtod(text));
  }
}

/// The exact decimal text of a number of at most 64 bits: 1100 digits hold all of every midpoint.
std::string exact_text(long double value) {
  char text[1200];
  const int length = std::snprintf(text, sizeof text, "%.1100Le", value);
  return {text, static_cast<std::size_t>(length)};
}

TEST(DecimalParse, ExactMiddlesBetweenNeighbours) {
  ASSERT_GE(std::numeric_limits<long double>::digits, 54)
      << "middles need one bit more than double";
  Random random(8);
  for (int i = 0; i < 30000; ++i) {
    double low = std::fabs(random.finite_pattern());
    if (i % 4 == 0) {
      low = __builtin_bit_cast(double, random.word() >> (12 + random.below(52)));  // Subnormal.
    } else if (i % 4 == 1) {
      low = std::fabs(random.ordinary());
    }
    const double high = std::nextafter(low, kInf);
    if (std::isinf(high)) {
      continue;
    }
    const long double middle = (static_cast<long double>(low) + static_cast<long double>(high)) / 2;
    const double even = (bits_of(low) & 1) == 0 ? low : high;
    const std::string text = exact_text(middle);
    ASSERT_EQ(bits_of(parse_decimal(span_of(text)).value), bits_of(even)) << text;

    // The same with a digit behind all the zeros: above. One less, with nines behind: below.
    const std::size_t e = text.find('e');
    const std::string above = text.substr(0, e) + "1" + text.substr(e);
    ASSERT_EQ(bits_of(parse_decimal(span_of(above)).value), bits_of(high)) << text;
    std::string below = text;
    const std::size_t last = below.find_last_not_of('0', e - 1);
    --below[last];
    below.replace(last + 1, e - last - 1, e - last - 1, '9');
    ASSERT_EQ(bits_of(parse_decimal(span_of(below)).value), bits_of(low)) << text;
  }
}

TEST(DecimalParse, EdgesOfTheRange) {
  for (const char* const text : {"5e-324",
                                 "4.9e-324",
                                 "2.5e-324",
                                 "2.4703282292062327e-324",
                                 "2.4703282292062328e-324",
                                 "1e-324",
                                 "1e-400",
                                 "-1e-400",
                                 "1.7976931348623157e308",
                                 "1.7976931348623158e308",
                                 "1.7976931348623159e308",
                                 "179769313486231580793e289",
                                 "-1.8e308",
                                 "1e309",
                                 "1e310",
                                 "1e311",
                                 "-1e400",
                                 "9007199254740993",
                                 "9007199254740992",
                                 "9007199254740993.00000000000000000000000000000001",
                                 "2.2250738585072011e-308",
                                 "2.2250738585072012e-308",
                                 "2.2250738585072014e-308",
                                 "0.1",
                                 "1e22",
                                 "1e23",
                                 "1e-22",
                                 "1e-23",
                                 "9007199254740991e22",
                                 "9007199254740993e22",
                                 "123456789012345678901234567890",
                                 "0",
                                 "-0",
                                 "+0",
                                 "-.0",
                                 "0e999999999999999999999",
                                 "1e99999999999999999999999",
                                 "1e-99999999999999999999999",
                                 "5.",
                                 ".5",
                                 "5.e1",
                                 "1e",
                                 "1e+",
                                 "1e-",
                                 "1e+x",
                                 "1.e",
                                 "1E5",
                                 "1e05",
                                 "1e+05",
                                 "00012.50",
                                 "1.2.3",
                                 "1-2",
                                 ".",
                                 "-",
                                 "+",
                                 "",
                                 "-.",
                                 ".e5",
                                 "e5",
                                 "+-1",
                                 "--1",
                                 "1 2",
                                 "12abc",
                                 "1,5"}) {
    EXPECT_TRUE(parses_like_strtod(text));
  }
}

TEST(DecimalParse, RefusesWhatIsNotADecimalNumber) {
  for (const char* const text :
       {"inf", "-inf", "INFINITY", "nan", "NaN", " 1", "\t1", "\n", "x", "abc"}) {
    const ParsedNumber parsed = parse_decimal(span_of(text));
    EXPECT_EQ(parsed.status, Status::kSyntax) << text;
    EXPECT_EQ(parsed.length, 0U) << text;
    EXPECT_EQ(bits_of(parsed.value), bits_of(0.0)) << text;
  }
  EXPECT_EQ(parse_decimal({}).status, Status::kSyntax);
  const ParsedNumber hexadecimal = parse_decimal(span_of("0x10"));
  EXPECT_EQ(hexadecimal.status, Status::kOk);
  EXPECT_EQ(hexadecimal.length, 1U);
}

TEST(DecimalParse, OverflowIsAnInfinityAndAnError) {
  const ParsedNumber parsed = parse_decimal(span_of("-1e400;"));
  EXPECT_EQ(parsed.status, Status::kInvalidArgument);
  EXPECT_EQ(parsed.value, -kInf);
  EXPECT_EQ(parsed.length, 6U);
}

TEST(DecimalParse, ReadsNoFurtherThanTheSpan) {
  const std::string text = "12345e67";
  for (std::size_t length = 1; length <= text.size(); ++length) {
    const std::string part = text.substr(0, length);
    EXPECT_TRUE(parses_like_strtod(part));
    const ParsedNumber parsed = parse_decimal(Span<const char>(text.data(), length));
    EXPECT_EQ(parsed.value, std::strtod(part.c_str(), nullptr));
  }
}

TEST(DecimalParse, ThousandsOfDigits) {
  const std::string zeros(20000, '0');
  const std::string nines(20000, '9');
  for (const std::string& text :
       {"0." + zeros + "1e20001", "1" + zeros + "e-20000", zeros + "12.5", "12.5" + zeros,
        "0." + nines, nines + "e-20000", nines, "0." + zeros + "1", "9007199254740993." + zeros,
        "9007199254740993." + zeros + "1", "9007199254740992." + nines,
        "0." + zeros + nines + "e20100", "." + zeros, zeros, zeros + "." + zeros + "e"}) {
    EXPECT_TRUE(parses_like_strtod(text));
  }
  Random random(9);
  for (int i = 0; i < 300; ++i) {
    std::string text;
    for (int k = 700 + random.below(200); k > 0; --k) {
      text += static_cast<char>('0' + random.below(10));
    }
    text += 'e' + std::to_string(-random.below(1300));
    ASSERT_TRUE(parses_like_strtod(text));
  }
}

}  // namespace
}  // namespace emax
