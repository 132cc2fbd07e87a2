// Noise that is the same on every target: integers only until the last multiplication.
#pragma once

#include <array>
#include <cstdint>

namespace emax::sim {

/// Two independent values of mean 0 and variance 1.
struct NoisePair {
  double first = 0.0;
  double second = 0.0;
};

/// White, nearly Gaussian noise.
///
/// Uniform words come from xoshiro256++ (Blackman, Vigna, 2021; period 2^256 - 1). The number of
/// ones among 64 fair bits is binomial, of standard deviation 4; a triangular fraction of +-1 fills
/// the gaps between whole numbers. Mean 0 and variance 1 are exact and the excess kurtosis is
/// -0.031; the density is normal within 1.4 % up to 2 standard deviations and 8 % up to 3, and the
/// largest value is 8.2.
/// 32 bytes, no floating-point state, three 64-bit words per pair.
class Noise {
 public:
  /// Starts the sequence of this seed; every seed is good, and different seeds give sequences that
  /// have nothing in common.
  void seed(std::uint64_t seed) noexcept;

  /// The next 64 fair bits.
  std::uint64_t bits() noexcept;

  /// The next two values.
  NoisePair pair() noexcept;

  /// One value of a true normal distribution of mean 0 and variance 1, by Box and Muller: slower,
  /// for draws that are made once.
  double normal() noexcept;

 private:
  std::array<std::uint64_t, 4> state_ = {1, 2, 3, 4};
};

}  // namespace emax::sim
