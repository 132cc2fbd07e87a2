// The rows of a table as numbers.
#include "desk/import/read_rows.hpp"

#include <cstddef>
#include <string>
#include <string_view>

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

#include "desk/import/table_layout.hpp"

namespace emax::desk {

namespace {

constexpr double kLargestPhase_rad = 360.0 * kRadiansPerDegree;
constexpr double kNepersPerDecibel = 0.11512925464970229;  // ln(10)/20.
constexpr char kExpectedNumber[] = "expected a number such as 1.03 or 4e3";

class RowReader final {
 public:
  RowReader(const FoundTable& table, const Conversions& by, const ImportOptions& options,
            std::vector<Row>& rows)
      : table_(table), by_(by), options_(options), rows_(rows) {}

  ImportError run() {
    for (std::size_t i = table_.first_row; i < table_.text.lines.size(); ++i) {
      if (is_comment(table_.text.lines[i])) {
        continue;
      }
      if (ImportError error = read_row(i)) {
        return error;
      }
    }
    return {};
  }

 private:
  ImportError read_row(std::size_t line) {
    std::vector<std::string> row = table_.cells(line);
    drop_empty_end(row, table_.columns.size());
    if (row.size() != table_.columns.size()) {
      return error_at(line + 1,
                      std::string(row.size() == 1 ? "there is " : "there are ") +
                          count_of(row.size(), "column"),
                      table_.is_native ? std::string(kExpectedNative)
                                       : "expected " + std::to_string(table_.columns.size()) +
                                             ", as many as the header has");
    }
    Row point;
    point.line = line + 1;
    ImportError error = read_phase(row, point);
    if (!error) {
      error = read_main(row, point);
    }
    if (!error) {
      rows_.push_back(point);
    }
    return error;
  }

  // @param[out] value In the unit of the column.
  ImportError read_number(const std::vector<std::string>& row, const Conversion& from,
                          std::size_t line, double& value) const {
    const Cell cell = read_cell(row[from.column], table_.layout.has_decimal_comma);
    switch (cell.kind) {
      case CellKind::kNumber:
        value = cell.value;
        return {};
      case CellKind::kBlank:
        return error_at(line, from.name + " is missing", kExpectedNumber);
      case CellKind::kText:
        return error_at(line, from.name + " is not a number", kExpectedNumber);
      case CellKind::kNotFinite:
        return error_at(line, from.name + " is not a finite number", kExpectedNumber);
    }
    return {};
  }

  ImportError read_positive(const std::vector<std::string>& row, const Conversion& from,
                            std::size_t line, double& value) const {
    ImportError error = read_number(row, from, line, value);
    if (!error && !(value > 0.0)) {
      error = error_at(line, from.name + " is zero or negative", "expected a number above 0");
    }
    return error;
  }

  bool is_blank(const std::vector<std::string>& row, const Conversion& from) const {
    return !from.is_there ||
           read_cell(row[from.column], table_.layout.has_decimal_comma).kind == CellKind::kBlank;
  }

  ImportError read_phase(const std::vector<std::string>& row, Row& point) {
    point.has_phase = !(is_blank(row, by_.phase()) && is_blank(row, by_.u_phase()));
    if (!by_.phase().is_there || !point.has_phase) {
      point.has_phase = false;
      return {};
    }
    double value = 0.0;
    if (ImportError error = read_number(row, by_.phase(), point.line, value)) {
      return error;
    }
    const double largest = kLargestPhase_rad / by_.phase().unit.scale;
    if (abs(value) > largest * (1.0 + 1e-12)) {
      return error_at(
          point.line,
          by_.phase().name + " is outside " +
              (by_.phase().unit.name == std::string_view("deg") ? "-360 to 360" : "one turn"),
          "expected a phase within a turn, negative for a lag");
    }
    point.phase_rad = by_.phase().sign * value * by_.phase().unit.scale;
    if (!by_.u_phase().is_there) {
      const GivenUncertainty& given = options_.phase_uncertainty;
      point.u_phase_rad = given.value / kImportCoverage * given.unit.scale;
      return {};
    }
    ImportError error = read_positive(row, by_.u_phase(), point.line, value);
    point.u_phase_rad = value / by_.u_phase().coverage * by_.u_phase().unit.scale;
    return error;
  }

  ImportError read_main(const std::vector<std::string>& row, Row& point) {
    double value = 0.0;
    if (ImportError error = read_positive(row, by_.frequency(), point.line, value)) {
      return error;
    }
    point.frequency_hz = value * by_.frequency().unit.scale;
    if (ImportError error = by_.amplitude().is_decibel
                                ? read_number(row, by_.amplitude(), point.line, value)
                                : read_positive(row, by_.amplitude(), point.line, value)) {
      return error;
    }
    const double plain = by_.amplitude().is_decibel ? exp(value * kNepersPerDecibel) : value;
    point.amplitude = plain * by_.amplitude().unit.scale;
    return read_amplitude_uncertainty(row, point);
  }

  ImportError read_amplitude_uncertainty(const std::vector<std::string>& row, Row& point) {
    const GivenUncertainty& given = options_.amplitude_uncertainty;
    double value = given.value;
    Conversion from = by_.u_amplitude();
    if (from.is_there) {
      if (ImportError error = read_positive(row, from, point.line, value)) {
        return error;
      }
    } else {
      from.unit = given.unit;
      from.is_relative = given.unit.quantity == Quantity::kRatio;
      from.is_decibel = given.unit.quantity == Quantity::kDecibel;
    }
    if (from.is_decibel) {
      point.u_amplitude = value * kNepersPerDecibel / from.coverage * point.amplitude;
      return {};
    }
    const double unit = from.is_relative ? from.unit.scale * point.amplitude : from.unit.scale;
    point.u_amplitude = value / from.coverage * unit;
    return {};
  }

  const FoundTable& table_;
  const Conversions& by_;
  const ImportOptions& options_;
  std::vector<Row>& rows_;
};

}  // namespace

ImportError read_rows(const FoundTable& table, const Conversions& conversions,
                      const ImportOptions& options, std::vector<Row>& rows) {
  rows.clear();
  return RowReader(table, conversions, options, rows).run();
}

}  // namespace emax::desk
