// All settings at random: *LRN? sets them again, and so do *RCL and *RCL after power off.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "emax/app/settings/setting_field.hpp"
#include "emax/app/settings/settings_rows.hpp"
#include "emax/app/settings/sweep_settings_rows.hpp"

#include "support/instrument_bench.hpp"

namespace emax {
namespace {

using app::SettingField;
using app::SettingKind;
using app::Settings;
using app::SweepSettings;
using test::InstrumentBench;

/// SplitMix64.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
  std::size_t below(std::size_t end) { return static_cast<std::size_t>(bits() % end); }
  /// From 0 to below 1.
  double share() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  double within(double low, double high) { return with_digits(low + (high - low) * share()); }
  double log_within(double low, double high) {
    return with_digits(low * std::pow(high / low, share()));
  }

 private:
  // A PC takes a message with all digits of all numbers; on a board a dozen of each must do.
  static double with_digits(double value) {
    if (kMaxPoints > 64) {
      return value;
    }
    char text[32];
    (void)std::snprintf(text, sizeof text, "%.12g", value);
    return std::strtod(text, nullptr);
  }

  std::uint64_t state_;
};

/// Ascending numbers in these limits.
template <typename Array>
void draw_list(Dice& dice, std::size_t count, double low, double high, Array& list) {
  list = {};
  for (std::size_t i = 0; i < count; ++i) {
    list[i] = dice.within(low, high);
  }
  std::sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count));
}

std::size_t draw_count(Dice& dice, std::size_t least, std::size_t most) {
  return dice.below(4) == 0 ? most : least + dice.below(std::min<std::size_t>(most - least, 20));
}

Settings draw_evaluation(Dice& dice) {
  Settings s = app::kDefaultSettings;
  s.filter_order = 1 + static_cast<int>(dice.below(9));
  s.cutoff_hz = dice.log_within(1.0, 1e5);
  s.gain_mode = static_cast<app::GainMode>(1 + dice.below(2));
  s.gain = s.gain_mode == app::GainMode::kFixed ? dice.log_within(1e-3, 1e3) : 0.0;
  s.duration_s = dice.log_within(1e-6, 900.0);
  s.limit_is_auto = false;
  s.limit_mps2 = dice.log_within(1e-3, 1e3);
  s.criterion = static_cast<Criterion>(1 + dice.below(2));
  s.delay_choice = app::DelayChoice::kGiven;
  s.delay_s = dice.log_within(1e-9, 10.0);
  s.method = Method::kPaper;
  s.step_s = s.duration_s * dice.within(1e-3, 1.0);
  s.iterations = 31 + static_cast<std::uint32_t>(dice.below(900));
  s.trials = 1000 + static_cast<std::uint32_t>(dice.below(190000));
  s.adaptive = dice.below(2) == 0;
  s.probability = s.adaptive ? dice.within(1e-4, 0.9999) : dice.within(1e-3, 0.999);
  s.distribution = Distribution::kNormal;
  s.birge = true;
  s.generator = dice.below(2) == 0 ? Generator::k2006 : Generator::k1982;
  for (std::uint32_t& part : s.seed) {
    const std::uint64_t most = s.generator == Generator::k2006 ? 2147483000U : 4294967295U;
    part = 1 + static_cast<std::uint32_t>(dice.bits() % most);
  }
  s.trend_count = draw_count(dice, 2, app::kMaxTrendPoints);
  draw_list(dice, s.trend_count, s.step_s, 1000.0, s.trend_s);
  s.common_percent = dice.within(0.01, 50.0);
  return s;
}

