// What the parts of the report have in common: labels, columns, and the part on the measurement.
#pragma once

#include <cstddef>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report_context.hpp"

namespace emax::app {

inline constexpr std::size_t kLabelWidth = 26;

/// The words of a report, as text of its own or between the marks of somebody else.
///
/// What begins a part writes the part's beginning as text only where there are no marks; words and
/// numbers are the same in both.
class ReportWriter final : public TextWriter {
 public:
  /// @param[in] markup Null for text.
  ReportWriter(const TextWriter& out, const ReportContext& context, ReportMarkup* markup) noexcept
      : TextWriter(out), markup_(markup), in_g_(context.in_g), rounds_to_u_(context.rounds_to_u) {}

  TextWriter& heading(ReportSection section, const char* words) noexcept;
  TextWriter& label(const char* name) noexcept;
  /// A further line below a label.
  TextWriter& indent() noexcept;
  /// Sentences, a table, or a line of it; as text they bring blanks and line feeds of their own.
  TextWriter& part(ReportPart part) noexcept;
  /// A cell of `width` characters.
  TextWriter& cell(std::size_t width) noexcept;
  /// Words that others wrote, in one line.
  TextWriter& quote(const char* words) noexcept;

  bool in_g() const noexcept { return in_g_; }
  bool rounds_to_u() const noexcept { return rounds_to_u_; }
  /// Text of its own, without marks.
  bool is_plain() const noexcept { return markup_ == nullptr; }
  /// A label and its energy, with nine digits or those that U = 2 u carries where
  /// `rounds_to_u()`.
  TextWriter& energy(const char* name, double energy_v2s, double u_v2s) noexcept;
  /// " (0.1057446 g)" behind an acceleration where that is asked for, else nothing.
  TextWriter& and_g(double acceleration_mps2, int digits) noexcept;
  /// " (10.16949 V/g)" behind a sensitivity.
  TextWriter& and_v_per_g(double sensitivity, int digits) noexcept;

 private:
  ReportMarkup* markup_;
  bool in_g_;
  bool rounds_to_u_;
};

/// As many decimals as give `u` three significant digits.
inline int decimals_for(double u) noexcept {
  constexpr int kMaxDecimals = 12;
  int decimals = 0;
  for (double scaled = u; scaled < 99.95 && decimals < kMaxDecimals; scaled *= 10.0) {
    ++decimals;
  }
  return decimals;
}

/// Title of the report, where its equations are from, and the labels. Above it, in plain text,
/// kSimulationBanner where it is due; a page has that as its own banner.
void write_title(const ReportContext& context, ReportWriter& out) noexcept;

/// The row on where the points are from, and what was understood of them.
void write_points_source(const EvaluationResults& results, const ReportContext& context,
                         ReportWriter& out) noexcept;

/// Where the points leave a parameter open, or disagree with what can be.
void write_fit_notes(const EvaluationResults& results, ReportWriter& out) noexcept;

/// Where chi-square says that the points do not follow the model, or follow it too well.
///
/// @param[in] cause Null if nobody knows.
void write_fit_warning(const WlspFit& fit, const char* cause, ReportWriter& out) noexcept;

/// Why the points do not fit, in lines; a note or a warning where `start` says so.
void write_cause(const char* start, const char* cause, ReportWriter& out) noexcept;

/// What is unlikely in units that a table does not name; null for nothing.
void write_doubt(const char* doubt, ReportWriter& out) noexcept;

/// The section in place of Monte Carlo where the damping is open.
void write_cut_range(const EvaluationResults& results, ReportWriter& out) noexcept;

/// The section on the measurement with its budget.
///
/// @param[in] fit Of these points; null if there is none.
void write_measurement_section(const Measurement& measurement, const Wlsp* fit,
                               ReportWriter& out) noexcept;

}  // namespace emax::app
