// The reciprocal square root in single precision against long double.
#include <cmath>
#include <gtest/gtest.h>

#include "emax/base/float_root.hpp"

namespace emax {
namespace {

TEST(InverseRoot, IsTheRootOfAnyNormalNumber) {
  for (int exponent = -120; exponent <= 120; ++exponent) {
    for (int k = 0; k < 64; ++k) {
      const float x = std::ldexp(1.0F + static_cast<float>(k) / 64.0F, exponent);
      const long double exact = 1.0L / std::sqrt(static_cast<long double>(x));
      // Four roundings of a step of Newton's method, each of 6e-8.
      EXPECT_NEAR(static_cast<double>(inverse_root(x) / exact), 1.0, 2.5e-7) << x;
    }
  }
}

}  // namespace
}  // namespace emax
