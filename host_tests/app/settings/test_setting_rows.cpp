// The rows of the settings: complete, in order, and what each of them says holds for its member.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <set>
#include <string>

#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/settings_rows.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/app/settings/sweep_settings_rows.hpp"

namespace {

using emax::Criterion;
using emax::Distribution;
using emax::Generator;
using emax::Method;
using emax::app::default_sweep_settings;
using emax::app::fields_of;
using emax::app::GainMode;
using emax::app::is_in_range;
using emax::app::is_same;
using emax::app::kDefaultSettings;
using emax::app::kSettingRows;
using emax::app::kSweepSettingRows;
using emax::app::SettingField;
using emax::app::SettingRow;
using emax::app::Settings;
using emax::app::SweepSettings;

const SettingField& field(const char* name) {
  return fields_of(kDefaultSettings)[emax::app::row_of(kSettingRows, name)];
}

TEST(SettingRows, EmptySettingsAreAllZeroAndRefused) {
  static const Settings settings;
  static const SweepSettings sweep;
  const auto is_zero = [](const void* begin, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(begin);
    return std::count(bytes, bytes + size, 0) == static_cast<std::ptrdiff_t>(size);
  };
  EXPECT_TRUE(is_zero(&settings, sizeof(settings)));
  EXPECT_TRUE(is_zero(&sweep, sizeof(sweep)));
  EXPECT_STREQ(emax::app::check(settings).setting, "order");
  const emax::hal::StreamFormat format = {100000.0, 10.0, 10.0, 64, 0};
  EXPECT_STREQ(emax::app::check(sweep, format).setting, "sweep frequencies");
  EXPECT_EQ(emax::app::check(default_sweep_settings(), format).setting, nullptr);
}

template <std::size_t kRows>
void expect_ordered(const SettingRow (&rows)[kRows]) {
  std::set<std::string> names;
  std::set<std::string> headers;
  std::set<std::string> options;
  std::size_t named = 0;
  std::size_t optional = 0;
  std::size_t end = 0;
  for (const SettingRow& row : rows) {
    names.insert(row.field.name);
    if (row.command.header != nullptr) {
      headers.insert(row.command.header);
      ++named;
    }
    if (row.option.name != nullptr) {
      options.insert(row.option.name);
      ++optional;
    }
    // Saved bytes and checks go in the order of the members.
    EXPECT_GE(row.field.offset, end) << row.field.name;
    end = row.field.offset + 1U;
  }
  EXPECT_EQ(names.size(), kRows);
  EXPECT_EQ(headers.size(), named);
  EXPECT_EQ(options.size(), optional);
}

TEST(SettingRows, AreInTheOrderOfTheMembersAndHaveNamesOfTheirOwn) {
  expect_ordered(kSettingRows);
  expect_ordered(kSweepSettingRows);
}

// The console must not take what the check refuses for its range alone.
TEST(SettingRows, TheConsoleIsNoWiderThanTheCheck) {
  const auto expect = [](const SettingRow& row) {
    if (row.command.header != nullptr) {
      EXPECT_GE(row.command.min, row.field.min) << row.field.name;
      EXPECT_LE(row.command.max, row.field.max) << row.field.name;
    }
  };
  for (const SettingRow& row : kSettingRows) {
    expect(row);
  }
  for (const SettingRow& row : kSweepSettingRows) {
    expect(row);
  }
}

TEST(SettingField, ANumberThatAWordStandsForHasNoRange) {
  Settings settings = kDefaultSettings;
  settings.gain = -1.0;
  EXPECT_TRUE(is_in_range(field("gain"), &settings));
  settings.gain_mode = GainMode::kTrack;
  EXPECT_TRUE(is_in_range(field("gain"), &settings));
  settings.gain_mode = GainMode::kFixed;
  EXPECT_FALSE(is_in_range(field("gain"), &settings));
  settings.gain = 1e9;
  EXPECT_TRUE(is_in_range(field("gain"), &settings));
}

TEST(SettingField, SameMeansTheSameValueInUse) {
  const Settings before = kDefaultSettings;
  Settings after = before;
  EXPECT_TRUE(is_same(field("limit"), &before, &after));
  after.limit_mps2 = 3.0;
  EXPECT_TRUE(is_same(field("limit"), &before, &after)) << "a is the number of S";
  after.limit_is_auto = false;
  EXPECT_FALSE(is_same(field("limit"), &before, &after));
  Settings other = after;
  EXPECT_TRUE(is_same(field("limit"), &other, &after));
  other.limit_mps2 = 4.0;
  EXPECT_FALSE(is_same(field("limit"), &other, &after));

  after.trend_s[5] = 1.0;
  EXPECT_TRUE(is_same(field("trend"), &before, &after)) << "behind its end";
  after.trend_s[4] = 1.0;
  EXPECT_FALSE(is_same(field("trend"), &before, &after));
  after = before;
  after.trend_count = 4;
  EXPECT_FALSE(is_same(field("trend"), &before, &after));
  after.seed[3] = 1;
  EXPECT_FALSE(is_same(field("seed"), &before, &after));
  EXPECT_TRUE(is_same(field("order"), &before, &after));
  after.filter_order = 9;
  EXPECT_FALSE(is_same(field("order"), &before, &after));
}

// Memory that is damaged may say so; nothing behind the end of a list is read.
TEST(SettingField, AListLongerThanItsRoomIsTheSameAsNone) {
  Settings settings = kDefaultSettings;
  const SettingField& trend = field("trend");
  settings.trend_count = trend.last;
  EXPECT_TRUE(is_same(trend, &settings, &settings));
  settings.trend_count = trend.last + 1;
  EXPECT_FALSE(is_same(trend, &settings, &settings));
}

TEST(SweepSettings, ListsLongerThanTheirRoomAreRefused) {
  const emax::hal::StreamFormat format = {1e5, 10.0, 10.0, 64, 37};
  SweepSettings settings = default_sweep_settings();
  ASSERT_EQ(check(settings, format).setting, nullptr);
  settings.frequency_count = emax::kMaxPoints + 1;
  EXPECT_STREQ(check(settings, format).setting, "sweep frequencies");
  settings = default_sweep_settings();
  settings.reference.count = emax::app::kMaxReferencePoints + 1;
  EXPECT_STREQ(check(settings, format).setting, "reference table");
}

/// A change, and whether energy, random numbers, trials and trend are the same after it.
struct Effect {
  const char* what;
  void (*change)(Settings& settings);
  bool energy;
  bool random;
  bool trials;
  bool trend;
};

constexpr Effect kEffects[] = {
    {"nothing", [](Settings&) {}, true, true, true, true},
    {"order", [](Settings& s) { s.filter_order = 4; }, false, true, true, true},
    {"cutoff", [](Settings& s) { s.cutoff_hz = 900.0; }, false, true, true, true},
    {"gain mode", [](Settings& s) { s.gain_mode = GainMode::kTrack; }, false, true, true, true},
    {"gain, unused", [](Settings& s) { s.gain = 2.0; }, true, true, true, true},
    {"time", [](Settings& s) { s.duration_s = 0.003; }, false, true, true, true},
    {"limit, unused", [](Settings& s) { s.limit_mps2 = 2.0; }, true, true, true, true},
    {"limit", [](Settings& s) { s.limit_is_auto = false; }, false, true, true, true},
    {"criterion", [](Settings& s) { s.criterion = Criterion::kEnergyDifference; }, false, true,
     true, true},
    {"method", [](Settings& s) { s.method = Method::kPaper; }, false, true, true, true},
    {"step, unused", [](Settings& s) { s.step_s = 1e-6; }, true, true, true, true},
    {"iterations, unused", [](Settings& s) { s.iterations = 3; }, true, true, true, true},
    {"trials", [](Settings& s) { s.trials = 5000; }, true, true, false, true},
    {"adaptive", [](Settings& s) { s.adaptive = true; }, true, true, false, true},
    {"probability", [](Settings& s) { s.probability = 0.9; }, true, true, false, true},
    {"distribution", [](Settings& s) { s.distribution = Distribution::kNormal; }, true, true, false,
     true},
    {"birge", [](Settings& s) { s.birge = true; }, true, true, false, true},
    {"seed", [](Settings& s) { s.seed[0] = 1; }, true, false, false, true},
    {"generator", [](Settings& s) { s.generator = Generator::k1982; }, true, false, false, true},
    {"trend", [](Settings& s) { s.trend_count = 2; }, true, true, true, false},
};

TEST(Settings, WhatDependsOnEach) {
  for (const Effect& effect : kEffects) {
    Settings after = kDefaultSettings;
    effect.change(after);
    const auto expect = [&](const Settings& a, const Settings& b) {
      EXPECT_EQ(is_same_energy(a, b), effect.energy) << effect.what;
      EXPECT_EQ(is_same_random(a, b), effect.random) << effect.what;
      EXPECT_EQ(is_same_trials(a, b), effect.trials) << effect.what;
      EXPECT_EQ(is_same_trend(a, b), effect.trend) << effect.what;
    };
    expect(kDefaultSettings, after);
    expect(after, kDefaultSettings);
  }
}

TEST(Settings, WhatDependsOnTheMethodAndOnTheNumberOfTrials) {
  Settings paper = kDefaultSettings;
  paper.method = Method::kPaper;
  Settings after = paper;
  after.step_s = 1e-6;
  EXPECT_FALSE(is_same_energy(paper, after));
  after = paper;
  after.iterations = 3;
  EXPECT_FALSE(is_same_energy(paper, after));
  Settings adaptive = kDefaultSettings;
  adaptive.adaptive = true;
  after = adaptive;
  after.trials = 5000;
  EXPECT_TRUE(is_same_trials(adaptive, after));
}

}  // namespace
