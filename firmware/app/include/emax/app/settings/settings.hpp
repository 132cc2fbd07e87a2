// What the user sets before an evaluation, and the defaults of the instrument.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/settings/settings_error.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/uncertainty/energy_trials.hpp"

namespace emax::app {

inline constexpr std::size_t kMaxTrendPoints = 16;
inline constexpr std::uint32_t kMaxTrials = 1'000'000'000;
inline constexpr double kMaxDuration_s = 1000.0;
/// Limits of a and of the filter's gain, far from where their squares would overflow.
inline constexpr double kMinLimit_mps2 = 1e-9;
inline constexpr double kMaxLimit_mps2 = 1e9;
inline constexpr double kMaxGain = 1e9;

enum class GainMode : std::uint8_t {
  kAuto,   ///< The estimate of S, the same in every trial.
  kFixed,  ///< The number given.
  kTrack,  ///< The S of each trial.
};

/// What delay the in-band errors allow the sensor.
enum class DelayChoice : std::uint8_t {
  kAuto,  ///< Its own at low frequency.
  kNone,
  kGiven,  ///< A number.
};

/// Everything but the device. `Settings{}` is all zero, which `check()` refuses.
struct Settings {
  int filter_order = 0;
  double cutoff_hz = 0.0;
  GainMode gain_mode = GainMode::kAuto;
  double gain = 0.0;           ///< In V/(m/s^2); used by GainMode::kFixed only.
  double duration_s = 0.0;     ///< T.
  bool limit_is_auto = false;  ///< a is the number of S, as in the paper.
  double limit_mps2 = 0.0;     ///< a; used if `limit_is_auto` is false.
  Criterion criterion = Criterion::kIntegralSquareError;
  DelayChoice delay_choice = DelayChoice::kAuto;  ///< Of the reference of in-band errors.
  double delay_s = 0.0;                           ///< Used by DelayChoice::kGiven only.
  Method method = Method::kBest;
  double step_s = 0.0;           ///< The paper's quantization step; Method::kPaper only.
  std::uint32_t iterations = 0;  ///< The paper's J; Method::kPaper only.
  std::uint32_t trials = 0;
  bool adaptive = false;  ///< JCGM 101 7.9 finds the number of trials; `trials` is then unused.
  double probability = 0.0;
  Distribution distribution = Distribution::kBox;
  bool birge = false;  ///< Trials take the uncertainties times the fit's Birge ratio, if above 1.
  std::array<std::uint32_t, 4> seed = {};
  Generator generator = Generator::k2006;
  std::array<double, kMaxTrendPoints> trend_s = {};
  std::size_t trend_count = 0;  ///< 0 for no trend, else 2 or more.
  /// Of points that are handed over: expanded, common to all of them and within their U(A).
  double common_percent = 0.0;
};

static_assert(std::is_trivially_copyable_v<Settings>);

/// What the instrument starts with, and *RST sets: the paper's filter, signal and trend.
constexpr Settings default_settings() noexcept {
  Settings settings;
  settings.filter_order = 10;
  settings.cutoff_hz = 1000.0;
  settings.duration_s = 0.002;
  settings.limit_is_auto = true;
  settings.step_s = 2e-6;
  settings.iterations = 30;
  settings.trials = 200000;
  settings.probability = 0.95;
  settings.seed = {123456789, 345678901, 567890123, 789012345};
  settings.trend_s = {0.002, 0.004, 0.006, 0.008, 0.010};
  settings.trend_count = 5;
  return settings;
}
inline constexpr Settings kDefaultSettings = default_settings();

/// Checks each setting against its range, and those that limit one another.
///
/// @returns The first that is wrong, in the order of `Settings`; nulls if there is none. What only
/// the device decides, such as the number of cells that T takes, is left to the evaluation.
SettingsError check(const Settings& settings) noexcept;

/// @returns Whether what depends on the settings is the same for both: model, limit and energy.
bool is_same_energy(const Settings& a, const Settings& b) noexcept;
/// The random numbers: those of the trials and of the draws of the fit.
bool is_same_random(const Settings& a, const Settings& b) noexcept;
/// The trials of the same energy, with their random numbers.
bool is_same_trials(const Settings& a, const Settings& b) noexcept;
/// The times of the trend.
bool is_same_trend(const Settings& a, const Settings& b) noexcept;

}  // namespace emax::app
