// What the star at the figures of a report means.
#pragma once

#include <cstdint>
#include <string>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report_context.hpp"

namespace emax::desk {

struct FigureMark {
  std::string words;       ///< Empty without a warning.
  std::uint32_t rows = 0;  ///< That it is about: a sum of `app::kRow...`.
};

/// @returns The warnings that concern the figures, and not only the paper's trials, by what they
/// are about, with the range of the paper's figure where the damping is open, and the rows that
/// they are about.
FigureMark mark_of_figures(const app::EvaluationResults& results,
                           const app::ReportContext& context);

}  // namespace emax::desk
