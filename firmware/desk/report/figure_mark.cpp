// What the star at the figures of a report means.
#include "desk/report/figure_mark.hpp"

#include <string_view>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/report/report_warnings.hpp"

#include "desk/cli/console.hpp"

namespace emax::desk {

namespace {

using app::Warning;

constexpr Warning kMarking[] = {
    Warning::kFit,         Warning::kOpenDamping, Warning::kDisagreement,  Warning::kLowFrequency,
    Warning::kShortTime,   Warning::kShortInBand, Warning::kGuardInBand,   Warning::kGuard,
    Warning::kCrowded,     Warning::kRedrawn,     Warning::kNoUncertainty, Warning::kRough,
    Warning::kMeasurement, Warning::kEnded,       Warning::kDataSheet,     Warning::kChange};

std::string range_of(const app::EvaluationResults& results) {
  StringSink sink;
  app::TextWriter out(sink);
  out.text("\n  The points leave beta open: these figures are at ");
  out.general(results.judgement.device.damping, 3);
  if (results.has_cut_range && results.cut_low_v2s > 0.0) {
    const bool is_papers = results.settings.criterion == Criterion::kIntegralSquareError;
    out.text(is_papers ? ";\n  the paper's is " : ";\n  that of E is ")
        .general(results.percent_of(results.cut_low_v2s), 4);
    out.text(" to ").general(results.percent_of(results.cut_high_v2s), 4).text(" over the range");
  }
  out.text(".");
  return sink.text();
}

}  // namespace

std::string mark_of_figures(const app::EvaluationResults& results,
                            const app::ReportContext& context) {
  std::string topics;
  std::string_view last;
  for (const Warning warning : kMarking) {
    if (holds(warning, results, context) && about(warning) != last) {
      last = about(warning);
      topics += (topics.empty() ? "" : ", ") + std::string(last);
    }
  }
  if (topics.empty()) {
    return "";
  }
  return "There is a warning below, on: " + topics + "." +
         (results.is_damping_open() ? range_of(results) : "");
}

}  // namespace emax::desk
