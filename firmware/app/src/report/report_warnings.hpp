// What a reader or a program must not miss about the results, one line each.
#pragma once

#include <cstdint>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report_context.hpp"

namespace emax::app {

enum class Warning : std::uint8_t {
  kFit,            ///< chi2 over dof is above `reduced_chi_square_limit()`.
  kShortTime,      ///< T is much shorter than the settling time.
  kFewTrials,      ///< Fewer than rule (3) asks for.
  kNotStable,      ///< The adaptive procedure ended on its limit.
  kGuard,          ///< A search beats its trial.
  kCrowded,        ///< More signals than the trials have room for.
  kRedrawn,        ///< More than 1 % of the draws of the uncertainty of E were no device.
  kNoUncertainty,  ///< The draws for the uncertainty of E have failed.
  kMeasurement,    ///< Points are flagged.
};

inline constexpr Warning kWarnings[] = {
    Warning::kFit,       Warning::kShortTime,     Warning::kFewTrials,
    Warning::kNotStable, Warning::kGuard,         Warning::kCrowded,
    Warning::kRedrawn,   Warning::kNoUncertainty, Warning::kMeasurement,
};

/// @returns Whether this has to be said of these results.
bool holds(Warning warning, const EvaluationResults& results,
           const ReportContext& context) noexcept;

/// @returns "fit", "energy", "monte_carlo", "uncertainty" or "measurement".
const char* about(Warning warning) noexcept;

/// @returns One line. Never null.
const char* words_of(Warning warning) noexcept;

/// T shorter than this part of the settling time is much shorter.
inline constexpr double kMuchShorter = 0.5;

}  // namespace emax::app
