// What was understood of a table, in one line.
#include "desk/import/understanding.hpp"

#include <string_view>

#include "desk/import/letters.hpp"
#include "desk/import/table_layout.hpp"
#include "desk/import/table_statements.hpp"

namespace emax::desk {

namespace {

std::string value_of(const GivenUncertainty& given) {
  return text_of_number(given.value) + " " + given.unit.name;
}

void add_uncertainty_units(const Conversions& by, std::string& text) {
  const auto name = [](const Conversion& u) { return u.is_decibel ? "dB" : u.unit.name; };
  const bool is_own =
      by.u_amplitude().is_there && (by.u_amplitude().is_relative || by.u_amplitude().is_decibel ||
                                    name(by.u_amplitude()) != name(by.amplitude()));
  if (is_own) {
    text += std::string(", ") + name(by.u_amplitude());
  }
  if (by.u_phase().is_there && by.phase().is_there &&
      std::string_view(by.u_phase().unit.name) != by.phase().unit.name) {
    text += std::string(", ") + by.u_phase().unit.name;
  }
}

// Nothing says a coverage factor, and the name is neither of the native form (u_...) nor the symbol
// U, which is that of an expanded uncertainty.
bool is_coverage_assumed(const Conversion& u, const FoundTable& table) noexcept {
  if (!u.is_there || table.is_native || table.statements.coverage > 0.0 ||
      table.columns[u.column].coverage > 0.0) {
    return false;
  }
  const std::string& name = u.name;
  const bool is_letter_next = name.size() > 1 && is_letter(name[1]);
  // "U95" states what it covers, not how.
  const bool is_symbol =
      !name.empty() && name[0] == 'U' && !is_letter_next && name.compare(1, 2, "95") != 0;
  return !is_symbol && name.compare(0, 2, "u_") != 0;
}

// The coverage factor where it is not 2 or nobody has said so, and what --uncertainty says.
void add_uncertainties(const FoundTable& table, const Conversions& by, const ImportOptions& options,
                       std::string& text) {
  const Conversion& of_amplitude = by.u_amplitude();
  const Conversion& of_phase = by.u_phase();
  const bool are_equal =
      !of_amplitude.is_there || !of_phase.is_there || of_amplitude.coverage == of_phase.coverage;
  const double coverage = of_amplitude.is_there ? of_amplitude.coverage : of_phase.coverage;
  if (!are_equal) {
    text += ", " + text_of_coverage(of_amplitude.coverage) + " (amplitude), " +
            text_of_coverage(of_phase.coverage) + " (phase)";
  } else if ((of_amplitude.is_there || of_phase.is_there) && coverage != kImportCoverage) {
    text += coverage == 1.0 ? ", standard uncertainties" : ", " + text_of_coverage(coverage);
  } else if (is_coverage_assumed(of_amplitude, table) || is_coverage_assumed(of_phase, table)) {
    text += ", uncertainties taken as " + text_of_coverage(kImportCoverage);
  }
  const bool is_amplitude_given = !of_amplitude.is_there;
  const bool is_phase_given = by.phase().is_there && !of_phase.is_there;
  if (is_amplitude_given || is_phase_given) {
    text += ", U = ";
    text += is_amplitude_given ? value_of(options.amplitude_uncertainty) : "";
    text += is_amplitude_given && is_phase_given ? " and " : "";
    text += is_phase_given ? value_of(options.phase_uncertainty) : "";
    text += " by --uncertainty";
  }
  text += by.u_common().is_there ? ", with what all points have in common" : "";
}

void add_changes(const Conversions& by, const ImportOptions& options, std::string& text) {
  text += by.phase().sign < 0.0 ? "; a lag is positive" : "";
  text += options.is_inverted ? "; polarity turned round" : "";
  if (options.channel_delay_s != 0.0) {
    text += "; the channel's delay of " + text_of_number(options.channel_delay_s) + " s taken out";
  }
  text += by.amplitude().unit.is_charge ? "; 1 pC is taken as 1 V" : "";
}

// Of the fit in a table that emax has written.
bool is_own_column(std::string_view name) noexcept {
  return name == "model_amplitude" || name == "model_phase_deg" || name == "residual_re" ||
         name == "residual_im";
}

void add_form(const FoundTable& table, std::string& text) {
  if (table.layout.separator != Separator::kComma) {
    text += std::string("; ") + name_of(table.layout.separator);
  }
  text += table.layout.has_decimal_comma ? "; decimal comma" : "";
  if (table.text.encoding != std::string_view("UTF-8")) {
    text += std::string("; ") + table.text.encoding;
  }
  text += table.is_labview ? "; LabVIEW, X_Value is the frequency" : "";
  if (table.has_thousands) {
    text += table.layout.has_decimal_comma ? "; a point in a frequency is one of thousands"
                                           : "; a comma in a frequency is one of thousands";
  }
  if (table.first_footer > 0) {
    text += "; not read from line " + std::to_string(table.first_footer + 1) + " on";
  }
  std::string unused;
  for (const Column& column : table.columns) {
    if (column.role == Role::kIgnored && !column.name.empty() && !is_own_column(column.name)) {
      unused += (unused.empty() ? "" : ", ") + column.name;
    }
  }
  text += unused.empty() ? "" : "; not used: " + unused;
}

}  // namespace

std::string understanding_of(const FoundTable& table, const Conversions& by,
                             const ImportOptions& options, const MergedRows& merged) {
  std::string text = std::string("read as ") + by.frequency().unit.name + ", ";
  text += by.amplitude().is_decibel ? "dB re 1 " : "";
  text += by.amplitude().unit.name;
  text += by.phase().is_there ? std::string(", ") + by.phase().unit.name : ", no phase";
  add_uncertainty_units(by, text);
  add_uncertainties(table, by, options, text);
  text += "; " + count_of(merged.rows.size(), "point");
  if (merged.repeats > 0) {
    text += ", " + std::to_string(merged.repeats) + " of them the mean of repeated rows";
  }
  add_changes(by, options, text);
  add_form(table, text);
  return text;
}

}  // namespace emax::desk
