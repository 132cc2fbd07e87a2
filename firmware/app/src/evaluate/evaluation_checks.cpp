// The checks of an evaluation and their sentences.
#include "evaluation_checks.hpp"

#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"
#include "emax/energy/grid_workspace.hpp"
#include "emax/uncertainty/energy_trials.hpp"

namespace emax::app {
namespace {

// Beyond these a^2 E would leave the range in which its squares are finite.
constexpr double kMinSensitivity = 1e-30;
constexpr double kMaxSensitivity = 1e30;

constexpr char kWrongSetting[] =
    "A setting is outside its range; give a value inside the stated range.";
constexpr char kWrongSensitivity[] =
    "The sensitivity is outside 1e-30 to 1e30 V/(m/s^2); check its unit.";
constexpr char kWrongDevice[] =
    "The sensitivity must be above 0, the natural frequency from 1e-3 to 1e9 Hz and the damping "
    "from 1e-4 to below 1; check the parameters and their units.";
constexpr char kWrongUncertainty[] = "An uncertainty is below 0 or not a number; give 0 or more.";
constexpr char kBoxTooLarge[] =
    "The ranges of the parameters, estimate -u to +u, leave what a "
    "device may be (S and f0 above 0, damping from 1e-4 to below 1); give smaller uncertainties.";
constexpr char kNormalTooWide[] =
    "Draws of the parameters leave what a device may be (S and f0 above 0, damping from 1e-4 to "
    "below 1) 65 times in a row, or the covariance is none; give smaller uncertainties.";
constexpr char kOverdamped[] =
    "The damping is 1 or more; devices with a resonance are supported, with a damping from 1e-4 to "
    "below 1.";
constexpr char kOnlySensitivity[] =
    "The points determine the sensitivity alone: they lie so far below the resonance that f0 and "
    "the damping may be anything; measure nearer to it.";
constexpr char kTooManyCellsBest[] =
    "The grid of 12 cells per period of the resonance (or of the cutoff, if that is higher) needs "
    "more than " EMAX_TEXT_OF(EMAX_MAX_CELLS) " cells for this time; shorten it.";
constexpr char kTooManyCellsPaper[] =
    "The grid of the paper's step needs more than " EMAX_TEXT_OF(EMAX_MAX_CELLS) " cells for this time; shorten it or take a "
    "longer step.";
constexpr char kTooManyCellsTrials[] =
    "The trials of the paper's method have no room for so many cells; shorten the time, take a "
    "longer step, or give no uncertainties.";
constexpr char kTooManySwitches[] =
    "The best signal changes sign more than " EMAX_TEXT_OF(EMAX_MAX_SWITCHES) " times, more than the table holds; shorten the "
    "time.";
constexpr char kLostInTime[] =
    "Within so short a T both outputs are so small that rounding hides their energies; take a "
    "longer time.";
constexpr char kNoDevice[] =
    "There is no accepted device to go on with; start with points or parameters.";
constexpr char kOtherSettings[] =
    "A setting of the energy itself has changed; start again for a new energy.";
constexpr char kTrialsFailed[] =
    "The energies of the trials cannot be summed up; check the units of the parameters.";

/// Whether all parameters moved by `side` times their uncertainties are still a device.
bool is_side_valid(const Device& device, double side) noexcept {
  const Accelerometer end = {
      device.estimate.sensitivity + side * device.u.sensitivity,
      device.estimate.natural_frequency_hz + side * device.u.natural_frequency_hz,
      device.estimate.damping + side * device.u.damping};
  return validate(end) == Status::kOk;
}

// False for a value that is not a number, too.
bool is_uncertainty(double u) noexcept { return u >= 0.0 && is_finite(u); }

Failure check_box(const EvaluationResults& results, const Settings& settings, Goal goal) noexcept {
  const ParameterBox& box = results.device.u;
  for (const double u : {box.sensitivity, box.natural_frequency_hz, box.damping}) {
    if (!is_uncertainty(u)) {
      return {Status::kInvalidArgument, Stage::kIdle, kWrongUncertainty};
    }
  }
  // Normal draws that are no device are drawn again.
  const bool is_box = settings.distribution == Distribution::kBox;
  const double widest = results.trial_scale(settings);
  for (const double side : {-widest, widest}) {
    if (wants_trials(goal) && is_box && !is_side_valid(results.device, side)) {
      return failure_of_width(Status::kInvalidArgument, settings.distribution);
    }
  }
  return {};
}

/// Whether the grids of the energy and of each time of the trend have room.
Failure check_grids(const EvaluationResults& results, const Settings& settings,
                    Goal goal) noexcept {
  const bool is_paper = settings.method == Method::kPaper;
  const std::size_t times = 1 + (wants_trend(goal) ? settings.trend_count : 0);
  for (std::size_t i = 0; i < times; ++i) {
    const bool is_energy = i == 0;
    const double duration_s = is_energy ? settings.duration_s : settings.trend_s[i - 1];
    const std::size_t cells = search_cells(results.model, search_settings(settings, duration_s));
    if (cells > kMaxCells && (is_energy || !adapts_trend(settings))) {
      return failure_of_search(Status::kTooManyCells, settings,
                               is_energy ? Stage::kEnergy : Stage::kTrend, duration_s, 0.0);
    }
    if (is_energy && is_paper && wants_trials(goal) && results.has_uncertainty() &&
        cells > GridWorkspace::kMaxTrialCells) {
      return {Status::kTooManyCells, Stage::kMonteCarlo, kTooManyCellsTrials, duration_s};
    }
  }
  return {};
}

}  // namespace

Failure check_settings(const Settings& settings) noexcept {
  if (check(settings).setting != nullptr) {
    return {Status::kInvalidArgument, Stage::kIdle, kWrongSetting};
  }
  return {};
}

Failure check_device(const Accelerometer& device) noexcept {
  const Status status = validate(device);
  if (status != Status::kOk) {
    return {status, Stage::kIdle, status == Status::kOverdamped ? kOverdamped : kWrongDevice};
  }
  if (device.sensitivity < kMinSensitivity || device.sensitivity > kMaxSensitivity) {
    return {Status::kInvalidArgument, Stage::kIdle, kWrongSensitivity};
  }
  return {};
}

Failure check_pursuit(const EvaluationResults& results, const Settings& settings) noexcept {
  if (!results.is_accepted) {
    return {Status::kInvalidArgument, Stage::kIdle, kNoDevice};
  }
  const Failure failure = check_settings(settings);
  if (failure.status == Status::kOk && !results.holds_energy_of(settings)) {
    return {Status::kInvalidArgument, Stage::kIdle, kOtherSettings};
  }
  return failure;
}

Failure check_goal(const EvaluationResults& results, const Settings& settings, Goal goal) noexcept {
  const Failure failure = check_box(results, settings, goal);
  if (failure.status != Status::kOk || goal == Goal::kModel) {
    return failure;
  }
  return check_grids(results, settings, goal);
}

Failure failure_of_fit(Status status) noexcept {
  return {status, Stage::kFitDraws, status == Status::kOverdamped ? kOverdamped : explain(status)};
}

Failure failure_of_sensitivity_alone() noexcept {
  return {Status::kNotIdentifiable, Stage::kFitDraws, kOnlySensitivity};
}

Failure failure_of_width(Status status, Distribution distribution) noexcept {
  return {status, Stage::kMonteCarlo,
          distribution == Distribution::kBox ? kBoxTooLarge : kNormalTooWide};
}

Failure failure_of_trials(Status status, Stage stage, bool is_exhausted) noexcept {
  return {status, stage, is_exhausted ? kNormalTooWide : kTrialsFailed};
}

Failure failure_of_search(Status status, const Settings& settings, Stage stage, double duration_s,
                          double settling_s) noexcept {
  const char* reason = explain(status);
  if (status == Status::kTooManyCells) {
    reason = settings.method == Method::kPaper ? kTooManyCellsPaper : kTooManyCellsBest;
  }
  // Unlike an error, a difference of energies is not hidden by the outputs that cancel.
  if (status == Status::kLostDigits && settings.criterion == Criterion::kEnergyDifference &&
      duration_s < kMuchShorter * settling_s) {
    reason = kLostInTime;
  }
  if (status == Status::kTooManySwitches) {
    reason = kTooManySwitches;
  }
  return {status, stage, reason, duration_s};
}

Failure failure_of_model(Status status, const Settings& settings) noexcept {
  const bool has_no_gain = settings.criterion == Criterion::kInBandError &&
                           settings.gain_mode == GainMode::kFixed && settings.gain == 0.0;
  return {status, Stage::kIdle, has_no_gain ? kNoGain : explain(status)};
}

ReferenceFilter reference_filter(const EvaluationResults& results) noexcept {
  const Settings& settings = results.settings;
  const bool gain_is_given = settings.gain_mode == GainMode::kFixed;
  return butterworth({settings.filter_order, settings.cutoff_hz,
                      gain_is_given ? settings.gain : results.device.estimate.sensitivity});
}

ReferenceDelay delay_of(const Settings& settings) noexcept {
  switch (settings.delay_choice) {
    case DelayChoice::kAuto:
      return {DelayMode::kOfSensor, 0.0};
    case DelayChoice::kGiven:
      return {DelayMode::kGiven, settings.delay_s};
    case DelayChoice::kNone:
      break;
  }
  return {DelayMode::kNone, 0.0};
}

ErrorMeasure measure_of(const Settings& settings) noexcept {
  const bool is_in_band = settings.criterion == Criterion::kInBandError;
  return {settings.criterion,
          is_in_band ? delay_of(settings) : ReferenceDelay{DelayMode::kNone, 0.0}};
}

bool needs_trials(Goal goal, const Settings& settings) noexcept {
  return wants_trials(goal) || (goal == Goal::kUncertainty && settings.adaptive);
}

bool adapts_trend(const Settings& settings) noexcept {
  return is_same_trend(settings, kDefaultSettings);
}

SearchSettings search_settings(const Settings& settings, double duration_s) noexcept {
  return {settings.method, duration_s, settings.step_s, settings.iterations};
}

}  // namespace emax::app
