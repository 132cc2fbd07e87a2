// What the names and units above the columns of a table say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "desk/import/input_units.hpp"

namespace emax::desk {

enum class Role : std::uint8_t {
  kIgnored,
  kFrequency,
  kAmplitude,
  kPhase,
  kAmplitudeUncertainty,
  kPhaseUncertainty,
  kCommonUncertainty,  ///< Of the amplitude, what all points have in common.
};

/// One column by its name.
struct Column {
  Role role = Role::kIgnored;
  std::string name;               ///< As it stands in the header.
  std::string unit_spelling;      ///< What stands behind the name; empty if nothing does.
  bool is_omega = false;          ///< The name is that of an angular frequency.
  bool is_lag = false;            ///< The name says lag: positive where the output is late.
  bool is_assumed = false;        ///< An uncertainty that does not say of what.
  bool is_charge = false;         ///< The name says that it is a charge.
  bool is_relative = false;       ///< The name says relative: without a unit it is a part of 1.
  double coverage = 0.0;          ///< The coverage factor k that the name states; 0 for none.
  bool is_contradictory = false;  ///< It states k twice, with different values.
};

/// @returns What one name says. Words that are not known make an ignored column.
Column read_column_name(const std::string& cell);

/// @returns Whether a name is in German, where "Grad" are degrees.
bool is_german(const std::vector<Column>& columns);

/// What a header says as a whole.
struct Header {
  std::vector<Column> columns;
  /// It names a frequency and an amplitude.
  bool is_complete = false;
  /// It names at least one of frequency, amplitude and phase.
  bool is_header = false;
};

/// Reads all names. An uncertainty that does not say of what belongs to the amplitude or phase
/// before it.
Header read_header(const std::vector<std::string>& cells);

/// @returns Whether a line below a header goes on with it: it has units or words of a name in its
/// first cell or none there, and units or such words in at least one.
bool continues_header(const std::vector<std::string>& cells);

/// Names over two lines, such as "Sensitivity" above "mV/g", or "Phase" above "value" and "U": a
/// name holds for the empty cells behind it.
std::vector<std::string> join_names(const std::vector<std::string>& names,
                                    const std::vector<std::string>& below);

/// A coverage factor in a text.
struct CoverageFactor {
  double value = 0.0;  ///< 0 for none.
  std::size_t begin = 0;
  std::size_t length = 0;  ///< Of the characters that state it.
};

/// Finds "k = 2" with a small k that is a word by itself, "k2" and "k 2" if `is_uncertainty`, and
/// "2 sigma".
CoverageFactor find_coverage(std::string_view text, bool is_uncertainty);

/// @returns The column of that role; the number of columns if there is none.
std::size_t column_of(const std::vector<Column>& columns, Role role) noexcept;

}  // namespace emax::desk
