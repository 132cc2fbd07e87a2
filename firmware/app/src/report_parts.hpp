// What the parts of the report have in common: labels, columns, and the part on the measurement.
#pragma once

#include <cstddef>

#include "emax/app/measurement.hpp"
#include "emax/app/text_writer.hpp"

namespace emax::app {

inline constexpr double kCoverageFactor = 2.0;
inline constexpr std::size_t kLabelWidth = 26;

inline TextWriter& label(TextWriter& out, const char* words) noexcept {
  return out.text("  ").left(kLabelWidth).text(words);
}

/// A further line below a label.
inline TextWriter& indent(TextWriter& out) noexcept { return out.spaces(2 + kLabelWidth); }

inline void heading(TextWriter& out, const char* words) noexcept { out.line().text(words).line(); }

/// As many decimals as give `u` three significant digits.
inline int decimals_for(double u) noexcept {
  constexpr int kMaxDecimals = 12;
  int decimals = 0;
  for (double scaled = u; scaled < 99.95 && decimals < kMaxDecimals; scaled *= 10.0) {
    ++decimals;
  }
  return decimals;
}

/// Title of the report and where its equations are from.
void write_title(TextWriter& out) noexcept;

/// The section on the measurement with its budget.
void write_measurement_section(const Measurement& measurement, TextWriter& out) noexcept;

}  // namespace emax::app
