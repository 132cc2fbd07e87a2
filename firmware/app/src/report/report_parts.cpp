// The beginnings of the parts of a report, as text or by way of somebody else's marks.
#include "report_parts.hpp"

#include "emax/app/base/version.hpp"

#include "report_figures.hpp"

namespace emax::app {
namespace {

void write_label(const char* name, const char* words, ReportWriter& out) noexcept {
  if (words != nullptr) {
    out.label(name);
    out.quote(words).line();
  }
}

}  // namespace

TextWriter& ReportWriter::heading(ReportSection section, const char* words) noexcept {
  if (markup_ != nullptr) {
    markup_->begin(section, words);
    return *this;
  }
  return words == nullptr ? *this : line().text(words).line();
}

TextWriter& ReportWriter::label(const char* name) noexcept {
  if (markup_ != nullptr) {
    markup_->begin(ReportPart::kRow, name);
    return *this;
  }
  return text("  ").left(kLabelWidth).text(name);
}

TextWriter& ReportWriter::indent() noexcept {
  return markup_ != nullptr ? part(ReportPart::kMore) : spaces(2 + kLabelWidth);
}

TextWriter& ReportWriter::part(ReportPart part) noexcept {
  if (markup_ != nullptr) {
    markup_->begin(part, nullptr);
  }
  return *this;
}

TextWriter& ReportWriter::cell(std::size_t width) noexcept {
  return markup_ != nullptr ? part(ReportPart::kCell) : right(width);
}

TextWriter& ReportWriter::quote(const char* words) noexcept {
  if (markup_ != nullptr) {
    markup_->quote(words);
    return *this;
  }
  return one_line(words, kLabelShown);
}

TextWriter& ReportWriter::energy(const char* name, double energy_v2s, double u_v2s) noexcept {
  constexpr int kAll = 8;
  const int known = decimals_of(kCoverageFactor * u_v2s, 2) - decimals_of(energy_v2s, 1);
  const bool is_short = rounds_to_u_ && u_v2s > 0.0 && known >= 0 && known < kAll;
  return label(name).scientific(energy_v2s, is_short ? known : kAll).text(" V^2 s");
}

TextWriter& ReportWriter::and_g(double acceleration_mps2, int digits) noexcept {
  if (in_g_) {
    text(" (").general(acceleration_mps2 / kStandardGravity_mps2, digits).text(" g)");
  }
  return *this;
}

TextWriter& ReportWriter::and_v_per_g(double sensitivity, int digits) noexcept {
  if (in_g_) {
    text(" (").general(sensitivity * kStandardGravity_mps2, digits).text(" V/g)");
  }
  return *this;
}

void write_title(const ReportContext& context, ReportWriter& out) noexcept {
  const Labels& labels = context.labels;
  if (out.is_plain() && is_simulated(context)) {
    out.text(kSimulationBanner).text("\n\n");
  }
  out.heading(ReportSection::kTitle, nullptr);
  out.text("emax report, version ").text(kVersion).line();
  out.text(
      "Maximum energy at the output of an accelerometer; equations by number are those of\n"
      "K. Tomczyk, Energies 2020, 13(7), 1552.\n");
  if (!labels.any()) {
    return;
  }
  out.heading(ReportSection::kLabels, "LABELS (as given)");
  write_label("Device", labels.device, out);
  write_label("Serial number", labels.serial, out);
  write_label("Operator", labels.operated_by, out);
  write_label("Date", labels.date, out);
  write_label("Note", labels.note, out);
  for (const NamedLabel& label : labels.more) {
    write_label(label.name, label.words, out);
  }
}

}  // namespace emax::app
