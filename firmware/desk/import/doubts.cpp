// What in a table is unlikely, though it can be read.
#include "desk/import/doubts.hpp"

#include <algorithm>

#include "desk/import/table_statements.hpp"

namespace emax::desk {

namespace {

// Of a seismic accelerometer of 100 V/g.
constexpr double kMostSensitivity = 10.0;
// Expanded, of the amplitude: nobody calibrates as badly at every frequency.
constexpr double kMostUncertainty = 0.3;

bool is_named(const FoundTable& table, const Conversion& column) {
  return !table.columns[column.column].unit_spelling.empty();
}

double largest_amplitude(const std::vector<Row>& rows) {
  double largest = 0.0;
  for (const Row& row : rows) {
    largest = std::max(largest, row.amplitude);
  }
  return largest;
}

double least_uncertainty(const std::vector<Row>& rows) {
  double least = 1.0;
  for (const Row& row : rows) {
    least = std::min(least, kImportCoverage * row.u_amplitude / row.amplitude);
  }
  return least;
}

}  // namespace

std::string doubts_of(const FoundTable& table, const Conversions& by, const ImportOptions& options,
                      const std::vector<Row>& rows) {
  std::string words;
  const bool is_amplitude_named =
      is_named(table, by.amplitude()) || options.amplitude_unit.is_given();
  const double largest = largest_amplitude(rows);
  if (!is_amplitude_named && largest > kMostSensitivity) {
    words =
        "No unit of the amplitude is named, and V/(m/s2) was taken: " + text_of_number(largest) +
        " V/(m/s2) is more than usual accelerometers have; where it is mV/g or mV/(m/s2), name "
        "it in the header or by --input-units mV/g.";
  }
  const Conversion& u = by.u_amplitude();
  const bool is_plain = u.is_there && !u.is_relative && !u.is_decibel && !is_named(table, u);
  const double least = least_uncertainty(rows);
  if (is_plain && least > kMostUncertainty) {
    words += std::string(words.empty() ? "" : " ") +
             "The uncertainties of the amplitude have no unit of their own, and in that of the "
             "amplitude they are " +
             text_of_number(100.0 * least) +
             " % of it or more; where they are in percent, name them so, such as "
             "u_amplitude_percent.";
  }
  return words;
}

}  // namespace emax::desk
