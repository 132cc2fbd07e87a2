// The simulated bench as a whole: response, converters, draws, noise, hum, clock and record.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/sim/sim_bench.hpp"

#include "hal/bench_response.hpp"
#include "hal/bench_run.hpp"

namespace emax::test {
namespace {

using hal::Frame;
using hal::kMaxRampFrames;
using hal::StreamFormat;
using hal::Word;
using sim::BenchSettings;
using sim::BenchTruth;
using sim::kBenchFormat;
using sim::SimBench;

constexpr double kInterval_s = 1e-5;
constexpr int kWindow = 10000;
// The transient of the suspension falls by e^-28 in a second.
constexpr int kSettling = 10 * kWindow;

std::vector<int> default_frequencies_hz() {
  std::vector<int> result;
  for (int f = 30; f <= 100; f += 10) {
    result.push_back(f);
  }
  for (int f = 200; f <= 1000; f += 100) {
    result.push_back(f);
  }
  for (int f = 1200; f <= 6000; f += 200) {
    result.push_back(f);
  }
  return result;
}

struct Pair {
  Complex reference;
  Complex device;
};

// Both channels' response to a cosine of this amplitude, referred to the drive's phase.
Pair response(SimBench& bench, int frequency_hz, double amplitude_v) {
  const int frames = kSettling + kWindow + 64;
  const std::vector<Frame> seen = run(bench, cosine(frequency_hz, amplitude_v, frames));
  const int latency = static_cast<int>(bench.format().latency_frames);
  const int first = kSettling - kSettling % kWindow;
  const Complex reference =
      component(seen, Channel::kReference, first, kWindow, frequency_hz, bench.format());
  const Complex device =
      component(seen, Channel::kDevice, first, kWindow, frequency_hz, bench.format());
  const Complex back = std::polar(1.0, kTurn * frequency_hz * latency * kInterval_s);
  return {reference * back, device * back};
}

TEST(SimBench, RespondsAsItsTransferFunction) {
  for (const int frequency_hz : {10, 30, 160, 1000, 4070, 6000, 14000, 40000}) {
    const BenchSettings settings = ideal_bench();
    SimBench bench;
    ASSERT_EQ(bench.configure(settings), Status::kOk);
    const Pair seen = response(bench, frequency_hz, 0.1);
    const Complex reference = 0.1 * acceleration_seen(settings.shaker, frequency_hz, kInterval_s);
    const Complex device = 0.1 * device_seen(settings.device, settings.shaker, frequency_hz,
                                             kInterval_s, settings.skew_s);
    // Reference: 0.1 V/(m/s^2) times 10 is 1. Words are rounded to 4.7e-9 V on the way out, and
    // come back larger by the gain, and on the way in.
    constexpr double kWord_v = 4.7e-9;
    const double rounding = kWord_v * (1.0 + 10.0 * std::abs(reference));
    EXPECT_LT(std::abs(seen.reference - reference), rounding) << frequency_hz;
    EXPECT_LT(std::abs(seen.device - device), rounding) << frequency_hz;
  }
}

// What a calibration measures: the ratio of the channels is the device's response, turned forward
// by the skew since later samples show a later phase. The images of the held drive, which the
// device does not pass as the reference does, are all that is left.
TEST(SimBench, RatioIsTheDevice) {
  const BenchSettings settings = ideal_bench();
  for (const int frequency_hz : default_frequencies_hz()) {
    SimBench bench;
    ASSERT_EQ(bench.configure(settings), Status::kOk);
    const Pair seen = response(bench, frequency_hz, 0.5);
    const Complex expected = device_response(settings.device, frequency_hz) *
                             std::polar(1.0, kTurn * frequency_hz * settings.skew_s);
    const double error = std::abs(seen.device / seen.reference / expected - 1.0);
    // The first image below, relative to the drive's own line.
    const double image_hz = frequency_hz - 1.0 / kInterval_s;
    const double image =
        std::abs(frequency_hz / image_hz * shaker_response(settings.shaker, image_hz) /
                 shaker_response(settings.shaker, frequency_hz));
    EXPECT_LT(error, 3e-9 + 2.0 * image) << frequency_hz;
    EXPECT_LT(error, 1e-9 * frequency_hz) << frequency_hz;
  }
}

TEST(SimBench, WordsAreLeftJustifiedAndWithinHalfAStep) {
  constexpr Word kAdcStep = 65536;
  BenchSettings settings = ideal_bench();
  // Drive words that a 12-bit DAC has too.
  std::vector<Word> drive = cosine(1000, 2.0, 6400);
  for (Word& word : drive) {
    word -= word % (1 << 20);
  }
  SimBench ideal;
  ASSERT_EQ(ideal.configure(settings), Status::kOk);
  const std::vector<Frame> exact = run(ideal, drive);
  settings.ideal_converters = false;
  SimBench real;
  ASSERT_EQ(real.configure(settings), Status::kOk);
  const std::vector<Frame> rounded = run(real, drive);
  Word widest = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_EQ(rounded[i].reference % kAdcStep, 0);
    EXPECT_EQ(rounded[i].device % kAdcStep, 0);
    // Half a step, and the rounding of the ideal word.
    EXPECT_LE(std::abs(rounded[i].reference - exact[i].reference), kAdcStep / 2 + 1);
    EXPECT_LE(std::abs(rounded[i].device - exact[i].device), kAdcStep / 2 + 1);
    widest = std::max(widest, std::abs(rounded[i].device - exact[i].device));
  }
  EXPECT_GT(widest, kAdcStep / 4);
}

// The DAC takes the highest 12 bits: the words of one step do the same, the next one does not.
TEST(SimBench, DacHasTwelveBits) {
  constexpr Word kDacStep = 1 << 20;
  const auto settled = [](Word level) {
    BenchSettings settings = ideal_bench();
    settings.ideal_converters = false;
    settings.device.sensitivity = 1e3;
    SimBench bench;
    EXPECT_EQ(bench.configure(settings), Status::kOk);
    return run(bench, std::vector<Word>(128, level));
  };
  const auto same = [&](Word a, Word b) {
    const std::vector<Frame> left = settled(a);
    const std::vector<Frame> right = settled(b);
    return std::equal(left.begin(), left.end(), right.begin(), [](const Frame& x, const Frame& y) {
      return x.reference == y.reference && x.device == y.device;
    });
  };
  EXPECT_TRUE(same(0, kDacStep - 1));
  EXPECT_FALSE(same(kDacStep - 1, kDacStep));
  EXPECT_TRUE(same(-1, -kDacStep));
  EXPECT_FALSE(same(-1, 0));
  EXPECT_FALSE(same(-kDacStep, -kDacStep - 1));
  EXPECT_TRUE(same(7 * kDacStep + 5, 8 * kDacStep - 1));
}

TEST(SimBench, AdcClipsAtItsEnds) {
  BenchSettings settings = ideal_bench();
  settings.ideal_converters = false;
  settings.shaker.gain = 1000.0;
  SimBench bench;
  ASSERT_EQ(bench.configure(settings), Status::kOk);
  const std::vector<Frame> seen = run(bench, cosine(1000, 1.0, 6400));
  Word highest = 0;
  Word lowest = 0;
  for (const Frame& frame : seen) {
    highest = std::max({highest, frame.reference, frame.device});
    lowest = std::min({lowest, frame.reference, frame.device});
  }
  EXPECT_EQ(highest, 32767 * 65536);
  EXPECT_EQ(lowest, std::numeric_limits<Word>::min());
}

TEST(SimBench, ResponseBeginsAfterTheLatency) {
  for (const std::uint32_t latency : {0U, 1U, 37U, 64U, 127U}) {
    StreamFormat format = kBenchFormat;
    format.latency_frames = latency;
    SimBench bench(format);
    BenchSettings settings = ideal_bench();
    settings.shaker.gain = 100.0;
    ASSERT_EQ(bench.configure(settings), Status::kOk);
    constexpr std::size_t kStepAt = 101;
    std::vector<Word> drive(320, 0);
    std::fill(drive.begin() + kStepAt, drive.end(), kVolt);
    const std::vector<Frame> seen = run(bench, drive);
    for (std::size_t i = 0; i < kStepAt + latency; ++i) {
      ASSERT_EQ(seen[i].reference, 0) << latency << ' ' << i;
      ASSERT_EQ(seen[i].device, 0) << latency << ' ' << i;
    }
    EXPECT_NE(seen[kStepAt + latency].reference, 0) << latency;
  }
}

// A second start sees nothing of the run before.
TEST(SimBench, StopEmptiesThePipeline) {
  SimBench bench;
  ASSERT_EQ(bench.configure(ideal_bench()), Status::kOk);
  run(bench, cosine(1000, 1.0, 640));
  EXPECT_EQ(bench.dac().last, 0);
  EXPECT_GE(bench.dac().frames_since_nonzero, kBenchFormat.latency_frames);
  const std::uint64_t before = bench.clock_frames();
  ASSERT_EQ(bench.start(kFree), Status::kOk);
  std::array<Word, 64> zero = {};
  std::array<Frame, 64> frames = {};
  for (std::uint64_t block = 0; block < 3; ++block) {
    const hal::Exchange exchange = bench.exchange(zero, frames);
    EXPECT_EQ(exchange.status, Status::kOk);
    EXPECT_EQ(exchange.first_frame, 64 * block);
  }
  EXPECT_EQ(bench.clock_frames(), before + 192);
  EXPECT_DOUBLE_EQ(bench.now_s(), static_cast<double>(before + 192) * kInterval_s);
  bench.stop();
}

TEST(SimBench, NoiseHasItsLevelAndIsWhite) {
  BenchSettings settings = ideal_bench();
  settings.ideal_converters = false;
  settings.noise_v = 5e-3;
  SimBench bench;
  ASSERT_EQ(bench.configure(settings), Status::kOk);
  constexpr int kFrames = 64 * 6000;
  const std::vector<Frame> seen = run(bench, silence(kFrames));
  constexpr double kCount = kFrames;
  // A step of the ADC, 20 V/2^16, adds its twelfth squared.
  const double step_v = 20.0 / 65536.0;
  const double variance = 25e-6 + step_v * step_v / 12.0;
  double cross = 0.0;
  for (const Channel channel : {Channel::kReference, Channel::kDevice}) {
    double sum = 0.0;
    double square = 0.0;
    std::array<double, 21> lagged = {};
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const double x = volts(seen[i], channel);
      sum += x;
      square += x * x;
      for (std::size_t lag = 1; lag < lagged.size() && lag <= i; ++lag) {
        lagged[lag] += x * volts(seen[i - lag], channel);
      }
    }
    EXPECT_LT(std::abs(sum / kCount), 4.0 * std::sqrt(variance / kCount));
    EXPECT_NEAR(square / kCount, variance, 4.0 * variance * std::sqrt(2.0 / kCount));
    for (std::size_t lag = 1; lag < lagged.size(); ++lag) {
      EXPECT_LT(std::abs(lagged[lag] / kCount), 4.0 * variance / std::sqrt(kCount)) << lag;
    }
  }
  for (const Frame& frame : seen) {
    cross += volts(frame, Channel::kReference) * volts(frame, Channel::kDevice);
  }
  EXPECT_LT(std::abs(cross / kCount), 4.0 * variance / std::sqrt(kCount));
}

