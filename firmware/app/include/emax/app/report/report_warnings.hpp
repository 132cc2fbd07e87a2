// What a reader or a program must not miss about the results, one line each.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/report/report_context.hpp"

namespace emax::app {

enum class Warning : std::uint8_t {
  kFit,            ///< chi2 over dof is above `reduced_chi_square_limit()`.
  kOpenDamping,    ///< The points leave the damping open.
  kOnlyS,          ///< The points determine the sensitivity alone.
  kDisagreement,   ///< u by formula and u by draws differ by more than kDisagreement.
  kLowFrequency,   ///< f0 is below the filter's cutoff.
  kShortTime,      ///< T is much shorter than the settling time.
  kShortInBand,    ///< The same of the in-band error, where it is not the criterion.
  kFewTrials,      ///< Fewer than rule (3) asks for.
  kNotStable,      ///< The adaptive procedure ended on its limit.
  kGuard,          ///< A search beats its trial.
  kGuardInBand,    ///< The same of an in-band error.
  kCrowded,        ///< More signals than the trials have room for.
  kTrialsRedrawn,  ///< More than 1 % of the draws of the trials were no device.
  kRedrawn,        ///< The same of the draws of the uncertainty of E.
  kNoUncertainty,  ///< The draws for the uncertainty of E have failed.
  kRough,          ///< Trials by polynomials are off by more than kMostRough.
  kMeasurement,    ///< Points are flagged.
  kEnded,          ///< A fault has ended the sweep.
  kDataSheet,      ///< The sensitivity at the check frequency is 20 % off the data sheet's.
  kBeyondTable,    ///< The sweep has frequencies beyond the ends of the reference's table.
  kUnits,          ///< A table names no units, and what was taken is unlikely.
  kChange,         ///< The check frequency's ratio has changed by 1 %, beyond its noise.
};

inline constexpr Warning kWarnings[] = {
    Warning::kUnits,        Warning::kFit,           Warning::kOpenDamping, Warning::kOnlyS,
    Warning::kDisagreement, Warning::kLowFrequency,  Warning::kShortTime,   Warning::kShortInBand,
    Warning::kFewTrials,    Warning::kNotStable,     Warning::kGuard,       Warning::kGuardInBand,
    Warning::kCrowded,      Warning::kTrialsRedrawn, Warning::kRedrawn,     Warning::kNoUncertainty,
    Warning::kRough,        Warning::kMeasurement,   Warning::kEnded,       Warning::kDataSheet,
    Warning::kBeyondTable,  Warning::kChange,
};

/// @returns Whether this has to be said of these results. The report then has a part
/// ReportPart::kWarning on it, and results.json a line.
bool holds(Warning warning, const EvaluationResults& results,
           const ReportContext& context) noexcept;

/// The same of those on the sweep alone: kEnded, kDataSheet, kBeyondTable and kChange, and their
/// lines.
bool contradicts(Warning warning, const SweepResults& sweep) noexcept;
const char* words_of_contradiction(Warning warning) noexcept;

/// @returns "units", "fit", "damping", "fit_draws", "energy", "band", "monte_carlo", "uncertainty"
/// or "measurement".
const char* about(Warning warning) noexcept;

/// @returns The T in s that a warning of a short one asks for, the settling time; 0 for all others,
/// and where no search reaches so far.
double least_time_s(Warning warning, const EvaluationResults& results) noexcept;

/// @returns The longest T in s that the cells suffice for.
double longest_time_s(const EvaluationResults& results) noexcept;

/// @returns A T in s for which the switching times have room, by whatever half period of sensor or
/// filter the signal switches.
double storable_time_s(const EvaluationResults& results) noexcept;

/// @returns Whether a search can take so long a T: its cells suffice, and its switching times too
/// if the resonance still rings then, for the signal follows that.
bool is_reachable(double duration_s, const EvaluationResults& results) noexcept;

/// @returns Where in the report it is said at length.
ReportSection place_of(Warning warning) noexcept;

/// @returns One line; a `least_time_s()` belongs behind it. Never null.
const char* words_of(Warning warning, const EvaluationResults& results) noexcept;

/// @returns The number of the parameter (0 is S, 1 is f0, 2 is beta) whose u by formula and u by
/// draws disagree; 3 if none does.
std::size_t disagreeing_parameter(const EvaluationResults& results) noexcept;

/// Of u by formula and u by draws: more is a warning.
inline constexpr double kDisagreement = 0.2;

/// Part of u(E) that its trials may be off by: more is a warning.
inline constexpr float kMostRough = 0.01F;

}  // namespace emax::app
