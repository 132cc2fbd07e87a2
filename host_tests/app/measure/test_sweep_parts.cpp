// The parts of a sweep by themselves: drive, silence, monitors, budget.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "emax/app/measure/channel_monitor.hpp"
#include "emax/app/measure/drive_oscillator.hpp"
#include "emax/app/measure/silence_record.hpp"
#include "emax/app/measure/sweep_budget.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/sim/noise.hpp"

namespace {

using emax::Complex;
using emax::Span;
using emax::app::BudgetInputs;
using emax::app::ChannelMonitor;
using emax::app::ChannelNoise;
using emax::app::DriveOscillator;
using emax::app::PointScatter;
using emax::app::PointVerdict;
using emax::app::Repeats;
using emax::app::SilenceRecord;
using emax::app::SilentChannel;
using emax::hal::Frame;
using emax::hal::StreamFormat;
using emax::hal::Word;

constexpr double kPi = 3.14159265358979323846;
constexpr StreamFormat kFormat = {100000.0, 10.0, 10.0, 64, 37};
constexpr double kWordsPerVolt = 2147483648.0 / 10.0;

std::vector<double> volts_of(DriveOscillator& drive, std::size_t frames, std::size_t block = 64) {
  std::vector<Word> words(frames);
  for (std::size_t i = 0; i < frames; i += block) {
    drive.fill(Span<Word>(words.data() + i, std::min(block, frames - i)));
  }
  std::vector<double> volts;
  for (const Word word : words) {
    volts.push_back(static_cast<double>(word) / kWordsPerVolt);
  }
  return volts;
}

TEST(DriveOscillator, IsSilentThenASine) {
  DriveOscillator drive;
  drive.configure(kFormat, 5.0, 1e5);
  for (const double v : volts_of(drive, 100)) {
    EXPECT_EQ(v, 0.0);
  }
  const std::uint32_t frames = drive.go_to(1000.0, 2.0);
  EXPECT_GE(frames, 256U);
  (void)volts_of(drive, frames);
  const std::vector<double> steady = volts_of(drive, 100000);
  // The phase begins at the first frame of the ramp. The nearest word is half a word off at most,
  // on either side of zero; the rotation is good to 1e-13, and the sine that is expected here, too.
  constexpr double kHalfWord_v = 0.501 / kWordsPerVolt;
  for (std::size_t i = 0; i < steady.size(); ++i) {
    const double turns = std::fmod(static_cast<double>(frames + i) * 0.01, 1.0);
    ASSERT_NEAR(steady[i], 2.0 * std::sin(2.0 * kPi * turns), kHalfWord_v) << i;
  }
}

TEST(DriveOscillator, BlocksDoNotMatter) {
  DriveOscillator one;
  one.configure(kFormat, 5.0, 1e5);
  DriveOscillator other = one;
  for (const auto& [frequency_hz, amplitude_v] :
       {std::pair{30.0, 1.0}, {5000.0, 0.3}, {5000.0, 1.5}, {160.0, 0.0}}) {
    const std::uint32_t frames = one.go_to(frequency_hz, amplitude_v);
    ASSERT_EQ(other.go_to(frequency_hz, amplitude_v), frames);
    const std::vector<double> a = volts_of(one, frames + 200, 64);
    const std::vector<double> b = volts_of(other, frames + 200, 7);
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_NEAR(a[i], b[i], 1e-8);
    }
  }
}