TEST(SimBench, HumHasItsLevelFrequencyAndThirdHarmonic) {
  BenchSettings settings = ideal_bench();
  settings.hum_v = 0.01;
  settings.hum_hz = 49.9;
  SimBench bench;
  ASSERT_EQ(bench.configure(settings), Status::kOk);
  constexpr int kTenSeconds = 1000000;
  const std::vector<Frame> seen = run(bench, silence(kTenSeconds));
  for (const Channel channel : {Channel::kReference, Channel::kDevice}) {
    const auto level = [&](double frequency_hz) {
      return component(seen, channel, 0, kTenSeconds, frequency_hz, bench.format());
    };
    EXPECT_NEAR(std::abs(level(49.9)), 0.01, 1e-10);
    EXPECT_NEAR(std::abs(level(149.7)), 0.01 / 3.0, 1e-10);
    EXPECT_NEAR(std::abs(level(99.8)), 0.0, 1e-10);
    EXPECT_NEAR(std::abs(level(50.0)), 0.0, 1e-10);
  }
  const auto phase = [&](Channel channel) {
    return std::arg(component(seen, channel, 0, kTenSeconds, 49.9, bench.format()));
  };
  EXPECT_GT(std::abs(phase(Channel::kReference) - phase(Channel::kDevice)), 0.01);
}

