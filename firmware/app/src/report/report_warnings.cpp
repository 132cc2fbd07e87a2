// When a warning is due, and its line.
#include "emax/app/report/report_warnings.hpp"

#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/energy/grid_workspace.hpp"

namespace emax::app {
namespace {

constexpr std::uint32_t kOnePercent = 100;
// Switching times that a signal by half periods may need; its ends may take a few more.
constexpr double kStorable = static_cast<double>(kMaxSwitches) - 8.0;

bool fit_warns(const EvaluationResults& results) noexcept {
  const WlspFit& fit = results.fit.result();
  return results.source == Source::kPoints &&
         fit.chi2 / static_cast<double>(fit.dof) > reduced_chi_square_limit(fit.dof);
}

bool has_few_trials(const EvaluationResults& results) noexcept {
  const std::uint32_t rule = minimum_trials(results.settings.probability);
  return results.has_monte_carlo && !results.settings.adaptive &&
         (rule == 0 || results.trials.result.trials < rule);
}

/// The settling time of the error that a warning of a short T is about; 0 for all others.
double settling_time_s(Warning warning, const EvaluationResults& results) noexcept {
  if (warning == Warning::kShortTime) {
    return results.settling_time.time_s;
  }
  const bool is_other = results.settings.criterion != Criterion::kInBandError;
  const bool has_row = is_other && results.band.exists();
  return warning == Warning::kShortInBand && has_row ? results.band_settling.time_s : 0.0;
}

bool is_short(Warning warning, const EvaluationResults& results) noexcept {
  return results.settings.duration_s < kMuchShorter * settling_time_s(warning, results);
}

const char* words_of_short_time(Warning warning, const EvaluationResults& results) noexcept {
  if (!is_reachable(settling_time_s(warning, results), results)) {
    return "T is much shorter than the settling time, and no T that can be searched is as long";
  }
  return warning == Warning::kShortInBand
             ? "T is much shorter than the settling time of the in-band error; give at least that "
               "time"
             : "T is much shorter than the settling time; give at least the settling time";
}

bool is_low(const EvaluationResults& results) noexcept {
  const double f0_hz = results.device.estimate.natural_frequency_hz;
  return results.source == Source::kPoints && f0_hz > 0.0 && f0_hz < results.settings.cutoff_hz;
}

bool are_redrawn(std::uint32_t redraws, std::uint32_t trials) noexcept {
  return redraws > trials / kOnePercent;
}

bool are_rough(const EvaluationResults& results) noexcept {
  const float of_trials = results.has_monte_carlo && results.trials.branches.rough_trials > 0
                              ? results.trials.branches.rough_part
                              : 0.0F;
  bool any = of_trials > kMostRough;
  for (const EnergyUncertainty* known :
       {&results.uncertainty, &results.band.uncertainty, &results.matched.uncertainty}) {
    any = any || (known->exists() && known->rough_trials > 0 && known->rough_part > kMostRough);
  }
  return any;
}

bool disagrees(const EnergyUncertainty& known) noexcept { return known.guard.disagreements > 0; }

bool guards_disagree(const EvaluationResults& results) noexcept {
  const bool of_trials = results.has_monte_carlo && results.guard.disagreements > 0;
  return of_trials || disagrees(results.uncertainty);
}

bool has_flags(const ReportContext& context) noexcept {
  if (context.measurement == nullptr) {
    return false;
  }
  bool any = false;
  for (const SweepPoint& point : context.measurement->sweep.points()) {
    any = any || point.flagged;
  }
  return any;
}

}  // namespace

bool holds(Warning warning, const EvaluationResults& results,
           const ReportContext& context) noexcept {
  const EnergyUncertainty& known = results.uncertainty;
  switch (warning) {
    case Warning::kUnits:
      return context.doubt != nullptr;
    case Warning::kFit:
      return fit_warns(results);
    case Warning::kOpenDamping:
      return results.is_damping_open();
    case Warning::kOnlyS:
      return results.judgement.determined == Determined::kSensitivity;
    case Warning::kDisagreement:
      return disagreeing_parameter(results) < kWlspParameters;
    case Warning::kLowFrequency:
      return is_low(results);
    case Warning::kShortTime:
    case Warning::kShortInBand:
      return is_short(warning, results);
    case Warning::kFewTrials:
      return has_few_trials(results);
    case Warning::kNotStable:
      return results.has_monte_carlo && results.settings.adaptive && !results.adaptive.stabilised;
    case Warning::kGuard:
      return guards_disagree(results);
    case Warning::kGuardInBand:
      return disagrees(results.band.uncertainty) || disagrees(results.matched.uncertainty);
    case Warning::kCrowded:
      return results.has_monte_carlo && results.trials.branches.is_crowded;
    case Warning::kTrialsRedrawn:
      return results.has_monte_carlo &&
             are_redrawn(results.trials.redraws, results.trials.result.trials);
    case Warning::kRedrawn:
      return known.exists() && are_redrawn(known.redraws, known.trials);
    case Warning::kNoUncertainty:
      return known.is_done && !known.exists();
    case Warning::kRough:
      return are_rough(results);
    case Warning::kMeasurement:
      return has_flags(context);
    case Warning::kEnded:
    case Warning::kDataSheet:
    case Warning::kBeyondTable:
    case Warning::kChange:
      return context.measurement != nullptr && contradicts(warning, context.measurement->sweep);
  }
  return false;
}

const char* about(Warning warning) noexcept {
  switch (warning) {
    case Warning::kUnits:
      return "units";
    case Warning::kFit:
      return "fit";
    case Warning::kOpenDamping:
      return "damping";
    case Warning::kDisagreement:
      return "fit_draws";
    case Warning::kOnlyS:
    case Warning::kLowFrequency:
    case Warning::kShortTime:
      return "energy";
    case Warning::kShortInBand:
    case Warning::kGuardInBand:
      return "band";
    case Warning::kFewTrials:
    case Warning::kNotStable:
    case Warning::kGuard:
    case Warning::kCrowded:
    case Warning::kTrialsRedrawn:
      return "monte_carlo";
    case Warning::kRedrawn:
    case Warning::kNoUncertainty:
    case Warning::kRough:
      return "uncertainty";
    case Warning::kMeasurement:
    case Warning::kEnded:
    case Warning::kDataSheet:
    case Warning::kBeyondTable:
    case Warning::kChange:
      break;
  }
  return "measurement";
}

ReportSection place_of(Warning warning) noexcept {
  switch (warning) {
    case Warning::kUnits:
    case Warning::kFit:
    case Warning::kOpenDamping:
    case Warning::kOnlyS:
    case Warning::kDisagreement:
    case Warning::kLowFrequency:
      return ReportSection::kFit;
    case Warning::kShortTime:
      return ReportSection::kErrorSystem;
    case Warning::kShortInBand:
    case Warning::kGuardInBand:
      return ReportSection::kInBand;
    case Warning::kFewTrials:
    case Warning::kNotStable:
    case Warning::kGuard:
    case Warning::kCrowded:
    case Warning::kTrialsRedrawn:
      return ReportSection::kMonteCarlo;
    case Warning::kRedrawn:
    case Warning::kNoUncertainty:
    case Warning::kRough:
      return ReportSection::kUncertainty;
    case Warning::kMeasurement:
    case Warning::kEnded:
    case Warning::kDataSheet:
    case Warning::kBeyondTable:
    case Warning::kChange:
      break;
  }
  return ReportSection::kMeasurement;
}

double least_time_s(Warning warning, const EvaluationResults& results) noexcept {
  const double settling_s = settling_time_s(warning, results);
  return is_reachable(settling_s, results) ? settling_s : 0.0;
}

double longest_time_s(const EvaluationResults& results) noexcept {
  const Settings& settings = results.settings;
  const bool is_of_trials = results.failure.stage == Stage::kMonteCarlo;
  const std::size_t cells = is_of_trials ? GridWorkspace::kMaxTrialCells : kMaxCells;
  const bool is_paper = settings.method == Method::kPaper;
  return static_cast<double>(cells) * (is_paper ? settings.step_s : grid_cell_s(results.model));
}

double storable_time_s(const EvaluationResults& results) noexcept {
  constexpr double kHalfPeriods = 2.0;
  return kStorable / (kHalfPeriods * results.model.grid_hz());
}

bool is_reachable(double duration_s, const EvaluationResults& results) noexcept {
  // It rings down to 5 % of the peak in 3 time constants, or a little more where it began as more.
  constexpr double kTimeConstants = 4.0;
  const Accelerometer& device = results.device.estimate;
  const double turns = device.natural_frequency_hz * duration_s;
  const bool rings = kTwoPi * turns * device.damping < kTimeConstants;
  return duration_s <= longest_time_s(results) && !(rings && 2.0 * turns > kStorable);
}

std::size_t disagreeing_parameter(const EvaluationResults& results) noexcept {
  for (std::size_t i = 0; results.has_fit_draws && i < kWlspParameters; ++i) {
    const double u = sqrt(results.covariance(i, i));
    const double drawn = sqrt(results.fit_draws.covariance[i][i]);
    if (u > 0.0 && abs(drawn - u) > kDisagreement * u) {
      return i;
    }
  }
  return kWlspParameters;
}

const char* words_of(Warning warning, const EvaluationResults& results) noexcept {
  switch (warning) {
    case Warning::kUnits:
      return "the units assumed are unlikely";
    case Warning::kFit:
      return "chi2/dof is above what one fit in a hundred exceeds: the device is not of second "
             "order over these frequencies, or the stated uncertainties are too small";
    case Warning::kOpenDamping:
      return "the points do not determine beta: E is at the estimate, or at the nearest beta that "
             "a device may have, and its range is wide";
    case Warning::kOnlyS:
      return "the points determine the sensitivity alone, so there is no maximum energy; measure "
             "to higher frequencies";
    case Warning::kDisagreement:
      return "u by formula and u by draws differ by more than 20 %: the stated uncertainties are "
             "too large for a linear law; check their units";
    case Warning::kLowFrequency:
      return "f0 is below the filter's cutoff; check that the frequencies are in Hz";
    case Warning::kShortTime:
    case Warning::kShortInBand:
      return words_of_short_time(warning, results);
    case Warning::kFewTrials:
      return "fewer trials than rule (3), 1e4/(1 - p), asks for";
    case Warning::kNotStable:
      return "the adaptive procedure was not stable when its greatest number of blocks was reached";
    case Warning::kGuard:
    case Warning::kGuardInBand:
      return "a full search found more energy than its trial: maximum and intervals are too low";
    case Warning::kCrowded:
      return "more signals than the trials have room for may be the worst within the ranges";
    case Warning::kTrialsRedrawn:
    case Warning::kRedrawn:
      return "more than 1 % of the draws were no device and were made again: E is not normal there";
    case Warning::kNoUncertainty:
      return "the uncertainties leave what a device may be, so E has none; check them and their "
             "units";
    case Warning::kRough:
      return "interpolated trials are off by more than 1 % of u(E), so it may be off in its "
             "second digit; use its first";
    case Warning::kEnded:
    case Warning::kDataSheet:
    case Warning::kBeyondTable:
    case Warning::kChange:
      return words_of_contradiction(warning);
    case Warning::kMeasurement:
      break;
  }
  return "points of the sweep are flagged";
}

}  // namespace emax::app
