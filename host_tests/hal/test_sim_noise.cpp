// The bench's noise: published words, moments, density, whiteness.
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "emax/sim/noise.hpp"

namespace emax::sim {
namespace {

constexpr std::size_t kPairs = 2000000;

std::vector<double> drawn(std::uint64_t seed) {
  Noise noise;
  noise.seed(seed);
  std::vector<double> values;
  values.reserve(2 * kPairs);
  for (std::size_t i = 0; i < kPairs; ++i) {
    const NoisePair pair = noise.pair();
    values.push_back(pair.first);
    values.push_back(pair.second);
  }
  return values;
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
  double skewness = 0.0;
  double excess = 0.0;
};

Moments moments(const std::vector<double>& values) {
  std::array<double, 5> sum = {};
  for (const double x : values) {
    sum[1] += x;
    sum[2] += x * x;
    sum[3] += x * x * x;
    sum[4] += x * x * x * x;
  }
  const auto n = static_cast<double>(values.size());
  // The mean is too small to matter in the higher moments.
  const double variance = sum[2] / n;
  return {sum[1] / n, variance, sum[3] / n / std::pow(variance, 1.5),
          sum[4] / n / (variance * variance) - 3.0};
}

double normal_probability(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

// The reference implementation of xoshiro256++ by its authors, started from 1, 2, 3, 4.
TEST(SimNoise, PublishedWords) {
  constexpr std::array<std::uint64_t, 10> kWords = {
      41943041U,
      58720359U,
      3588806011781223U,
      3591011842654386U,
      9228616714210784205U,
      9973669472204895162U,
      14011001112246962877U,
      12406186145184390807U,
      15849039046786891736U,
      10450023813501588000U,
  };
  Noise noise;
  for (const std::uint64_t word : kWords) {
    EXPECT_EQ(noise.bits(), word);
  }
}

// SplitMix64 from 1234567 gives 6457827717110365317, 3203168211198807973, 9817491932198370423,
// 4593380528125082431; the first word is rotl(s0 + s3, 23) + s0.
TEST(SimNoise, SeedsBySplitMix) {
  constexpr std::uint64_t kFirst = 6457827717110365317U;
  constexpr std::uint64_t kSum = kFirst + 4593380528125082431U;
  Noise noise;
  noise.seed(1234567);
  EXPECT_EQ(noise.bits(), ((kSum << 23U) | (kSum >> 41U)) + kFirst);
}

TEST(SimNoise, Moments) {
  const Moments seen = moments(drawn(7));
  constexpr double kCount = 2.0 * kPairs;
  // Four standard deviations of each statistic.
  EXPECT_NEAR(seen.mean, 0.0, 4.0 * std::sqrt(1.0 / kCount));
  EXPECT_NEAR(seen.variance, 1.0, 4.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(seen.skewness, 0.0, 4.0 * std::sqrt(6.0 / kCount));
  // Fourth cumulants: -1/8 per bit, -1/120 per fraction; variances 1/4 and 1/12.
  const double variance = 64.0 / 4.0 + 2.0 / 12.0;
  const double excess = -(64.0 / 8.0 + 2.0 / 120.0) / (variance * variance);
  EXPECT_NEAR(seen.excess, excess, 4.0 * std::sqrt(24.0 / kCount));
}

// Shares of intervals, each a quarter of a standard deviation wide.
TEST(SimNoise, DensityIsNormal) {
  const std::vector<double> values = drawn(8);
  std::array<double, 24> count = {};
  for (const double x : values) {
    const double bin = std::floor(4.0 * (x + 3.0));
    if (bin >= 0.0 && bin < 24.0) {
      count[static_cast<std::size_t>(bin)] += 1.0;
    }
  }
  for (std::size_t i = 0; i < count.size(); ++i) {
    const double low = static_cast<double>(i) * 0.25 - 3.0;
    const double expected = normal_probability(low + 0.25) - normal_probability(low);
    const double counted = count[i] / static_cast<double>(values.size());
    const double scatter = std::sqrt(expected / static_cast<double>(values.size()));
    // What is promised, and what counting adds.
    const double promised = low >= -2.0 && low < 2.0 ? 0.014 : 0.08;
    EXPECT_NEAR(counted, expected, promised * expected + 4.0 * scatter) << low;
  }
}

// Both channels of a frame, and each with its past. 4.5 standard deviations for 60 statistics.
TEST(SimNoise, IsWhite) {
  const std::vector<double> values = drawn(9);
  for (std::size_t lag = 1; lag <= 60; ++lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < values.size(); ++i) {
      sum += values[i] * values[i - lag];
    }
    const auto n = static_cast<double>(values.size() - lag);
    EXPECT_LT(std::abs(sum / n), 4.5 / std::sqrt(n)) << lag;
  }
}

TEST(SimNoise, SeedsDiffer) {
  Noise a;
  Noise b;
  Noise c;
  a.seed(1);
  b.seed(1);
  c.seed(2);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t word = a.bits();
    EXPECT_EQ(word, b.bits());
    equal += word == c.bits() ? 1 : 0;
  }
  EXPECT_EQ(equal, 0);
}

// Box and Muller from the first two published words, whose upper 53 bits are 20480 and 28672.
TEST(SimNoise, NormalDrawFromPublishedWords) {
  const double radius = std::sqrt(-2.0 * std::log(std::ldexp(20481.0, -53)));
  const double angle = 6.283185307179586 * std::ldexp(28672.0, -53);
  Noise noise;
  EXPECT_NEAR(noise.normal(), radius * std::cos(angle), 1e-14);
}

TEST(SimNoise, NormalDraws) {
  Noise noise;
  noise.seed(10);
  std::vector<double> values;
  constexpr std::size_t kDraws = 1000000;
  values.reserve(kDraws);
  double beyond_three = 0.0;
  for (std::size_t i = 0; i < kDraws; ++i) {
    values.push_back(noise.normal());
    beyond_three += std::abs(values.back()) > 3.0 ? 1.0 : 0.0;
  }
  const Moments seen = moments(values);
  constexpr double kCount = kDraws;
  EXPECT_NEAR(seen.mean, 0.0, 4.0 * std::sqrt(1.0 / kCount));
  EXPECT_NEAR(seen.variance, 1.0, 4.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(seen.skewness, 0.0, 4.0 * std::sqrt(6.0 / kCount));
  EXPECT_NEAR(seen.excess, 0.0, 4.0 * std::sqrt(24.0 / kCount));
  const double expected = 2.0 * normal_probability(-3.0) * kCount;
  EXPECT_NEAR(beyond_three, expected, 4.0 * std::sqrt(expected));
}

}  // namespace
}  // namespace emax::sim
