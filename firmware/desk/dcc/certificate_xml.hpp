// The results as a Digital Calibration Certificate: XML by the schema 3.2.1 of PTB, with
// D-SI 2.1.0.
#pragma once

#include <string>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report_context.hpp"

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// @returns Which of the labels are missing that every such certificate has, or what is wrong with
/// the date or the country; nothing if all is well.
Problem check_certificate_labels(const app::Labels& labels);

/// @param[in] results With the stage kDone.
/// @param[in] context With labels that `check_certificate_labels()` has no complaint about.
/// @returns The certificate. It is not signed; a simulation says that it is one in its identifier
/// and in a statement.
std::string certificate_xml(const app::EvaluationResults& results,
                            const app::ReportContext& context);

}  // namespace emax::desk
