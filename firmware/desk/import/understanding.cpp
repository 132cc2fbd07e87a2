// What was understood of a table, in one line.
#include "desk/import/understanding.hpp"

#include <string_view>

#include "desk/import/table_layout.hpp"

namespace emax::desk {

namespace {

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
  if (by.u_amplitude().coverage == 1.0 || by.u_phase().coverage == 1.0) {
    text += ", standard uncertainties";
  }
  if (!by.u_amplitude().is_there || (by.phase().is_there && !by.u_phase().is_there)) {
    text += ", uncertainties by --uncertainty";
  }
}

void add_changes(const Conversions& by, const ImportOptions& options, std::string& text) {
  text += by.phase().sign < 0.0 ? "; a lag is positive" : "";
  text += options.is_inverted ? "; polarity turned round" : "";
  text += options.channel_delay_s != 0.0 ? "; the channel's delay taken out" : "";
  text += by.amplitude().unit.is_charge ? "; 1 pC is taken as 1 V" : "";
}

void add_form(const FoundTable& table, std::string& text) {
  if (table.layout.separator != Separator::kComma) {
    text += std::string("; ") + name_of(table.layout.separator);
  }
  text += table.layout.has_decimal_comma ? "; decimal comma" : "";
  if (table.text.encoding != std::string_view("UTF-8")) {
    text += std::string("; ") + table.text.encoding;
  }
  std::string unused;
  for (const Column& column : table.columns) {
    if (column.role == Role::kIgnored && !column.name.empty()) {
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
  text += "; " + count_of(merged.rows.size(), "point");
  if (merged.repeats > 0) {
    text += ", " + std::to_string(merged.repeats) + " of them the mean of repeated rows";
  }
  add_changes(by, options, text);
  add_form(table, text);
  return text;
}

}  // namespace emax::desk
