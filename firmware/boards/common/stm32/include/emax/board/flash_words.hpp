// How bytes become what a flash memory programs.
#pragma once

#include <cstdint>

namespace emax::board {

/// @param[in] bytes Four of them, the lowest first.
constexpr std::uint32_t word_of(const std::uint8_t* bytes) noexcept {
  return bytes[0] | std::uint32_t{bytes[1]} << 8U | std::uint32_t{bytes[2]} << 16U |
         std::uint32_t{bytes[3]} << 24U;
}

}  // namespace emax::board