// x + 2 d2 x^2 - 4 d3 x^3 of a cosine of amplitude A: harmonics d2 A^2 and d3 A^3, and 3 d3 A^3
// missing in the first.
TEST(SimBench, DistortionHasItsHarmonics) {
  for (const double amplitude_v : {1.0, 2.0}) {
    BenchSettings settings = ideal_bench();
    settings.second_harmonic = 1e-3;
    settings.third_harmonic = 3e-4;
    SimBench bench;
    ASSERT_EQ(bench.configure(settings), Status::kOk);
    const std::vector<Frame> seen = run(bench, cosine(1000, amplitude_v, kSettling + kWindow + 64));
    const auto in_drive = [&](int harmonic) {
      const double frequency_hz = 1000.0 * harmonic;
      return std::abs(
          component(seen, Channel::kReference, kSettling, kWindow, frequency_hz, bench.format()) /
          acceleration_seen(settings.shaker, frequency_hz, kInterval_s));
    };
    const double square = amplitude_v * amplitude_v;
    EXPECT_NEAR(in_drive(1), amplitude_v * (1.0 - 9e-4 * square), 1e-8);
    EXPECT_NEAR(in_drive(2), 1e-3 * square, 1e-8);
    EXPECT_NEAR(in_drive(3), 3e-4 * square * amplitude_v, 1e-8);
    EXPECT_NEAR(in_drive(4), 0.0, 1e-8);
  }
}