SweepSettings draw_sweep(Dice& dice, const SweepSettings& by_default) {
  SweepSettings s = by_default;
  s.frequency_count = draw_count(dice, 3, kMaxPoints);
  draw_list(dice, s.frequency_count, 0.1, 39999.0, s.frequency_hz);
  s.level_mps2 = dice.log_within(1e-6, 1e6);
  s.acceleration_limit_mps2 = s.level_mps2 * dice.within(1.01, 10.0);
  s.drive_full_scale_v = dice.log_within(1e-3, 1e4);
  s.drive_limit_v = s.drive_full_scale_v * dice.within(0.01, 1.0);
  s.slew_v_per_s = s.drive_limit_v * dice.log_within(400.0, 4000.0);
  s.settle_s = dice.within(0.02, 10.0);
  s.cycles = 4 + static_cast<std::uint32_t>(dice.below(900));
  s.repeats = 6 + static_cast<std::uint32_t>(dice.below(10));
  s.reference.count = draw_count(dice, 1, app::kMaxReferencePoints);
  draw_list(dice, s.reference.count, 1.0, 1e4, s.reference.frequency_hz);
  if (s.reference.count == 1) {
    s.reference.frequency_hz[0] = 0.0;
  }
  for (std::size_t i = 0; i < s.reference.count; ++i) {
    s.reference.sensitivity[i] = dice.log_within(1e-4, 1e2);
  }
  double* const percents[] = {&s.reference.expanded_percent,   &s.reference_gain_expanded_percent,
                              &s.device_gain_expanded_percent, &s.ratio_expanded_percent,
                              &s.mounting_expanded_percent,    &s.crosstalk_expanded_percent,
                              &s.linearity_expanded_percent};
  for (double* const percent : percents) {
    *percent = dice.within(0.01, 50.0);
  }
  s.reference_gain = dice.log_within(1e-3, 1e3);
  s.device_gain = dice.log_within(1e-3, 1e3);
  s.ratio_correction = dice.within(0.1, 10.0);
  s.skew_s = dice.within(-1e-3, 1e-3);
  s.skew_expanded_s = dice.within(1e-9, 1e-3);
  s.clock_expanded_ppm = dice.within(0.01, 1e4);
  s.check_hz = dice.within(0.1, 39999.0);
  s.expected_sensitivity = dice.log_within(1e-4, 1e2);
  s.reference_full_scale_v = dice.log_within(1e-3, 1e4);
  s.device_full_scale_v = dice.log_within(1e-3, 1e4);
  return s;
}

/// Another state of all settings; fails where it is not one there can be.
void draw_state(InstrumentBench& i, Dice& dice) {
  const Settings settings = draw_evaluation(dice);
  const SweepSettings sweep = draw_sweep(dice, i.sweep);
  ASSERT_EQ(check(settings).setting, nullptr);
  const app::SettingsError wrong = check(sweep, i.bench.format());
  ASSERT_EQ(wrong.setting, nullptr) << wrong.setting << ": " << wrong.expectation;
  ASSERT_FALSE(i.instrument->take(settings));
  ASSERT_FALSE(i.instrument->take(sweep));
}

template <typename AnySettings>
void expect_same(const AnySettings& now, const AnySettings& before) {
  for (const SettingField& field : fields_of(now)) {
    EXPECT_TRUE(is_same(field, &now, &before)) << field.name;
  }
}

// No console sets the least duration of a repeat; the rest must be off its default, or the test
// would not see that it is lost.
TEST(InstrumentLearn, EachSettingIsDrawnOffItsDefault) {
  InstrumentBench i;
  Dice dice(1);
  const Settings settings = draw_evaluation(dice);
  const SweepSettings sweep = draw_sweep(dice, i.sweep);
  for (const SettingField& field : fields_of(settings)) {
    const bool is_free = field.kind == SettingKind::kSwitch || field.kind == SettingKind::kChoice;
    EXPECT_TRUE(is_free || !is_same(field, &settings, &app::kDefaultSettings)) << field.name;
  }
  for (const SettingField& field : fields_of(sweep)) {
    const bool is_drawn = std::string(field.name) != "repeat duration";
    EXPECT_EQ(!is_same(field, &sweep, &i.sweep), is_drawn) << field.name;
  }
}

