// Checks and comparisons of the settings of an evaluation: ranges by the rows, here what limits one
// another.
#include "emax/app/settings/settings.hpp"

#include "emax/app/settings/settings_rows.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

// 100 blocks of 100/(1 - p) trials, the most that the adaptive procedure takes, are then
// kMaxTrials.
constexpr double kMaxAdaptiveProbability = 0.99999;
constexpr std::uint32_t kAdaptiveBlock = 10000;
constexpr std::uint32_t kModuli[] = {2147483579, 2147483543, 2147483423, 2147483123};

constexpr bool is_duration(double value_s) noexcept {
  return value_s > 0.0 && value_s <= kMaxDuration_s;
}

SettingsError check_step(const Settings& settings) noexcept {
  if (settings.method == Method::kPaper && settings.step_s > settings.duration_s) {
    return {"step", "at most the time T"};
  }
  return {};
}

SettingsError check_probability(const Settings& settings) noexcept {
  const double p = settings.probability;
  if (settings.adaptive && p > kMaxAdaptiveProbability) {
    return {"probability", "at most 0.99999 where the number of trials is adaptive"};
  }
  const double trials = settings.adaptive ? kAdaptiveBlock : settings.trials;
  const double share = floor(p * trials + 0.5);
  if (share < 1.0) {
    return {"probability", "larger, so that its share of the trials is at least one of them"};
  }
  if (!settings.adaptive && share >= trials) {
    return {"trials", "more: with so few, an interval of that probability would hold them all"};
  }
  return {};
}

SettingsError check_seed(const Settings& settings) noexcept {
  const bool is_2006 = settings.generator == Generator::k2006;
  for (std::size_t i = 0; i < settings.seed.size(); ++i) {
    if (settings.seed[i] == 0 || (is_2006 && settings.seed[i] >= kModuli[i])) {
      return {"seed", is_2006 ? "four whole numbers from 1 to 2147483578, 2147483542, 2147483422 "
                                "and 2147483122"
                              : "whole numbers from 1 to 4294967295"};
    }
  }
  return {};
}

SettingsError check_trend(const Settings& settings) noexcept {
  constexpr SettingsError kWrong = {"trend",
                                    "2 to 16 times in s, each more than the one before, more than "
                                    "0 and at most 1000 s"};
  const std::size_t count = settings.trend_count;
  if (count == 0) {
    return {};
  }
  if (count < 2 || count > kMaxTrendPoints) {
    return kWrong;
  }
  double before_s = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = settings.trend_s[i];
    if (!is_duration(time_s) || !(time_s > before_s)) {
      return kWrong;
    }
    if (settings.method == Method::kPaper && settings.step_s > time_s) {
      return {"trend", "times that are at least as long as the step"};
    }
    before_s = time_s;
  }
  return {};
}

constexpr std::size_t row(const char* name) noexcept { return row_of(kSettingRows, name); }

/// What comes behind the range of a row.
SettingsError own_check(std::size_t index, const Settings& settings) noexcept {
  switch (index) {
    case row("step"):
      return check_step(settings);
    case row("probability"):
      return check_probability(settings);
    case row("seed"):
      return check_seed(settings);
    case row("trend"):
      return check_trend(settings);
    default:
      return {};
  }
}

using Concerns = std::uint32_t;
constexpr Concerns bit(Concern concern) noexcept {
  return Concerns{1} << static_cast<unsigned>(concern);
}

/// Whether all that these concerns depend on is the same.
bool is_same(const Settings& a, const Settings& b, Concerns concerns) noexcept {
  for (const SettingField& field : fields_of(a)) {
    if ((concerns & bit(field.concern)) != 0 && !is_same(field, &a, &b)) {
      return false;
    }
  }
  return true;
}

}  // namespace

SettingsError check(const Settings& settings) noexcept {
  const Span<const SettingField> fields = fields_of(settings);
  for (std::size_t index = 0; index < fields.size(); ++index) {
    if (!is_in_range(fields[index], &settings)) {
      return {fields[index].name, fields[index].expectation};
    }
    const SettingsError error = own_check(index, settings);
    if (error.setting != nullptr) {
      return error;
    }
  }
  return {};
}

bool is_same_energy(const Settings& a, const Settings& b) noexcept {
  const Concerns paper = a.method == Method::kPaper ? bit(Concern::kPaper) : 0;
  return is_same(a, b, bit(Concern::kEnergy) | paper);
}

bool is_same_random(const Settings& a, const Settings& b) noexcept {
  return is_same(a, b, bit(Concern::kRandom));
}

bool is_same_trials(const Settings& a, const Settings& b) noexcept {
  const Concerns count = a.adaptive ? 0 : bit(Concern::kTrialCount);
  return is_same(a, b, bit(Concern::kRandom) | bit(Concern::kTrials) | count);
}

bool is_same_trend(const Settings& a, const Settings& b) noexcept {
  return is_same(a, b, bit(Concern::kTrend));
}

}  // namespace emax::app
