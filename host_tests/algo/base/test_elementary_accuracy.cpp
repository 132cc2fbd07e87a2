// The error of every elementary function against 113-bit arithmetic (libquadmath; hosts only).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <random>
#include <string>

#include "emax/base/elementary.hpp"

__extension__ typedef __float128 Quad;

// clang has no quadmath.h; the library is the same.
extern "C" {
Quad expq(Quad x);
Quad logq(Quad x);
void sincosq(Quad x, Quad* sine, Quad* cosine);
Quad atan2q(Quad y, Quad x);
Quad sqrtq(Quad x);
Quad frexpq(Quad x, int* exponent);
Quad ldexpq(Quad x, int exponent);
}

namespace emax {
namespace {

// What elementary.hpp promises of all, and what it states of each. The stated errors are the
// greatest ever found, rounded up: more means that a step has become inexact that was exact. The
// reference is good to 2^-112 of the value, 2^-59 of these tolerances.
constexpr double kPromiseUlp = 1.0;
constexpr double kStatedExpUlp = 0.53;
constexpr double kStatedExpSubnormalUlp = 0.76;
constexpr double kStatedLogUlp = 0.56;
constexpr double kStatedSineUlp = 0.82;
constexpr double kStatedAtan2Ulp = 0.52;
constexpr double kStatedSqrtUlp = 0.5;  // Correctly rounded.

/// The greatest error of one function and where it was found.
class Worst {
 public:
  explicit Worst(const char* name) : name_(name) {}

  void compare(double got, Quad want, double x, double y = 0.0) {
    ++count_;
    // One ulp: the distance of doubles where the exact value lies, 2^-1074 for subnormals.
    int exponent = 0;
    frexpq(want, &exponent);
    exponent = std::max(exponent - 53, -1074);
    const Quad difference = static_cast<Quad>(got) - want;
    const double error =
        static_cast<double>(ldexpq(difference < 0 ? -difference : difference, -exponent));
    if (!(error <= error_)) {  // A NaN is the worst of all.
      error_ = error;
      x_ = x;
      y_ = y;
    }
  }

  /// Prints a row of the table of errors, and fails where the header is wrong.
  void report(double stated_ulp, long least_count = 1000000) const {
    std::printf("  %-16s max error %.4f ulp on %ld arguments, at %a %a\n", name_, error_, count_,
                x_, y_);
    testing::Test::RecordProperty(std::string(name_) + "_max_error_ulp", std::to_string(error_));
    EXPECT_GE(count_, least_count);
    EXPECT_LE(stated_ulp, kPromiseUlp);
    EXPECT_LE(error_, stated_ulp) << name_ << std::hexfloat << ' ' << x_ << ' ' << y_;
  }

 private:
  const char* name_;
  long count_ = 0;
  double error_ = 0.0;
  double x_ = 0.0;
  double y_ = 0.0;
};

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t word() { return engine_(); }
  /// Any finite double: all exponents alike.
  double finite_pattern() {
    for (;;) {
      const auto x = __builtin_bit_cast(double, engine_());
      if (std::isfinite(x)) {
        return x;
      }
    }
  }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  /// All exponents from low to high alike.
  double spread(int low, int high) {
    const int exponent = low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1));
    const double magnitude = std::ldexp(uniform(1.0, 2.0), exponent);
    return (engine_() & 1) != 0 ? -magnitude : magnitude;
  }

 private:
  std::mt19937_64 engine_;
};

TEST(ElementaryAccuracy, Exp) {
  Random random(101);
  Worst worst("exp");
  Worst worst_subnormal("exp, subnormal");
  const auto check = [&](double x) {
    constexpr double kLnLeastNormal = -708.3964185322641;
    Worst& kind = x < kLnLeastNormal ? worst_subnormal : worst;
    kind.compare(exp(x), expq(static_cast<Quad>(x)), x);
  };
  for (int i = 0; i < 400000; ++i) {
    check(random.uniform(-708.0, 709.78));
    check(random.uniform(-4.0, 4.0));
  }
  for (int i = 0; i < 150000; ++i) {
    check(random.spread(-60, 9) * 0.69);    // Below 708 in magnitude.
    check(random.uniform(-745.2, -707.0));  // Subnormal results.
    check(random.uniform(705.0, 709.782712));
    // Next to the ends of the intervals of the table.
    const double knot = static_cast<double>(i % 2048 - 1024) * 0.34657359027997264 / 32.0;
    check(knot + random.uniform(-1.0, 1.0) * 1e-15);
  }
  worst.report(kStatedExpUlp);
  worst_subnormal.report(kStatedExpSubnormalUlp, 100000);
}

