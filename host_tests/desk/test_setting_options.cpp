// The options of settings: their values arrive, and the defaults in the help are those of the
// settings.
#include <gtest/gtest.h>
#include <string>
#include <string_view>
#include <vector>

#include "emax/app/settings/settings_rows.hpp"
#include "emax/app/settings/sweep_settings_rows.hpp"

#include "desk/cli/option_table.hpp"
#include "desk/cli/setting_options.hpp"
#include "desk/cli/value_text.hpp"

namespace {

using emax::app::default_sweep_settings;
using emax::app::GainMode;
using emax::app::kDefaultSettings;
using emax::app::Settings;
using emax::app::SweepSettings;
using emax::desk::find_option;
using emax::desk::Option;
using emax::desk::report_options;
using emax::desk::ReportOptions;
using emax::desk::shortest_text;

bool take(const std::vector<Option>& options, std::string_view name, std::string_view text) {
  return find_option(options, name)->take(text);
}

// Taken by the option itself, the text of a default leads from nothing to the default.
TEST(SettingOptions, DefaultsInTheHelpAreThoseOfTheSettings) {
  ReportOptions options;
  options.settings = {};
  options.sweep = {};
  // Said in words.
  options.sweep.frequency_hz = default_sweep_settings().frequency_hz;
  options.sweep.frequency_count = default_sweep_settings().frequency_count;
  std::size_t defaults = 0;
  for (const Option& option : report_options(options)) {
    if (!option.by_default.empty() && option.name != "frequencies") {
      EXPECT_TRUE(option.take(option.by_default)) << option.name;
      ++defaults;
    }
  }
  EXPECT_GE(defaults, 20U);
  for (const emax::app::SettingField& field : fields_of(options.settings)) {
    EXPECT_TRUE(is_same(field, &options.settings, &kDefaultSettings)) << field.name;
  }
  const SweepSettings sweep = default_sweep_settings();
  for (const emax::app::SettingRow& row : emax::app::kSweepSettingRows) {
    if (row.option.name != nullptr) {
      EXPECT_TRUE(is_same(row.field, &options.sweep, &sweep)) << row.field.name;
    }
  }
}

TEST(SettingOptions, EachKindOfValueArrives) {
  Settings settings = kDefaultSettings;
  const std::vector<Option> options = emax::desk::setting_options(settings);
  EXPECT_TRUE(take(options, "cutoff", "1.5e3"));
  EXPECT_EQ(settings.cutoff_hz, 1500.0);
  EXPECT_TRUE(take(options, "order", "4"));
  EXPECT_EQ(settings.filter_order, 4);
  EXPECT_FALSE(take(options, "order", "4.5"));
  EXPECT_EQ(settings.filter_order, 4);
  EXPECT_TRUE(take(options, "adaptive", ""));
  EXPECT_TRUE(settings.adaptive);
  EXPECT_TRUE(take(options, "method", "paper"));
  EXPECT_EQ(settings.method, emax::Method::kPaper);
  EXPECT_TRUE(take(options, "generator", "1982"));
  EXPECT_EQ(settings.generator, emax::Generator::k1982);
  EXPECT_FALSE(take(options, "generator", "WH2006"));
}

TEST(SettingOptions, ANumberOrAWord) {
  Settings settings = kDefaultSettings;
  const std::vector<Option> options = emax::desk::setting_options(settings);
  EXPECT_TRUE(take(options, "gain", "track"));
  EXPECT_EQ(settings.gain_mode, GainMode::kTrack);
  EXPECT_TRUE(take(options, "gain", "2"));
  EXPECT_EQ(settings.gain_mode, GainMode::kFixed);
  EXPECT_EQ(settings.gain, 2.0);
  EXPECT_TRUE(take(options, "gain", "auto"));
  EXPECT_EQ(settings.gain_mode, GainMode::kAuto);
  EXPECT_FALSE(take(options, "gain", "NUMBER"));
  EXPECT_TRUE(take(options, "limit", "9.81"));
  EXPECT_FALSE(settings.limit_is_auto);
  EXPECT_EQ(settings.limit_mps2, 9.81);
  EXPECT_TRUE(take(options, "limit", "auto"));
  EXPECT_TRUE(settings.limit_is_auto);
  EXPECT_FALSE(take(options, "limit", "track"));
}

TEST(SettingOptions, ErrorsOfSettingsLeadToTheirOptions) {
  EXPECT_EQ(emax::desk::option_of_setting("settling time"), "settle");
  EXPECT_EQ(emax::desk::option_of_setting("acceleration limit"), "acceleration-limit");
  EXPECT_EQ(emax::desk::option_of_setting("limit"), "limit");
  EXPECT_EQ(emax::desk::option_of_setting("repeats"), "repeats");
  EXPECT_EQ(emax::desk::option_of_setting("reference gain uncertainty"), "reference-gain");
  EXPECT_EQ(emax::desk::option_of_setting("skew uncertainty"), "correction-skew");
}

TEST(SettingOptions, AValueAndItsUncertainty) {
  SweepSettings sweep = default_sweep_settings();
  const std::vector<Option> options = emax::desk::sweep_setting_options(sweep);
  EXPECT_TRUE(take(options, "correction-ratio", "1.03,0.02"));
  EXPECT_EQ(sweep.ratio_correction, 1.03);
  EXPECT_EQ(sweep.ratio_expanded_percent, 0.02);
  EXPECT_TRUE(take(options, "correction-ratio", "1.04"));
  EXPECT_EQ(sweep.ratio_correction, 1.04);
  EXPECT_EQ(sweep.ratio_expanded_percent, 0.02);
  EXPECT_FALSE(take(options, "correction-ratio", "1.04,0.1,0.2"));
  EXPECT_FALSE(take(options, "correction-ratio", ""));
  EXPECT_EQ(sweep.ratio_correction, 1.04);
}

TEST(SettingOptions, ListsOfTheBench) {
  ReportOptions options;
  const std::vector<Option> all = report_options(options);
  EXPECT_TRUE(take(all, "frequencies", "100,200,400.5"));
  EXPECT_EQ(options.sweep.frequency_count, 3U);
  EXPECT_EQ(options.sweep.frequency_hz[2], 400.5);
  EXPECT_TRUE(take(all, "reference-table", "10,0.1,1000,0.2"));
  EXPECT_EQ(options.sweep.reference.count, 2U);
  EXPECT_EQ(options.sweep.reference.frequency_hz[1], 1000.0);
  EXPECT_EQ(options.sweep.reference.sensitivity[1], 0.2);
  EXPECT_FALSE(take(all, "reference-table", "10,0.1,1000"));
  EXPECT_FALSE(take(all, "reference-table", "10,0.1"));
  EXPECT_TRUE(take(all, "reference-sensitivity", "0.25"));
  EXPECT_EQ(options.sweep.reference.count, 1U);
  EXPECT_EQ(options.sweep.reference.sensitivity[0], 0.25);
}

TEST(ShortestText, IsWhatOneWouldWrite) {
  EXPECT_EQ(shortest_text(0.0), "0");
  EXPECT_EQ(shortest_text(200000.0), "200000");
  EXPECT_EQ(shortest_text(0.002), "0.002");
  EXPECT_EQ(shortest_text(2e-6), "2e-6");
  EXPECT_EQ(shortest_text(-1.25e-6), "-1.25e-6");
  EXPECT_EQ(shortest_text(1e300), "1e+300");
}

}  // namespace
