// Separators, decimal signs and cells of a table.
#include "desk/import/table_layout.hpp"

#include <algorithm>

#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax::desk {

namespace {

constexpr std::string_view kMinus = "\xE2\x88\x92";        // U+2212.
constexpr std::string_view kHardSpace = "\xC2\xA0";        // U+00A0.
constexpr std::string_view kNarrowSpace = "\xE2\x80\xAF";  // U+202F.

bool is_blank(char character) noexcept { return character == ' ' || character == '\t'; }

std::string_view trim(std::string_view text) noexcept {
  for (;;) {
    if (!text.empty() && is_blank(text.front())) {
      text.remove_prefix(1);
    } else if (!text.empty() && is_blank(text.back())) {
      text.remove_suffix(1);
    } else if (text.substr(0, kHardSpace.size()) == kHardSpace) {
      text.remove_prefix(kHardSpace.size());
    } else if (text.substr(0, kNarrowSpace.size()) == kNarrowSpace) {
      text.remove_prefix(kNarrowSpace.size());
    } else if (text.size() >= kHardSpace.size() &&
               text.substr(text.size() - kHardSpace.size()) == kHardSpace) {
      text.remove_suffix(kHardSpace.size());
    } else {
      return text;
    }
  }
}

bool separates(char character, Separator separator) noexcept {
  switch (separator) {
    case Separator::kTab:
      return character == '\t';
    case Separator::kSemicolon:
      return character == ';';
    case Separator::kComma:
      return character == ',';
    case Separator::kBlanks:
      return is_blank(character);
  }
  return false;
}

char lower(char character) noexcept {
  return character >= 'A' && character <= 'Z' ? static_cast<char>(character - 'A' + 'a')
                                              : character;
}

bool is_word(std::string_view text, std::string_view word) noexcept {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                    [](char a, char b) { return lower(a) == b; });
}

// Words that elsewhere stand for numbers.
bool is_word_for_no_number(std::string_view text) noexcept {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    text.remove_prefix(1);
  }
  return is_word(text.substr(0, 3), "nan") || is_word(text, "inf") || is_word(text, "infinity");
}

// From a quote on: what stands inside, and how many characters that takes with its quotes.
std::size_t take_quoted(std::string_view text, std::string& cell) {
  std::size_t at = 1;
  while (at < text.size()) {
    if (text[at] != '"') {
      cell += text[at++];
      continue;
    }
    if (at + 1 < text.size() && text[at + 1] == '"') {
      cell += '"';
      at += 2;
      continue;
    }
    return at + 1;
  }
  return at;
}

std::size_t count_rows(const std::vector<std::string>& lines, const TableLayout& layout) {
  std::size_t rows = 0;
  for (const std::string& line : lines) {
    rows += !is_comment(line) && is_row(line, layout) ? 1U : 0U;
  }
  return rows;
}

}  // namespace

const char* name_of(Separator separator) noexcept {
  switch (separator) {
    case Separator::kTab:
      return "tabs";
    case Separator::kSemicolon:
      return "semicolons";
    case Separator::kComma:
      return "commas";
    case Separator::kBlanks:
      return "blanks";
  }
  return "commas";
}

std::vector<std::string> cells_of(std::string_view line, Separator separator) {
  std::vector<std::string> cells;
  line = trim(line);
  std::size_t at = 0;
  for (;;) {
    std::string cell;
    while (at < line.size() && is_blank(line[at]) && !separates(line[at], separator)) {
      ++at;
    }
    if (at < line.size() && line[at] == '"') {
      at += take_quoted(line.substr(at), cell);
    }
    while (at < line.size() && !separates(line[at], separator)) {
      cell += line[at++];
    }
    cells.emplace_back(trim(cell));
    if (at >= line.size()) {
      return cells;
    }
    ++at;
    while (separator == Separator::kBlanks && at < line.size() && is_blank(line[at])) {
      ++at;
    }
  }
}

void drop_empty_end(std::vector<std::string>& cells, std::size_t keep) {
  while (cells.size() > keep && cells.back().empty()) {
    cells.pop_back();
  }
}

std::string_view without_comment(std::string_view line) noexcept {
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    is_quoted = line[i] == '"' ? !is_quoted : is_quoted;
    if (line[i] == '#' && !is_quoted &&
        (i == 0 || is_blank(line[i - 1]) || line[i - 1] == ',' || line[i - 1] == ';')) {
      return line.substr(0, i);
    }
  }
  return line;
}

bool is_comment(std::string_view line) noexcept {
  line = trim(line);
  if (line.empty() || line.front() == '#' || line.front() == '%') {
    return true;
  }
  return line.find_first_not_of(" \t,;\"") == std::string_view::npos;
}

Cell read_cell(std::string_view text, bool has_decimal_comma) {
  if (text.empty() || text == "-" || text == "--" || text == "---" || is_word(text, "n/a")) {
    return {};
  }
  std::string number;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i, kMinus.size()) == kMinus) {
      number += '-';
      i += kMinus.size() - 1;
      continue;
    }
    if (has_decimal_comma && text[i] == '.') {
      return {CellKind::kText};
    }
    number += has_decimal_comma && text[i] == ',' ? '.' : text[i];
  }
  if (is_word_for_no_number(number)) {
    return {CellKind::kNotFinite};
  }
  const ParsedNumber parsed = parse_decimal(Span<const char>(number.data(), number.size()));
  if (parsed.status == Status::kSyntax || parsed.length != number.size()) {
    return {CellKind::kText};
  }
  if (parsed.status != Status::kOk || !is_finite(parsed.value)) {
    return {CellKind::kNotFinite};
  }
  return {CellKind::kNumber, parsed.value};
}

bool is_row(std::string_view line, const TableLayout& layout) {
  const std::vector<std::string> cells = cells_of(without_comment(line), layout.separator);
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellKind kind = read_cell(cells[i], layout.has_decimal_comma).kind;
    if (kind == CellKind::kText || (i == 0 && kind != CellKind::kNumber)) {
      return false;
    }
    numbers += kind == CellKind::kBlank ? 0U : 1U;
  }
  return numbers >= 2;
}

TableLayout find_layout(const std::vector<std::string>& lines) {
  constexpr TableLayout kLayouts[] = {
      {Separator::kTab, false},      {Separator::kTab, true},    {Separator::kSemicolon, false},
      {Separator::kSemicolon, true}, {Separator::kComma, false}, {Separator::kBlanks, false},
      {Separator::kBlanks, true},
  };
  TableLayout best;
  std::size_t most = 0;
  for (const TableLayout& layout : kLayouts) {
    const std::size_t rows = count_rows(lines, layout);
    if (rows > most) {
      most = rows;
      best = layout;
    }
  }
  return best;
}

}  // namespace emax::desk
