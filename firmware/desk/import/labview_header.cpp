// The lines above the columns of a LabVIEW measurement file (.lvm).
#include "desk/import/labview_header.hpp"

#include <algorithm>
#include <string_view>

#include "desk/import/table_layout.hpp"

namespace emax::desk {

namespace {

constexpr std::string_view kFirstLine = "LabVIEW Measurement";
constexpr std::size_t kMostLines = 200;

// Tabs or commas; units have no commas.
std::vector<std::string> fields_of(const std::string& line) {
  const bool has_tabs = line.find('\t') != std::string::npos;
  std::vector<std::string> fields = cells_of(line, has_tabs ? Separator::kTab : Separator::kComma);
  drop_empty_end(fields, 1);
  return fields;
}

}  // namespace

LabviewHeader read_labview_header(const std::vector<std::string>& lines) {
  LabviewHeader header;
  if (lines.empty() || lines.front().compare(0, kFirstLine.size(), kFirstLine) != 0) {
    return header;
  }
  for (std::size_t i = 1; i < std::min(lines.size(), kMostLines); ++i) {
    const std::vector<std::string> fields = fields_of(lines[i]);
    if (fields.front() == "X_Dimension") {
      header.is_frequency =
          fields.size() > 1 && std::all_of(fields.begin() + 1, fields.end(),
                                           [](const std::string& f) { return f == "Frequency"; });
    } else if (fields.front() == "X_Unit_Label") {
      header.unit_of_frequency = fields.size() > 1 ? fields[1] : "";
    } else if (fields.front() == "Y_Unit_Label") {
      header.units = fields;
    } else if (fields.front() == "X_Value") {
      header.names_line = i;
      return header;
    }
  }
  return header;
}

}  // namespace emax::desk