TEST(SimBench, SeedDecidesAllWords) {
  const auto words = [](std::uint64_t seed) {
    BenchSettings settings;
    settings.seed = seed;
    SimBench bench;
    EXPECT_EQ(bench.configure(settings), Status::kOk);
    return run(bench, cosine(160, 0.5, 6400));
  };
  const auto equal_words = [](const std::vector<Frame>& a, const std::vector<Frame>& b) {
    int equal = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      equal += a[i].reference == b[i].reference ? 1 : 0;
      equal += a[i].device == b[i].device ? 1 : 0;
    }
    return equal;
  };
  const std::vector<Frame> first = words(1);
  EXPECT_EQ(equal_words(first, words(1)), 12800);
  // Noise of 16 steps makes equal words by chance in 1 of 60.
  EXPECT_LT(equal_words(first, words(2)), 12800 / 30);
}

// Means, standard deviations and correlations over seeds, at 4 standard deviations of each.
TEST(SimBench, DrawsHaveTheStatedSpread) {
  constexpr std::size_t kSeeds = 1000;
  constexpr std::size_t kDraws = 7;
  const BenchSettings defaults;
  std::vector<std::array<double, kDraws>> draws;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    BenchSettings settings;
    settings.seed = seed;
    settings.ratio_expanded_percent = 0.1;
    SimBench bench;
    ASSERT_EQ(bench.configure(settings), Status::kOk);
    const BenchTruth& truth = bench.truth();
    draws.push_back({(truth.reference_sensitivity / 0.1 - 1.0) / 0.0025,
                     truth.reference_drift / 0.0001,
                     (truth.gain_factor / truth.channel_ratio - 1.0) / 0.0005,
                     (truth.mounting_factor - 1.0) / 0.001, truth.reference_offset_v / 3e-3,
                     truth.device_offset_v / 3e-3, (truth.channel_ratio - 1.0) / 0.0005});
    EXPECT_EQ(truth.device.sensitivity, defaults.device.sensitivity);
  }
  constexpr double kCount = kSeeds;
  for (std::size_t i = 0; i < kDraws; ++i) {
    double mean = 0.0;
    for (const auto& row : draws) {
      mean += row[i] / kCount;
    }
    EXPECT_NEAR(mean, 0.0, 4.0 / std::sqrt(kCount)) << i;
    for (std::size_t j = 0; j <= i; ++j) {
      double covariance = 0.0;
      for (const auto& row : draws) {
        covariance += row[i] * row[j] / kCount;
      }
      const double scatter = std::sqrt((i == j ? 2.0 : 1.0) / kCount);
      EXPECT_NEAR(covariance, i == j ? 1.0 : 0.0, 4.0 * scatter) << i << ' ' << j;
    }
  }
}