TEST(ElementaryAccuracy, Log) {
  Random random(102);
  Worst worst("log");
  const auto check = [&](double x) { worst.compare(log(x), logq(static_cast<Quad>(x)), x); };
  for (int i = 0; i < 300000; ++i) {
    check(std::fabs(random.spread(-1074, 1023)) + 5e-324);
    check(random.uniform(0.5, 2.0));
    check(random.uniform(0.99, 1.01));
    check(random.uniform(0.0, 1.0));
    check(1.0 + random.spread(-52, -3));
    check(std::ldexp(1.0 + random.spread(-52, -4), static_cast<int>(random.word() % 2000) - 1000));
  }
  worst.report(kStatedLogUlp);
}

TEST(ElementaryAccuracy, SineAndCosine) {
  Random random(103);
  Worst sine("sin");
  Worst cosine("cos");
  const auto check = [&](double x) {
    Quad s = 0;
    Quad c = 0;
    sincosq(static_cast<Quad>(x), &s, &c);
    const SinCos both = sincos(x);
    sine.compare(both.sin, s, x);
    cosine.compare(both.cos, c, x);
  };
  // The doubles nearest to a multiple of pi/2 in all the range: 2^-61 away.
  check(0x1.6ac5b262ca1ffp+849);
  check(-0x1.6ac5b262ca1ffp+849);
  constexpr double kHalfPi = 1.5707963267948966;
  for (int i = 0; i < 150000; ++i) {
    check(random.uniform(-0.8, 0.8));
    check(random.uniform(0.7, 0.87));  // Where the two series are worst.
    check(random.uniform(-7.0, 7.0));
    check(random.uniform(-1000.0, 1000.0));
    check(random.uniform(-70000.0, 70000.0));
    check(random.finite_pattern());
    check(random.spread(-40, 70));
    // Next to multiples of pi/2, where the reduction changes from one path to the other.
    const double near = static_cast<double>(i / 2) * kHalfPi;
    check(near);
    check(near + random.spread(-60, -10));
    check(static_cast<double>(random.word() >> (11 + i % 50)) * kHalfPi);
  }
  sine.report(kStatedSineUlp);
  cosine.report(kStatedSineUlp);
}

TEST(ElementaryAccuracy, Atan2) {
  Random random(104);
  Worst worst("atan2");
  const auto check = [&](double y, double x) {
    worst.compare(atan2(y, x), atan2q(static_cast<Quad>(y), static_cast<Quad>(x)), y, x);
  };
  for (int i = 0; i < 200000; ++i) {
    check(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    check(random.finite_pattern(), random.finite_pattern());
    check(random.spread(-70, 70), random.spread(-3, 3));
    check(random.spread(-1074, -1000), random.spread(-1074, -1000));
    check(random.spread(1000, 1023), random.spread(990, 1023));
    // Next to the points of the table and to the ends of its intervals.
    const double x = random.spread(-5, 5);
    check(x * (static_cast<double>(i % 33 - 16) / 16.0 + random.spread(-53, -8)), x);
  }
  worst.report(kStatedAtan2Ulp);
}

TEST(ElementaryAccuracy, Sqrt) {
  Random random(105);
  Worst worst("sqrt");
  for (int i = 0; i < 1000000; ++i) {
    const double x = std::fabs(random.finite_pattern());
    worst.compare(detail::software_sqrt(x), sqrtq(static_cast<Quad>(x)), x);
  }
  worst.report(kStatedSqrtUlp);
}

}  // namespace
}  // namespace emax
