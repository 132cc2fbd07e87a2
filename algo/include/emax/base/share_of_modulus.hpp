// x/m for the moduli of a generator, with and without a division of doubles.
#pragma once

#include <cstdint>

namespace emax {

/// The moduli are just below this power of two.
inline constexpr unsigned kModulusBits = 31;

/// @returns floor(2^94/m), what `share_by_multiplication()` takes in place of the division; m is
/// above 2^30 and below 2^31. The compiler computes it.
constexpr std::uint64_t reciprocal_of_modulus(std::uint32_t modulus) noexcept {
  std::uint64_t quotient = 0;
  std::uint64_t rest = 1;  // Digit by digit: 2^94 has no type of its own.
  for (unsigned bit = 0; bit < 94; ++bit) {
    rest *= 2;
    quotient *= 2;
    if (rest >= modulus) {
      rest -= modulus;
      quotient += 1;
    }
  }
  return quotient;
}

/// @returns x/m to the nearest double, by the division of doubles.
inline double share_by_division(std::uint32_t value, std::uint32_t modulus) noexcept {
  return static_cast<double>(value) / static_cast<double>(modulus);
}

/// @returns The same double by multiplications of integers: for cores that divide doubles in
/// software, where it takes a fifth of the instructions.
///
/// With x shifted up to 31 bits, x = 2^s value, the quotient q = floor(2^53 x/m) (2^52 where
/// x >= m) has the 53 bits of a double. The reciprocal gives it, or one less: its error is below
/// x/2^41. The rest x 2^53 - q m tells which, and how to round; it is below 2m and so known from
/// its lower 32 bits. A rest of half of m does not occur, as m is odd.
///
/// @param[in] value      1 to m - 1.
/// @param[in] modulus    Odd, above 2^30 and below 2^31.
/// @param[in] reciprocal Of the modulus, by `reciprocal_of_modulus()`.
inline double share_by_multiplication(std::uint32_t value, std::uint32_t modulus,
                                      std::uint64_t reciprocal) noexcept {
  const auto shift = static_cast<unsigned>(__builtin_clz(value)) - 1U;
  const std::uint32_t x = value << shift;
  const unsigned above = x >= modulus ? 1U : 0U;
  const std::uint64_t upper = std::uint64_t{x} * static_cast<std::uint32_t>(reciprocal >> 32U);
  const std::uint64_t lower = std::uint64_t{x} * static_cast<std::uint32_t>(reciprocal);
  std::uint64_t quotient = (upper + (lower >> 32U)) >> (9U + above);
  std::uint32_t rest = 0U - static_cast<std::uint32_t>(quotient) * modulus;
  if (rest >= modulus) {
    rest -= modulus;
    ++quotient;
  }
  quotient += 2U * std::uint64_t{rest} > modulus ? 1U : 0U;
  // The quotient's leading bit adds one to the exponent, as does a quotient rounded up to 2^53.
  const std::uint64_t bits = (std::uint64_t{1021U - shift + above} << 52U) + quotient;
  double share = 0.0;
  __builtin_memcpy(&share, &bits, sizeof share);
  return share;
}

}  // namespace emax
