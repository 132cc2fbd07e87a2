// Why an evaluation has led to nothing, in the line that the program ends with.
#pragma once

#include <string>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/identify/frequency_response.hpp"

#include "desk/cli/options.hpp"
#include "desk/cli/problem.hpp"

namespace emax::desk {

/// @returns The failure of an evaluation that was made for these options, with the option or the
/// input that has to be changed; a fault where the bench has given the points.
///
/// @param[in] is_phase_unit_named As for `cause_of()`.
/// @param[in] doubt               Of the table, as `ImportedPoints` has it.
Problem describe_failure(const app::EvaluationResults& evaluation, const ReportOptions& options,
                         bool is_phase_unit_named, const std::string& doubt);

/// @returns A problem where --damping was given and the points do not leave that damping open, or
/// leave f0 open too, or are magnitudes that fit no such damping.
Problem check_given_damping(const app::EvaluationResults& evaluation, const ReportOptions& options,
                            const FrequencyResponse& points);

/// @returns Sentences of the library as the middle of a line: each begins with a small letter
/// unless that is a symbol, semicolons part them, and there is no full stop.
std::string in_line(const std::string& text);

}  // namespace emax::desk
