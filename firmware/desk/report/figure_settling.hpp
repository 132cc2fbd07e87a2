// How long the error of the leading figure takes to develop.
#pragma once

#include "emax/app/evaluate/evaluation_results.hpp"

namespace emax::desk {

/// The figure that engineers rank sensors by; the next best where it is refused, or where no delay
/// was to be taken out.
///
/// @returns Null where no figure in band exists.
const app::FigureResults* leading_figure(const app::EvaluationResults& results) noexcept;

/// @returns The time in s after which the impulse response of the leading figure's error stays
/// below 5 % of its peak; 0 where there is no such figure, or no such time was found.
double settling_time_of_leading_s(const app::EvaluationResults& results);

}  // namespace emax::desk
