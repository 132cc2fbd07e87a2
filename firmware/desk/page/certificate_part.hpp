// What a report says to be a certificate, in the manner of ISO/IEC 17025.
#pragma once

#include <string>

#include "emax/app/report/report_context.hpp"

namespace emax::desk {

/// @returns The number of the certificate; null if the report is none.
const char* certificate_number(const app::Labels& labels) noexcept;

/// @returns What stands below each printed page: certificate or report, device and serial number.
std::string running_words(const app::ReportContext& context);

/// @returns A section: method, uncertainty, traceability, what the results apply to, and a place
/// for the signature of a certificate.
std::string certificate_of(const app::ReportContext& context);

/// Adds the mark behind which nothing more belongs to the report.
void append_end(std::string& html, const app::ReportContext& context);

}  // namespace emax::desk
