// The sine fit in integers against a published vector, normal equations in double with the
// library's sines, chance, the words' rounding, and its own arithmetic at full scale.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "emax/identify/frame_sine_fit.hpp"

namespace emax {
namespace {

using Word = std::int32_t;

// As a board's stream has it; nothing but the two words matters.
struct Frame {
  Word reference;
  Word device;
};

constexpr double kPi = 3.14159265358979323846;
constexpr double kRate_hz = 100000.0;
constexpr double kWordsPerVolt = 2147483648.0 / 10.0;
constexpr double kVoltsPerWord = 1.0 / kWordsPerVolt;

struct Wave {
  double amplitude_v;
  double phase_rad;
  double offset_v;
  double noise_v;
};

double angle_of(std::size_t frame, double frequency_hz) {
  return 2.0 * kPi * std::fmod(static_cast<double>(frame) * frequency_hz / kRate_hz, 1.0);
}

// As a converter of so many bits would give it.
Word word_of(double volts, int bits) {
  const double step = std::ldexp(1.0, 32 - bits);
  return static_cast<Word>(step * std::round(volts * kWordsPerVolt / step));
}

std::vector<Frame> record(std::size_t frames, double frequency_hz, const Wave& reference,
                          const Wave& device, int bits, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto volts_of = [&](const Wave& wave, double angle) {
    return wave.offset_v + wave.amplitude_v * std::sin(angle + wave.phase_rad) +
           wave.noise_v * normal(random);
  };
  std::vector<Frame> record;
  for (std::size_t i = 0; i < frames; ++i) {
    const double angle = angle_of(i, frequency_hz);
    const Word reference_word = word_of(volts_of(reference, angle), bits);
    record.push_back({reference_word, word_of(volts_of(device, angle), bits)});
  }
  return record;
}

FrameSineFit fit_of(const std::vector<Frame>& frames, double frequency_hz, std::size_t block = 64) {
  FrameSineFit fit;
  EXPECT_EQ(fit.start(frequency_hz, kRate_hz, kVoltsPerWord), Status::kOk);
  for (std::size_t i = 0; i < frames.size(); i += block) {
    fit.add(Span<const Frame>(frames.data() + i, std::min(block, frames.size() - i)));
  }
  return fit;
}

struct Expected {
  double cosine_v;
  double sine_v;
  double offset_v;
  double residual_std_v;
};

// Normal equations by Cramer's rule.
Expected normal_equations(const std::vector<double>& samples, double frequency_hz) {
  double n[3][3] = {};
  double g[3] = {};
  const auto row = [&](std::size_t i) {
    const double angle = angle_of(i, frequency_hz);
    return std::array<double, 3>{std::cos(angle), std::sin(angle), 1.0};
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto r = row(i);
    for (std::size_t j = 0; j < 3; ++j) {
      g[j] += r[j] * samples[i];
      for (std::size_t k = 0; k < 3; ++k) {
        n[j][k] += r[j] * r[k];
      }
    }
  }
  const auto determinant = [](const double(&m)[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  double x[3] = {};
  for (std::size_t k = 0; k < 3; ++k) {
    double m[3][3] = {};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        m[i][j] = j == k ? g[i] : n[i][j];
      }
    }
    x[k] = determinant(m) / determinant(n);
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto r = row(i);
    const double rest = samples[i] - x[0] * r[0] - x[1] * r[1] - x[2];
    squares += rest * rest;
  }
  return {x[0], x[1], x[2], std::sqrt(squares / static_cast<double>(samples.size() - 3))};
}

void expect_fit(const SineFitResult& result, const std::vector<double>& samples,
                double frequency_hz) {
  const Expected expected = normal_equations(samples, frequency_hz);
  ASSERT_EQ(result.status, Status::kOk);
  const double largest =
      std::fabs(*std::max_element(samples.begin(), samples.end(),
                                  [](double a, double b) { return std::fabs(a) < std::fabs(b); }));
  // What the header states.
  const double within_v = 1e-8 * largest;
  EXPECT_NEAR(result.cosine_v, expected.cosine_v, within_v) << frequency_hz;
  EXPECT_NEAR(result.sine_v, expected.sine_v, within_v) << frequency_hz;
  EXPECT_NEAR(result.offset_v, expected.offset_v, within_v) << frequency_hz;
  // Errors of the residual add by squares where they do not depend on it.
  EXPECT_NEAR(result.residual_std_v, expected.residual_std_v,
              within_v + 1e-6 * expected.residual_std_v)
      << frequency_hz;
  EXPECT_NEAR(result.amplitude_v, std::hypot(expected.cosine_v, expected.sine_v), 2 * within_v);
  EXPECT_NEAR(
      std::remainder(result.phase_rad - std::atan2(expected.cosine_v, expected.sine_v), 2 * kPi),
      0.0, 1e-7)
      << frequency_hz;
  EXPECT_EQ(result.samples, samples.size());
}

void expect_fits(const std::vector<Frame>& frames, double frequency_hz) {
  const FrameSineFit fit = fit_of(frames, frequency_hz);
  std::vector<double> reference_v;
  std::vector<double> device_v;
  for (const Frame& frame : frames) {
    reference_v.push_back(static_cast<double>(frame.reference) / kWordsPerVolt);
    device_v.push_back(static_cast<double>(frame.device) / kWordsPerVolt);
  }
  expect_fit(fit.reference(), reference_v, frequency_hz);
  expect_fit(fit.device(), device_v, frequency_hz);
}

TEST(FrameSineFit, PublishedVector) {
  // y_n = n mod 5, pi/4 per sample, n = 0 to 11; y = A cos + B sin + C, time from the first sample.
  std::vector<Frame> frames;
  for (int n = 0; n < 12; ++n) {
    const Word word = n % 5 * (Word{1} << 26);
    frames.push_back({word, -word});
  }
  FrameSineFit fit;
  ASSERT_EQ(fit.start(1.0, 8.0, std::ldexp(1.0, -26)), Status::kOk);
  fit.add(Span<const Frame>(frames.data(), frames.size()));
  const SineFitResult result = fit.reference();
  ASSERT_EQ(result.status, Status::kOk);
  // What the header states of a largest word of 4 V.
  constexpr double kWithin_v = 4e-8;
  EXPECT_NEAR(result.cosine_v, -0.09573833725177855, kWithin_v);
  EXPECT_NEAR(result.sine_v, 0.3093073222875872, kWithin_v);
  EXPECT_NEAR(result.offset_v, 1.6957503670703147, kWithin_v);
  EXPECT_EQ(result.samples, 12U);
  EXPECT_NEAR(result.amplitude_v, std::hypot(0.09573833725177855, 0.3093073222875872), kWithin_v);
  EXPECT_NEAR(result.phase_rad, std::atan2(-0.09573833725177855, 0.3093073222875872),
              kWithin_v / 0.3);
  EXPECT_EQ(result.phasor().re, result.cosine_v);
  EXPECT_EQ(result.phasor().im, -result.sine_v);
  EXPECT_NEAR(fit.device().sine_v, -0.3093073222875872, kWithin_v);
}

TEST(FrameSineFit, ScatterIsThatOfTheory) {
  constexpr unsigned kFits = 500;
  constexpr std::size_t kFrames = 200;
  constexpr double kNoise_v = 0.01;
  double amplitude2 = 0.0;
  double phase2 = 0.0;
  double variance = 0.0;
  const auto add = [&](const SineFitResult& fit, const Wave& wave) {
    const double amplitude_error = fit.amplitude_v - wave.amplitude_v;
    const double phase_error = (fit.phase_rad - wave.phase_rad) * wave.amplitude_v;
    amplitude2 += amplitude_error * amplitude_error / (2 * kFits);
    phase2 += phase_error * phase_error / (2 * kFits);
    variance += fit.residual_std_v * fit.residual_std_v / (2 * kFits);
  };
  const Wave waves[] = {{1.0, 0.4, 0.1, kNoise_v}, {2.0, -1.4, -0.3, kNoise_v}};
  for (unsigned seed = 0; seed < kFits; ++seed) {
    const FrameSineFit fit = fit_of(record(kFrames, 1500.0, waves[0], waves[1], 24, seed), 1500.0);
    add(fit.reference(), waves[0]);
    add(fit.device(), waves[1]);
  }
  // A variance from 1000 values has a relative standard uncertainty of sqrt(2/1000), one of the
  // residual's by 200 frames sqrt(2/200000): four of them.
  const double expected = kNoise_v * kNoise_v * 2.0 / kFrames;
  EXPECT_NEAR(amplitude2 / expected, 1.0, 4 * 0.045);
  EXPECT_NEAR(phase2 / expected, 1.0, 4 * 0.045);
  EXPECT_NEAR(variance / (kNoise_v * kNoise_v), 1.0, 4 * 0.0032);
}

TEST(FrameSineFit, SameAsNormalEquations) {
  struct Case {
    std::size_t frames;
    double frequency_hz;
    Wave reference;
    Wave device;
    int bits;
  };
  const Case cases[] = {
      {4, 25e3, {1.0, 0.3, 0.5, 0.1}, {2.0, -0.3, 0.0, 0.1}, 16},
      {100, 3e3, {1.0, 0.7, 0.0, 0.01}, {0.5, 2.0, -3.0, 1e-3}, 12},
      {3334, 30.0, {9.0, -2.0, 0.5, 1e-3}, {1e-2, 0.1, 9.0, 1e-3}, 16},
      {1000, 6e3, {0.5, 3.0, 4.0, 1e-4}, {4.0, 3.0, 4.0, 1e-4}, 24},
      {777, 39999.0, {1.0, 0.5, 0.1, 1e-3}, {5.0, 0.5, 0.1, 1e-3}, 16},
      {20002, 50.0, {4e-3, 1.0, 0.5, 5e-3}, {0.0, 0.0, -0.25, 5e-3}, 16},
  };
  for (const Case& c : cases) {
    expect_fits(record(c.frames, c.frequency_hz, c.reference, c.device, c.bits), c.frequency_hz);
  }
}

// Products at their largest, all of one sign: about the first word each other is two full scales.
TEST(FrameSineFit, FullScaleDoesNotOverflow) {
  constexpr Word kLowest = std::numeric_limits<Word>::min();
  constexpr Word kHighest = std::numeric_limits<Word>::max();
  std::vector<Frame> frames(20000, {kHighest, kLowest});
  frames[0] = {kLowest, kHighest};
  for (const double frequency_hz : {10.0, 50.0}) {
    expect_fits(frames, frequency_hz);
  }
}

TEST(FrameSineFit, ResidualOfTinyNoiseOnALargeSignal) {
  const auto frames = record(100000, 160.0, {9.0, 1.0, 0.5, 5e-6}, {9.0, 0.0, 0.0, 0.0}, 28);
  const FrameSineFit fit = fit_of(frames, 160.0);
  // A standard deviation from 1e5 samples has a relative standard uncertainty of 0.22 %.
  EXPECT_NEAR(fit.reference().residual_std_v / 5e-6, 1.0, 4 * 0.0022);
  // Of the words alone it would be 75 nV/sqrt(12); sums of squares of the signal are rounded, too.
  EXPECT_LT(fit.device().residual_std_v, 1e-7 * 9.0);
}

TEST(FrameSineFit, BlocksDoNotMatterBitForBit) {
  const auto frames = record(3000, 1230.0, {1.0, 0.3, 0.2, 0.01}, {2.0, 1.3, -0.2, 0.01}, 16);
  const SineFitResult whole[] = {fit_of(frames, 1230.0, 3000).reference(),
                                 fit_of(frames, 1230.0, 3000).device()};
  for (const std::size_t block : {1U, 7U, 63U, 64U, 65U, 2999U}) {
    const FrameSineFit fit = fit_of(frames, 1230.0, block);
    const SineFitResult parts[] = {fit.reference(), fit.device()};
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(std::memcmp(&parts[i].cosine_v, &whole[i].cosine_v, 6 * sizeof(double)), 0);
      EXPECT_EQ(parts[i].samples, whole[i].samples);
    }
  }
}

TEST(FrameSineFit, RestartIsAStart) {
  const auto first = record(1000, 700.0, {1.0, 0.3, 0.2, 0.01}, {2.0, 1.3, -0.2, 0.01}, 16);
  const auto second = record(500, 700.0, {3.0, 1.3, 0.0, 0.01}, {1.0, 0.3, 0.2, 0.01}, 16);
  FrameSineFit fit = fit_of(first, 700.0);
  fit.restart();
  EXPECT_EQ(fit.reference().status, Status::kTooFewPoints);
  fit.add(Span<const Frame>(second.data(), second.size()));
  const SineFitResult again = fit.reference();
  const SineFitResult fresh = fit_of(second, 700.0).reference();
  EXPECT_EQ(std::memcmp(&again.cosine_v, &fresh.cosine_v, 6 * sizeof(double)), 0);
}

TEST(FrameSineFit, ConstantWordsLeaveNothing) {
  const std::vector<Frame> frames(1000, {word_of(2.5, 16), word_of(-7.5, 16)});
  const SineFitResult result = fit_of(frames, 160.0).device();
  EXPECT_EQ(result.amplitude_v, 0.0);
  EXPECT_EQ(result.offset_v, -7.5);
  EXPECT_EQ(result.residual_std_v, 0.0);
}

TEST(FrameSineFit, TooFewFrames) {
  FrameSineFit fit;
  const std::vector<Frame> frames(100, {1 << 20, 1 << 20});
  fit.add(Span<const Frame>(frames.data(), 100));  // Not started.
  EXPECT_EQ(fit.reference().status, Status::kTooFewPoints);
  ASSERT_EQ(fit.start(1000.0, kRate_hz, kVoltsPerWord), Status::kOk);
  fit.add(Span<const Frame>(frames.data(), 99));
  EXPECT_EQ(fit.reference().status, Status::kTooFewPoints);
  EXPECT_EQ(fit.device().samples, 0U);
  fit.add(Span<const Frame>(frames.data(), 1));
  EXPECT_EQ(fit.reference().status, Status::kOk);
  ASSERT_EQ(fit.start(49000.0, kRate_hz, kVoltsPerWord), Status::kOk);
  fit.add(Span<const Frame>(frames.data(), 3));
  EXPECT_EQ(fit.reference().status, Status::kTooFewPoints);
}

TEST(FrameSineFit, BadRatesKeepTheRunningFit) {
  const auto frames = record(1000, 700.0, {1.0, 0.3, 0.2, 0.0}, {2.0, 1.3, -0.2, 0.0}, 24);
  FrameSineFit fit = fit_of(frames, 700.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, 5e4, 6e4, nan, infinity}) {
    EXPECT_EQ(fit.start(bad, kRate_hz, kVoltsPerWord), Status::kInvalidArgument) << bad;
  }
  for (const double bad : {0.0, -1e5, 1400.0, nan, infinity}) {
    EXPECT_EQ(fit.start(700.0, bad, kVoltsPerWord), Status::kInvalidArgument) << bad;
  }
  for (const double bad : {0.0, -1.0, nan}) {
    EXPECT_EQ(fit.start(700.0, kRate_hz, bad), Status::kInvalidArgument) << bad;
  }
  EXPECT_NEAR(fit.device().amplitude_v, 2.0, 1e-6);
  EXPECT_EQ(fit.device().samples, 1000U);
}

TEST(FrameSineFit, NotIdentifiableNextToHalfTheRate) {
  const auto frames = record(640, 49999.9999, {1.0, 0.3, 0.2, 0.0}, {2.0, 1.3, -0.2, 0.0}, 24);
  EXPECT_EQ(fit_of(frames, 49999.9999).reference().status, Status::kNotIdentifiable);
}

}  // namespace
}  // namespace emax
