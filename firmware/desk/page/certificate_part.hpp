// What a report says to be a certificate, in the manner of ISO/IEC 17025.
#pragma once

#include <string>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report_context.hpp"

namespace emax::desk {

/// @returns The number of the certificate; null if the report is none.
const char* certificate_number(const app::Labels& labels) noexcept;

/// @returns What stands below each printed page: certificate or report, device and serial number.
std::string running_words(const app::ReportContext& context);

/// ISO/IEC 17025, 7.8.2.1.
inline constexpr char kReproduction[] =
    "This certificate may not be reproduced other than in full except with the written approval of "
    "the issuing laboratory.";

/// @returns Whether an item was tested; else the parameters were given, or the bench was simulated.
constexpr bool is_of_item(const app::ReportContext& context) noexcept {
  return (context.measurement != nullptr || context.source_name != nullptr) &&
         !is_simulated(context);
}

/// @returns Sentences, as plain text: what U is and what it does not hold, how the gain goes into
/// it, what the results apply to, and what they are traceable to.
std::string uncertainty_statement(const app::EvaluationResults& results,
                                  const app::ReportContext& context);
/// What chi-square is of, where stated shared effects come into it; empty where none do.
std::string chi_square_statement(const app::EvaluationResults& results);
std::string gain_statement(const app::EvaluationResults& results);
std::string validity_statement(const app::ReportContext& context);
std::string traceability_statement(const app::ReportContext& context);

/// @returns The options of the labels that ISO/IEC 17025 asks for and that are not given, as
/// "--laboratory, --customer"; empty for none, and for what is no certificate of an item.
std::string labels_not_stated(const app::ReportContext& context);

/// @returns A section: method, uncertainty, traceability, what the results apply to, a place for
/// the signature of a certificate, and the mark behind which nothing more belongs to the report.
std::string certificate_of(const app::EvaluationResults& results,
                           const app::ReportContext& context);

}  // namespace emax::desk
