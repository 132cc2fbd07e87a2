// What the names and units above the columns of a table say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
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
};

/// One column by its name.
struct Column {
  Role role = Role::kIgnored;
  std::string name;           ///< As it stands in the header.
  std::string unit_spelling;  ///< What stands behind the name; empty if nothing does.
  bool is_omega = false;      ///< The name is that of an angular frequency.
  bool is_lag = false;        ///< The name says lag: positive where the output is late.
  bool is_assumed = false;    ///< An uncertainty that does not say of what.
  bool is_standard = false;   ///< A standard uncertainty (k = 1), not an expanded one.
};

/// @returns What one name says. Words that are not known make an ignored column.
Column read_column_name(const std::string& cell);

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

/// @returns Whether every cell that is not empty is a unit, and at least two are.
bool is_unit_row(const std::vector<std::string>& cells);

/// @returns The column of that role; the number of columns if there is none.
std::size_t column_of(const std::vector<Column>& columns, Role role) noexcept;

}  // namespace emax::desk
