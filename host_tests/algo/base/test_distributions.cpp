// Uniform ranges and Box and Muller's transform against their definitions in long double.
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>

#include "emax/base/distributions.hpp"
#include "emax/base/wichmann_hill.hpp"

namespace emax {
namespace {

constexpr std::array<std::uint32_t, 4> kSeeds = {123456789, 345678901, 567890123, 789012345};
// Clang warns of the implicit conversion.
constexpr long double wide(double x) { return static_cast<long double>(x); }

constexpr long double kTwoPi = 6.283185307179586476925286766559L;

TEST(UniformIn, EndsAndMiddle) {
  EXPECT_EQ(uniform_in(-2.0, 6.0, 0.0), -2.0);
  EXPECT_EQ(uniform_in(-2.0, 6.0, 0.5), 2.0);
  EXPECT_EQ(uniform_in(-2.0, 6.0, 0.875), 5.0);
  EXPECT_EQ(uniform_in(3.0, 3.0, 0.7), 3.0);
}

TEST(BoxMuller, ClosedForm) {
  WichmannHill generator;
  ASSERT_EQ(generator.seed(Generator::k2006, kSeeds), Status::kOk);
  for (int i = 0; i < 100000; ++i) {
    const double u1 = generator.next();
    const double u2 = generator.next();
    const NormalPair z = box_muller(u1, u2);
    const long double radius = std::sqrt(-2.0L * std::log(wide(u1)));
    // 2 pi u2 is rounded once, at most 2^-51 off; logarithm, root, sine and products add a few
    // parts in 2^52.
    const double tolerance = 4e-15 * (1.0 + static_cast<double>(radius));
    ASSERT_NEAR(z.first, static_cast<double>(radius * std::cos(kTwoPi * wide(u2))), tolerance);
    ASSERT_NEAR(z.second, static_cast<double>(radius * std::sin(kTwoPi * wide(u2))), tolerance);
  }
}

TEST(BoxMuller, Quarters) {
  const double u1 = std::exp(-0.5);  // Radius 1.
  EXPECT_NEAR(box_muller(u1, 0.0).first, 1.0, 1e-15);
  EXPECT_EQ(box_muller(u1, 0.0).second, 0.0);
  EXPECT_NEAR(box_muller(u1, 0.25).second, 1.0, 1e-15);
  EXPECT_NEAR(box_muller(u1, 0.5).first, -1.0, 1e-15);
  EXPECT_NEAR(box_muller(u1, 0.75).second, -1.0, 1e-15);
}

TEST(BoxMuller, ZeroHasALargeFiniteRadius) {
  const NormalPair z = box_muller(0.0, 0.0);
  EXPECT_NEAR(z.first, std::sqrt(2.0 * 53.0 * std::log(2.0)), 1e-14);
  EXPECT_LT(z.first, 8.6);
  EXPECT_EQ(z.second, 0.0);
}

TEST(BoxMuller, MomentsOfTheNormalDistribution) {
  WichmannHill generator;
  ASSERT_EQ(generator.seed(Generator::k2006, kSeeds), Status::kOk);
  constexpr int kPairs = 500000;
  double sums[4] = {};
  double cross = 0.0;
  for (int i = 0; i < kPairs; ++i) {
    const double u1 = generator.next();
    const double u2 = generator.next();
    const NormalPair z = box_muller(u1, u2);
    for (const double value : {z.first, z.second}) {
      double term = 1.0;
      for (double& sum : sums) {
        term *= value;
        sum += term;
      }
    }
    cross += z.first * z.second;
  }
  // Moments 0, 1, 0, 3 with variances 1, 2, 15, 96; four standard deviations of the mean of 1e6
  // numbers.
  const double n = 2.0 * kPairs;
  EXPECT_NEAR(sums[0] / n, 0.0, 4.0 * std::sqrt(1.0 / n));
  EXPECT_NEAR(sums[1] / n, 1.0, 4.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(sums[2] / n, 0.0, 4.0 * std::sqrt(15.0 / n));
  EXPECT_NEAR(sums[3] / n, 3.0, 4.0 * std::sqrt(96.0 / n));
  EXPECT_NEAR(cross / kPairs, 0.0, 4.0 * std::sqrt(1.0 / kPairs));
}

}  // namespace
}  // namespace emax
