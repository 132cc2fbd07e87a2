// What `emax report --out` leaves in its directory.
#pragma once

#include <string>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report_context.hpp"

#include "desk/cli/problem.hpp"
#include "desk/files/output_files.hpp"

namespace emax::desk {

/// Writes report, results, tables, pictures and page, and puts them in place.
///
/// @param[in]  results    With the stage kDone.
/// @param[out] remark     Why there are no pictures, if there are none; all else is there then.
Problem write_files(const app::EvaluationResults& results, const app::ReportContext& context,
                    OutputFiles& files, Problem& remark);

/// Writes a table of what has been measured.
///
/// @param[in] context With a measurement.
/// @param[in] results Null or without points if the measurement failed.
void write_points(const app::EvaluationResults* results, const app::ReportContext& context,
                  app::TextWriter& out);

/// Where the files of a measurement cannot be written, tries its points alone, which take little
/// room, under a name that replaces no other measurement.
///
/// @returns The name of the file; empty if there is none.
std::string write_points_alone(const app::EvaluationResults* results,
                               const app::ReportContext& context, OutputFiles& files);

/// The same for a sweep whose evaluation was stopped; no table of an earlier one is lost by it,
/// either.
std::string write_stopped_points(const app::EvaluationResults* results,
                                 const app::ReportContext& context, OutputFiles& files);

/// Writes what there is of a measurement that led to no result, and puts it in place.
///
/// @param[in] context With a measurement.
/// @param[in] refused The evaluation that has refused the points; null if the sweep failed.
Problem write_fault_files(const app::ReportContext& context, const app::EvaluationResults* refused,
                          OutputFiles& files);

/// The report on points that determine the sensitivity alone, with what `context` says of the
/// damping.
void write_sensitivity_text(const app::EvaluationResults& results,
                            const app::ReportContext& context, app::TextWriter& out);

/// The files of points that determine the sensitivity alone: report.txt and results.json. What an
/// earlier run has left of the others goes.
Problem write_sensitivity_files(const app::EvaluationResults& results,
                                const app::ReportContext& context, OutputFiles& files);

}  // namespace emax::desk
