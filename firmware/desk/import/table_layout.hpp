// Separators, decimal signs and cells of a table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace emax::desk {

enum class Separator : std::uint8_t { kTab, kSemicolon, kComma, kBlanks };

/// How the lines of a table are cut into numbers.
struct TableLayout {
  Separator separator = Separator::kComma;
  bool has_decimal_comma = false;
  bool has_units = false;  ///< Units stand behind the numbers: "100 Hz".
};

/// @returns "tabs", "semicolons", "commas" or "blanks".
const char* name_of(Separator separator) noexcept;

/// @returns The cells of a line without blanks and quotes around them. A separator inside quotes
/// does not separate; two quotes inside quotes are one.
std::vector<std::string> cells_of(std::string_view line, Separator separator);

/// Takes empty cells off the end until `keep` cells are left.
void drop_empty_end(std::vector<std::string>& cells, std::size_t keep);

/// @returns The line up to a '#' outside quotes that stands at its start or behind a blank or a
/// separator, and is not the beginning of what a spreadsheet writes for no number ("#N/A").
std::string_view without_comment(std::string_view line) noexcept;

/// @returns Whether the line is empty, has separators only, or begins with '#' or '%'.
bool is_comment(std::string_view line) noexcept;

enum class CellKind : std::uint8_t {
  kNumber,
  kBlank,
  kText,
  kNotFinite,
  kAmbiguous,  ///< "1,035": with a mark of thousands, or with another decimal sign than the rest.
};

struct Cell {
  CellKind kind = CellKind::kBlank;
  double value = 0.0;  ///< 0 unless it is a number; if it is ambiguous, that with thousands.
  bool is_half_width = false;  ///< "±" or "+/-" stands before it, as before an uncertainty.
};

/// Reads a number; U+2212 stands for a minus too. Marks of thousands (blanks, apostrophes, or the
/// other one of point and comma) are read where they cannot be a decimal sign: "1.234,5". "±" and
/// "+/-" may stand before it. Empty,
/// "-", "--", "---", "n/a", "NA", and "#N/A" or "#NV" of spreadsheets are blank. "nan", "inf",
/// "infinity" and numbers beyond the range of double are not finite.
Cell read_cell(std::string_view text, bool has_decimal_comma);

/// A number and what stands behind it.
struct CellWithUnit {
  Cell cell;
  std::string_view unit_spelling;  ///< Empty if there is none; a unit that is known else.
};

/// Reads a number with a unit behind it, such as "100 Hz", as `read_cell()` does.
CellWithUnit read_cell_with_unit(std::string_view text, bool has_decimal_comma);

/// @returns Whether a line is a row of numbers: two cells or more that are a number or blank, the
/// first of them a number, and another number among them; behind three of them, but for blanks
/// between cells, there may be a remark.
bool is_row(std::string_view line, const TableLayout& layout);

/// @returns The layout that makes most lines rows of numbers, of equal ones the first in the order
/// tabs, semicolons, commas, blanks and decimal point before decimal comma; commas and decimal
/// point if there is none. A decimal comma does not go with commas between cells. Units behind the
/// numbers are looked for where fewer than two lines are rows without.
TableLayout find_layout(const std::vector<std::string>& lines);

}  // namespace emax::desk
