// What a warning says, with the number that it asks for.
#pragma once

#include <string>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report_warnings.hpp"

namespace emax::desk {

/// @param[in] words        Of a warning, without a full stop.
/// @param[in] least_time_s The T that it asks for in s; 0 if it asks for none.
/// @returns The words, and that T in three digits where there is one.
std::string sentence_of(const std::string& words, double least_time_s);

/// @param[in] leading_settling_s Of the leading figure's error, in s; 0 for none.
/// @returns The words of a warning of these results, with the T that it asks for, which is long
/// enough for the leading figure, too, and what follows for U where the fit is poor.
std::string sentence_of(app::Warning warning, const app::EvaluationResults& results,
                        double leading_settling_s);

/// @returns What no warning tells of a T below the settling time of the leading figure's error,
/// without a full stop; empty where T is as long.
std::string note_on_time(const app::EvaluationResults& results, double leading_settling_s);

}  // namespace emax::desk