TEST(DriveOscillator, KeepsAmplitudeSlopeAndPhase) {
  const double slew_per_frame = 0.25;
  DriveOscillator drive;
  drive.configure(kFormat, 5.0, slew_per_frame * 1e5);
  emax::sim::Noise noise;
  noise.seed(3);
  double last = 0.0;
  double largest = 0.0;
  double steepest = 0.0;
  double ceiling = 0.0;
  for (int move = 0; move < 300; ++move) {
    const double frequency_hz = 20.0 + static_cast<double>(noise.bits() % 12000);
    const double most = drive.max_amplitude_v(frequency_hz);
    ceiling = std::max(ceiling, most);
    const double amplitude = most * static_cast<double>(noise.bits() % 5) / 4.0;
    const std::uint32_t frames = drive.go_to(frequency_hz, amplitude);
    // Now and then the next move comes before the ramp has ended.
    const std::size_t taken = move % 7 == 0 ? frames / 2 : frames + 50;
    for (const double v : volts_of(drive, taken)) {
      largest = std::max(largest, std::fabs(v));
      steepest = std::max(steepest, std::fabs(v - last));
      last = v;
    }
  }
  EXPECT_LE(largest, 5.0);
  EXPECT_GT(largest, 0.9 * ceiling);
  EXPECT_LE(steepest, slew_per_frame);
  EXPECT_GT(steepest, 0.85 * slew_per_frame);  // It uses what it may.
}

TEST(SilenceRecord, FindsOffsetNoiseAndHum) {
  SilenceRecord record;
  record.start(kFormat, {10.0, 10.0, 10.0});
  emax::sim::Noise noise;
  noise.seed(5);
  std::array<Frame, 50> frames = {};
  std::uint32_t frame = 0;
  while (frame < record.frames()) {
    for (std::size_t i = 0; i < frames.size(); ++i, ++frame) {
      const double t = static_cast<double>(frame) / 1e5;
      const auto z = noise.pair();
      const double reference_v = 0.5 + 1e-3 * z.first + 4e-3 * std::sin(2 * kPi * 50 * t + 1.0) +
                                 2e-3 * std::cos(2 * kPi * 150 * t);
      const double device_v = -0.25 + 2e-3 * z.second + 1e-3 * std::sin(2 * kPi * 60 * t) + 5.0 * t;
      frames[i] = {static_cast<Word>(reference_v * kWordsPerVolt),
                   static_cast<Word>(device_v * kWordsPerVolt)};
    }
    const std::size_t count = std::min<std::size_t>(50, record.frames() - frame + 50);
    record.add(Span<const Frame>(frames).first(count));
  }
  const SilentChannel r = record.reference();
  // 20 000 samples: 1e-3/sqrt(20000) = 7e-6; a standard deviation to 0.5 %.
  EXPECT_NEAR(r.offset_v, 0.5, 4e-5);
  EXPECT_NEAR(r.noise_v, 1e-3, 2e-5);
  EXPECT_NEAR(r.hum_v[0], 4e-3, 5e-5);
  EXPECT_NEAR(r.hum_v[2], 2e-3, 5e-5);
  EXPECT_LT(r.hum_v[3], 6e-5);
  EXPECT_NEAR(r.drift_v, 0.0, 1e-4);
  // At its own frequency all of it, 10 Hz off over 0.1 s one part in pi.
  EXPECT_NEAR(r.hum_in_fit_v(50.0, 0.1), 4e-3 / std::sqrt(2.0), 1e-4);
  EXPECT_NEAR(r.hum_in_fit_v(40.0, 0.1), 4e-3 / std::sqrt(2.0) / kPi, 6e-5);
  EXPECT_NEAR(record.device().drift_v, 0.5, 1e-3);
}

TEST(SilenceRecord, EmptyGivesZeros) {
  SilenceRecord record;
  record.start({200.0, 10.0, 10.0, 64, 0},
               {10.0, 10.0, 10.0});  // Most lines are beyond half of it.
  EXPECT_EQ(record.reference().noise_v, 0.0);
  EXPECT_EQ(record.device().hum_v[5], 0.0);
}

TEST(ChannelMonitor, CountsFullScaleAndEqualWords) {
  ChannelMonitor monitor;
  EXPECT_EQ(monitor.step(), 0.0);
  for (const Word word : {0x7FFF0000, -2147483647 - 1, 0x7FF00000, -0x7FF00000}) {
    monitor.add(word);
  }
  EXPECT_EQ(monitor.full_scale_words(), 4U);
  EXPECT_EQ(monitor.equal_words(), 0U);
  monitor.clear_full_scale();
  monitor.add(0x7FEF0000);
  EXPECT_EQ(monitor.full_scale_words(), 0U);
  for (int i = 0; i < 10; ++i) {
    monitor.add(0x00030000);
  }
  EXPECT_EQ(monitor.equal_words(), 9U);
  EXPECT_EQ(monitor.step(), 65536.0 / 2147483648.0);
  monitor.add(0x00040000);
  EXPECT_EQ(monitor.equal_words(), 0U);
}

