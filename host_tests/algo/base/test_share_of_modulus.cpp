// The quotient by multiplications is the quotient by division, to the last bit.
#include <cstdint>
#include <gtest/gtest.h>

#include "emax/base/share_of_modulus.hpp"

namespace {

using emax::reciprocal_of_modulus;
using emax::share_by_division;
using emax::share_by_multiplication;

// The moduli of the generator of 2006, as JCGM 101 C.3 prints them.
constexpr std::uint32_t kModuli[] = {2147483579, 2147483543, 2147483423, 2147483123};

// Differences, in values from `first` on, `step` apart.
std::uint64_t differences(std::uint32_t modulus, std::uint64_t first, std::uint64_t step,
                          std::uint64_t count) {
  const std::uint64_t reciprocal = reciprocal_of_modulus(modulus);
  std::uint64_t found = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto value = static_cast<std::uint32_t>(first + i * step);
    found +=
        share_by_multiplication(value, modulus, reciprocal) != share_by_division(value, modulus)
            ? 1U
            : 0U;
  }
  return found;
}

TEST(ShareOfModulus, ReciprocalIsTheIntegerPart) {
  for (const std::uint32_t modulus : kModuli) {
    const std::uint64_t reciprocal = reciprocal_of_modulus(modulus);
    // 2^94 - m floor(2^94/m), from its lower 64 bits, in which 2^94 is 0: at least 0, below m.
    EXPECT_LT(0U - reciprocal * modulus, modulus);
    EXPECT_GE(reciprocal, std::uint64_t{1} << 63U);  // As m is below 2^31.
  }
}

TEST(ShareOfModulus, IsTheQuotientAtBothEndsAndAroundPowersOfTwo) {
  for (const std::uint32_t modulus : kModuli) {
    EXPECT_EQ(differences(modulus, 1, 1, 4096), 0U);
    EXPECT_EQ(differences(modulus, modulus - 4096, 1, 4096), 0U);
    for (unsigned bits = 13; bits < 31; ++bits) {
      EXPECT_EQ(differences(modulus, (std::uint64_t{1} << bits) - 1024, 1, 2048), 0U) << bits;
    }
    // Where the value, shifted up to 31 bits, passes the modulus: the exponent changes there.
    for (unsigned shift = 1; shift < 18; ++shift) {
      EXPECT_EQ(differences(modulus, (modulus >> shift) - 64, 1, 128), 0U) << shift;
    }
  }
}

TEST(ShareOfModulus, IsTheQuotientAllOverTheRange) {
  for (const std::uint32_t modulus : kModuli) {
    // 2^16 values, an odd step apart so that all low bits occur.
    EXPECT_EQ(differences(modulus, 1, 32749, 65536), 0U);
  }
}

}  // namespace
