// Text of others, which may or may not be UTF-8, one character at a time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace emax::app {

/// One character of a text, and how many bytes it takes there.
struct Character {
  std::uint32_t code = 0;  ///< kReplacement for a byte that is no part of valid UTF-8.
  std::size_t length = 0;  ///< 0 at the end of the text, else 1 to 4.
};

inline constexpr std::uint32_t kReplacement = 0xFFFD;

/// @param[in] text Ends with a zero.
/// @returns The first character: of the shortest form, at most U+10FFFF and no surrogate (RFC
/// 3629); every other byte counts as a character by itself.
Character first_character(const char* text) noexcept;

/// @returns Whether a character may stand in a line of text as it is: no control character, no end
/// of a line or paragraph, nothing that turns the direction of what follows.
bool is_printable(std::uint32_t code) noexcept;

}  // namespace emax::app