// Repeats with given noise of the channels and a common part that cancels in the ratio.
Repeats repeats_of(emax::sim::Noise& noise, double reference_v, double device_v, double samples,
                   double sigma_reference, double sigma_device, double common) {
  Repeats repeats;
  repeats.count = 5;
  const double share = std::sqrt(2.0 / samples);
  for (std::uint32_t k = 0; k < repeats.count; ++k) {
    const auto c = noise.pair();
    const auto r = noise.pair();
    const auto a = noise.pair();
    const Complex together = {1.0 + common * c.first, common * c.second};
    repeats.reference[k] = reference_v * together + Complex{sigma_reference * share * r.first,
                                                            sigma_reference * share * r.second};
    repeats.device[k] = Complex{0.0, device_v} * together +
                        Complex{sigma_device * share * a.first, sigma_device * share * a.second};
  }
  return repeats;
}

TEST(SweepBudget, PooledNoiseLeavesOutWhatBothChannelsShare) {
  emax::sim::Noise noise;
  noise.seed(11);
  std::vector<PointScatter> scatter;
  std::vector<double> frequency_hz;
  for (int i = 0; i < 1000; ++i) {
    const double samples = i % 2 == 0 ? 1000.0 : 5000.0;
    PointScatter p =
        emax::app::scatter_of(repeats_of(noise, 1.0, 0.5 + 0.002 * i, samples, 5e-3, 2e-3, 5e-5));
    p.repeat_samples = samples;
    scatter.push_back(p);
    frequency_hz.push_back(1000.0);
  }
  BudgetInputs inputs;
  inputs.sample_rate_hz = 1e5;
  inputs.silent_reference.noise_v = 5e-3;
  inputs.silent_device.noise_v = 2e-3;
  const ChannelNoise pooled =
      emax::app::pooled_noise(Span<const PointScatter>(scatter.data(), scatter.size()),
                              Span<const double>(frequency_hz.data(), frequency_hz.size()), inputs);
  // 8000 degrees of freedom give a standard deviation to 0.8 %; the common part adds 4 % for the
  // device, whose own scatter is below it: with it the device would come out 1.6 times too large.
  EXPECT_EQ(pooled.dof, 8000U);
  EXPECT_NEAR(pooled.reference_v / 5e-3, 1.0, 0.04);
  EXPECT_NEAR(pooled.device_v / 2e-3, 1.0, 0.15);
}

