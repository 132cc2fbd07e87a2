// The rows of a table as numbers.
#include "desk/import/read_rows.hpp"

#include <algorithm>
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
constexpr char kExpectedComma[] =
    "expected a number such as 1,03 or 4e3, with a decimal comma as in the rest of the table";
constexpr char kExpectedOneUnit[] =
    "expected the unit of all in the name of the column, such as \"u_amplitude [%]\"";
constexpr char kExpectedOneSign[] =
    "expected one decimal sign in all of the table, and no mark of thousands";

// A cell or a line as a complaint shows it.
std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 40;
  std::size_t end = std::min(text.size(), kMost);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
    --end;
  }
  return "\"" + std::string(text.substr(0, end)) + (end < text.size() ? "..." : "") + "\"";
}

class RowReader final {
 public:
  RowReader(const FoundTable& table, const Conversions& by, const ImportOptions& options,
            std::vector<Row>& rows)
      : table_(table), by_(by), options_(options), rows_(rows) {}

  ImportError run() {
    for (std::size_t i = table_.first_row; i < table_.end_row; ++i) {
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
    if (lacks_comment(row)) {
      row.emplace_back();
    }
    if (row.size() != table_.columns.size()) {
      return error_at(line + 1,
                      std::string(row.size() == 1 ? "there is " : "there are ") +
                          count_of(row.size(), "column") + ": " + shown(table_.text.lines[line]),
                      table_.is_native ? std::string(kExpectedNative)
                                       : "expected " + std::to_string(table_.columns.size()) +
                                             ", as many as the header has; a line that is no row "
                                             "begins with #");
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

  // LabVIEW names a last column for comments, and writes it only where there is one.
  bool lacks_comment(const std::vector<std::string>& row) const {
    return table_.is_labview && row.size() + 1 == table_.columns.size() &&
           table_.columns.back().name == "Comment";
  }

  CellWithUnit cell_of(const std::vector<std::string>& row, const Conversion& from) const {
    return table_.layout.has_units
               ? read_cell_with_unit(row[from.column], table_.layout.has_decimal_comma)
               : CellWithUnit{read_cell(row[from.column], table_.layout.has_decimal_comma), {}};
  }

  ImportError bad_cell(const std::vector<std::string>& row, const Conversion& from,
                       std::size_t line, const char* problem, const char* expectation) const {
    const std::string& cell = row[from.column];
    return error_at(line,
                    from.name + problem + (cell.empty() ? "" : ": " + shown(cell)) + " (column " +
                        std::to_string(from.column + 1) + ")",
                    expectation);
  }

  // @param[out] value In the unit of the column.
  ImportError read_number(const std::vector<std::string>& row, const Conversion& from,
                          std::size_t line, double& value) const {
    const CellWithUnit read = cell_of(row, from);
    const bool has_comma = table_.layout.has_decimal_comma;
    if (read.cell.is_half_width && !from.is_uncertainty) {
      return bad_cell(row, from, line, " has a sign of plus and minus, as an uncertainty",
                      kExpectedNumber);
    }
    switch (read.cell.kind) {
      case CellKind::kNumber:
        value = read.cell.value;
        return read.unit_spelling.empty() ? ImportError{} : convert(row, from, line, read, value);
      case CellKind::kBlank:
        return bad_cell(row, from, line, " is missing", kExpectedNumber);
      case CellKind::kText:
        return read_cell_with_unit(row[from.column], has_comma).unit_spelling.empty()
                   ? bad_cell(row, from, line, " is not a number",
                              has_comma ? kExpectedComma : kExpectedNumber)
                   : bad_cell(row, from, line, " has a unit, and other rows have none",
                              kExpectedOneUnit);
      case CellKind::kNotFinite:
        return bad_cell(row, from, line, " is not a finite number", kExpectedNumber);
      case CellKind::kAmbiguous:
        if (table_.has_thousands && &from == &by_.frequency()) {
          value = read.cell.value;
          return {};
        }
        return bad_cell(
            row, from, line,
            has_comma ? " has a point among decimal commas" : " has a comma among decimal points",
            kExpectedOneSign);
    }
    return {};
  }

  // From the unit behind the number to that of the column.
  ImportError convert(const std::vector<std::string>& row, const Conversion& from, std::size_t line,
                      const CellWithUnit& read, double& value) const {
    const Unit unit = find_unit(read.unit_spelling);
    const bool is_degree =
        are_same(unit, kGrad) && are_same(from.unit, kDegree) && is_german(table_.columns);
    if (are_same(unit, from.unit) || is_degree) {
      return {};
    }
    const bool is_plain =
        !from.is_decibel && unit.quantity == from.unit.quantity && !are_same(unit, kGrad);
    if (!is_plain) {
      return bad_cell(row, from, line, " is in another unit than its column",
                      expected_units(from.unit.quantity));
    }
    value *= unit.scale / from.unit.scale;
    return {};
  }

  ImportError read_positive(const std::vector<std::string>& row, const Conversion& from,
                            std::size_t line, double& value) const {
    ImportError error = read_number(row, from, line, value);
    if (!error && !(value > 0.0)) {
      error = bad_cell(row, from, line, " is zero or negative", "expected a number above 0");
    }
    return error;
  }

  bool is_blank(const std::vector<std::string>& row, const Conversion& from) const {
    return !from.is_there || cell_of(row, from).cell.kind == CellKind::kBlank;
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
      const bool is_deg = by_.phase().unit.name == std::string_view("deg");
      return bad_cell(row, by_.phase(), point.line,
                      is_deg ? " is outside -360 to 360" : " is outside one turn",
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
    point.u_amplitude = standard_uncertainty(from, value, point.amplitude);
    return by_.u_common().is_there ? read_common(row, point) : ImportError{};
  }

  static double standard_uncertainty(const Conversion& from, double value, double amplitude) {
    if (from.is_decibel) {
      return value * kNepersPerDecibel / from.coverage * amplitude;
    }
    const double unit = from.is_relative ? from.unit.scale * amplitude : from.unit.scale;
    return value / from.coverage * unit;
  }

  // The rest is what the point has by itself.
  ImportError read_common(const std::vector<std::string>& row, Row& point) {
    const Conversion& from = by_.u_common();
    double value = 0.0;
    if (ImportError error = read_number(row, from, point.line, value)) {
      return error;
    }
    const double common = standard_uncertainty(from, value, point.amplitude);
    if (!(common >= 0.0) || !(common < point.u_amplitude)) {
      return bad_cell(row, from, point.line, " is not below the uncertainty that contains it",
                      "expected 0 or more, and less than the total");
    }
    point.u_amplitude = sqrt((point.u_amplitude - common) * (point.u_amplitude + common));
    point.u_common = common / point.amplitude;
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
