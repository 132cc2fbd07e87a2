// e^z and its divided differences against long double, across the radius where the series ends.
#include <cmath>
#include <complex>
#include <gtest/gtest.h>

#include "emax/base/complex_exp.hpp"

namespace emax {
namespace {

using Wide = std::complex<long double>;

/// The power series, summed until nothing is added: exact to long double for moduli up to 3.
Wide divided_difference(Wide z, int order) {
  long double factorial = 1;
  for (int i = 2; i <= order; ++i) {
    factorial *= i;
  }
  Wide term = 1 / factorial;
  Wide sum = term;
  for (int n = 1; n < 80; ++n) {
    term *= z / static_cast<long double>(n + order);
    sum += term;
  }
  return sum;
}

double relative_error(Complex value, Wide expected) {
  return static_cast<double>(std::abs(Wide(value.re, value.im) - expected) / std::abs(expected));
}

TEST(ComplexExp, DividedDifferencesAreAccurateNearZeroAndAcrossTheRadius) {
  for (double modulus = 1e-12; modulus < 3.0; modulus *= 1.3) {
    for (int step = 0; step < 16; ++step) {
      const double angle = 0.3926990816987242 * step;
      const Complex z = {modulus * std::cos(angle), modulus * std::sin(angle)};
      const Wide wide(z.re, z.im);
      // Outside the series, e^z - 1 loses up to a factor of 2.5, e^z - 1 - z one of 15.
      EXPECT_LT(relative_error(exp(z), std::exp(wide)), 4e-16);
      EXPECT_LT(relative_error(phi1(z), divided_difference(wide, 1)), 2e-15);
      EXPECT_LT(relative_error(phi2(z), divided_difference(wide, 2)), 1e-14);
    }
  }
}

TEST(ComplexExp, ValuesAtZeroAreTheLimits) {
  EXPECT_EQ(exp(Complex{}).re, 1.0);
  EXPECT_EQ(phi1(Complex{}).re, 1.0);
  EXPECT_EQ(phi2(Complex{}).re, 0.5);
  EXPECT_EQ(phi2(Complex{}).im, 0.0);
}

TEST(ComplexExp, RealArgumentsStayReal) {
  for (const double x : {-30.0, -1.0, -0.1, 0.1, 1.0}) {
    EXPECT_EQ(exp(Complex{x, 0.0}).im, 0.0);
    EXPECT_EQ(phi1(Complex{x, 0.0}).im, 0.0);
  }
}

}  // namespace
}  // namespace emax
