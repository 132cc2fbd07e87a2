// The sine fit against a published vector, normal equations in long double, closed forms and
// chance.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "emax/base/distributions.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/identify/sine_fit.hpp"

namespace {

using emax::SineFit;
using emax::SineFitResult;
using emax::Status;

constexpr long double kPi = 3.14159265358979323846264338327950288L;

SineFitResult fit_of(const std::vector<double>& samples, double frequency_hz,
                     double sample_rate_hz) {
  SineFit fit;
  EXPECT_EQ(fit.start(frequency_hz, sample_rate_hz), Status::kOk);
  fit.add({samples.data(), samples.size()});
  return fit.result();
}

class Noise {
 public:
  explicit Noise(std::uint32_t seed) {
    const std::array<std::uint32_t, 4> seeds = {seed, 2, 3, 4};
    EXPECT_EQ(generator_.seed(emax::Generator::k2006, seeds), Status::kOk);
    for (int i = 0; i < 100; ++i) {
      (void)generator_.next();
    }
  }
  double next() {
    const double u1 = generator_.next();
    const double u2 = generator_.next();
    return emax::box_muller(u1, u2).first;
  }

 private:
  emax::WichmannHill generator_;
};

struct Expected {
  long double a = 0.0L;
  long double b = 0.0L;
  long double c = 0.0L;
  long double residual_std = 0.0L;
};

// Normal equations by Cramer's rule, angles from the standard library in long double.
Expected normal_equations(const std::vector<double>& samples, double frequency_hz,
                          double sample_rate_hz) {
  long double n[3][3] = {};
  long double g[3] = {};
  const auto column = [&](std::size_t i, int k) {
    const long double angle =
        2.0L * kPi *
        std::fmod(static_cast<long double>(i) * static_cast<long double>(frequency_hz) /
                      static_cast<long double>(sample_rate_hz),
                  1.0L);
    return k == 0 ? std::cos(angle) : k == 1 ? std::sin(angle) : 1.0L;
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (int j = 0; j < 3; ++j) {
      g[j] += column(i, j) * static_cast<long double>(samples[i]);
      for (int k = 0; k < 3; ++k) {
        n[j][k] += column(i, j) * column(i, k);
      }
    }
  }
  const auto determinant = [](const long double(&m)[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  long double x[3] = {};
  for (int k = 0; k < 3; ++k) {
    long double m[3][3] = {};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        m[i][j] = j == k ? g[i] : n[i][j];
      }
    }
    x[k] = determinant(m) / determinant(n);
  }
  long double squares = 0.0L;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const long double rest =
        static_cast<long double>(samples[i]) - x[0] * column(i, 0) - x[1] * column(i, 1) - x[2];
    squares += rest * rest;
  }
  return {x[0], x[1], x[2], std::sqrt(squares / static_cast<long double>(samples.size() - 3))};
}

// A record of a sine with offset and white noise, each sample rounded once.
std::vector<double> record(std::size_t samples, double frequency_hz, double amplitude,
                           double phase_rad, double offset, double noise, std::uint32_t seed) {
  Noise source(seed);
  std::vector<double> y(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const long double turns = std::fmod(
        static_cast<long double>(i) * static_cast<long double>(frequency_hz) / 1e5L, 1.0L);
    y[i] =
        static_cast<double>(static_cast<long double>(offset) +
                            static_cast<long double>(amplitude) *
                                std::sin(2.0L * kPi * turns + static_cast<long double>(phase_rad)));
    if (noise > 0.0) {
      y[i] += noise * source.next();
    }
  }
  return y;
}

TEST(SineFit, PublishedVector) {
  // y_n = n mod 5, pi/4 per sample, n = 0 to 11; y = A cos + B sin + C, time from the first sample.
  std::vector<double> samples;
  for (int n = 0; n < 12; ++n) {
    samples.push_back(n % 5);
  }
  const SineFitResult result = fit_of(samples, 1.0, 8.0);
  ASSERT_EQ(result.status, Status::kOk);
  // Sums of a dozen numbers of size 4 and angles within an ulp: a few 1e-15.
  EXPECT_NEAR(result.cosine_v, -0.09573833725177855, 1e-14);
  EXPECT_NEAR(result.sine_v, 0.3093073222875872, 1e-14);
  EXPECT_NEAR(result.offset_v, 1.6957503670703147, 1e-14);
  EXPECT_EQ(result.samples, 12U);
  EXPECT_NEAR(result.amplitude_v, std::hypot(0.09573833725177855, 0.3093073222875872), 1e-14);
  EXPECT_NEAR(result.phase_rad, std::atan2(-0.09573833725177855, 0.3093073222875872), 1e-13);
  EXPECT_EQ(result.phasor().re, result.cosine_v);
  EXPECT_EQ(result.phasor().im, -result.sine_v);
}

