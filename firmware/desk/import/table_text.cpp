// The bytes of a table as lines of UTF-8, whatever its encoding.
#include "desk/import/table_text.hpp"

#include <cstdint>

#include "desk/files/utf8_text.hpp"

namespace emax::desk {

namespace {

constexpr std::uint32_t kNoCharacter = 0xFFFD;

std::uint32_t byte_at(std::string_view bytes, std::size_t index) noexcept {
  return static_cast<unsigned char>(bytes[index]);
}

bool starts_with(std::string_view text, std::string_view start) noexcept {
  return text.substr(0, start.size()) == start;
}

// The number of bytes of a valid character of UTF-8 (RFC 3629), 0 for none.
std::size_t length_of_character(std::string_view text) noexcept {
  const std::uint32_t first = byte_at(text, 0);
  const std::size_t length = first < 0x80                     ? 1U
                             : first >= 0xC2 && first < 0xE0  ? 2U
                             : first >= 0xE0 && first < 0xF0  ? 3U
                             : first >= 0xF0 && first <= 0xF4 ? 4U
                                                              : 0U;
  if (length == 0 || length > text.size()) {
    return 0;
  }
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte_at(text, i) & 0xC0) != 0x80) {
      return 0;
    }
  }
  const std::uint32_t second = length > 1 ? byte_at(text, 1) : 0;
  const bool is_wrong = (first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
                        (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F);
  return is_wrong ? 0 : length;
}

bool is_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::size_t length = length_of_character(text);
    if (length == 0) {
      return false;
    }
    text.remove_prefix(length);
  }
  return true;
}

std::string from_latin_1(std::string_view bytes) {
  std::string text;
  text.reserve(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    append_utf8(byte_at(bytes, i), text);
  }
  return text;
}

std::string from_utf_16(std::string_view bytes, bool is_big_endian) {
  const auto unit = [&](std::size_t index) {
    const std::uint32_t first = byte_at(bytes, index);
    const std::uint32_t second = byte_at(bytes, index + 1);
    return is_big_endian ? first << 8 | second : second << 8 | first;
  };
  std::string text;
  text.reserve(bytes.size());
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit(i);
    if (code >= 0xD800 && code < 0xDC00 && i + 3 < bytes.size() && unit(i + 2) >= 0xDC00 &&
        unit(i + 2) < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10) + (unit(i + 2) - 0xDC00);
      i += 2;
    } else if (code >= 0xD800 && code < 0xE000) {
      code = kNoCharacter;
    }
    append_utf8(code, text);
  }
  return text;
}

// A text of numbers in UTF-16 has a zero in every second byte, nearly; a text of bytes has none.
bool looks_like_utf_16(std::string_view bytes, std::size_t zeros_at) noexcept {
  constexpr std::size_t kLooked = 64;
  std::size_t zeros = 0;
  std::size_t units = 0;
  for (std::size_t i = 0; i + 1 < bytes.size() && units < kLooked; i += 2) {
    ++units;
    zeros += bytes[i + zeros_at] == '\0' && bytes[i + 1 - zeros_at] != '\0' ? 1U : 0U;
  }
  return units >= 4 && 4 * zeros >= 3 * units;
}

bool is_control(char character) noexcept {
  const auto byte = static_cast<unsigned char>(character);
  return (byte < ' ' && byte != '\t') || byte == 0x7F;
}

void split_lines(std::string_view text, TableText& table) {
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    const std::string_view line = text.substr(0, end);
    table.lines.emplace_back(line);
    for (const char character : line) {
      if (is_control(character)) {
        table.bad_line = table.lines.size();
        table.problem = "this is not a text file: the line holds a control character";
        return;
      }
    }
    if (end == std::string_view::npos) {
      return;
    }
    const bool is_pair = text[end] == '\r' && end + 1 < text.size() && text[end + 1] == '\n';
    text.remove_prefix(end + (is_pair ? 2 : 1));
  }
}

}  // namespace

TableText decode_table(std::string_view bytes) {
  constexpr std::string_view kUtf32Little("\xFF\xFE\0\0", 4);
  constexpr std::string_view kUtf32Big("\0\0\xFE\xFF", 4);
  TableText table;
  if (starts_with(bytes, kUtf32Little) || starts_with(bytes, kUtf32Big)) {
    table.encoding = "UTF-32";
    table.bad_line = 1;
    table.problem = "the encoding is UTF-32";
    return table;
  }
  const bool is_little = starts_with(bytes, "\xFF\xFE");
  const bool is_big = starts_with(bytes, "\xFE\xFF");
  if (is_little || is_big || looks_like_utf_16(bytes, 1) || looks_like_utf_16(bytes, 0)) {
    table.encoding = "UTF-16";
    const bool is_big_endian = is_big || (!is_little && looks_like_utf_16(bytes, 0));
    split_lines(from_utf_16(bytes.substr(is_little || is_big ? 2 : 0), is_big_endian), table);
    return table;
  }
  if (starts_with(bytes, "\xEF\xBB\xBF")) {
    bytes.remove_prefix(3);
  }
  if (is_utf8(bytes)) {
    split_lines(bytes, table);
    return table;
  }
  table.encoding = "Latin-1";
  split_lines(from_latin_1(bytes), table);
  return table;
}

}  // namespace emax::desk