TEST(SweepBudget, UncertaintyIsThatOfTheFit) {
  emax::sim::Noise noise;
  noise.seed(12);
  PointScatter p = emax::app::scatter_of(repeats_of(noise, 2.0, 1.0, 1000.0, 5e-3, 2e-3, 0.0));
  p.repeat_samples = 1000.0;
  BudgetInputs inputs;
  inputs.sample_rate_hz = 1e5;
  const ChannelNoise known = {5e-3, 2e-3, 300};
  PointVerdict verdict = emax::app::point_verdict(p, 1000.0, known, inputs);
  const double expected = std::sqrt(2.0 / 5000.0) * std::hypot(5e-3 / 2.0, 2e-3 / 1.0);
  EXPECT_FALSE(verdict.scatters);
  EXPECT_NEAR(verdict.relative_u / expected, 1.0, 0.01);  // The phasors scatter a little.
  EXPECT_EQ(verdict.budget.quantisation, 0.0);            // Ideal converters.

  // Hum at the frequency: half of its square on each component.
  inputs.silent_device.hum_v[0] = 1e-3;
  verdict = emax::app::point_verdict(p, 50.0, known, inputs);
  EXPECT_NEAR(verdict.budget.hum, 1e-3 / std::sqrt(2.0), 1e-5);
  EXPECT_NEAR(verdict.relative_u / std::hypot(expected, 1e-3 / std::sqrt(2.0)), 1.0, 0.01);

  // A point that scatters three times as much as the others speaks for itself.
  PointScatter wild = emax::app::scatter_of(repeats_of(noise, 2.0, 1.0, 1000.0, 15e-3, 6e-3, 0.0));
  wild.repeat_samples = 1000.0;
  verdict = emax::app::point_verdict(wild, 1000.0, known, inputs);
  EXPECT_TRUE(verdict.scatters);
  EXPECT_GT(verdict.relative_u, 1.5 * expected);

  // Without noise, a drive of 100 frames is rounded alike in every period and every repeat.
  inputs = BudgetInputs();
  inputs.sample_rate_hz = 1e5;
  inputs.device_step_v = 0.1;
  const ChannelNoise none = {0.0, 0.1 / std::sqrt(12.0), 300};
  verdict = emax::app::point_verdict(p, 1000.0, none, inputs);
  const double rounding = 0.1 / std::sqrt(12.0);
  EXPECT_NEAR(verdict.budget.quantisation, std::sqrt(2.0 / 100.0) * rounding, 1e-5);
  EXPECT_NEAR(verdict.budget.noise, std::sqrt(2.0 / 5000.0) * rounding, 1e-5);
  EXPECT_NEAR(verdict.relative_u, std::hypot(verdict.budget.noise, verdict.budget.quantisation),
              1e-15);
  // Noise of half a step leaves exp(-pi^2/2) of it.
  const ChannelNoise half = {0.0, std::hypot(rounding, 0.05), 300};
  verdict = emax::app::point_verdict(p, 1000.0, half, inputs);
  EXPECT_NEAR(verdict.budget.quantisation, std::sqrt(2.0 / 100.0) * rounding * 0.0071919, 1e-6);
}

TEST(SweepBudget, OneInAThousandScattersByChance) {
  emax::sim::Noise noise;
  noise.seed(13);
  const ChannelNoise known = {5e-3, 2e-3, 300};
  BudgetInputs inputs;
  inputs.sample_rate_hz = 1e5;
  int count = 0;
  for (int i = 0; i < 100000; ++i) {
    PointScatter p = emax::app::scatter_of(repeats_of(noise, 2.0, 1.0, 1000.0, 5e-3, 2e-3, 1e-4));
    p.repeat_samples = 1000.0;
    count += emax::app::point_verdict(p, 1000.0, known, inputs).scatters;
  }
  // 100 expected, standard deviation 10; Wilson and Hilferty's quantile is good to a few per cent.
  EXPECT_GT(count, 55);
  EXPECT_LT(count, 145);
}

TEST(SweepBudget, CommonPart) {
  emax::app::SweepSettings settings = emax::app::default_sweep_settings();
  const emax::app::CommonBudget common = emax::app::common_budget(settings, -3e-3);
  EXPECT_NEAR(common.reference, 0.0025, 1e-15);
  EXPECT_NEAR(common.gain, 0.0005, 1e-15);
  EXPECT_NEAR(common.mounting, 0.001, 1e-15);
  EXPECT_NEAR(common.drift, 3e-3 / std::sqrt(3.0), 1e-12);
  // 0.3, 0.4 and 1.2 percent are 1.3 percent together, expanded.
  emax::app::SweepSettings gains = settings;
  gains.reference_gain_expanded_percent = 0.3;
  gains.device_gain_expanded_percent = 0.4;
  gains.ratio_expanded_percent = 1.2;
  EXPECT_NEAR(emax::app::common_budget(gains, 0.0).gain, 0.0065, 1e-15);
  EXPECT_NEAR(common.total, std::sqrt(0.0025 * 0.0025 + 0.0005 * 0.0005 + 0.001 * 0.001 + 3e-6),
              1e-12);
}

}  // namespace
