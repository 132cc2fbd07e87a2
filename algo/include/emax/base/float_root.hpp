// 1/sqrt(x) in single precision with the same bits everywhere.
#pragma once

#include <cstdint>

namespace emax {

/// 1/sqrt(x) of a normal number above 0, to about 2e-7 of itself: a guess from the bits of x, and
/// four steps of Newton's method. No instruction of the processor, so that those without one say
/// the same.
inline float inverse_root(float x) noexcept {
  const float half = 0.5F * x;
  const auto bits = __builtin_bit_cast(std::uint32_t, x);
  float root = __builtin_bit_cast(float, 0x5F375A86U - (bits >> 1));
  for (int step = 0; step < 4; ++step) {
    root = root * (1.5F - half * root * root);
  }
  return root;
}

}  // namespace emax
