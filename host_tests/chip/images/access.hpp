// How the test images of all chips reach a register, wait for it and let clocks and interrupts on.
#pragma once

#include <cstdint>

namespace image {

using Word = std::uint32_t;

inline volatile Word& reg(Word address) { return *reinterpret_cast<volatile Word*>(address); }
inline volatile std::uint16_t& half(Word address) {
  return *reinterpret_cast<volatile std::uint16_t*>(address);
}

constexpr unsigned kTries = 1000000;

/// Waits until these bits are as wanted. @returns False when that takes too long.
inline bool wait(Word address, Word bits, Word wanted) {
  for (unsigned i = 0; i < kTries; ++i) {
    if ((reg(address) & bits) == wanted) {
      return true;
    }
  }
  return false;
}

inline void delay(unsigned turns) {
  for (unsigned i = 0; i < turns; ++i) {
    asm volatile("nop");
  }
}

/// Lets a peripheral's clock on, and waits until it has come.
inline void clock_on(Word address, Word bits) {
  reg(address) = reg(address) | bits;
  const Word read_back = reg(address);
  static_cast<void>(read_back);
}

inline void interrupt_on(unsigned number) {
  reg(0xE000E100 + 4 * (number / 32)) = 1U << number % 32;
}

}  // namespace image
