// A table of measured points as a laboratory has it: text in, points or a complaint out.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "emax/identify/frequency_response.hpp"

#include "desk/import/import_error.hpp"
#include "desk/import/import_options.hpp"

namespace emax::desk {

/// A table that has been read.
struct ImportedPoints {
  FrequencyResponse points;        ///< Ascending; standard uncertainties; a phase may be unknown.
  std::vector<std::size_t> lines;  ///< The line that each point came from, from 1.
  /// What was understood: "read as Hz, mV/g, deg, percent; 20 points; tabs, decimal comma".
  std::string understanding;
  std::string doubt;  ///< Sentences that ask about units which nobody has named; else empty.
  bool names_phase_unit = false;  ///< Degrees or radians are not just assumed.
  bool states_common = false;     ///< The table itself says what all its points have in common.
};

/// Reads a table in UTF-8, UTF-16 or Latin-1.
///
/// Separators are tabs, semicolons, commas or blanks; a decimal comma goes with all but commas.
/// Quotes, trailing separators, empty lines, lines that begin with '#' or '%', comments behind a
/// '#', U+2212 for a minus, marks of thousands that can be nothing else, and units behind numbers
/// are allowed. The header is read: its names say what a column is, and its units, or those of the
/// lines below it, what it is in; columns of other names are not used. Of the lines before it and
/// of comments a coverage factor and units are read ("k = 2", "units: Hz, mV/g"). A table without a
/// header is the native form, f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg. Uncertainties are
/// expanded ones with k = 2 unless the table says another k; the understanding says so where the
/// names are not of the native form and nothing says it. A column u_common is what all points have
/// in common, and is taken out of u_amplitude; a comment "# shared:" is what they share else.
///
/// Points are put in order. Rows of the same frequency are one point: means of amplitude and
/// phase, and u^2 the mean of theirs plus the variance of the mean by their scatter; what a row
/// states is not made smaller, since most of it is common to all rows. A row without a phase and
/// without its uncertainty is a point whose phase is unknown (`kUnknownPhase_rad`).
///
/// Time and memory are proportional to the text, but for sorting the rows.
///
/// @param[out] imported Of no use after an error.
ImportError import_points(std::string_view text, const ImportOptions& options,
                          ImportedPoints& imported);

}  // namespace emax::desk
