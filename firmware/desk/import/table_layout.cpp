// Separators, decimal signs and cells of a table.
#include "desk/import/table_layout.hpp"

#include <algorithm>
#include <iterator>

#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

#include "desk/import/input_units.hpp"
#include "desk/import/letters.hpp"

namespace emax::desk {

namespace {

constexpr std::string_view kMinus = "\xE2\x88\x92";                    // U+2212.
constexpr std::string_view kHardSpace = "\xC2\xA0";                    // U+00A0.
constexpr std::string_view kNarrowSpace = "\xE2\x80\xAF";              // U+202F.
constexpr std::string_view kThinSpace = "\xE2\x80\x89";                // U+2009.
constexpr std::string_view kApostrophe = "\xE2\x80\x99";               // U+2019.
constexpr std::string_view kHalfWidths[] = {"\xC2\xB1", "+/-", "+-"};  // The first is U+00B1.

// Spreadsheets write these for no number; the first ones where a value is not available.
constexpr std::string_view kNotAvailable[] = {"#n/a", "#nv", "n/a", "na", "-", "--", "---"};
constexpr std::string_view kSheetErrors[] = {"#n/a",   "#nv",      "#div/0!", "#value!", "#wert!",
                                             "#ref!",  "#bezug!",  "#num!",   "#zahl!",  "#name?",
                                             "#null!", "#valeur!", "#nombre!"};

bool is_blank(char character) noexcept { return character == ' ' || character == '\t'; }

std::string_view trim_cell(std::string_view text) noexcept {
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

bool is_word(std::string_view text, std::string_view word) noexcept {
  return std::equal(text.begin(), text.end(), word.begin(), word.end(),
                    [](char a, char b) { return small_letter(a) == b; });
}

// Words that elsewhere stand for numbers.
bool is_word_for_no_number(std::string_view text) noexcept {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    text.remove_prefix(1);
  }
  return is_word(text.substr(0, 3), "nan") || is_word(text, "inf") || is_word(text, "infinity");
}

template <std::size_t kCount>
bool is_any_word(std::string_view text, const std::string_view (&words)[kCount]) noexcept {
  return std::any_of(std::begin(words), std::end(words),
                     [text](std::string_view word) { return is_word(text, word); });
}

bool starts_sheet_error(std::string_view text) noexcept {
  return std::any_of(
      std::begin(kSheetErrors), std::end(kSheetErrors),
      [text](std::string_view word) { return is_word(text.substr(0, word.size()), word); });
}

// A cell as `parse_decimal()` reads it, and what was taken out for that.
struct PlainNumber {
  std::string text;
  std::size_t groups = 0;       // Marks of thousands,
  bool are_other_sign = false;  // which are the point or comma that is no decimal sign here.
  bool is_grouped_well = true;
  bool has_decimal_sign = false;
};

class NumberCleaner final {
 public:
  NumberCleaner(std::string_view text, bool has_decimal_comma) noexcept
      : text_(text),
        decimal_(has_decimal_comma ? ',' : '.'),
        other_(has_decimal_comma ? '.' : ',') {}

  PlainNumber run() {
    while (at_ < text_.size()) {
      if (text_.substr(at_, kMinus.size()) == kMinus) {
        plain_.text += '-';
        at_ += kMinus.size();
      } else if (const std::size_t length = mark_length()) {
        take_mark(length);
      } else {
        take(text_[at_++]);
      }
    }
    plain_.is_grouped_well = plain_.is_grouped_well && (plain_.groups == 0 || ends_group());
    return plain_;
  }

 private:
  // Only a sign between digits can be a mark.
  std::size_t mark_length() const noexcept {
    if (at_ == 0 || !is_digit(text_[at_ - 1]) || plain_.has_decimal_sign) {
      return 0;
    }
    for (const std::string_view mark :
         {kHardSpace, kNarrowSpace, kThinSpace, kApostrophe, std::string_view(" "),
          std::string_view("'"), std::string_view(&other_, 1)}) {
      const std::size_t next = at_ + mark.size();
      if (text_.substr(at_, mark.size()) == mark && next < text_.size() && is_digit(text_[next])) {
        return mark.size();
      }
    }
    return 0;
  }

  void take_mark(std::size_t length) {
    const std::string_view mark = text_.substr(at_, length);
    const bool is_first = plain_.groups == 0;
    const bool starts = digits_ >= 1 && digits_ <= kGroup && text_[at_ - digits_] != '0';
    const bool is_right = is_first ? starts : ends_group() && mark == mark_;
    plain_.is_grouped_well = plain_.is_grouped_well && is_right;
    plain_.are_other_sign = mark.front() == other_;
    ++plain_.groups;
    mark_ = mark;
    digits_ = 0;
    at_ += length;
  }

  void take(char c) {
    if (c == decimal_ || small_letter(c) == 'e') {
      plain_.is_grouped_well = plain_.is_grouped_well && (plain_.groups == 0 || ends_group());
      digits_ = kGroup;  // What comes now is no group.
      plain_.has_decimal_sign = plain_.has_decimal_sign || c == decimal_;
    } else if (is_digit(c) && !plain_.has_decimal_sign) {
      ++digits_;
    }
    plain_.text += c == decimal_ ? '.' : c == other_ ? '?' : c;
  }

  bool ends_group() const noexcept { return digits_ == kGroup || plain_.has_decimal_sign; }