TEST(SineFit, SameAsNormalEquationsInLongDouble) {
  struct Case {
    std::size_t samples;
    double frequency_hz;
    double amplitude;
    double offset;
    double noise;
  };
  const Case cases[] = {{4, 25e3, 1.0, 0.5, 0.1},        {100, 3e3, 1.0, 0.0, 0.01},
                        {3334, 30.0, 1.0, -3.0, 1e-3},   {1000, 6e3, 0.5, 4.0, 1e-4},
                        {10000, 4057.3, 2.0, 1.0, 1e-5}, {777, 39999.0, 1.0, 0.1, 1e-3},
                        {5000, 160.0, 1e-3, 5.0, 1e-5},  {5000, 160.0, 5.0, 1e-3, 1e-6}};
  std::uint32_t seed = 1;
  for (const Case& c : cases) {
    const std::vector<double> samples =
        record(c.samples, c.frequency_hz, c.amplitude, 0.7, c.offset, c.noise, seed++);
    const SineFitResult result = fit_of(samples, c.frequency_hz, 1e5);
    const Expected expected = normal_equations(samples, c.frequency_hz, 1e5);
    ASSERT_EQ(result.status, Status::kOk) << c.frequency_hz;
    // Rounding of the samples' own size, and of the equations' condition for the shortest records.
    const double tolerance = 3e-14 * (c.amplitude + std::fabs(c.offset));
    EXPECT_NEAR(result.cosine_v, static_cast<double>(expected.a), tolerance);
    EXPECT_NEAR(result.sine_v, static_cast<double>(expected.b), tolerance);
    EXPECT_NEAR(result.offset_v, static_cast<double>(expected.c), tolerance);
    // Before the end of the first period squares of the signal's size are summed.
    const double floor = 1e-8 * c.amplitude / c.noise;
    EXPECT_NEAR(result.residual_std_v / static_cast<double>(expected.residual_std), 1.0,
                1e-9 + floor * floor)
        << c.frequency_hz;
  }
}

TEST(SineFit, BlocksDoNotMatterBitForBit) {
  const std::vector<double> samples = record(3000, 1230.0, 1.0, 0.3, 0.2, 0.01, 5);
  const SineFitResult whole = fit_of(samples, 1230.0, 1e5);
  for (const std::size_t block : {1U, 7U, 32U, 63U, 64U, 65U, 2999U}) {
    SineFit fit;
    ASSERT_EQ(fit.start(1230.0, 1e5), Status::kOk);
    for (std::size_t i = 0; i < samples.size(); i += block) {
      const std::size_t count = std::min(block, samples.size() - i);
      fit.add({samples.data() + i, count});
      (void)fit.result();
    }
    const SineFitResult parts = fit.result();
    EXPECT_EQ(std::memcmp(&parts.cosine_v, &whole.cosine_v, 6 * sizeof(double)), 0) << block;
    EXPECT_EQ(parts.samples, whole.samples);
  }
}

TEST(SineFit, MillionSamples) {
  // At 1e6 samples the phase of the last one is known to 1e6 * 0.04 turns * 1.1e-16; sums of 1e6
  // terms about the fit of the first period keep the rest.
  for (const double frequency_hz : {30.0, 160.0, 4057.3, 40000.1}) {
    const std::vector<double> samples = record(1000000, frequency_hz, 1.0, -2.1, 10.0, 0.0, 1);
    const SineFitResult result = fit_of(samples, frequency_hz, 1e5);
    ASSERT_EQ(result.status, Status::kOk);
    EXPECT_NEAR(result.amplitude_v, 1.0, 2e-13) << frequency_hz;
    EXPECT_NEAR(result.phase_rad, -2.1, 2e-11) << frequency_hz;
    EXPECT_NEAR(result.offset_v, 10.0, 2e-13) << frequency_hz;
    EXPECT_LT(result.residual_std_v, 5e-9) << frequency_hz;
  }
}

TEST(SineFit, ResidualOfTinyNoiseOnALargeSignal) {
  // Noise of 1e-7 of the amplitude: plain sums of squares would keep two digits of it.
  const std::vector<double> samples = record(200000, 160.0, 5.0, 1.0, 3.0, 5e-7, 9);
  const SineFitResult result = fit_of(samples, 160.0, 1e5);
  // A standard deviation from 2e5 samples has a relative standard uncertainty of 0.16 %.
  EXPECT_NEAR(result.residual_std_v / 5e-7, 1.0, 4 * 0.0016);
}

