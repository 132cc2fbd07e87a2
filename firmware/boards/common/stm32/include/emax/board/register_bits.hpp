// What clock trees are made of.
#pragma once

#include <cstdint>

#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {

/// Sets bits of a register that switches clocks on. Reads it back, so that the clock is on before
/// its peripheral is asked for anything.
inline void switch_on(std::uintptr_t enable, std::uint32_t bits) noexcept {
  reg(enable) |= bits;
  const std::uint32_t is_on = reg(enable);
  (void)is_on;
}

/// Replaces some bits of a register.
inline void replace_bits(std::uintptr_t address, std::uint32_t which, std::uint32_t bits) noexcept {
  reg(address) = (reg(address) & ~which) | bits;
}

/// Waits until some bits read so. @returns False if they did not within this time.
inline bool become(std::uintptr_t address, std::uint32_t which, std::uint32_t bits,
                   std::uint32_t most_us) noexcept {
  return wait_for([=] { return (reg(address) & which) == bits; }, most_us);
}

/// Likewise until they are set.
inline bool is_set(std::uintptr_t address, std::uint32_t bits, std::uint32_t most_us) noexcept {
  return become(address, bits, bits, most_us);
}

/// @param[in] clear Where the flag is cleared, by the same bit.
/// @returns Whether the flag was there; it is cleared then.
inline bool take_flag(std::uintptr_t flags, std::uintptr_t clear, std::uint32_t flag) noexcept {
  if ((reg(flags) & flag) == 0) {
    return false;
  }
  reg(clear) = flag;
  return true;
}

}  // namespace emax::board
