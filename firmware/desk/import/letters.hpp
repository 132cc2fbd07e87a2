// Digits and letters of ASCII, whatever the locale says.
#pragma once

namespace emax::desk {

inline bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// A capital letter as a small one, any other byte as it is.
inline char small_letter(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

inline bool is_small_letter(char c) noexcept { return c >= 'a' && c <= 'z'; }

inline bool is_letter(char c) noexcept { return is_small_letter(small_letter(c)); }

}  // namespace emax::desk