// What was drawn is what the words say.
TEST(SimBench, TruthIsInTheWords) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    BenchSettings settings;
    settings.seed = seed;
    settings.ideal_converters = true;
    settings.noise_v = 0.0;
    settings.hum_v = 0.0;
    settings.drift_expanded_percent = 0.0;
    settings.reference_gain = 7.0;
    settings.device_gain = 3.0;
    SimBench bench;
    ASSERT_EQ(bench.configure(settings), Status::kOk);
    const BenchTruth& truth = bench.truth();
    const Pair seen = response(bench, 100, 0.5);
    const Complex ratio = (seen.device / 3.0) / (seen.reference / 7.0) * 0.1;
    const double expected = truth.apparent_sensitivity *
                            std::abs(device_response(truth.device, 100) / truth.device.sensitivity);
    EXPECT_NEAR(std::abs(ratio), expected, 1e-8);
    EXPECT_NEAR(
        truth.apparent_sensitivity,
        1.037 * truth.gain_factor * truth.mounting_factor * 0.1 / truth.reference_sensitivity,
        1e-15);
    EXPECT_GT(std::abs(truth.apparent_sensitivity - 1.037), 1e-6);
    SimBench silent;
    ASSERT_EQ(silent.configure(settings), Status::kOk);
    const std::vector<Frame> offsets = run(silent, silence(64));
    EXPECT_NEAR(volts(offsets[5], Channel::kReference), truth.reference_offset_v, 5e-9);
    EXPECT_NEAR(volts(offsets[5], Channel::kDevice), truth.device_offset_v, 5e-9);
  }
}

// Of a drive, a reference and a device channel with front ends the words tell the same volts.
TEST(SimBench, FrontEndScales) {
  BenchSettings settings = ideal_bench();
  SimBench plain;
  ASSERT_EQ(plain.configure(settings), Status::kOk);
  settings.front_end = {5.0, 40.0, 1.25};
  SimBench scaled;
  ASSERT_EQ(scaled.configure(settings), Status::kOk);
  const Pair volts = response(plain, 1000, 0.5);
  const Pair words = response(scaled, 1000, 1.0);  // 1 V at the pin is 0.5 V outside.
  // Words are 4.7e-9 V; the last factor makes one of them larger.
  EXPECT_LT(std::abs(words.reference * 4.0 - volts.reference), 4e-8);
  EXPECT_LT(std::abs(words.device / 8.0 - volts.device), 2e-8);
}

TEST(SimBench, RatioOfTheChannelsIsTheDevices) {
  BenchSettings settings = ideal_bench();
  SimBench plain;
  ASSERT_EQ(plain.configure(settings), Status::kOk);
  settings.ratio = 1.03;
  SimBench off;
  ASSERT_EQ(off.configure(settings), Status::kOk);
  EXPECT_EQ(off.truth().gain_factor, 1.03);
  const Pair whole = response(plain, 1000, 0.5);
  const Pair seen = response(off, 1000, 0.5);
  EXPECT_EQ(seen.reference, whole.reference);
  EXPECT_LT(std::abs(seen.device / whole.device - 1.03), 2e-8);
}

TEST(SimBench, ClockCrosstalkAndLinearityAreAsDrawn) {
  BenchSettings settings = ideal_bench();
  settings.clock_expanded_ppm = 1e4;
  settings.crosstalk_expanded_percent = 1.0;
  settings.linearity_expanded_percent = 1.0;
  for (const double full_scale_v : {0.0, 5.0}) {
    settings.front_end = {0.0, full_scale_v, full_scale_v};
    SimBench bench;
    ASSERT_EQ(bench.configure(settings), Status::kOk);
    const BenchTruth& truth = bench.truth();
    ASSERT_GT(std::abs(truth.clock_factor - 1.0), 1e-3);
    ASSERT_GT(std::abs(truth.into_device), 1e-3);
    ASSERT_GT(std::abs(truth.device_linearity), 1e-3);
    const double scale = full_scale_v > 0.0 ? full_scale_v / 10.0 : 1.0;
    const Pair words = response(bench, 4000, 1.0);
    const Pair seen = {words.reference * scale, words.device * scale};
    // Everything happens at the true frequency; a cubic error of a sine of amplitude A changes the
    // gain by the square of A over full scale.
    const double true_hz = 4000.0 * truth.clock_factor;
    const double interval_s = 1e-5 / truth.clock_factor;
    const Complex reference = acceleration_seen(settings.shaker, true_hz, interval_s);
    const Complex device =
        device_seen(settings.device, settings.shaker, true_hz, interval_s, settings.skew_s);
    const auto bent = [&](Complex clean, double linearity) {
      return clean * (1.0 + linearity * std::norm(clean / (10.0 * scale)));
    };
    const Complex expected_reference =
        bent(reference, truth.reference_linearity) + truth.into_reference * device;
    const Complex expected_device =
        bent(device, truth.device_linearity) + truth.into_device * reference;
    EXPECT_LT(std::abs(seen.reference - expected_reference), 1e-7);
    EXPECT_LT(std::abs(seen.device - expected_device), 1e-7);
  }
}