TEST(SineFit, ScatterIsThatOfTheory) {
  constexpr int kFits = 2000;
  constexpr std::size_t kSamples = 500;
  constexpr double kNoise = 0.01;
  double amplitude2 = 0.0;
  double phase2 = 0.0;
  double variance = 0.0;
  for (std::uint32_t i = 0; i < kFits; ++i) {
    const SineFitResult result =
        fit_of(record(kSamples, 1200.0, 1.0, 0.4, 0.1, kNoise, i + 1), 1200.0, 1e5);
    amplitude2 += (result.amplitude_v - 1.0) * (result.amplitude_v - 1.0) / kFits;
    phase2 += (result.phase_rad - 0.4) * (result.phase_rad - 0.4) / kFits;
    variance += result.residual_std_v * result.residual_std_v / kFits;
  }
  // A variance from 2000 values has a relative standard uncertainty of sqrt(2/2000): four of them.
  const double expected = kNoise * kNoise * 2.0 / kSamples;
  EXPECT_NEAR(amplitude2 / expected, 1.0, 4 * 0.0316);
  EXPECT_NEAR(phase2 / expected, 1.0, 4 * 0.0316);
  EXPECT_NEAR(variance / (kNoise * kNoise), 1.0, 4 * 0.0316 / 22.0);
}

TEST(SineFit, TooFewSamples) {
  SineFit fit;
  EXPECT_EQ(fit.result().status, Status::kTooFewPoints);
  const double samples[] = {1.0, 2.0, 3.0, 2.0, 1.0, 2.0, 3.0, 2.0, 1.0, 2.0};
  fit.add(samples);  // Not started.
  EXPECT_EQ(fit.result().samples, 0U);
  ASSERT_EQ(fit.start(1.0, 10.0), Status::kOk);
  fit.add({samples, 9});
  EXPECT_EQ(fit.result().status, Status::kTooFewPoints);
  EXPECT_EQ(fit.result().amplitude_v, 0.0);
  fit.add({samples + 9, 1});
  EXPECT_EQ(fit.result().status, Status::kOk);
  ASSERT_EQ(fit.start(4.9, 10.0), Status::kOk);
  fit.add({samples, 3});
  EXPECT_EQ(fit.result().status, Status::kTooFewPoints);
}

TEST(SineFit, BadRatesKeepTheRunningFit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> samples = record(100, 5000.0, 1.0, 0.3, 0.2, 0.0, 5);
  SineFit fit;
  ASSERT_EQ(fit.start(5.0, 100.0), Status::kOk);
  fit.add({samples.data(), samples.size()});
  const double bad[][2] = {{0.0, 100.0},    {-1.0, 100.0},        {50.0, 100.0},  {60.0, 100.0},
                           {1.0, 0.0},      {1.0, -5.0},          {nan, 100.0},   {1.0, nan},
                           {1.0, infinity}, {infinity, infinity}, {1e-300, 1e300}};
  for (const auto& rates : bad) {
    EXPECT_EQ(fit.start(rates[0], rates[1]), Status::kInvalidArgument) << rates[0];
  }
  EXPECT_NEAR(fit.result().amplitude_v, 1.0, 1e-14);
  EXPECT_EQ(fit.result().samples, 100U);
}

TEST(SineFit, NotIdentifiable) {
  // Next to half the sample rate sines are as good as zero at the samples.
  SineFit fit;
  ASSERT_EQ(fit.start(0.4999999999, 1.0), Status::kOk);
  const double samples[] = {1.0, -1.0, 1.0, -1.0, 1.0, -1.0};
  fit.add(samples);
  EXPECT_EQ(fit.result().status, Status::kNotIdentifiable);
  EXPECT_EQ(fit.result().amplitude_v, 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {nan, std::numeric_limits<double>::infinity(), 1e308}) {
    ASSERT_EQ(fit.start(1.0, 5.0), Status::kOk);
    const double values[] = {0.0, bad, -bad, 1.0, -1.0, bad};
    fit.add(values);
    EXPECT_EQ(fit.result().status, Status::kNotIdentifiable) << bad;
  }
}

TEST(SineFit, PureOffset) {
  const std::vector<double> samples(1000, 2.5);
  const SineFitResult result = fit_of(samples, 160.0, 1e5);
  ASSERT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.amplitude_v, 0.0);
  EXPECT_EQ(result.offset_v, 2.5);
  EXPECT_EQ(result.residual_std_v, 0.0);
}

}  // namespace
