// What the flash memories of STM32 have in common.
#pragma once

#include <cstdint>

namespace emax::board {

/// What unlocks the memory, one after the other.
inline constexpr std::uint32_t kFirstKey = 0x45670123;
inline constexpr std::uint32_t kSecondKey = 0xCDEF89AB;

/// @param[in] bytes Four of them, the lowest first.
constexpr std::uint32_t word_of(const std::uint8_t* bytes) noexcept {
  return bytes[0] | std::uint32_t{bytes[1]} << 8U | std::uint32_t{bytes[2]} << 16U |
         std::uint32_t{bytes[3]} << 24U;
}

}  // namespace emax::board