TEST(SimBench, ReferenceDriftsAndThenStays) {
  BenchSettings settings = ideal_bench();
  settings.drift_expanded_percent = 10.0;
  settings.drift_time_s = 2.0;
  SimBench bench;
  ASSERT_EQ(bench.configure(settings), Status::kOk);
  const double drift = bench.truth().reference_drift;
  ASSERT_GT(std::abs(drift), 1e-3);
  const std::vector<Frame> seen = run(bench, cosine(1000, 0.5, 300032));
  const auto level = [&](int first) {
    return std::abs(component(seen, Channel::kReference, first, 1000, 1000.0, bench.format()));
  };
  const double late = level(250000);
  // The middle of a window of 10 ms that starts at 1 s; the drift goes in steps of 64 frames.
  EXPECT_NEAR(level(100000) / late, (1.0 + 0.5025 * drift) / (1.0 + drift),
              3.2e-4 * std::abs(drift));
  EXPECT_NEAR(level(210000) / late, 1.0, 1e-9);
}

TEST(SimBench, RecordsTheDrive) {
  SimBench bench;
  ASSERT_EQ(bench.configure({}), Status::kOk);
  ASSERT_EQ(bench.start({kVolt, kVolt / 100}), Status::kOk);
  std::array<Word, 64> drive = {};
  std::array<Frame, 64> frames = {};
  for (std::size_t i = 0; i < drive.size(); ++i) {
    drive[i] = -static_cast<Word>(i) * (kVolt / 200);
  }
  ASSERT_EQ(bench.exchange(drive, frames).status, Status::kOk);
  EXPECT_EQ(bench.dac().frames, 64U);
  EXPECT_EQ(bench.dac().last, drive[63]);
  EXPECT_EQ(bench.dac().max_amplitude, static_cast<std::uint32_t>(-drive[63]));
  EXPECT_EQ(bench.dac().max_step, static_cast<std::uint32_t>(kVolt / 200));
  EXPECT_EQ(bench.dac().frames_since_nonzero, 0U);
  // 63 steps of 1/200 take 32 of 1/100, the last one half as long.
  EXPECT_EQ(bench.stop(), 32U);
  EXPECT_EQ(bench.dac().last, 0);
  EXPECT_EQ(bench.dac().max_step, static_cast<std::uint32_t>(kVolt / 100));
  EXPECT_EQ(bench.dac().frames, 64U + 32U + 37U);
  EXPECT_EQ(bench.dac().frames_since_nonzero, 1U + 37U);
}

TEST(SimBench, RampEndsInTimeFromTheEndsOfTheScale) {
  constexpr Word kMax = std::numeric_limits<Word>::max();
  for (const Word target : {kMax, -kMax}) {
    SimBench bench;
    ASSERT_EQ(bench.configure({}), Status::kOk);
    constexpr Word kStep = kMax / 256 + 1;
    ASSERT_EQ(bench.start({kMax, kStep}), Status::kOk);
    std::array<Word, 64> drive = {};
    std::array<Frame, 64> frames = {};
    Word word = 0;
    while (word != target) {
      for (Word& next : drive) {
        const std::int64_t step = target > 0 ? kStep : -kStep;
        word = static_cast<Word>(std::clamp<std::int64_t>(word + step, -kMax, kMax));
        next = word;
      }
      ASSERT_EQ(bench.exchange(drive, frames).status, Status::kOk);
    }
    EXPECT_LE(bench.stop(), kMaxRampFrames);
    EXPECT_EQ(bench.dac().last, 0);
    EXPECT_EQ(bench.dac().max_step, static_cast<std::uint32_t>(kStep));
    EXPECT_EQ(bench.dac().max_amplitude, static_cast<std::uint32_t>(kMax));
  }
}

