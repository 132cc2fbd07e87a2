// The range of each setting, in numbers and in words.
#include "emax/app/settings/settings.hpp"

#include "emax/base/elementary.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/model/butterworth.hpp"
#include "emax/uncertainty/monte_carlo.hpp"

namespace emax::app {
namespace {

// 100 blocks of 100/(1 - p) trials, the most that the adaptive procedure takes, are then
// kMaxTrials.
constexpr double kMaxAdaptiveProbability = 0.99999;
constexpr std::uint32_t kAdaptiveBlock = 10000;
constexpr std::uint32_t kModuli[] = {2147483579, 2147483543, 2147483423, 2147483123};

// False for a value that is not a number, too.
constexpr bool is_within(double value, double low, double high) noexcept {
  return value >= low && value <= high;
}

constexpr bool is_duration(double value_s) noexcept {
  return value_s > 0.0 && value_s <= kMaxDuration_s;
}

SettingsError check_filter(const Settings& settings) noexcept {
  if (settings.filter_order < 1 || settings.filter_order > kMaxFilterOrder) {
    return {"order", "a whole number from 1 to 15"};
  }
  if (!is_within(settings.cutoff_hz, kMinFrequency_hz, kMaxFrequency_hz)) {
    return {"cutoff", "from 0.001 to 1e9 Hz"};
  }
  if (settings.gain_mode == GainMode::kFixed && !is_within(settings.gain, 0.0, kMaxGain)) {
    return {"gain", "'auto', 'track', or from 0 to 1e9 V/(m/s^2)"};
  }
  return {};
}

SettingsError check_signal(const Settings& settings) noexcept {
  if (!is_duration(settings.duration_s)) {
    return {"time", "more than 0 and at most 1000 s"};
  }
  if (!settings.limit_is_auto && !is_within(settings.limit_mps2, kMinLimit_mps2, kMaxLimit_mps2)) {
    return {"limit", "from 1e-9 to 1e9 m/s^2"};
  }
  return {};
}

SettingsError check_paper(const Settings& settings) noexcept {
  if (!is_duration(settings.step_s)) {
    return {"step", "more than 0 and at most 1000 s"};
  }
  if (settings.method == Method::kPaper && settings.step_s > settings.duration_s) {
    return {"step", "at most the time T"};
  }
  if (settings.iterations < 1 || settings.iterations > kMaxIterations) {
    return {"iterations", "a whole number from 1 to 1000"};
  }
  return {};
}

SettingsError check_trials(const Settings& settings) noexcept {
  if (settings.trials < kMinTrials || settings.trials > kMaxTrials) {
    return {"trials", "a whole number from 1000 to 1000000000"};
  }
  const double p = settings.probability;
  if (!(p > 0.0) || !(p < 1.0)) {
    return {"probability", "more than 0 and less than 1"};
  }
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

}  // namespace

SettingsError check(const Settings& settings) noexcept {
  using Check = SettingsError (*)(const Settings&) noexcept;
  constexpr Check kChecks[] = {check_filter, check_signal, check_paper,
                               check_trials, check_seed,   check_trend};
  for (const Check one : kChecks) {
    const SettingsError error = one(settings);
    if (error.setting != nullptr) {
      return error;
    }
  }
  return {};
}

}  // namespace emax::app
