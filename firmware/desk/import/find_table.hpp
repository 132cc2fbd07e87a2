// Where in a text the table is: its layout, its header, its first row.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "desk/import/import_error.hpp"
#include "desk/import/table_header.hpp"
#include "desk/import/table_layout.hpp"
#include "desk/import/table_statements.hpp"
#include "desk/import/table_text.hpp"

namespace emax::desk {

/// A table in its text. Lines count from 0.
struct FoundTable {
  TableText text;
  TableLayout layout;
  std::vector<Column> columns;
  Statements statements;  ///< Of the lines around it; units that the header lacks are in `columns`.
  std::vector<std::size_t> header_lines;  ///< Where the names and units stand; empty for none.
  std::size_t header_line = 0;
  std::size_t first_row = 0;
  std::size_t end_row = 0;       ///< Behind it there are only words.
  std::size_t first_footer = 0;  ///< Of the words that end it without an empty line; 0 for none.
  bool is_native = false;        ///< It has no header and is taken as the native form.
  bool is_labview = false;       ///< The columns stand behind the header of a LabVIEW file.
  /// "1,000" of a frequency is 1000: read so they are in order, and read as 1 they are not.
  bool has_thousands = false;

  /// @returns The cells of a line without its comment.
  std::vector<std::string> cells(std::size_t line) const;
};

/// Decodes a text and finds the table in it. Of lines before the header, and of comments, only what
/// `StatementReader` knows is read. A header may go on in the lines below it, with units or parts
/// of names, or be a comment. Without one the table must have the five columns of the native form.
///
/// @param[out] table Of no use after an error.
ImportError find_table(std::string_view bytes, FoundTable& table);

}  // namespace emax::desk
