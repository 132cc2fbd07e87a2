// The stages of an evaluation, the goals that it is asked for, and why it ends early.
#pragma once

#include <cstdint>

#include "emax/base/status.hpp"

namespace emax::app {

enum class Stage : std::uint8_t {
  kIdle,
  kModel,       ///< Peak, settling time and the largest absolute error.
  kFitDraws,    ///< Covariance of the fit by Monte Carlo draws.
  kEnergy,      ///< The largest energy at the estimate.
  kBound,       ///< What no signal can exceed.
  kTrend,       ///< Before the trials: only its searches say whether its times are too long.
  kPrediction,  ///< Which signals may be the worst over the ranges, and how their energies change.
  kAdaptive,    ///< Number of trials by JCGM 101 7.9.
  kMonteCarlo,
  kGuard,        ///< Full searches for some of the trials.
  kIdeal,        ///< The largest energy of an ideal sensor, the baseline.
  kBand,         ///< The in-band error, its bound and uncertainty.
  kMatched,      ///< The same with the sensor's constant delay taken out.
  kUncertainty,  ///< The uncertainty of the largest energy by JCGM 101.
  kDone,
  kFailed,
};

/// @returns "fit", "energy", "number of trials", "Monte Carlo", "trend" and so on, for a progress
/// line.
const char* name_of(Stage stage) noexcept;

/// How far an evaluation goes. What a goal needs is done first; what is there already is kept.
enum class Goal : std::uint8_t {
  kModel,        ///< Fit, error system, its peak and settling time, the largest absolute error.
  kEnergy,       ///< kModel, the largest energy at the estimate, and its upper bound.
  kMonteCarlo,   ///< kEnergy, the trials and the guard.
  kTrend,        ///< kEnergy and the trend.
  kBand,         ///< kEnergy and the in-band errors with their bounds.
  kUncertainty,  ///< kEnergy and its uncertainty by JCGM 101.
  kReport,       ///< Everything, with the draws of the fit.
};

/// @returns Whether this goal needs the trials.
constexpr bool wants_trials(Goal goal) noexcept {
  return goal == Goal::kMonteCarlo || goal == Goal::kReport;
}

/// @returns Whether this goal needs the in-band errors and the ideal sensor.
constexpr bool wants_figures(Goal goal) noexcept {
  return goal == Goal::kBand || goal == Goal::kReport;
}

/// @returns Whether this goal needs the uncertainty of the energy by JCGM 101.
constexpr bool wants_uncertainty(Goal goal) noexcept {
  return goal == Goal::kUncertainty || goal == Goal::kReport;
}

/// @returns Whether this goal needs the trend.
constexpr bool wants_trend(Goal goal) noexcept {
  return goal == Goal::kTrend || goal == Goal::kReport;
}

/// Why an evaluation was refused or has ended early.
struct Failure {
  Status status = Status::kOk;
  /// The stage that failed: kIdle for what was put in, kFitDraws for the fit.
  Stage stage = Stage::kIdle;
  const char* reason =
      nullptr;              ///< One sentence: what is wrong and what to do. Null if all is well.
  double duration_s = 0.0;  ///< The T of the search that failed; 0 if it was no search.
};

}  // namespace emax::app
