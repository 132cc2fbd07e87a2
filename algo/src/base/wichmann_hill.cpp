// The uniform generators of Wichmann and Hill, 2006 and 1982, with jump-ahead.
#include "emax/base/wichmann_hill.hpp"

#include "emax/base/double_unit.hpp"
#include "emax/base/share_of_modulus.hpp"

namespace emax {
namespace {

constexpr std::uint32_t kMultipliers2006[4] = {11600, 47003, 23000, 33000};
constexpr std::uint32_t kModuli2006[4] = {2147483579, 2147483543, 2147483423, 2147483123};
constexpr std::uint32_t kMultipliers1982[3] = {171, 172, 170};
constexpr std::uint32_t kModuli1982[3] = {30269, 30307, 30323};

constexpr std::uint64_t kReciprocals2006[4] = {
    reciprocal_of_modulus(kModuli2006[0]), reciprocal_of_modulus(kModuli2006[1]),
    reciprocal_of_modulus(kModuli2006[2]), reciprocal_of_modulus(kModuli2006[3])};

constexpr std::uint32_t kFoldMask = (std::uint32_t{1} << kModulusBits) - 1;

// a i mod m without a 64-bit division, which small cores do in software: m = 2^31 - c, so 2^31 is c
// modulo m. With a < 2^16 and c <= 525 one fold leaves less than 2m, and fits into 32 bits.
std::uint32_t multiply_2006(std::uint32_t value, std::size_t j) noexcept {
  const std::uint32_t modulus = kModuli2006[j];
  const std::uint32_t complement = (std::uint32_t{1} << kModulusBits) - modulus;
  const std::uint64_t product = std::uint64_t{kMultipliers2006[j]} * value;
  const std::uint32_t folded = (static_cast<std::uint32_t>(product) & kFoldMask) +
                               complement * static_cast<std::uint32_t>(product >> kModulusBits);
  return folded >= modulus ? folded - modulus : folded;
}

std::uint32_t power_times(std::uint32_t multiplier, std::uint64_t exponent, std::uint32_t modulus,
                          std::uint32_t value) noexcept {
  std::uint64_t result = value;
  std::uint64_t square = multiplier;
  while (exponent != 0) {
    if ((exponent & 1U) != 0) {
      result = result * square % modulus;
    }
    square = square * square % modulus;
    exponent >>= 1U;
  }
  return static_cast<std::uint32_t>(result);
}

double share_2006(std::uint32_t value, std::size_t j) noexcept {
  if (kHasDoubleUnit || value == 0) {  // Zero only before a seed.
    return share_by_division(value, kModuli2006[j]);
  }
  return share_by_multiplication(value, kModuli2006[j], kReciprocals2006[j]);
}

// The fraction of a sum that is below 4 and not negative.
double fraction(double sum) noexcept {
  return sum - static_cast<double>(static_cast<std::uint32_t>(sum));
}

}  // namespace

Status WichmannHill::seed(Generator generator, Span<const std::uint32_t> seeds) noexcept {
  const std::size_t needed = generator == Generator::k2006 ? 4 : 3;
  if (seeds.size() < needed || seeds.size() > kMaxComponents) {
    return Status::kInvalidArgument;
  }
  std::array<std::uint32_t, kMaxComponents> state = {};
  for (std::size_t j = 0; j < needed; ++j) {
    if (seeds[j] == 0) {
      return Status::kInvalidArgument;
    }
    if (generator == Generator::k1982) {
      state[j] = 1 + (seeds[j] - 1) % (kModuli1982[j] - 1);
      continue;
    }
    if (seeds[j] >= kModuli2006[j]) {
      return Status::kInvalidArgument;
    }
    state[j] = seeds[j];
  }
  state_ = state;
  generator_ = generator;
  return Status::kOk;
}

double WichmannHill::next() noexcept {
  double sum = 0.0;
  if (generator_ == Generator::k1982) {
    for (std::size_t j = 0; j < 3; ++j) {
      state_[j] = kMultipliers1982[j] * state_[j] % kModuli1982[j];
      sum += static_cast<double>(state_[j]) / static_cast<double>(kModuli1982[j]);
    }
    return fraction(sum);
  }
  for (std::size_t j = 0; j < 4; ++j) {
    state_[j] = multiply_2006(state_[j], j);
    sum += share_2006(state_[j], j);
  }
  return fraction(sum);
}

void WichmannHill::jump(std::uint64_t steps) noexcept {
  for (std::size_t j = 0; j < components(); ++j) {
    state_[j] = generator_ == Generator::k2006
                    ? power_times(kMultipliers2006[j], steps, kModuli2006[j], state_[j])
                    : power_times(kMultipliers1982[j], steps, kModuli1982[j], state_[j]);
  }
}

}  // namespace emax
