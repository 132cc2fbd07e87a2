// Where in a text the table is: its layout, its header, its first row.
#include "desk/import/find_table.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "desk/import/labview_header.hpp"
#include "desk/import/letters.hpp"

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
    if (ImportError error = table_.columns.empty() ? take_native(columns) : ImportError{}) {
      return error;
    }
    return take_statements();
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
    const bool is_number = kind == CellKind::kNumber || kind == CellKind::kAmbiguous;
    return (is_number && has_count) || kind == CellKind::kNotFinite;
  }

  std::vector<std::string> names_in(std::size_t line) const {
    std::vector<std::string> names = table_.cells(line);
    drop_empty_end(names, 1);
    return names;
  }

  // A line with words of which none is a number may go on with the header above it.
  bool may_be_names(const std::vector<std::string>& cells) const {
    return std::all_of(cells.begin(), cells.end(), [this](const std::string& cell) {
      const CellKind kind = read_cell(cell, table_.layout.has_decimal_comma).kind;
      return kind == CellKind::kText || kind == CellKind::kBlank;
    });
  }

  void take_names(const Header& header, std::size_t line) {
    table_.columns = header.columns;
    table_.header_line = line;
    table_.header_lines.push_back(line);
  }

  ImportError take_header(std::size_t columns) {
    const LabviewHeader labview = read_labview_header(table_.text.lines);
    if (labview.names_line != 0) {
      return take_labview(labview);
    }
    for (std::size_t i = 0; i < before_.size(); ++i) {
      const std::vector<std::string> names = names_in(before_[i]);
      const Header header = read_header(names);
      if (names.size() >= 2 && header.is_complete) {
        take_names(header, before_[i]);
        take_lines_below(names, i + 1);
        return {};
      }
      if (take_pair(names, i, columns)) {
        return {};
      }
      if (is_spoilt_row(names, columns)) {
        table_.first_row = before_[i];  // Reading it says what is wrong.
        return {};
      }
    }
    return before_.empty() ? take_comment_as_header(columns) : refuse_header(columns);
  }

  // X_Value is what the lines above say, and the units are there, too.
  ImportError take_labview(const LabviewHeader& labview) {
    std::vector<std::string> names = names_in(labview.names_line);
    if (!labview.is_frequency) {
      return error_at(labview.names_line + 1, "X_Value of this LabVIEW file is no frequency",
                      "expected a spectrum, whose X_Dimension is Frequency, or the name Frequency "
                      "in place of X_Value");
    }
    names.front() = "Frequency";
    const Header header = read_header(names);
    if (!header.is_complete) {
      return error_at(labview.names_line + 1, "the header has no name for the amplitude",
                      "expected names of the channels such as Amplitude, Phase, U amplitude and U "
                      "phase in place of Untitled");
    }
    take_names(header, labview.names_line);
    table_.is_labview = true;
    table_.columns.front().name = "X_Value";
    table_.columns.front().unit_spelling = labview.unit_of_frequency;
    for (std::size_t i = 1; i < std::min(table_.columns.size(), labview.units.size()); ++i) {
      std::string& spelling = table_.columns[i].unit_spelling;
      spelling = spelling.empty() ? labview.units[i] : spelling;
    }
    for (std::size_t line = 0; line < labview.names_line; ++line) {
      table_.header_lines.push_back(line);  // All that is to be read there has been read.
    }
    return {};
  }

  // Two lines that are a header only together: "Magnitude" and "Phase" above "f", "value", "U".
  bool take_pair(const std::vector<std::string>& names, std::size_t index, std::size_t columns) {
    if (index + 1 == before_.size()) {
      return false;
    }
    const std::vector<std::string> below = names_in(before_[index + 1]);
    const std::vector<std::string> joined = join_names(names, below);
    const Header header = read_header(joined);
    if (joined.size() != columns || !header.is_complete || !may_be_names(names) ||
        !may_be_names(below) || read_header(below).is_complete) {
      return false;
    }
    table_.header_lines.push_back(before_[index]);
    take_names(header, before_[index + 1]);
    take_lines_below(joined, index + 2);
    return true;
  }

  // Between the header and the first row only more of the header may stand.
  void take_lines_below(std::vector<std::string> names, std::size_t index) {
    constexpr std::size_t kMostLines = 4;  // Of names; each makes them longer.
    for (; index < before_.size(); ++index) {
      const std::vector<std::string> below = names_in(before_[index]);
      const bool is_full = table_.header_lines.size() >= kMostLines;
      if (is_full || !may_be_names(below) || !continues_header(below)) {
        if (is_statement(table_.text.lines[before_[index]])) {
          continue;
        }
        table_.first_row = before_[index];
        return;
      }
      take_more_names(names, below);
      table_.header_lines.push_back(before_[index]);
    }
  }

  // Columns keep their names where units alone are added, and where they are not used.
  void take_more_names(std::vector<std::string>& names, const std::vector<std::string>& below) {
    const Header another = read_header(below);
    if (another.is_complete) {  // The header once more, or the real one below a title.
      names = below;
      table_.columns = another.columns;
      return;
    }
    const std::vector<Column> before = table_.columns;
    names = join_names(names, below);
    table_.columns = read_header(names).columns;
    for (std::size_t i = 0; i < std::min(before.size(), table_.columns.size()); ++i) {
      const bool is_unit =
          i < below.size() &&
          (find_unit(below[i]).is_given() || as_decibel(below[i]).is_decibel || below[i].empty());
      const bool keeps = is_unit || table_.columns[i].role == Role::kIgnored;
      table_.columns[i].name = keeps ? before[i].name : table_.columns[i].name;
    }
  }

  // Behind an empty line, words up to the end of the text are no rows; without one, words that are
  // no row with a fault.
  void find_end() {
    const std::vector<std::string>& lines = table_.text.lines;
    table_.end_row = lines.size();
    std::size_t words_begin = lines.size();
    bool are_all_words = true;
    for (std::size_t i = lines.size(); i > table_.first_row; --i) {
      const bool is_empty = lines[i - 1].find_first_not_of(" \t,;") == std::string::npos;
      if (is_empty) {
        table_.end_row = i;
        are_all_words = true;
      } else if (!is_comment(lines[i - 1])) {
        if (!is_footer(lines[i - 1])) {
          break;
        }
        are_all_words = are_all_words && is_no_row(lines[i - 1]);
        words_begin = are_all_words ? i - 1 : words_begin;
      }
    }
    if (words_begin < table_.end_row && words_begin > table_.first_row) {
      table_.end_row = words_begin;
      table_.first_footer = words_begin;
    }
  }

  bool is_footer(const std::string& line) const {
    const std::string first = cells_of(line, table_.layout.separator).front();
    return read_cell_with_unit(first, table_.layout.has_decimal_comma).cell.kind == CellKind::kText;
  }

  // "Page 1 of 1": a word of several letters, and less numbers than a row with a fault has.
  bool is_no_row(const std::string& line) const {
    constexpr long kLeastLetters = 2;
    constexpr long kMostNumbers = 2;
    std::vector<std::string> cells = cells_of(without_comment(line), table_.layout.separator);
    drop_empty_end(cells, 1);
    const std::string& first = cells.front();
    const auto letters = std::count_if(first.begin(), first.end(), is_letter_of_any);
    const auto numbers = std::count_if(cells.begin(), cells.end(), [this](const std::string& cell) {
      const CellKind kind = read_cell(cell, table_.layout.has_decimal_comma).kind;
      return kind == CellKind::kNumber || kind == CellKind::kAmbiguous;
    });
    const bool begins_as_number = !first.empty() && is_digit(first.front());
    return letters >= kLeastLetters && !begins_as_number && numbers <= kMostNumbers &&
           cells.size() != table_.columns.size();
  }

  static bool is_letter_of_any(char c) noexcept {
    return is_letter(c) || static_cast<unsigned char>(c) >= 0x80;
  }

  // Frequencies with one mark that may be of thousands or a decimal sign: the order tells.
  ImportError settle_thousands() {
    const std::size_t column = column_of(table_.columns, Role::kFrequency);
    const bool has_comma_alone = table_.layout.has_decimal_comma && !has_comma_beside(column);
    // Commas of frequencies alone say nothing of the rest of the table.
    const bool has_decimal_comma = table_.layout.has_decimal_comma && !has_comma_alone;
    std::vector<double> with_thousands;
    std::vector<double> with_decimals;
    std::size_t open_line = 0;
    for (std::size_t i = table_.first_row; i < table_.end_row; ++i) {
      const std::vector<std::string> row = table_.cells(i);
      if (is_comment(table_.text.lines[i]) || column >= row.size()) {
        continue;
      }
      const Cell cell = read_cell_with_unit(row[column], has_decimal_comma).cell;
      const bool is_ambiguous = cell.kind == CellKind::kAmbiguous;
      if (has_comma_alone && cell.kind == CellKind::kText) {
        return {};  // "12,5" is no thousand.
      }
      open_line = is_ambiguous && open_line == 0 ? i + 1 : open_line;
      with_thousands.push_back(cell.value);
      with_decimals.push_back(is_ambiguous ? cell.value / 1000.0 : cell.value);
    }
    if (open_line == 0) {
      return {};
    }
    table_.has_thousands = is_in_order(with_thousands) && !is_in_order(with_decimals);
    if (has_comma_alone && is_in_order(with_thousands) && !table_.has_thousands) {
      return error_at(open_line,
                      "the comma in the frequency may be a decimal sign or a mark of thousands",
                      "expected frequencies without marks of thousands, such as 1000 or 1.25");
    }
    if (table_.has_thousands) {
      table_.layout.has_decimal_comma = has_decimal_comma;
    }
    return {};
  }

  bool has_comma_beside(std::size_t column) const {
    for (std::size_t i = table_.first_row; i < table_.end_row; ++i) {
      const std::vector<std::string> row = table_.cells(i);
      for (std::size_t cell = 0; cell < row.size(); ++cell) {
        if (cell != column && !is_comment(table_.text.lines[i]) &&
            row[cell].find(',') != std::string::npos) {
          return true;
        }
      }
    }
    return false;
  }

  static bool is_in_order(const std::vector<double>& values) {
    return std::is_sorted(values.begin(), values.end()) ||
           std::is_sorted(values.rbegin(), values.rend());
  }

  // Of the lines around the table, and of comments anywhere.
  ImportError take_statements() {
    find_end();
    if (ImportError error = settle_thousands()) {
      return error;
    }
    StatementReader reader;
    for (std::size_t i = 0; i < table_.text.lines.size(); ++i) {
      const bool is_header = std::find(table_.header_lines.begin(), table_.header_lines.end(), i) !=
                             table_.header_lines.end();
      const bool is_around =
          i < table_.first_row || i >= table_.end_row || is_comment(table_.text.lines[i]);
      if (is_header || !is_around) {
        continue;
      }
      if (ImportError error = reader.take(i + 1, table_.text.lines[i])) {
        return error;
      }
    }
    table_.statements = reader.finish();
    take_units_of_cells();
    for (Column& column : table_.columns) {
      if (ImportError error = take_stated_unit(column)) {
        return error;
      }
    }
    return {};
  }

  // Units that stand behind the numbers are those of a column that names none.
  void take_units_of_cells() {
    if (!table_.layout.has_units || table_.first_row == table_.text.lines.size()) {
      return;
    }
    const std::vector<std::string> row = table_.cells(table_.first_row);
    for (std::size_t i = 0; i < std::min(row.size(), table_.columns.size()); ++i) {
      if (table_.columns[i].unit_spelling.empty()) {
        table_.columns[i].unit_spelling =
            read_cell_with_unit(row[i], table_.layout.has_decimal_comma).unit_spelling;
      }
    }
  }

  ImportError take_stated_unit(Column& column) const {
    const Statements& statements = table_.statements;
    const StatedUnit* const stated = column.role == Role::kFrequency   ? &statements.frequency
                                     : column.role == Role::kAmplitude ? &statements.amplitude
                                     : column.role == Role::kPhase     ? &statements.phase
                                                                       : nullptr;
    if (stated == nullptr || stated->spelling.empty()) {
      return {};
    }
    if (column.unit_spelling.empty()) {
      column.unit_spelling = stated->spelling;
      return {};
    }
    const std::string_view own = find_unit(column.unit_spelling).name;
    if (own.empty() || own == find_unit(stated->spelling).name) {
      return {};
    }
    return error_at(table_.header_line + 1,
                    "\"" + column.name + "\" is in " + std::string(own) + ", and line " +
                        std::to_string(stated->line) + " says " + stated->spelling,
                    "expected one unit of each quantity");
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
        take_names(header, line);
        return {};
      }
    }
    return {};
  }

  // Words stand before the numbers, but none of the lines names a frequency and an amplitude.
  ImportError refuse_header(std::size_t columns) const {
    for (const std::size_t line : before_) {
      const std::vector<std::string> names = names_in(line);
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
