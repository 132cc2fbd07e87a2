// A table of measured points as a laboratory has it: text in, points or a complaint out.
#include "desk/import/import_points.hpp"

#include <algorithm>
#include <cstdint>

#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/status.hpp"
#include "emax/base/units.hpp"

#include "desk/import/merge_rows.hpp"
#include "desk/import/table_header.hpp"
#include "desk/import/table_layout.hpp"
#include "desk/import/table_text.hpp"

namespace emax::desk {

namespace {

constexpr std::size_t kMaxLineLength = 4096;
constexpr std::size_t kMinPoints = 3;
constexpr std::size_t kNativeColumns = 5;
constexpr double kCoverageFactor = 2.0;
constexpr double kLargestPhase_rad = 360.0 * kRadiansPerDegree;
constexpr double kNepersPerDecibel = 0.11512925464970229;  // ln(10)/20.

constexpr char kExpectedNative[] =
    "expected five numbers separated by commas: f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg; "
    "or a header that names the columns";
constexpr char kExpectedNumber[] = "expected a number such as 1.03 or 4e3";
constexpr char kExpectedPoints[] = "expected 3 to " EMAX_TEXT_OF(EMAX_MAX_POINTS) " points";
constexpr char kExpectedText[] = "expected lines of text with a table of numbers";
constexpr char kExpectedUncertainty[] =
    "expected a column with it, or --uncertainty 1%,1deg (expanded, k = 2)";

// How a column becomes numbers in Hz, V/(m/s^2) and rad.
struct Conversion {
  std::size_t column = 0;
  std::string name;
  Unit unit;
  double sign = 1.0;
  double coverage = kCoverageFactor;  // Of an uncertainty.
  bool is_there = false;
  bool is_relative = false;  // An uncertainty in percent.
  bool is_decibel = false;
};

ImportError error_at(std::size_t line, std::string problem, std::string expectation) {
  return {line, std::move(problem), std::move(expectation)};
}

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

std::string count_of(std::size_t number, const char* noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

class Importer final {
 public:
  Importer(const ImportOptions& options, ImportedPoints& imported)
      : options_(options), imported_(imported) {}

  ImportError run(std::string_view bytes) {
    text_ = decode_table(bytes);
    if (text_.problem != nullptr) {
      return error_at(text_.bad_line, text_.problem,
                      text_.encoding == std::string_view("UTF-32") ? "expected UTF-8 or UTF-16"
                                                                   : kExpectedText);
    }
    layout_ = find_layout(text_.lines);
    ImportError error = find_table();
    if (!error) {
      error = set_conversions();
    }
    if (!error) {
      error = read_rows();
    }
    return error ? error : finish();
  }

 private:
  // Where the table begins

  ImportError find_table() {
    for (std::size_t i = 0; i < text_.lines.size(); ++i) {
      if (text_.lines[i].size() > kMaxLineLength) {
        return error_at(i + 1, "the line has more than 4096 characters", kExpectedText);
      }
    }
    first_row_ = 0;
    while (first_row_ < text_.lines.size() &&
           (is_comment(text_.lines[first_row_]) || !is_row(text_.lines[first_row_], layout_))) {
      ++first_row_;
    }
    const std::size_t columns = columns_of_first_row();
    for (std::size_t i = 0; i < first_row_; ++i) {
      if (!is_comment(text_.lines[i])) {
        before_.push_back(i);
      }
    }
    if (ImportError error = take_header(columns)) {
      return error;
    }
    if (first_row_ == text_.lines.size() && before_.empty()) {
      return error_at(0, "the table holds no points", kExpectedPoints);
    }
    return columns_.empty() ? take_native(columns) : ImportError{};
  }

  std::vector<std::string> cells(std::size_t line) const {
    return cells_of(without_comment(text_.lines[line]), layout_.separator);
  }

  std::size_t columns_of_first_row() const {
    if (first_row_ == text_.lines.size()) {
      return 0;
    }
    return cells(first_row_).size();
  }

  // A row of numbers with something wrong in it is no header.
  bool is_spoilt_row(const std::vector<std::string>& cells, std::size_t columns) const {
    const CellKind kind = read_cell(cells[0], layout_.has_decimal_comma).kind;
    const bool has_count = cells.size() == columns || columns == 0;
    return (kind == CellKind::kNumber && has_count) || kind == CellKind::kNotFinite;
  }

  ImportError take_header(std::size_t columns) {
    for (const std::size_t line : before_) {
      std::vector<std::string> names = cells(line);
      drop_empty_end(names, 1);
      const Header header = read_header(names);
      if (names.size() >= 2 && header.is_complete) {
        columns_ = header.columns;
        header_line_ = line;
        return take_unit_row(line);
      }
      if (is_spoilt_row(names, columns)) {
        first_row_ = line;  // Reading it says what is wrong.
        return {};
      }
    }
    return before_.empty() ? take_comment_as_header(columns) : refuse_header(columns);
  }

  // Between the header and the first row only the units may stand.
  ImportError take_unit_row(std::size_t header_line) {
    const auto below = std::find(before_.begin(), before_.end(), header_line) + 1;
    if (below == before_.end()) {
      return {};
    }
    std::vector<std::string> units = cells(*below);
    drop_empty_end(units, 1);
    if (!is_unit_row(units)) {
      first_row_ = *below;
      return {};
    }
    for (std::size_t i = 0; i < std::min(units.size(), columns_.size()); ++i) {
      if (columns_[i].unit_spelling.empty()) {
        columns_[i].unit_spelling = units[i];
      }
    }
    if (below + 1 != before_.end()) {
      first_row_ = *(below + 1);
    }
    return {};
  }

  // Programs such as numpy write the header as a comment. It is one only if every word of it is.
  ImportError take_comment_as_header(std::size_t columns) {
    std::size_t line = first_row_;
    while (line > 0 && columns > 0) {
      --line;
      std::string_view words = text_.lines[line];
      const std::size_t begin = words.find_first_not_of(" \t#%");
      if (begin == std::string_view::npos) {
        continue;
      }
      std::vector<std::string> names = cells_of(words.substr(begin), layout_.separator);
      drop_empty_end(names, 1);
      const Header header = read_header(names);
      const bool are_all_ours =
          std::all_of(header.columns.begin(), header.columns.end(),
                      [](const Column& column) { return column.role != Role::kIgnored; });
      if (names.size() == columns && header.is_complete && are_all_ours) {
        columns_ = header.columns;
        header_line_ = line;
      }
      return {};
    }
    return {};
  }

  // Words stand before the numbers, but none of the lines names a frequency and an amplitude.
  ImportError refuse_header(std::size_t columns) const {
    for (const std::size_t line : before_) {
      std::vector<std::string> names = cells(line);
      drop_empty_end(names, 1);
      const Header header = read_header(names);
      const bool is_last = line == before_.back();
      if (names.size() < 2 || (!header.is_header && !(is_last && names.size() == columns))) {
        continue;
      }
      const std::size_t frequency = column_of(header.columns, Role::kFrequency);
      const char* missing = frequency == header.columns.size() ? "frequency" : "amplitude";
      return error_at(line + 1, std::string("the header has no name for the ") + missing,
                      "expected names such as f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg");
    }
    return first_row_ == text_.lines.size()
               ? error_at(before_.front() + 1,
                          "there is " + count_of(cells(before_.front()).size(), "column"),
                          kExpectedNative)
               : ImportError{};
  }

  ImportError take_native(std::size_t columns) {
    if (first_row_ < text_.lines.size() && columns > kNativeColumns) {
      std::vector<std::string> row = cells(first_row_);
      drop_empty_end(row, kNativeColumns);
      columns = row.size();
    }
    if (columns != kNativeColumns && columns != 0) {
      return error_at(first_row_ + 1, "there are " + count_of(columns, "column") + " and no header",
                      kExpectedNative);
    }
    constexpr const char* kNames[] = {"f_hz", "amplitude", "phase_deg", "u_amplitude",
                                      "u_phase_deg"};
    constexpr Role kRolesInOrder[] = {Role::kFrequency, Role::kAmplitude, Role::kPhase,
                                      Role::kAmplitudeUncertainty, Role::kPhaseUncertainty};
    for (std::size_t i = 0; i < kNativeColumns; ++i) {
      columns_.emplace_back();
      columns_.back().name = kNames[i];
      columns_.back().role = kRolesInOrder[i];
    }
    is_native_ = true;
    return {};
  }

  // What its columns mean

  ImportError set_conversions() {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const Role role = columns_[i].role;
      if (role == Role::kIgnored) {
        continue;
      }
      Conversion& conversion = conversion_of(role);
      if (conversion.is_there) {
        return error_at(header_line_ + 1,
                        quoted(conversion.name) + " and " + quoted(columns_[i].name) +
                            " name the same quantity",
                        "expected one column of each");
      }
      conversion.is_there = true;
      conversion.column = i;
      conversion.name = columns_[i].name;
      conversion.sign = columns_[i].is_lag ? -1.0 : 1.0;
      conversion.coverage = columns_[i].is_standard ? 1.0 : kCoverageFactor;
    }
    if (ImportError error = set_units()) {
      return error;
    }
    return check_uncertainties();
  }

  Conversion& conversion_of(Role role) noexcept {
    return conversions_[static_cast<std::size_t>(role)];
  }
  const Conversion& conversion_of(Role role) const noexcept {
    return conversions_[static_cast<std::size_t>(role)];
  }
  Conversion& frequency() noexcept { return conversion_of(Role::kFrequency); }
  Conversion& amplitude() noexcept { return conversion_of(Role::kAmplitude); }
  Conversion& phase() noexcept { return conversion_of(Role::kPhase); }
  Conversion& u_amplitude() noexcept { return conversion_of(Role::kAmplitudeUncertainty); }
  Conversion& u_phase() noexcept { return conversion_of(Role::kPhaseUncertainty); }

  ImportError set_units() {
    const bool is_omega = columns_[frequency().column].is_omega;
    ImportError error = set_unit(frequency(), Quantity::kFrequency, options_.frequency_unit,
                                 is_omega ? kRadiansPerSecond : kHertz);
    if (!error) {
      error = set_amplitude_unit();
    }
    if (!error && phase().is_there) {
      error = set_unit(phase(), Quantity::kPhase, options_.phase_unit, kDegree);
    }
    if (!error && u_amplitude().is_there) {
      error = set_uncertainty_unit(u_amplitude(), amplitude());
    }
    if (!error && u_phase().is_there) {
      error = set_uncertainty_unit(u_phase(), phase().is_there ? phase() : u_phase());
    }
    return error;
  }

  ImportError unknown_unit(const Conversion& conversion, Quantity quantity) const {
    return error_at(header_line_ + 1,
                    "the unit " + quoted(columns_[conversion.column].unit_spelling) + " of " +
                        quoted(conversion.name) + " is not known",
                    expected_units(quantity));
  }

  ImportError set_unit(Conversion& conversion, Quantity quantity, const Unit& given,
                       const Unit& by_default) const {
    const std::string& spelling = columns_[conversion.column].unit_spelling;
    if (spelling.empty()) {
      conversion.unit = given.is_given() ? given : by_default;
      return {};
    }
    conversion.unit = find_unit(spelling);
    if (!conversion.unit.is_given() || conversion.unit.quantity != quantity) {
      return unknown_unit(conversion, quantity);
    }
    return contradiction(conversion, given);
  }

  ImportError contradiction(const Conversion& conversion, const Unit& given) const {
    if (!given.is_given() || std::string_view(given.name) == conversion.unit.name) {
      return {};
    }
    return error_at(header_line_ + 1,
                    std::string("the header says ") + conversion.unit.name +
                        " and --input-units says " + given.name,
                    "expected --input-units only for columns whose unit is not named");
  }

  ImportError set_amplitude_unit() {
    const DecibelUnit decibel = as_decibel(columns_[amplitude().column].unit_spelling);
    if (!decibel.is_decibel) {
      return set_unit(amplitude(), Quantity::kAmplitude, options_.amplitude_unit,
                      kVoltsPerAcceleration);
    }
    amplitude().is_decibel = true;
    amplitude().unit =
        decibel.reference.empty() ? kVoltsPerAcceleration : find_unit(decibel.reference);
    if (decibel.reference.empty() && options_.amplitude_unit.is_given()) {
      amplitude().unit = options_.amplitude_unit;
    }
    return !amplitude().unit.is_given() || amplitude().unit.quantity != Quantity::kAmplitude
               ? unknown_unit(amplitude(), Quantity::kAmplitude)
               : ImportError{};
  }

  // An uncertainty is in its own unit, in percent or dB, or in the unit of what it belongs to.
  ImportError set_uncertainty_unit(Conversion& u, const Conversion& of) const {
    const std::string& spelling = columns_[u.column].unit_spelling;
    const bool is_amplitude = &u == &conversions_[std::size_t(Role::kAmplitudeUncertainty)];
    if (spelling.empty()) {
      u.unit = of.unit.is_given() ? of.unit : kDegree;
      u.is_decibel = of.is_decibel;
      return {};
    }
    u.unit = find_unit(spelling);
    u.is_decibel = is_amplitude && as_decibel(spelling).is_decibel;
    u.is_relative = is_amplitude && u.unit.is_given() && u.unit.quantity == Quantity::kRatio;
    const Quantity wanted = is_amplitude ? Quantity::kAmplitude : Quantity::kPhase;
    const bool is_plain = u.unit.is_given() && u.unit.quantity == wanted;
    if (u.is_decibel) {
      u.unit = kDecibelUnit;
    }
    return is_plain || u.is_decibel || u.is_relative
               ? ImportError{}
               : unknown_unit(u, is_amplitude ? Quantity::kRatio : Quantity::kPhase);
  }

  ImportError check_uncertainties() {
    const bool is_amplitude_given = options_.amplitude_uncertainty.value > 0.0;
    const bool is_phase_given = options_.phase_uncertainty.value > 0.0;
    if (!u_amplitude().is_there && !is_amplitude_given) {
      return error_at(header_line_ + 1, "there is no uncertainty of the amplitude",
                      kExpectedUncertainty);
    }
    if (phase().is_there && !u_phase().is_there && !is_phase_given) {
      return error_at(header_line_ + 1, "there is no uncertainty of the phase",
                      kExpectedUncertainty);
    }
    const bool all_there = u_amplitude().is_there && (u_phase().is_there || !phase().is_there);
    if (all_there && (is_amplitude_given || is_phase_given)) {
      return error_at(header_line_ + 1, "the table has uncertainties of its own",
                      "expected --uncertainty only for a table without them");
    }
    return {};
  }

  // Its rows

  ImportError read_rows() {
    for (std::size_t i = first_row_; i < text_.lines.size(); ++i) {
      if (is_comment(text_.lines[i])) {
        continue;
      }
      if (ImportError error = read_row(i)) {
        return error;
      }
    }
    return {};
  }

  ImportError read_row(std::size_t line) {
    std::vector<std::string> row = cells(line);
    drop_empty_end(row, columns_.size());
    if (row.size() != columns_.size()) {
      return error_at(line + 1,
                      std::string(row.size() == 1 ? "there is " : "there are ") +
                          count_of(row.size(), "column"),
                      is_native_ ? std::string(kExpectedNative)
                                 : "expected " + std::to_string(columns_.size()) +
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
    const Cell cell = read_cell(row[from.column], layout_.has_decimal_comma);
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
           read_cell(row[from.column], layout_.has_decimal_comma).kind == CellKind::kBlank;
  }

  ImportError read_phase(const std::vector<std::string>& row, Row& point) {
    point.has_phase = !(is_blank(row, phase()) && is_blank(row, u_phase()));
    if (!phase().is_there || !point.has_phase) {
      point.has_phase = false;
      return {};
    }
    double value = 0.0;
    if (ImportError error = read_number(row, phase(), point.line, value)) {
      return error;
    }
    const double largest = kLargestPhase_rad / phase().unit.scale;
    if (abs(value) > largest * (1.0 + 1e-12)) {
      return error_at(
          point.line,
          phase().name + " is outside " +
              (phase().unit.name == std::string_view("deg") ? "-360 to 360" : "one turn"),
          "expected a phase within a turn, negative for a lag");
    }
    point.phase_rad = phase().sign * value * phase().unit.scale;
    if (!u_phase().is_there) {
      const GivenUncertainty& given = options_.phase_uncertainty;
      point.u_phase_rad = given.value / kCoverageFactor * given.unit.scale;
      return {};
    }
    ImportError error = read_positive(row, u_phase(), point.line, value);
    point.u_phase_rad = value / u_phase().coverage * u_phase().unit.scale;
    return error;
  }

  ImportError read_main(const std::vector<std::string>& row, Row& point) {
    double value = 0.0;
    if (ImportError error = read_positive(row, frequency(), point.line, value)) {
      return error;
    }
    point.frequency_hz = value * frequency().unit.scale;
    if (ImportError error = amplitude().is_decibel
                                ? read_number(row, amplitude(), point.line, value)
                                : read_positive(row, amplitude(), point.line, value)) {
      return error;
    }
    const double plain = amplitude().is_decibel ? exp(value * kNepersPerDecibel) : value;
    point.amplitude = plain * amplitude().unit.scale;
    return read_amplitude_uncertainty(row, point);
  }

  ImportError read_amplitude_uncertainty(const std::vector<std::string>& row, Row& point) {
    const GivenUncertainty& given = options_.amplitude_uncertainty;
    double value = given.value;
    Conversion from = u_amplitude();
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

  // The whole

  ImportError finish() {
    const MergedRows merged = merge_rows(rows_);
    for (const Row& row : merged.rows) {
      if (ImportError error = add_point(row)) {
        return error;
      }
    }
    const std::size_t count = imported_.points.size();
    if (count < kMinPoints) {
      return error_at(0,
                      count == 0 ? "the table holds no points"
                                 : "the table holds only " + count_of(count, "point"),
                      kExpectedPoints);
    }
    imported_.understanding = understanding(merged);
    return {};
  }

  ImportError add_point(const Row& row) {
    ResponsePoint point;
    point.frequency_hz = row.frequency_hz;
    point.amplitude = row.amplitude;
    point.u_amplitude = row.u_amplitude;
    point.u_phase_rad = kUnknownPhase_rad;
    if (row.has_phase) {
      point.phase_rad = row.phase_rad;
      point.u_phase_rad = row.u_phase_rad;
      turn(point);
    }
    const Status status = imported_.points.add(point);
    if (status == Status::kTooManyPoints) {
      return error_at(row.line, "this is one point more than " EMAX_TEXT_OF(EMAX_MAX_POINTS),
                      kExpectedPoints);
    }
    if (status != Status::kOk) {
      return error_at(row.line, "a number is too small or too large to be represented",
                      "expected uncertainties well above 0");
    }
    imported_.lines.push_back(row.line);
    return {};
  }

  void turn(ResponsePoint& point) const {
    if (options_.channel_delay_s == 0.0 && !options_.is_inverted) {
      return;
    }
    const double half_turn = options_.is_inverted ? kPi : 0.0;
    const SinCos angle = sincos(point.phase_rad + half_turn +
                                kTwoPi * point.frequency_hz * options_.channel_delay_s);
    point.phase_rad = atan2(angle.sin, angle.cos);
  }

  // What was understood

  std::string understanding(const MergedRows& merged) {
    std::string text = std::string("read as ") + frequency().unit.name + ", ";
    text += amplitude().is_decibel ? "dB re 1 " : "";
    text += amplitude().unit.name;
    text += phase().is_there ? std::string(", ") + phase().unit.name : ", no phase";
    add_uncertainty_units(text);
    text += "; " + count_of(imported_.points.size(), "point");
    if (merged.repeats > 0) {
      text += ", " + std::to_string(merged.repeats) + " of them the mean of repeated rows";
    }
    add_changes(text);
    add_form(text);
    return text;
  }

  void add_uncertainty_units(std::string& text) {
    const auto name = [](const Conversion& u) { return u.is_decibel ? "dB" : u.unit.name; };
    const bool is_own =
        u_amplitude().is_there && (u_amplitude().is_relative || u_amplitude().is_decibel ||
                                   name(u_amplitude()) != name(amplitude()));
    if (is_own) {
      text += std::string(", ") + name(u_amplitude());
    }
    if (u_phase().is_there && phase().is_there &&
        std::string_view(u_phase().unit.name) != phase().unit.name) {
      text += std::string(", ") + u_phase().unit.name;
    }
    if (u_amplitude().coverage == 1.0 || u_phase().coverage == 1.0) {
      text += ", standard uncertainties";
    }
    if (!u_amplitude().is_there || (phase().is_there && !u_phase().is_there)) {
      text += ", uncertainties by --uncertainty";
    }
  }

  void add_changes(std::string& text) {
    text += phase().sign < 0.0 ? "; a lag is positive" : "";
    text += options_.is_inverted ? "; polarity turned round" : "";
    text += options_.channel_delay_s != 0.0 ? "; the channel's delay taken out" : "";
    text += amplitude().unit.is_charge ? "; 1 pC is taken as 1 V" : "";
  }

  void add_form(std::string& text) const {
    if (layout_.separator != Separator::kComma) {
      text += std::string("; ") + name_of(layout_.separator);
    }
    text += layout_.has_decimal_comma ? "; decimal comma" : "";
    if (text_.encoding != std::string_view("UTF-8")) {
      text += std::string("; ") + text_.encoding;
    }
    std::string unused;
    for (const Column& column : columns_) {
      if (column.role == Role::kIgnored && !column.name.empty()) {
        unused += (unused.empty() ? "" : ", ") + column.name;
      }
    }
    text += unused.empty() ? "" : "; not used: " + unused;
  }

  static constexpr std::size_t kRoles = static_cast<std::size_t>(Role::kPhaseUncertainty) + 1;

  const ImportOptions& options_;
  ImportedPoints& imported_;
  TableText text_;
  TableLayout layout_;
  std::vector<std::size_t> before_;  // Lines with words before the first row.
  std::size_t first_row_ = 0;
  std::size_t header_line_ = 0;
  bool is_native_ = false;
  std::vector<Column> columns_;
  Conversion conversions_[kRoles];
  std::vector<Row> rows_;
};

}  // namespace

ImportError import_points(std::string_view text, const ImportOptions& options,
                          ImportedPoints& imported) {
  imported = ImportedPoints();
  return Importer(options, imported).run(text);
}

}  // namespace emax::desk
