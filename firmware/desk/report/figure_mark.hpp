// What the star at the figures of a report means.
#pragma once

#include <string>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report_context.hpp"

namespace emax::desk {

/// @returns The warnings that concern the figures, and not only the paper's trials, by what they
/// are about, with the range of the paper's figure where the damping is open; empty without any.
std::string mark_of_figures(const app::EvaluationResults& results,
                            const app::ReportContext& context);

}  // namespace emax::desk
