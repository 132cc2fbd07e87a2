// Special values, symmetries and exact functions of elementary.hpp. Accuracy has a file of its own.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "emax/base/elementary.hpp"

namespace emax {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kMax = std::numeric_limits<double>::max();
constexpr double kLeast = std::numeric_limits<double>::denorm_min();
constexpr double kLeastNormal = std::numeric_limits<double>::min();

// pi/4, pi/2, 3pi/4 and pi, correctly rounded (from 50 decimal digits of pi).
constexpr double kQuarterPi = 0.78539816339744830961566084581987572;
constexpr double kHalfPi = 1.5707963267948966192313216916397514;
constexpr double kThreeQuarterPi = 2.3561944901923449288469825374596271;
constexpr double kPi = 3.1415926535897932384626433832795029;

std::uint64_t bits_of(double x) { return __builtin_bit_cast(std::uint64_t, x); }

/// The same number with the same sign of zero; all NaN are the same.
testing::AssertionResult same(double a, double b) {
  if (bits_of(a) == bits_of(b) || (std::isnan(a) && std::isnan(b))) {
    return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << std::hexfloat << a << " is not " << b;
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t word() { return engine_(); }
  double pattern() { return __builtin_bit_cast(double, engine_()); }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }

 private:
  std::mt19937_64 engine_;
};

TEST(ElementaryExp, SpecialValues) {
  EXPECT_TRUE(same(exp(0.0), 1.0));
  EXPECT_TRUE(same(exp(-0.0), 1.0));
  EXPECT_TRUE(same(exp(kInf), kInf));
  EXPECT_TRUE(same(exp(-kInf), 0.0));
  EXPECT_TRUE(std::isnan(exp(kNan)));
  EXPECT_TRUE(same(exp(kMax), kInf));
  EXPECT_TRUE(same(exp(-kMax), 0.0));
  EXPECT_TRUE(same(exp(kLeast), 1.0));
  EXPECT_TRUE(same(exp(-kLeast), 1.0));
}

TEST(ElementaryExp, OverflowsAndUnderflowsWhereTheResultDoes) {
  // ln(DBL_MAX) = 709.78271289338399678..., between these two neighbours.
  EXPECT_TRUE(is_finite(exp(0x1.62e42fefa39efp+9)));
  EXPECT_GT(exp(0x1.62e42fefa39efp+9), 0.999999999999 * kMax);
  EXPECT_TRUE(same(exp(0x1.62e42fefa39f0p+9), kInf));
  // ln(2^-1075) = -745.13321910194110842...: half of the least double is the last to round up.
  EXPECT_TRUE(same(exp(-745.133219101941), kLeast));
  EXPECT_TRUE(same(exp(-745.133219101942), 0.0));
  EXPECT_TRUE(same(exp(-1000.0), 0.0));
  EXPECT_TRUE(same(exp(1000.0), kInf));
}

TEST(ElementaryLog, SpecialValues) {
  EXPECT_TRUE(same(log(0.0), -kInf));
  EXPECT_TRUE(same(log(-0.0), -kInf));
  EXPECT_TRUE(same(log(1.0), 0.0));
  EXPECT_TRUE(same(log(kInf), kInf));
  EXPECT_TRUE(std::isnan(log(kNan)));
  EXPECT_TRUE(std::isnan(log(-1.0)));
  EXPECT_TRUE(std::isnan(log(-kLeast)));
  EXPECT_TRUE(std::isnan(log(-kInf)));
}

TEST(ElementarySine, SpecialValues) {
  EXPECT_TRUE(same(sin(0.0), 0.0));
  EXPECT_TRUE(same(sin(-0.0), -0.0));
  EXPECT_TRUE(same(cos(0.0), 1.0));
  EXPECT_TRUE(same(cos(-0.0), 1.0));
  for (const double x : {kInf, -kInf, kNan}) {
    EXPECT_TRUE(std::isnan(sin(x)));
    EXPECT_TRUE(std::isnan(cos(x)));
    EXPECT_TRUE(std::isnan(sincos(x).sin));
    EXPECT_TRUE(std::isnan(sincos(x).cos));
  }
  // x - x^3/6 rounds to x down there.
  for (const double x : {kLeast, kLeastNormal, 0x1.123456789abcdp-1022, 0x1p-28}) {
    EXPECT_TRUE(same(sin(x), x));
    EXPECT_TRUE(same(sin(-x), -x));
    EXPECT_TRUE(same(cos(x), 1.0));
  }
}

TEST(ElementarySine, ZerosOfSineShowTheErrorOfRoundedPi) {
  // sin(fl(pi)) = pi - fl(pi) up to its cube, 1e-48: the second part of pi in double.
  EXPECT_TRUE(same(sin(kPi), 0x1.1a62633145c07p-53));
  EXPECT_TRUE(same(cos(kHalfPi), 0x1.1a62633145c07p-54));
}

TEST(ElementarySine, OddAndEvenAndTheSameTogether) {
  Random random(2024);
  for (int i = 0; i < 300000; ++i) {
    double x = (i & 1) != 0 ? random.uniform(-1e3, 1e3) : random.pattern();
    if (!std::isfinite(x)) {
      x = static_cast<double>(i);
    }
    ASSERT_TRUE(same(sin(-x), -sin(x))) << std::hexfloat << x;
    ASSERT_TRUE(same(cos(-x), cos(x))) << std::hexfloat << x;
    const SinCos both = sincos(x);
    ASSERT_TRUE(same(both.sin, sin(x))) << std::hexfloat << x;
    ASSERT_TRUE(same(both.cos, cos(x))) << std::hexfloat << x;
    ASSERT_LE(abs(both.sin), 1.0);
    ASSERT_LE(abs(both.cos), 1.0);
  }
}

TEST(ElementaryAtan2, SpecialValues) {
  EXPECT_TRUE(same(atan2(0.0, 1.0), 0.0));
  EXPECT_TRUE(same(atan2(-0.0, 1.0), -0.0));
  EXPECT_TRUE(same(atan2(0.0, 0.0), 0.0));
  EXPECT_TRUE(same(atan2(-0.0, 0.0), -0.0));
  EXPECT_TRUE(same(atan2(0.0, -0.0), kPi));
  EXPECT_TRUE(same(atan2(-0.0, -0.0), -kPi));
  EXPECT_TRUE(same(atan2(0.0, -1.0), kPi));
  EXPECT_TRUE(same(atan2(-0.0, -1.0), -kPi));
  EXPECT_TRUE(same(atan2(1.0, 0.0), kHalfPi));
  EXPECT_TRUE(same(atan2(1.0, -0.0), kHalfPi));
  EXPECT_TRUE(same(atan2(-1.0, 0.0), -kHalfPi));
  EXPECT_TRUE(same(atan2(-1.0, -0.0), -kHalfPi));
  EXPECT_TRUE(same(atan2(1.0, -kInf), kPi));
  EXPECT_TRUE(same(atan2(-1.0, -kInf), -kPi));
  EXPECT_TRUE(same(atan2(1.0, kInf), 0.0));
  EXPECT_TRUE(same(atan2(-1.0, kInf), -0.0));
  EXPECT_TRUE(same(atan2(0.0, kInf), 0.0));
  EXPECT_TRUE(same(atan2(-0.0, -kInf), -kPi));
  EXPECT_TRUE(same(atan2(kInf, 3.0), kHalfPi));
  EXPECT_TRUE(same(atan2(-kInf, -3.0), -kHalfPi));
  EXPECT_TRUE(same(atan2(kInf, 0.0), kHalfPi));
  EXPECT_TRUE(same(atan2(kInf, kInf), kQuarterPi));
  EXPECT_TRUE(same(atan2(-kInf, kInf), -kQuarterPi));
  EXPECT_TRUE(same(atan2(kInf, -kInf), kThreeQuarterPi));
  EXPECT_TRUE(same(atan2(-kInf, -kInf), -kThreeQuarterPi));
  for (const double x : {0.0, 1.0, -1.0, kInf, -kInf, kNan}) {
    EXPECT_TRUE(std::isnan(atan2(kNan, x)));
    EXPECT_TRUE(std::isnan(atan2(x, kNan)));
  }
}

TEST(ElementaryAtan2, DiagonalsAtEveryScale) {
  for (int exponent = -1074; exponent <= 1023; ++exponent) {
    const double x = std::ldexp(1.0, exponent);
    ASSERT_TRUE(same(atan2(x, x), kQuarterPi)) << exponent;
    ASSERT_TRUE(same(atan2(x, -x), kThreeQuarterPi)) << exponent;
    ASSERT_TRUE(same(atan2(-x, x), -kQuarterPi)) << exponent;
    ASSERT_TRUE(same(atan2(-x, -x), -kThreeQuarterPi)) << exponent;
  }
}

TEST(ElementaryAtan2, ExtremeRatios) {
  EXPECT_TRUE(same(atan2(kLeast, kMax), 0.0));
  EXPECT_TRUE(same(atan2(-kLeast, kMax), -0.0));
  EXPECT_TRUE(same(atan2(kMax, kLeast), kHalfPi));
  EXPECT_TRUE(same(atan2(kLeast, -kMax), kPi));
  EXPECT_TRUE(same(atan2(kLeast, 1.0), kLeast));
  EXPECT_TRUE(same(atan2(0x1p-1000, 0x1p60), 0x1p-1060));
}

TEST(ElementaryAtan2, OddInItsFirstArgument) {
  Random random(7);
  for (int i = 0; i < 200000; ++i) {
    const double y = random.uniform(-2.0, 2.0);
    const double x = random.uniform(-2.0, 2.0);
    ASSERT_TRUE(same(atan2(-y, x), -atan2(y, x))) << std::hexfloat << y << ' ' << x;
  }
}

TEST(ElementarySqrt, SpecialValues) {
  for (double (*root)(double) : {&sqrt, &detail::software_sqrt}) {
    EXPECT_TRUE(same(root(0.0), 0.0));
    EXPECT_TRUE(same(root(-0.0), -0.0));
    EXPECT_TRUE(same(root(kInf), kInf));
    EXPECT_TRUE(std::isnan(root(kNan)));
    EXPECT_TRUE(std::isnan(root(-1.0)));
    EXPECT_TRUE(std::isnan(root(-kLeast)));
    EXPECT_TRUE(std::isnan(root(-kInf)));
    EXPECT_TRUE(same(root(kLeast), 0x1p-537));
    EXPECT_TRUE(same(root(4.0), 2.0));
  }
}

TEST(ElementarySqrt, SoftwareAgreesWithTheProcessor) {
  Random random(11);
  for (int i = 0; i < 1500000; ++i) {
    std::uint64_t bits = random.word() >> 1;
    if (i % 4 == 1) {
      bits >>= 12 + (i / 4) % 52;  // Subnormal, of every length.
    } else if (i % 4 == 2) {
      bits = bits_of(random.uniform(0.25, 4.0));
    }
    const double x = __builtin_bit_cast(double, bits);
    ASSERT_TRUE(same(detail::software_sqrt(x), std::sqrt(x))) << std::hexfloat << x;
    ASSERT_TRUE(same(sqrt(x), std::sqrt(x))) << std::hexfloat << x;
  }
}

TEST(ElementarySqrt, SquaresAndTheirNeighbours) {
  // Roots that end on or next to the middle between two doubles are the hard ones.
  Random random(12);
  for (int i = 0; i < 300000; ++i) {
    const std::uint64_t root_bits = bits_of(random.uniform(1.0, 2.0));
    const double root =
        __builtin_bit_cast(double, root_bits & ~((std::uint64_t{1} << (i % 28)) - 1));
    const double square = root * root;
    for (const double x : {std::nextafter(square, 0.0), square, std::nextafter(square, 8.0)}) {
      ASSERT_TRUE(same(detail::software_sqrt(x), std::sqrt(x))) << std::hexfloat << x;
    }
  }
}

TEST(ElementaryFloor, AgreesWithTheHostEverywhere) {
  for (const double x : {0.0, -0.0, kInf, -kInf, kNan, 0.5, -0.5, kLeast, -kLeast, 1.0, -1.0,
                         0x1.fffffffffffffp-1, -0x1.fffffffffffffp-1, 0x1.fffffffffffffp+51,
                         -0x1.fffffffffffffp+51, 0x1p52, -0x1p53, 2097152.5, -2097152.5}) {
    EXPECT_TRUE(same(floor(x), std::floor(x))) << std::hexfloat << x;
  }
  Random random(13);
  for (int i = 0; i < 500000; ++i) {
    const double x = random.pattern();
    ASSERT_TRUE(same(floor(x), std::floor(x))) << std::hexfloat << x;
    const double y = random.uniform(-1.0, 1.0) * std::ldexp(1.0, i % 54);
    ASSERT_TRUE(same(floor(y), std::floor(y))) << std::hexfloat << y;
  }
}

TEST(ElementaryAbs, ClearsTheSign) {
  static_assert(abs(-2.0) == 2.0 && abs(3.0) == 3.0);
  EXPECT_TRUE(same(abs(-0.0), 0.0));
  EXPECT_TRUE(same(abs(0.0), 0.0));
  EXPECT_TRUE(same(abs(-kInf), kInf));
  EXPECT_TRUE(same(abs(-kLeast), kLeast));
  EXPECT_TRUE(std::isnan(abs(kNan)));
}

TEST(ElementaryIsFinite, TellsNumbersFromTheRest) {
  static_assert(is_finite(0.0) && is_finite(-1.0));
  EXPECT_TRUE(is_finite(kMax));
  EXPECT_TRUE(is_finite(-kLeast));
  EXPECT_FALSE(is_finite(kInf));
  EXPECT_FALSE(is_finite(-kInf));
  EXPECT_FALSE(is_finite(kNan));
}

}  // namespace
}  // namespace emax