// Steps as large as the words, whose sums do not fit in one.
TEST(SimBench, RampsAtOnceWhereThatIsPermitted) {
  for (const Word level : {kFree.amplitude, -kFree.amplitude}) {
    SimBench bench;
    ASSERT_EQ(bench.configure({}), Status::kOk);
    ASSERT_EQ(bench.start(kFree), Status::kOk);
    std::array<Word, 64> drive = {};
    std::array<Frame, 64> frames = {};
    drive.fill(level);
    ASSERT_EQ(bench.exchange(drive, frames).status, Status::kOk);
    EXPECT_EQ(bench.stop(), 1U);
    EXPECT_EQ(bench.dac().last, 0);
    EXPECT_EQ(bench.dac().max_step, static_cast<std::uint32_t>(kFree.amplitude));
  }
}

TEST(SimBench, BuiltAnewItStartsAsNew) {
  BenchSettings faulty;
  faulty.seed = 3;
  faulty.hum_hz = 61.0;
  faulty.fault = {sim::FaultKind::kSwappedChannels, 100};
  SimBench used;
  ASSERT_EQ(used.configure(faulty), Status::kOk);
  run(used, cosine(160, 2.0, 6400));
  ASSERT_EQ(used.configure({}), Status::kOk);
  SimBench fresh;
  ASSERT_EQ(fresh.configure({}), Status::kOk);
  const std::vector<Word> drive = cosine(160, 0.5, 640);
  const std::vector<Frame> expected = run(fresh, drive);
  const std::vector<Frame> seen = run(used, drive);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i].reference, expected[i].reference) << i;
    EXPECT_EQ(seen[i].device, expected[i].device) << i;
  }
}

TEST(SimBench, NeedsParts) {
  SimBench bench;
  EXPECT_EQ(bench.start(kFree), Status::kHardwareFault);
  EXPECT_EQ(bench.clock_frames(), 0U);
  EXPECT_EQ(bench.now_s(), 0.0);
  ASSERT_EQ(bench.configure({}), Status::kOk);
  ASSERT_EQ(bench.start(kFree), Status::kOk);
  EXPECT_EQ(bench.configure({}), Status::kAlreadyRunning);
  bench.stop();
  EXPECT_GT(bench.clock_frames(), 0U);
  EXPECT_EQ(bench.configure({}), Status::kOk);
  EXPECT_EQ(bench.clock_frames(), 0U);
  EXPECT_EQ(bench.dac().frames, 0U);
}

TEST(SimBench, RefusesBadSettingsAndKeepsTheOldOnes) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  SimBench bench;
  BenchSettings good;
  good.seed = 77;
  ASSERT_EQ(bench.configure(good), Status::kOk);
  const BenchTruth truth = bench.truth();
  using Change = std::function<void(BenchSettings&, double)>;
  const std::vector<Change> positive = {
      [](BenchSettings& s, double x) { s.reference_sensitivity = x; },
      [](BenchSettings& s, double x) { s.drift_time_s = x; },
      [](BenchSettings& s, double x) { s.reference_gain = x; },
      [](BenchSettings& s, double x) { s.device_gain = x; },
      [](BenchSettings& s, double x) { s.device.natural_frequency_hz = x; },
      [](BenchSettings& s, double x) { s.shaker.suspension_damping = x; },
  };
  const std::vector<Change> not_negative = {
      [](BenchSettings& s, double x) { s.second_harmonic = x; },
      [](BenchSettings& s, double x) { s.third_harmonic = x; },
      [](BenchSettings& s, double x) { s.reference_expanded_percent = x; },
      [](BenchSettings& s, double x) { s.drift_expanded_percent = x; },
      [](BenchSettings& s, double x) { s.gain_expanded_percent = x; },
      [](BenchSettings& s, double x) { s.ratio_expanded_percent = x; },
      [](BenchSettings& s, double x) { s.mounting_expanded_percent = x; },
      [](BenchSettings& s, double x) { s.noise_v = x; },
      [](BenchSettings& s, double x) { s.offset_v = x; },
      [](BenchSettings& s, double x) { s.hum_v = x; },
      [](BenchSettings& s, double x) { s.hum_hz = x; },
  };
  const auto answer = [&bench](const Change& change, double x) {
    BenchSettings settings;
    change(settings, x);
    return bench.configure(settings);
  };
  for (const double bad : {kNan, kInfinity, -kInfinity, -1.0}) {
    for (std::size_t i = 0; i < positive.size(); ++i) {
      EXPECT_EQ(answer(positive[i], bad), Status::kInvalidArgument) << i << ' ' << bad;
    }
    for (std::size_t i = 0; i < not_negative.size(); ++i) {
      EXPECT_EQ(answer(not_negative[i], bad), Status::kInvalidArgument) << i << ' ' << bad;
    }
  }
  for (std::size_t i = 0; i < positive.size(); ++i) {
    EXPECT_EQ(answer(positive[i], 0.0), Status::kInvalidArgument) << i;
  }
  EXPECT_EQ(answer([](BenchSettings& s, double x) { s.skew_s = x; }, 6e-6),
            Status::kInvalidArgument);
  EXPECT_EQ(answer([](BenchSettings& s, double x) { s.hum_hz = x; }, 50001.0),
            Status::kInvalidArgument);
  EXPECT_EQ(bench.settings().seed, 77U);
  EXPECT_EQ(bench.truth().reference_sensitivity, truth.reference_sensitivity);
  for (const Change& change : not_negative) {
    SimBench fresh;
    BenchSettings settings;
    change(settings, 0.0);
    EXPECT_EQ(fresh.configure(settings), Status::kOk);
  }
}

