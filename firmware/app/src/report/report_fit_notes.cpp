// What a report says where points leave a parameter open.
#include "emax/app/report/report_warnings.hpp"
#include "emax/base/elementary.hpp"

#include "report_parts.hpp"

namespace emax::app {
namespace {

const char* const kNames[] = {"S", "f0", "beta"};

void write_span(const EvaluationResults& results, double f0_hz, ReportWriter& out) noexcept {
  const Span<const ResponsePoint> points = results.fit.response().points();
  out.text("The points end at ").general(points[points.size() - 1].frequency_hz / f0_hz, 2);
  out.text(" f0.");
}

void write_open_damping(const EvaluationResults& results, ReportWriter& out) noexcept {
  const FitJudgement& judgement = results.judgement;
  out.line();
  out.part(ReportPart::kWarning);
  out.text("  WARNING: the points do not determine beta: within 2u it may be anything from ");
  out.general(judgement.damping_low, 3).text(" to ").general(judgement.damping_high, 3);
  out.text(".\n  ");
  write_span(results, judgement.device.natural_frequency_hz, out);
  out.text(judgement.device.damping > kMinDamping
               ? " The energy is given at the estimate, "
               : " The energy is given at the least that a device may have, ");
  out.general(judgement.device.damping, 3);
  out.text(
      ",\n  and for the range. Measure nearer to the resonance, or give the beta that its maker "
      "states.\n");
}

void write_magnitudes_only(const WlspFit& fit, std::size_t points, ReportWriter& out) noexcept {
  if (fit.unknown_phases > 0) {
    out.line();
    out.part(ReportPart::kNote).text("  Note: the phase is unknown at ");
    out.integer(fit.unknown_phases).text(" of ").integer(points);
    out.text(" points; there only the magnitude is fitted.\n");
  }
  if (fit.is_damping_given) {
    out.line();
    out.part(ReportPart::kNote);
    out.text("  Note: the points do not determine beta; it is held at the value given.\n");
  }
}

void write_disagreement(const EvaluationResults& results, ReportWriter& out) noexcept {
  const std::size_t i = disagreeing_parameter(results);
  if (i == kWlspParameters) {
    return;
  }
  out.line();
  out.part(ReportPart::kWarning).text("  WARNING: u(").text(kNames[i]).text(") by formula, ");
  out.general(sqrt(results.covariance(i, i)), 3).text(", and by draws, ");
  out.general(sqrt(results.fit_draws.covariance[i][i]), 3);
  out.text(
      ", differ by more than 20 %: the stated\n"
      "  uncertainties are too large for a linear law of propagation. Check their units.\n");
}

void write_low_frequency(const EvaluationResults& results, ReportWriter& out) noexcept {
  const double f0_hz = results.device.estimate.natural_frequency_hz;
  const double cutoff_hz = results.settings.cutoff_hz;
  if (!(f0_hz > 0.0) || f0_hz >= cutoff_hz) {
    return;
  }
  out.line();
  out.part(ReportPart::kWarning).text("  WARNING: f0 = ").general(f0_hz, 4);
  out.text(" Hz is below the filter's cutoff of ").general(cutoff_hz, 4);
  out.text(
      " Hz. Are the frequencies in Hz, and not\n"
      "  in kHz? Otherwise choose a cutoff within the band that the sensor is used in.\n");
}

}  // namespace

void write_cause(const char* start, const char* cause, ReportWriter& out) noexcept {
  constexpr std::size_t kMaxLine = 100;
  constexpr std::size_t kIndent = 2;
  out.part(*start == '\0'  ? ReportPart::kText
           : *start == 'N' ? ReportPart::kNote
                           : ReportPart::kWarning);
  std::size_t column = 0;
  while (*cause != '\0') {
    std::size_t length = 0;
    while (cause[length] != '\0' && cause[length] != ' ') {
      ++length;
    }
    if (column == 0 || column + 1 + length > kMaxLine) {
      out.text(column == 0 ? "  " : "\n  ").text(column == 0 ? start : "");
      column = kIndent;
    } else {
      out.text(" ");
      ++column;
    }
    out.text(Span<const char>(cause, length));
    column += length;
    cause += cause[length] == ' ' ? length + 1 : length;
  }
  out.line();
}

void write_doubt(const char* doubt, ReportWriter& out) noexcept {
  if (doubt != nullptr) {
    out.line();
    write_cause("WARNING: ", doubt, out);
  }
}

void write_fit_notes(const EvaluationResults& results, ReportWriter& out) noexcept {
  write_magnitudes_only(results.fit.result(), results.fit.response().size(), out);
  if (results.is_damping_open()) {
    write_open_damping(results, out);
  }
  write_disagreement(results, out);
  write_low_frequency(results, out);
}

void write_cut_range(const EvaluationResults& results, ReportWriter& out) noexcept {
  const FitJudgement& judgement = results.judgement;
  out.heading(ReportSection::kMonteCarlo,
              "RANGE OF E (over the dampings that the points leave open)");
  out.label("beta").general(judgement.damping_low, 3).text(" to ");
  out.general(judgement.damping_high, 3)
      .text(", with S and f0 as they follow from it, +- 2u")
      .line();
  if (!results.has_cut_range) {
    out.part(ReportPart::kText)
        .text(
            "  No range: at its ends the search needs more switches or cells than there is room "
            "for.\n");
    return;
  }
  out.label("E").scientific(results.cut_low_v2s, 3).text(" to ");
  out.scientific(results.cut_high_v2s, 3).text(" V^2 s (at least 95 %)").line();
  out.part(ReportPart::kText)
      .text("  There are no Monte Carlo trials: they need an uncertainty of each parameter.\n");
}

void write_sensitivity_report(const EvaluationResults& results, const ReportContext& context,
                              TextWriter& out, ReportMarkup* markup) noexcept {
  const FitJudgement& judgement = results.judgement;
  const WlspFit& fit = results.fit.result();
  const int decimals = decimals_for(judgement.u_sensitivity);
  ReportWriter writer(out, context, markup);
  write_title(context, writer);
  writer.heading(ReportSection::kInput, "WHAT WAS PUT IN");
  write_points_source(results, context, writer);
  writer.heading(ReportSection::kFit, "FIT");
  writer.label("S").fixed(judgement.device.sensitivity, decimals).text(" V/(m/s^2), u = ");
  writer.fixed(judgement.u_sensitivity, decimals).text(", U = ");
  writer.fixed(kCoverageFactor * judgement.u_sensitivity, decimals).text(" (k = 2)").line();
  writer.label("f0").text("not determined");
  const double above_hz = judgement.frequency_low_hz;
  if (above_hz > 1.0) {
    writer.text(", above ").fixed(floor(above_hz), 0).text(" Hz by 2u");
  }
  writer.line();
  writer.label("beta").text("not determined").line();
  if (fit.dof > 0 && fit.chi2 > 0.0) {
    writer.label("chi-square").general(fit.chi2, 5).text(" with ").integer(fit.dof);
    writer.text(" degrees of freedom, chi2/dof = ").general(fit.chi2 / fit.dof, 4).line();
    write_fit_warning(fit, context.cause, writer);
  }
  write_doubt(context.doubt, writer);
  writer.line();
  writer.part(ReportPart::kWarning);
  writer.text(
      "  WARNING: the points lie so far below the resonance that they determine the sensitivity\n"
      "  alone. Without f0 and beta there is no maximum energy. Measure to higher frequencies; for "
      "a\n"
      "  table of magnitudes --damping helps where its damping is known.\n");
}

}  // namespace emax::app
