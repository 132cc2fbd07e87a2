// Classes of characters, as IEEE 488.2 has them.
#pragma once

namespace emax::app::scpi {

constexpr bool is_line_end(char c) noexcept { return c == '\n' || c == '\r'; }
/// White space of IEEE 488.2, 7.4.1.2: all up to the blank, but for the ends of lines.
constexpr bool is_blank(char c) noexcept {
  return static_cast<unsigned char>(c) <= ' ' && !is_line_end(c);
}
constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) noexcept {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}
constexpr bool is_printable(char c) noexcept { return c >= ' ' && c <= '~'; }

}  // namespace emax::app::scpi
