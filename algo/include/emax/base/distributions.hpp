// Uniform and normal numbers from uniform numbers in [0, 1).
#pragma once

namespace emax {

/// @returns low + (high - low) u: for u in [0, 1) a number in [low, high), to rounding. JCGM
/// 101 6.4.2.4.
double uniform_in(double low, double high, double u) noexcept;

/// Two independent draws from N(0, 1).
struct NormalPair {
  double first = 0.0;
  double second = 0.0;
};

/// The transform of Box and Muller, JCGM 101 C.4: sqrt(-2 ln u1) times cos(2 pi u2) and sin(2 pi
/// u2).
///
/// @param[in] u1, u2 In [0, 1). u1 = 0, which has no logarithm, is taken as 2^-53: both numbers
/// stay below 8.6.
/// @returns cos first, sin second. One logarithm, one square root, one sine and cosine.
NormalPair box_muller(double u1, double u2) noexcept;

}  // namespace emax
