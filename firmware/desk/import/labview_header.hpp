// The lines above the columns of a LabVIEW measurement file (.lvm).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace emax::desk {

/// What they say of the columns.
struct LabviewHeader {
  std::size_t names_line = 0;  ///< That begins with X_Value, from 0; 0 for none.
  bool is_frequency = false;   ///< X_Dimension is Frequency for all channels.
  std::string unit_of_frequency;
  std::vector<std::string> units;  ///< Y_Unit_Label by column; the first is that of the row's name.
};

/// @returns An object without a line of names if the first line is not that of such a file, or if
/// no line begins with X_Value.
LabviewHeader read_labview_header(const std::vector<std::string>& lines);

}  // namespace emax::desk