  static constexpr std::size_t kGroup = 3;

  std::string_view text_;
  std::string_view mark_;
  PlainNumber plain_;
  std::size_t at_ = 0;
  std::size_t digits_ = 0;  // Since the last mark.
  char decimal_;
  char other_;
};

// How many of the first characters are a number; 0 for none.
std::size_t length_of_number(std::string_view text, bool has_decimal_comma) {
  constexpr std::size_t kMostCharacters = 40;
  std::size_t length = 0;
  for (std::size_t end = std::min(text.size(), kMostCharacters); end > 0 && length == 0; --end) {
    const bool may_end = is_digit(text[end - 1]) || text[end - 1] == '.' || text[end - 1] == ',';
    length = may_end && read_cell(text.substr(0, end), has_decimal_comma).kind == CellKind::kNumber
                 ? end
                 : 0;
  }
  return length;
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
  line = trim_cell(line);
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
    cells.emplace_back(trim_cell(cell));
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
    if (line[i] == '#' && !is_quoted && !starts_sheet_error(line.substr(i)) &&
        (i == 0 || is_blank(line[i - 1]) || line[i - 1] == ',' || line[i - 1] == ';')) {
      return line.substr(0, i);
    }
  }
  return line;
}

bool is_comment(std::string_view line) noexcept {
  line = trim_cell(line);
  if (line.empty() || line.front() == '%' || (line.front() == '#' && !starts_sheet_error(line))) {
    return true;
  }
  return line.find_first_not_of(" \t,;\"") == std::string_view::npos;
}

namespace {

// Takes a sign of plus and minus off.
bool drop_half_width(std::string_view& text) noexcept {
  for (const std::string_view sign : kHalfWidths) {
    if (text.substr(0, sign.size()) == sign) {
      text = trim_cell(text.substr(sign.size()));
      return true;
    }
  }
  return false;
}

Cell read_plain_cell(std::string_view text, bool has_decimal_comma) {
  const PlainNumber plain = NumberCleaner(text, has_decimal_comma).run();
  if (is_word_for_no_number(plain.text)) {
    return {CellKind::kNotFinite};
  }
  const ParsedNumber parsed = parse_decimal(Span<const char>(plain.text.data(), plain.text.size()));
  if (parsed.status == Status::kSyntax || parsed.length != plain.text.size() ||
      !plain.is_grouped_well) {
    return {CellKind::kText};
  }
  if (parsed.status != Status::kOk || !is_finite(parsed.value)) {
    return {CellKind::kNotFinite};
  }
  if (plain.groups == 1 && plain.are_other_sign && !plain.has_decimal_sign) {
    return {CellKind::kAmbiguous, parsed.value};
  }
  return {CellKind::kNumber, parsed.value};
}

}  // namespace

Cell read_cell(std::string_view text, bool has_decimal_comma) {
  if (text.empty() || is_any_word(text, kNotAvailable)) {
    return {};
  }
  const bool is_half_width = drop_half_width(text);
  Cell cell = read_plain_cell(text, has_decimal_comma);
  cell.is_half_width = is_half_width;
  return cell;
}

CellWithUnit read_cell_with_unit(std::string_view text, bool has_decimal_comma) {
  CellWithUnit result = {read_cell(text, has_decimal_comma), {}};
  if (result.cell.kind != CellKind::kText || text.empty()) {
    return result;
  }
  constexpr std::size_t kLongestUnit = 40;
  const std::size_t length = length_of_number(text, has_decimal_comma);
  const std::string_view unit = trim_cell(text.substr(length));
  if (length > 0 && unit.size() <= kLongestUnit && find_unit(unit).is_given()) {
    result = {read_cell(text.substr(0, length), has_decimal_comma), unit};
  }
  return result;
}

namespace {

// A last column may have remarks.
bool is_remark(const std::string& cell) noexcept {
  const char first = cell.empty() ? '\0' : small_letter(cell.front());
  return (first >= 'a' && first <= 'z') || static_cast<unsigned char>(first) >= 0x80;
}

}  // namespace

bool is_row(std::string_view line, const TableLayout& layout) {
  constexpr std::size_t kLeastBeforeRemark = 3;
  const std::vector<std::string> cells = cells_of(without_comment(line), layout.separator);
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const CellKind kind = layout.has_units
                              ? read_cell_with_unit(cells[i], layout.has_decimal_comma).cell.kind
                              : read_cell(cells[i], layout.has_decimal_comma).kind;
    if (kind == CellKind::kText && i + 1 == cells.size() && numbers >= kLeastBeforeRemark &&
        layout.separator != Separator::kBlanks) {
      return is_remark(cells[i]);
    }
    if (kind == CellKind::kText || kind == CellKind::kAmbiguous ||
        (i == 0 && kind != CellKind::kNumber)) {
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
  constexpr std::size_t kEnough = 2;
  TableLayout best;
  std::size_t most = 0;
  for (const bool has_units : {false, true}) {
    for (TableLayout layout : kLayouts) {
      // Blanks would cut the units off.
      layout.has_units = has_units && layout.separator != Separator::kBlanks;
      const std::size_t rows = layout.has_units == has_units ? count_rows(lines, layout) : 0;
      if (rows > most) {
        most = rows;
        best = layout;
      }
    }
    if (most >= kEnough) {
      break;
    }
  }
  return best;
}

}  // namespace emax::desk
