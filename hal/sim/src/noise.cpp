// xoshiro256++, counted bits with a triangular fraction, and Box and Muller.
#include "emax/sim/noise.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::sim {
namespace {

/// Ones and fractions are summed in units of 2^-16.
constexpr std::uint64_t kUnit = 65536;
/// 32 ones on average, and two fractions of (2^16 - 1) / 2 each.
constexpr std::int32_t kMean = 32 * 65536 + 65535;
/// 1 over the standard deviation: sqrt(16 * 2^32 + 2 * (2^32 - 1) / 12).
constexpr double kScale = 3.794982935900909e-06;
constexpr double kUniformStep = 1.1102230246251565e-16;  // 2^-53

constexpr std::uint64_t rotate_left(std::uint64_t bits, unsigned count) noexcept {
  return (bits << count) | (bits >> (64U - count));
}

constexpr std::uint64_t count_ones(std::uint64_t bits) noexcept {
  bits -= (bits >> 1U) & 0x5555555555555555U;
  bits = (bits & 0x3333333333333333U) + ((bits >> 2U) & 0x3333333333333333U);
  bits = (bits + (bits >> 4U)) & 0x0F0F0F0F0F0F0F0FU;
  return (bits * 0x0101010101010101U) >> 56U;
}

double to_noise(std::uint64_t bits, std::uint64_t fraction1, std::uint64_t fraction2) noexcept {
  const std::uint64_t sum = count_ones(bits) * kUnit + fraction1 + fraction2;
  return static_cast<double>(static_cast<std::int32_t>(sum) - kMean) * kScale;
}

}  // namespace

void Noise::seed(std::uint64_t seed) noexcept {
  // SplitMix64, as the authors of xoshiro advise: near seeds give states that have nothing in
  // common, and never four zeros.
  for (std::uint64_t& word : state_) {
    seed += 0x9E3779B97F4A7C15U;
    std::uint64_t mixed = seed;
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
    word = mixed ^ (mixed >> 31U);
  }
}

std::uint64_t Noise::bits() noexcept {
  const std::uint64_t result = rotate_left(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t shifted = state_[1] << 17U;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = rotate_left(state_[3], 45);
  return result;
}

NoisePair Noise::pair() noexcept {
  const std::uint64_t first = bits();
  const std::uint64_t second = bits();
  const std::uint64_t fractions = bits();
  return {to_noise(first, fractions & 0xFFFFU, (fractions >> 16U) & 0xFFFFU),
          to_noise(second, (fractions >> 32U) & 0xFFFFU, fractions >> 48U)};
}

double Noise::normal() noexcept {
  const double radius_uniform = static_cast<double>((bits() >> 11U) + 1U) * kUniformStep;
  const double angle_uniform = static_cast<double>(bits() >> 11U) * kUniformStep;
  return sqrt(-2.0 * log(radius_uniform)) * cos(kTwoPi * angle_uniform);
}

}  // namespace emax::sim
