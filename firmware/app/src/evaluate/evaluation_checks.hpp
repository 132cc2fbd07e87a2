// What stands in the way of an evaluation, in sentences that say what to do.
#pragma once

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/evaluate/stage.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/base/status.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/model/accelerometer.hpp"

namespace emax::app {

inline constexpr const char* kNoGain =
    "The in-band error needs a reference filter with a gain above 0; give another gain.";

// Each `check_...()` answers kOk if nothing stands in the way.

/// @returns kInvalidArgument for a setting out of its range.
Failure check_settings(const Settings& settings) noexcept;

/// @returns kOverdamped, or kInvalidArgument for a device that there cannot be or whose energies
/// would leave the range of numbers.
Failure check_device(const Accelerometer& device) noexcept;

/// @returns kInvalidArgument unless these results have a device whose energy these settings keep.
Failure check_pursuit(const EvaluationResults& results, const Settings& settings) noexcept;

/// What would stop this goal later on, as far as it can be seen before.
///
/// @param[in] results With device and model.
Failure check_goal(const EvaluationResults& results, const Settings& settings, Goal goal) noexcept;

/// @returns Why there is no fit of the points.
Failure failure_of_fit(Status status) noexcept;

/// @returns Why points that determine the sensitivity alone have no energy.
Failure failure_of_sensitivity_alone() noexcept;

/// @returns Why trials of this distribution cannot be made.
Failure failure_of_width(Status status, Distribution distribution) noexcept;

/// @returns Why the energies of the trials have no summary.
Failure failure_of_trials(Status status, Stage stage, bool is_exhausted) noexcept;

/// @returns Why a search has no result.
///
/// @param[in] settling_s Of the error; 0 if it is not known yet.
Failure failure_of_search(Status status, const Settings& settings, Stage stage, double duration_s,
                          double settling_s) noexcept;

/// @returns Why there is no error system.
Failure failure_of_model(Status status, const Settings& settings) noexcept;

/// The reference filter of a device that is known.
ReferenceFilter reference_filter(const EvaluationResults& results) noexcept;

/// The delay that these settings allow the sensor.
ReferenceDelay delay_of(const Settings& settings) noexcept;

/// What these settings call the error.
ErrorMeasure measure_of(const Settings& settings) noexcept;

/// @returns Whether a goal needs the trials of the box: also for their number, where it is
/// adaptive.
bool needs_trials(Goal goal, const Settings& settings) noexcept;

/// @returns Whether a length of the trend is left out where it needs more cells or switches than
/// there is room for: of the default trend, which nobody has asked for.
bool adapts_trend(const Settings& settings) noexcept;

/// The settings of a search for this time.
SearchSettings search_settings(const Settings& settings, double duration_s) noexcept;

}  // namespace emax::app