TEST(SimBench, RefusesBadFormats) {
  const auto answer = [](const StreamFormat& format) {
    SimBench bench(format);
    return bench.configure({});
  };
  EXPECT_EQ(answer({1e5, 10.0, 10.0, 64, 127}), Status::kOk);
  EXPECT_EQ(answer({1e5, 10.0, 10.0, 1, 0}), Status::kOk);
  EXPECT_EQ(answer({0.0, 10.0, 10.0, 64, 37}), Status::kInvalidArgument);
  EXPECT_EQ(answer({1e5, 0.0, 10.0, 64, 37}), Status::kInvalidArgument);
  EXPECT_EQ(answer({1e5, 10.0, 0.0, 64, 37}), Status::kInvalidArgument);
  EXPECT_EQ(answer({1e5, 10.0, 10.0, 0, 37}), Status::kInvalidArgument);
  EXPECT_EQ(answer({1e5, 10.0, 10.0, 65, 37}), Status::kInvalidArgument);
  EXPECT_EQ(answer({1e5, 10.0, 10.0, 64, 128}), Status::kInvalidArgument);
}

// A wire: what goes out comes in, word for word, and the device's input sees it later. The shaker
// does not move.
TEST(SimBench, LoopBackFeedsTheDriveToBothInputs) {
  BenchSettings settings;
  settings.noise_v = 0.0;
  settings.offset_v = 0.0;
  settings.hum_v = 0.0;
  settings.gain_expanded_percent = 0.0;
  settings.mounting_expanded_percent = 0.0;
  settings.skew_s = 2.5e-6;  // A quarter of an interval.
  settings.ideal_converters = true;
  SimBench bench;
  ASSERT_EQ(bench.configure(settings), Status::kOk);
  EXPECT_TRUE(bench.loop_back(true));
  ASSERT_EQ(bench.start({1 << 30, 1 << 24}), Status::kOk);
  EXPECT_FALSE(bench.loop_back(false)) << "while it runs";
  constexpr double kStep = 0.02;  // rad per frame.
  constexpr std::size_t kBlock = kBenchFormat.block_frames;
  std::array<Word, kBlock> words = {};
  std::array<Frame, kBlock> frames = {};
  const auto drive = [](double frame) { return 1e8 * std::sin(kStep * frame); };
  for (std::uint64_t first = 0; first < 10 * kBlock; first += kBlock) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      words[i] = static_cast<Word>(drive(static_cast<double>(first + i)));
    }
    ASSERT_EQ(bench.exchange(Span<const Word>(words), Span<Frame>(frames)).status, Status::kOk);
    for (std::size_t i = 0; i < kBlock && first > 0; ++i) {
      const double sent = static_cast<double>(first + i) - kBenchFormat.latency_frames;
      EXPECT_NEAR(frames[i].reference, drive(sent), 2.0);
      EXPECT_NEAR(frames[i].device, drive(sent + 0.25), 10.0) << "0.006 (0.02)^4 of 1e8, and bits";
    }
  }
  EXPECT_EQ(bench.peak_mps2(), 0.0);
  (void)bench.stop();
  EXPECT_TRUE(bench.loop_back(false));
}

}  // namespace
}  // namespace emax::test
