// The bytes of a table as lines of UTF-8, whatever its encoding.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace emax::desk {

/// The lines of a text, without line ends.
struct TableText {
  std::vector<std::string> lines;  ///< In UTF-8.
  const char* encoding = "UTF-8";  ///< "UTF-16" or "Latin-1" where it is another one.
  std::size_t bad_line = 0;        ///< From 1; 0 if all is well.
  const char* problem = nullptr;   ///< What is wrong there; null if all is well.
};

/// Decodes UTF-8 with or without a byte order mark, UTF-16 of either byte order, and takes a text
/// that is not valid UTF-8 for Latin-1. Lines end with LF, CR LF or CR. Refused, with the line, are
/// control characters other than tab; UTF-32 is refused by name.
///
/// Time and memory are proportional to the text.
TableText decode_table(std::string_view bytes);

}  // namespace emax::desk
