// Cycles of the processor (DWT, Armv7-M Architecture Reference Manual C1.8).
#pragma once

#include <cstdint>

#include "emax/board/registers.hpp"

namespace emax::board {

/// Lets it count; where a debugger may lock it, unlocks it.
inline void start_cycle_counter() noexcept {
  constexpr std::uint32_t kTraceOn = 1U << 24;
  constexpr std::uint32_t kUnlock = 0xC5ACCE55;
  reg(0xE000EDFC) |= kTraceOn;
  reg(0xE0001FB0) = kUnlock;
  reg(0xE0001000) |= 1U;
}

/// Modulo 2^32.
inline std::uint32_t cycles() noexcept { return reg(0xE0001004); }

}  // namespace emax::board
