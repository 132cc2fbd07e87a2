// Classes of characters, as IEEE 488.2 has them.
#pragma once

namespace emax::app::scpi {

constexpr bool is_line_end(char c) noexcept { return c == '\n' || c == '\r'; }
/// The standard counts most control characters as white space; here they are noise.
constexpr bool is_blank(char c) noexcept { return c == ' ' || c == '\t'; }
constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) noexcept {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}
constexpr bool is_printable(char c) noexcept { return c >= ' ' && c <= '~'; }

}  // namespace emax::app::scpi
