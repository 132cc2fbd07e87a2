// The report as one page for a browser or a printer, with its pictures inside.
#pragma once

#include <string>
#include <vector>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/report_context.hpp"

#include "desk/pictures/pictures.hpp"

namespace emax::desk {

/// A picture as it stands in a page.
struct PagePicture {
  Picture picture;
  std::string svg;  ///< What gnuplot has written.
};

/// Writes a page in UTF-8 that needs nothing from outside itself and no scripts.
///
/// @param[in] results    With the stage kDone.
/// @param[in] pictures   Empty if there are none; the page says so then.
void write_page(const app::EvaluationResults& results, const app::ReportContext& given,
                const std::vector<PagePicture>& pictures, app::TextWriter& out);

/// The same for a measurement that led to no result; `context` has the measurement.
void write_fault_page(const app::ReportContext& context, const app::EvaluationResults* refused,
                      app::TextWriter& out);

}  // namespace emax::desk