TEST(InstrumentLearn, AnswerSetsEverythingFromAnyState) {
  Dice dice(20261129);
  std::size_t longest = 0;
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    InstrumentBench i;
    ASSERT_NO_FATAL_FAILURE(draw_state(i, dice));
    const Settings settings = i.instrument->settings();
    const SweepSettings sweep = i.instrument->sweep_settings();
    const std::string learned = i.ask("*LRN?");
    longest = std::max(longest, learned.size());
    i.switch_on();
    if (round % 2 == 1) {
      ASSERT_NO_FATAL_FAILURE(draw_state(i, dice));
    }
    EXPECT_EQ(i.ask(learned), "");
    ASSERT_EQ(i.errors(), "");
    EXPECT_EQ(i.ask("*LRN?"), learned);
    expect_same(i.instrument->settings(), settings);
    expect_same(i.instrument->sweep_settings(), sweep);
  }
  EXPECT_LE(longest, app::scpi::InputBuffer::kCapacity) << "it must fit into one message";
}

TEST(InstrumentLearn, SlotsKeepEverythingOverPowerOff) {
  Dice dice(488);
  for (int round = 0; round < 20; ++round) {
    SCOPED_TRACE(round);
    InstrumentBench i;
    ASSERT_NO_FATAL_FAILURE(draw_state(i, dice));
    const std::string learned = i.ask("*LRN?");
    const Settings settings = i.instrument->settings();
    const SweepSettings sweep = i.instrument->sweep_settings();
    EXPECT_EQ(i.ask("*SAV 2"), "");
    ASSERT_NO_FATAL_FAILURE(draw_state(i, dice));
    EXPECT_EQ(i.ask("*RCL 2;*LRN?"), learned);
    i.switch_on();
    EXPECT_EQ(i.ask("*RCL 2;*LRN?"), learned);
    EXPECT_EQ(i.errors(), "");
    expect_same(i.instrument->settings(), settings);
    expect_same(i.instrument->sweep_settings(), sweep);
  }
}

// The uncertainties of points at hand stay what they are in all, by *RCL as by the command.
TEST(InstrumentLearn, RecalledCommonPartIsThatOfThePoints) {
  InstrumentBench i;
  const std::string points = "TRAC:FRES:DATA 100,2,-1,0.02,1,200,2,-2,0.02,1";
  EXPECT_EQ(i.ask("CALC:REF:UNC 0.6;*SAV 0;:CALC:REF:UNC 2;*SAV 1;*RST"), "");
  EXPECT_EQ(i.ask(points), "");
  EXPECT_EQ(i.ask("*RCL 0;:CALC:REF:UNC?"), "6.0E-1");
  EXPECT_NEAR(i.instrument->sequencer().points().points()[0].u_amplitude, 0.008, 1e-15);
  EXPECT_EQ(i.ask("*RCL 1;:CALC:REF:UNC?"), "6.0E-1") << "as large as U(A) in all";
  EXPECT_EQ(i.errors(), "-222,\"Data out of range;a point has a smaller U(A)\"\n");
}

// With the points of a sweep at hand the setting waits for others; telling it again is no error.
TEST(InstrumentLearn, AnswerCanBeSentBackBesideTheSweepsPoints) {
  InstrumentBench i;
  EXPECT_EQ(i.ask("CALC:REF:UNC 0.6;:INIT;*OPC?"), "1");
  const std::string learned = i.ask("*LRN?");
  EXPECT_NE(learned.find(":CALC:REF:UNC 6.0E-1;"), std::string::npos) << learned;
  EXPECT_EQ(i.ask(learned), "");
  EXPECT_EQ(i.errors(), "");
  EXPECT_EQ(i.ask("*LRN?"), learned);
}

// IEEE 488.2, 8.4.1: answers of one message are separated by a semicolon.
TEST(InstrumentLearn, AnswerIsSeparatedFromThoseBesideIt) {
  InstrumentBench i;
  const std::string learned = i.ask("*LRN?");
  EXPECT_EQ(i.ask("*OPC?;*LRN?"), "1;" + learned);
  EXPECT_EQ(i.ask("*IDN?;*LRN?;*OPC?"), i.ask("*IDN?") + ";" + learned + ";1");
  EXPECT_EQ(i.ask("*LRN?;*LRN?"), learned + ";" + learned);
}

}  // namespace
}  // namespace emax
