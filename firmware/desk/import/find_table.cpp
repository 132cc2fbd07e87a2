// Where in a text the table is: its layout, its header, its first row.
#include "desk/import/find_table.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace emax::desk {

namespace {

constexpr std::size_t kMaxLineLength = 4096;
constexpr std::size_t kNativeColumns = 5;

class TableFinder final {
 public:
  explicit TableFinder(FoundTable& table) : table_(table) {}

  ImportError run() {
    for (std::size_t i = 0; i < table_.text.lines.size(); ++i) {
      if (table_.text.lines[i].size() > kMaxLineLength) {
        return error_at(i + 1, "the line has more than 4096 characters", kExpectedText);
      }
    }
    table_.first_row = 0;
    while (table_.first_row < table_.text.lines.size() &&
           (is_comment(table_.text.lines[table_.first_row]) ||
            !is_row(table_.text.lines[table_.first_row], table_.layout))) {
      ++table_.first_row;
    }
    const std::size_t columns = columns_of_first_row();
    for (std::size_t i = 0; i < table_.first_row; ++i) {
      if (!is_comment(table_.text.lines[i])) {
        before_.push_back(i);
      }
    }
    if (ImportError error = take_header(columns)) {
      return error;
    }
    if (table_.first_row == table_.text.lines.size() && before_.empty()) {
      return error_at(0, "the table holds no points", kExpectedPoints);
    }
    return table_.columns.empty() ? take_native(columns) : ImportError{};
  }

 private:
  std::size_t columns_of_first_row() const {
    if (table_.first_row == table_.text.lines.size()) {
      return 0;
    }
    return table_.cells(table_.first_row).size();
  }

  // A row of numbers with something wrong in it is no header.
  bool is_spoilt_row(const std::vector<std::string>& cells, std::size_t columns) const {
    const CellKind kind = read_cell(cells[0], table_.layout.has_decimal_comma).kind;
    const bool has_count = cells.size() == columns || columns == 0;
    return (kind == CellKind::kNumber && has_count) || kind == CellKind::kNotFinite;
  }

  ImportError take_header(std::size_t columns) {
    for (const std::size_t line : before_) {
      std::vector<std::string> names = table_.cells(line);
      drop_empty_end(names, 1);
      const Header header = read_header(names);
      if (names.size() >= 2 && header.is_complete) {
        table_.columns = header.columns;
        table_.header_line = line;
        return take_unit_row(line);
      }
      if (is_spoilt_row(names, columns)) {
        table_.first_row = line;  // Reading it says what is wrong.
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
    std::vector<std::string> units = table_.cells(*below);
    drop_empty_end(units, 1);
    if (!is_unit_row(units)) {
      table_.first_row = *below;
      return {};
    }
    for (std::size_t i = 0; i < std::min(units.size(), table_.columns.size()); ++i) {
      if (table_.columns[i].unit_spelling.empty()) {
        table_.columns[i].unit_spelling = units[i];
      }
    }
    if (below + 1 != before_.end()) {
      table_.first_row = *(below + 1);
    }
    return {};
  }

  // Programs such as numpy write the header as a comment. It is one only if every word of it is.
  ImportError take_comment_as_header(std::size_t columns) {
    std::size_t line = table_.first_row;
    while (line > 0 && columns > 0) {
      --line;
      std::string_view words = table_.text.lines[line];
      const std::size_t begin = words.find_first_not_of(" \t#%");
      if (begin == std::string_view::npos) {
        continue;
      }
      std::vector<std::string> names = cells_of(words.substr(begin), table_.layout.separator);
      drop_empty_end(names, 1);
      const Header header = read_header(names);
      const bool are_all_ours =
          std::all_of(header.columns.begin(), header.columns.end(),
                      [](const Column& column) { return column.role != Role::kIgnored; });
      if (names.size() == columns && header.is_complete && are_all_ours) {
        table_.columns = header.columns;
        table_.header_line = line;
      }
      return {};
    }
    return {};
  }

  // Words stand before the numbers, but none of the lines names a frequency and an amplitude.
  ImportError refuse_header(std::size_t columns) const {
    for (const std::size_t line : before_) {
      std::vector<std::string> names = table_.cells(line);
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
    return table_.first_row == table_.text.lines.size()
               ? error_at(before_.front() + 1,
                          "there is " + count_of(table_.cells(before_.front()).size(), "column"),
                          kExpectedNative)
               : ImportError{};
  }

  ImportError take_native(std::size_t columns) {
    if (table_.first_row < table_.text.lines.size() && columns > kNativeColumns) {
      std::vector<std::string> row = table_.cells(table_.first_row);
      drop_empty_end(row, kNativeColumns);
      columns = row.size();
    }
    if (columns != kNativeColumns && columns != 0) {
      return error_at(table_.first_row + 1,
                      "there are " + count_of(columns, "column") + " and no header",
                      kExpectedNative);
    }
    constexpr const char* kNames[] = {"f_hz", "amplitude", "phase_deg", "u_amplitude",
                                      "u_phase_deg"};
    constexpr Role kRolesInOrder[] = {Role::kFrequency, Role::kAmplitude, Role::kPhase,
                                      Role::kAmplitudeUncertainty, Role::kPhaseUncertainty};
    for (std::size_t i = 0; i < kNativeColumns; ++i) {
      table_.columns.emplace_back();
      table_.columns.back().name = kNames[i];
      table_.columns.back().role = kRolesInOrder[i];
    }
    table_.is_native = true;
    return {};
  }

  FoundTable& table_;
  std::vector<std::size_t> before_;  // Lines with words before the first row.
};

}  // namespace

std::vector<std::string> FoundTable::cells(std::size_t line) const {
  return cells_of(without_comment(text.lines[line]), layout.separator);
}

ImportError find_table(std::string_view bytes, FoundTable& table) {
  table = FoundTable();
  table.text = decode_table(bytes);
  if (table.text.problem != nullptr) {
    const bool is_wide = table.text.encoding == std::string_view("UTF-32");
    return error_at(table.text.bad_line, table.text.problem,
                    is_wide ? "expected UTF-8 or UTF-16" : kExpectedText);
  }
  table.layout = find_layout(table.text.lines);
  return TableFinder(table).run();
}

}  // namespace emax::desk
