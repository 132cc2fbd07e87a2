// Exact conversion between double and decimal text: whole numbers of a fixed size, no approximation
// to repair.
#include "emax/base/decimal.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace emax {
namespace {

constexpr std::uint64_t kHiddenBit = std::uint64_t{1} << 52;
constexpr std::uint64_t kInfinityBits = std::uint64_t{0x7FF} << 52;
constexpr int kMaxDecimals = 17;

// Digits that decide: the middle between two doubles has 768 at most. One more stands for all that
// follow.
constexpr std::size_t kDecidingDigits = 768;

// 769 digits have 2555 bits; so has 5^1100, the greatest divisor, and a quotient needs 64 more.
constexpr std::size_t kLimbs = 84;

/// A whole number, least limb first; no zero limb at the top.
struct Natural {
  std::size_t size = 0;
  std::uint32_t limbs[kLimbs];  // Only `size` of them are ever read.
};

void trim(Natural& number) noexcept {
  while (number.size > 0 && number.limbs[number.size - 1] == 0) {
    --number.size;
  }
}

void assign(Natural& number, std::uint64_t value) noexcept {
  number.limbs[0] = static_cast<std::uint32_t>(value);
  number.limbs[1] = static_cast<std::uint32_t>(value >> 32);
  number.size = 2;
  trim(number);
}

std::uint64_t low_bits(const Natural& number) noexcept {
  const std::uint64_t low = number.size > 0 ? number.limbs[0] : 0U;
  const std::uint64_t high = number.size > 1 ? number.limbs[1] : 0U;
  return (high << 32) | low;
}

int bit_length(const Natural& number) noexcept {
  if (number.size == 0) {
    return 0;
  }
  return static_cast<int>(number.size * 32) - __builtin_clz(number.limbs[number.size - 1]);
}

void multiply_add(Natural& number, std::uint32_t factor, std::uint32_t addend) noexcept {
  std::uint32_t carry = addend;
  for (std::size_t i = 0; i < number.size; ++i) {
    const std::uint64_t sum = std::uint64_t{number.limbs[i]} * factor + carry;
    number.limbs[i] = static_cast<std::uint32_t>(sum);
    carry = static_cast<std::uint32_t>(sum >> 32);
  }
  if (carry != 0) {
    number.limbs[number.size] = carry;
    ++number.size;
  }
}

void multiply_by_power_of_five(Natural& number, int exponent) noexcept {
  constexpr std::uint32_t kPowers[14] = {1,       5,        25,        125,       625,
                                         3125,    15625,    78125,     390625,    1953125,
                                         9765625, 48828125, 244140625, 1220703125};
  for (; exponent > 13; exponent -= 13) {
    multiply_add(number, kPowers[13], 0);
  }
  multiply_add(number, kPowers[exponent], 0);
}

/// A number above 0.
void shift_left(Natural& number, int bits) noexcept {
  if (bits == 0) {
    return;
  }
  const auto whole = static_cast<std::size_t>(bits) / 32;
  const int part = bits % 32;
  std::uint32_t above = 0;
  for (std::size_t i = number.size; i-- > 0;) {
    const std::uint64_t pair = std::uint64_t{number.limbs[i]} << part;
    number.limbs[i + whole + 1] = above | static_cast<std::uint32_t>(pair >> 32);
    above = static_cast<std::uint32_t>(pair);
  }
  number.limbs[whole] = above;
  std::fill_n(number.limbs, whole, 0U);
  number.size += whole + 1;
  trim(number);
}

/// @returns The remainder.
std::uint32_t divide(Natural& number, std::uint32_t divisor) noexcept {
  std::uint32_t remainder = 0;
  for (std::size_t i = number.size; i-- > 0;) {
    const std::uint64_t dividend = (std::uint64_t{remainder} << 32) | number.limbs[i];
    number.limbs[i] = static_cast<std::uint32_t>(dividend / divisor);
    remainder = static_cast<std::uint32_t>(dividend % divisor);
  }
  trim(number);
  return remainder;
}

/// What was cut off below a whole number, against one half.
enum class Rest : std::uint8_t { kZero, kBelowHalf, kHalf, kAboveHalf };

/// The rest in units of `divisor` when `remainder` stands above the old rest.
constexpr Rest combine(std::uint32_t remainder, std::uint32_t divisor, Rest below) noexcept {
  const std::uint32_t half = divisor / 2;
  if (remainder == half) {
    return below == Rest::kZero ? Rest::kHalf : Rest::kAboveHalf;
  }
  if (remainder > half) {
    return Rest::kAboveHalf;
  }
  return remainder == 0 && below == Rest::kZero ? Rest::kZero : Rest::kBelowHalf;
}

constexpr bool rounds_up(Rest rest, bool odd) noexcept {
  return rest == Rest::kAboveHalf || (rest == Rest::kHalf && odd);
}

Rest shift_right(Natural& number, int bits) noexcept {
  const int length = bit_length(number);
  if (bits > length) {
    const Rest rest = length == 0 ? Rest::kZero : Rest::kBelowHalf;
    number.size = 0;
    return rest;
  }
  const auto half_limb = static_cast<std::size_t>(bits - 1) / 32;
  const std::uint32_t half = std::uint32_t{1} << ((bits - 1) % 32);
  std::uint32_t below = number.limbs[half_limb] & (half - 1);
  for (std::size_t i = 0; i < half_limb; ++i) {
    below |= number.limbs[i];
  }
  const bool has_half = (number.limbs[half_limb] & half) != 0;

  const auto whole = static_cast<std::size_t>(bits) / 32;
  const int part = bits % 32;
  for (std::size_t i = whole; i < number.size; ++i) {
    const std::uint64_t above = i + 1 < number.size ? number.limbs[i + 1] : 0U;
    number.limbs[i - whole] = static_cast<std::uint32_t>(((above << 32) | number.limbs[i]) >> part);
  }
  number.size -= whole;
  trim(number);
  if (has_half) {
    return below == 0 ? Rest::kHalf : Rest::kAboveHalf;
  }
  return below == 0 ? Rest::kZero : Rest::kBelowHalf;
}

constexpr std::uint32_t small_power_of_ten(int exponent) noexcept {
  std::uint32_t power = 1;
  for (; exponent > 0; --exponent) {
    power *= 10;
  }
  return power;
}

Rest drop_digits(Natural& number, int count, Rest rest) noexcept {
  while (count > 0) {
    const int step = std::min(count, 9);
    const std::uint32_t divisor = small_power_of_ten(step);
    rest = combine(divide(number, divisor), divisor, rest);
    count -= step;
  }
  return rest;
}

/// A finite magnitude, mantissa 2^exponent.
struct Magnitude {
  std::uint64_t mantissa;
  int exponent;
};

Magnitude magnitude_of(std::uint64_t bits) noexcept {
  const auto exponent = static_cast<int>((bits >> 52) & 0x7FF);
  const std::uint64_t fraction = bits & (kHiddenBit - 1);
  if (exponent == 0) {
    return {fraction, -1074};
  }
  return {fraction | kHiddenBit, exponent - 1075};
}

/// The whole part of magnitude 10^decimals.
Rest scale(Magnitude magnitude, int decimals, Natural& number) noexcept {
  assign(number, magnitude.mantissa);
  multiply_by_power_of_five(number, decimals);
  const int shift = magnitude.exponent + decimals;
  if (shift >= 0) {
    shift_left(number, shift);
    return Rest::kZero;
  }
  return shift_right(number, -shift);
}

/// A rounded magnitude: the digits as one number, the first one worth 10^exponent.
struct Digits {
  std::uint64_t number;
  int exponent;
};

Digits significant_digits_of(Magnitude magnitude, int count) noexcept {
  if (magnitude.mantissa == 0) {
    return {0, 0};
  }
  std::uint64_t limit = 1;
  for (int i = 0; i < count; ++i) {
    limit *= 10;
  }
  // log10(2) = 78913 / 2^18; the true exponent is this one or the next.
  const int log2 = 63 - __builtin_clzll(magnitude.mantissa) + magnitude.exponent;
  int exponent = (log2 * 78913) >> 18;
  const int decimals = count - 1 - exponent;
  Natural scaled;
  Rest rest = scale(magnitude, std::max(decimals, 0), scaled);
  rest = drop_digits(scaled, std::max(-decimals, 0), rest);
  std::uint64_t number = low_bits(scaled);
  if (number >= limit) {
    rest = combine(static_cast<std::uint32_t>(number % 10), 10, rest);
    number /= 10;
    ++exponent;
  }
  if (rounds_up(rest, (number & 1) != 0)) {
    ++number;
  }
  if (number == limit) {
    number /= 10;
    ++exponent;
  }
  return {number, exponent};
}

constexpr bool is_negative(std::uint64_t bits) noexcept { return (bits >> 63) != 0; }
constexpr bool is_finite_pattern(std::uint64_t bits) noexcept {
  return (bits & kInfinityBits) != kInfinityBits;
}

/// Text of at most 32 characters that is not yet the caller's.
class ShortText {
 public:
  void append(char character) noexcept {
    characters_[size_] = character;
    ++size_;
  }
  void append_zeros(int count) noexcept {
    for (; count > 0; --count) {
      append('0');
    }
  }
  std::size_t copy_to(Span<char> text) const noexcept {
    if (size_ > text.size()) {
      return 0;
    }
    for (std::size_t i = 0; i < size_; ++i) {
      text[i] = characters_[i];
    }
    return size_;
  }

 private:
  std::size_t size_ = 0;
  char characters_[32];
};

constexpr char digit_character(std::uint32_t digit) noexcept {
  return static_cast<char>('0' + static_cast<char>(digit));
}

std::size_t format_not_finite(std::uint64_t bits, Span<char> text) noexcept {
  ShortText result;
  const bool infinite = (bits << 12) == 0;
  if (infinite && is_negative(bits)) {
    result.append('-');
  }
  const char* const word = infinite ? "inf" : "nan";
  for (int i = 0; i < 3; ++i) {
    result.append(word[i]);
  }
  return result.copy_to(text);
}

/// The `count` digits of a number, most significant first, from two halves: 32-bit divisions are
/// cheap.
void split_digits(std::uint64_t number, int count, char* digits) noexcept {
  constexpr std::uint32_t kBillion = 1000000000;
  auto part = static_cast<std::uint32_t>(number % kBillion);
  std::uint64_t rest = number / kBillion;
  int in_part = 9;
  for (int i = count; i-- > 0;) {
    if (in_part == 0) {
      part = static_cast<std::uint32_t>(rest);
      rest = 0;
      in_part = 9;
    }
    digits[i] = digit_character(part % 10);
    part /= 10;
    --in_part;
  }
}

void append_scientific(ShortText& result, const char* digits, int count, int exponent) noexcept {
  result.append(digits[0]);
  if (count > 1) {
    result.append('.');
  }
  for (int i = 1; i < count; ++i) {
    result.append(digits[i]);
  }
  result.append('e');
  result.append(exponent < 0 ? '-' : '+');
  const auto size = static_cast<std::uint32_t>(exponent < 0 ? -exponent : exponent);
  if (size >= 100) {
    result.append(digit_character(size / 100));
  }
  result.append(digit_character(size / 10 % 10));
  result.append(digit_character(size % 10));
}

void append_positional(ShortText& result, const char* digits, int count, int exponent) noexcept {
  if (exponent < 0) {
    result.append('0');
    result.append('.');
    result.append_zeros(-1 - exponent);
  }
  for (int i = 0; i < count; ++i) {
    if (i == exponent + 1 && i > 0) {
      result.append('.');
    }
    result.append(digits[i]);
  }
  result.append_zeros(exponent + 1 - count);
}

/// A whole number in groups of nine digits, least first.
struct DigitGroups {
  std::size_t size = 0;
  std::uint32_t groups[38];  // 2^1080 and more.
};

/// u[0..size] -= quotient v[0..size-1] with the greatest quotient possible; v's top bit is set.
///
/// @returns The quotient, which must be less than 2^32.
std::uint32_t divide_step(std::uint32_t* u, const std::uint32_t* v, std::size_t size) noexcept {
  const std::uint64_t leading = (std::uint64_t{u[size]} << 32) | u[size - 1];
  // From the leading limbs alone the quotient comes out right or at most 2 too large.
  std::uint64_t quotient = std::min<std::uint64_t>(leading / v[size - 1], 0xFFFFFFFFU);
  std::uint64_t carry = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint64_t product = quotient * v[i] + carry;
    const auto low = static_cast<std::uint32_t>(product);
    carry = (product >> 32) + (u[i] < low ? 1U : 0U);
    u[i] -= low;
  }
  // Limbs are unsigned: a negative difference shows in the limb above, as all ones or nearly.
  std::uint32_t top = u[size] - static_cast<std::uint32_t>(carry);
  while (top != 0) {
    --quotient;
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < size; ++i) {
      sum = std::uint64_t{u[i]} + v[i] + (sum >> 32);
      u[i] = static_cast<std::uint32_t>(sum);
    }
    top += static_cast<std::uint32_t>(sum >> 32);
  }
  u[size] = 0;
  return static_cast<std::uint32_t>(quotient);
}

/// A positive number between leading 2^exponent and (leading + 1) 2^exponent; exactly the former if
/// not `more`.
struct Leading {
  std::uint64_t leading;
  int exponent;
  bool more;
};

/// number 10^exponent, exponent >= 0.
Leading leading_of_product(Natural& number, int exponent) noexcept {
  multiply_by_power_of_five(number, exponent);
  const int surplus = bit_length(number) - 64;
  bool more = false;
  if (surplus > 0) {
    more = shift_right(number, surplus) != Rest::kZero;
  } else {
    shift_left(number, -surplus);
  }
  return {low_bits(number), surplus + exponent, more};
}

/// number 10^-exponent, exponent > 0.
Leading leading_of_quotient(Natural& number, int exponent) noexcept {
  Natural divisor;
  assign(divisor, 1);
  multiply_by_power_of_five(divisor, exponent);
  // Make the divisor fill its limbs and the number 63 bits longer: the quotient then has 63 or 64
  // bits.
  const int number_bits = bit_length(number);
  const int divisor_bits = bit_length(divisor);
  const int limbs = std::max((divisor_bits + 31) / 32, (number_bits - 63 + 31) / 32);
  const int divisor_shift = 32 * limbs - divisor_bits;
  const int number_shift = 32 * limbs + 63 - number_bits;
  shift_left(divisor, divisor_shift);
  shift_left(number, number_shift);
  const auto size = static_cast<std::size_t>(limbs);
  const std::uint64_t high = divide_step(number.limbs + 1, divisor.limbs, size);
  const std::uint64_t low = divide_step(number.limbs, divisor.limbs, size);
  trim(number);
  return {(high << 32) | low, divisor_shift - number_shift - exponent, number.size != 0};
}

/// The bits of the nearest double, ties to even; those of infinity if it is too large.
std::uint64_t round_to_double(Leading number) noexcept {
  const int zeros = __builtin_clzll(number.leading);
  const std::uint64_t leading = number.leading << zeros;
  const int exponent = number.exponent - zeros + 63;  // Of the first bit.
  if (exponent > 1023) {
    return kInfinityBits;
  }
  const bool normal = exponent >= -1022;
  const int drop = normal ? 11 : 11 + (-1022 - exponent);
  if (drop > 64) {
    return 0;
  }
  const std::uint64_t cut = leading << (64 - drop);
  std::uint64_t kept = drop == 64 ? 0 : leading >> drop;
  constexpr std::uint64_t kHalf = std::uint64_t{1} << 63;
  if (cut > kHalf || (cut == kHalf && (number.more || (kept & 1) != 0))) {
    ++kept;
  }
  // The hidden bit, and a carry out of the fraction, count the exponent up by one.
  return normal ? (static_cast<std::uint64_t>(exponent + 1022) << 52) + kept : kept;
}

constexpr bool is_digit(char character) noexcept { return character >= '0' && character <= '9'; }

/// What the text says, before any arithmetic.
struct ScannedNumber {
  bool negative = false;
  std::size_t length = 0;       // 0: not a number.
  std::size_t first = 0;        // Where the first digit other than 0 is.
  std::size_t significant = 0;  // Digits from there on.
  std::size_t needed = 0;       // Digits from there to the last one other than 0.
  std::uint64_t leading = 0;    // The first 19 of them.
  std::int64_t exponent = 0;    // Of the last digit.
};

constexpr std::size_t kLeadingDigits = 19;

/// An exponent from `at` on, behind the letter; beyond 10^17 it stays there, which no length of
/// text outweighs.
void scan_exponent(Span<const char> text, std::size_t at, ScannedNumber& number) noexcept {
  bool negative = false;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) {
    negative = text[at] == '-';
    ++at;
  }
  if (at == text.size() || !is_digit(text[at])) {
    return;
  }
  constexpr std::int64_t kLimit = 10000000000000000;
  std::int64_t exponent = 0;
  for (; at < text.size() && is_digit(text[at]); ++at) {
    if (exponent < kLimit) {
      exponent = exponent * 10 + (text[at] - '0');
    }
  }
  number.exponent += negative ? -exponent : exponent;
  number.length = at;
}

ScannedNumber scan(Span<const char> text) noexcept {
  ScannedNumber number;
  std::size_t at = 0;
  if (!text.empty() && (text[0] == '+' || text[0] == '-')) {
    number.negative = text[0] == '-';
    ++at;
  }
  bool any = false;
  bool point = false;
  for (; at < text.size(); ++at) {
    const char character = text[at];
    if (character == '.' && !point) {
      point = true;
      continue;
    }
    if (!is_digit(character)) {
      break;
    }
    any = true;
    number.exponent -= point ? 1 : 0;
    const auto digit = static_cast<std::uint32_t>(character - '0');
    if (number.significant == 0) {
      if (digit == 0) {
        continue;
      }
      number.first = at;
    }
    ++number.significant;
    if (digit != 0) {
      number.needed = number.significant;
    }
    if (number.significant <= kLeadingDigits) {
      number.leading = number.leading * 10 + digit;
    }
  }
  if (!any) {
    return {};
  }
  number.length = at;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    scan_exponent(text, at + 1, number);
  }
  return number;
}

/// The first `count` significant digits of the text.
void collect_digits(Span<const char> text, std::size_t first, std::size_t count,
                    Natural& number) noexcept {
  number.size = 0;
  std::uint32_t group = 0;
  std::uint32_t factor = 1;
  for (std::size_t at = first; count > 0; ++at) {
    if (text[at] == '.') {
      continue;
    }
    group = group * 10 + static_cast<std::uint32_t>(text[at] - '0');
    factor *= 10;
    --count;
    if (factor == 1000000000 || count == 0) {
      multiply_add(number, factor, group);
      group = 0;
      factor = 1;
    }
  }
}

/// The bits of the magnitude of a number between 10^-330 and 10^310 that is not zero.
std::uint64_t convert(Span<const char> text, const ScannedNumber& scanned) noexcept {
  const std::size_t counted = std::min(scanned.significant, kLeadingDigits);
  Natural number;
  std::int64_t exponent = scanned.exponent;
  if (scanned.needed <= kLeadingDigits) {
    exponent += static_cast<std::int64_t>(scanned.significant - counted);
    assign(number, scanned.leading);
  } else {
    const std::size_t kept = std::min(scanned.needed, kDecidingDigits);
    exponent += static_cast<std::int64_t>(scanned.significant - kept);
    collect_digits(text, scanned.first, kept, number);
    if (scanned.needed > kept) {
      multiply_add(number, 10, 1);
      --exponent;
    }
  }
  const int power = static_cast<int>(exponent);
  return round_to_double(power >= 0 ? leading_of_product(number, power)
                                    : leading_of_quotient(number, -power));
}

constexpr double kPowersOfTen[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                     1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                     1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

}  // namespace

std::size_t format_general(double value, int significant_digits, Span<char> text) noexcept {
  const auto bits = __builtin_bit_cast(std::uint64_t, value);
  if (significant_digits < 1 || significant_digits > kMaxDecimals) {
    return 0;
  }
  if (!is_finite_pattern(bits)) {
    return format_not_finite(bits, text);
  }
  const Digits rounded = significant_digits_of(magnitude_of(bits), significant_digits);
  char digits[kMaxDecimals];
  split_digits(rounded.number, significant_digits, digits);
  int count = significant_digits;
  while (count > 1 && digits[count - 1] == '0') {
    --count;
  }
  ShortText result;
  if (is_negative(bits)) {
    result.append('-');
  }
  if (rounded.exponent < -4 || rounded.exponent >= significant_digits) {
    append_scientific(result, digits, count, rounded.exponent);
  } else {
    append_positional(result, digits, count, rounded.exponent);
  }
  return result.copy_to(text);
}

std::size_t format_scientific(double value, int decimals, Span<char> text) noexcept {
  const auto bits = __builtin_bit_cast(std::uint64_t, value);
  if (decimals < 0 || decimals > kMaxDecimals) {
    return 0;
  }
  if (!is_finite_pattern(bits)) {
    return format_not_finite(bits, text);
  }
  const Digits rounded = significant_digits_of(magnitude_of(bits), decimals + 1);
  char digits[kMaxDecimals + 1];
  split_digits(rounded.number, decimals + 1, digits);
  ShortText result;
  if (is_negative(bits)) {
    result.append('-');
  }
  append_scientific(result, digits, decimals + 1, rounded.exponent);
  return result.copy_to(text);
}

std::size_t format_fixed(double value, int decimals, Span<char> text) noexcept {
  const auto bits = __builtin_bit_cast(std::uint64_t, value);
  if (decimals < 0 || decimals > kMaxDecimals) {
    return 0;
  }
  if (!is_finite_pattern(bits)) {
    return format_not_finite(bits, text);
  }
  Natural number;
  const Rest rest = scale(magnitude_of(bits), decimals, number);
  const bool round_up = rounds_up(rest, (low_bits(number) & 1) != 0);
  multiply_add(number, 1, round_up ? 1 : 0);

  DigitGroups groups;
  while (number.size > 0) {
    groups.groups[groups.size] = divide(number, 1000000000);
    ++groups.size;
  }
  const auto fraction = static_cast<std::size_t>(decimals);
  std::size_t digits = 0;
  if (groups.size > 0) {
    digits = 9 * (groups.size - 1);
    for (std::uint32_t top = groups.groups[groups.size - 1]; top > 0; top /= 10) {
      ++digits;
    }
  }
  digits = std::max(digits, fraction + 1);
  const std::size_t length = (is_negative(bits) ? 1U : 0U) + digits + (fraction > 0 ? 1U : 0U);
  if (length > text.size()) {
    return 0;
  }
  std::size_t at = length;
  std::uint32_t group = 0;
  for (std::size_t i = 0; i < digits; ++i) {
    if (i % 9 == 0) {
      group = i / 9 < groups.size ? groups.groups[i / 9] : 0U;
    }
    if (i == fraction && fraction > 0) {
      --at;
      text[at] = '.';
    }
    --at;
    text[at] = digit_character(group % 10);
    group /= 10;
  }
  if (is_negative(bits)) {
    text[0] = '-';
  }
  return length;
}

ParsedNumber parse_decimal(Span<const char> text) noexcept {
  const ScannedNumber scanned = scan(text);
  ParsedNumber result;
  if (scanned.length == 0) {
    return result;
  }
  result.status = Status::kOk;
  result.length = scanned.length;
  // The value is below 10^size and not below a tenth of that.
  const std::int64_t size = scanned.exponent + static_cast<std::int64_t>(scanned.significant);
  const std::size_t counted = std::min(scanned.significant, kLeadingDigits);
  const std::int64_t exponent =
      scanned.exponent + static_cast<std::int64_t>(scanned.significant - counted);
  if (scanned.significant == 0 || size < -330) {
    result.value = 0.0;
  } else if (size > 310) {
    result.value = std::numeric_limits<double>::infinity();
  } else if (scanned.needed <= kLeadingDigits && scanned.leading <= 2 * kHiddenBit &&
             exponent >= -22 && exponent <= 22) {
    // Both operands are exact, so the one operation rounds correctly.
    const double leading = static_cast<double>(static_cast<std::int64_t>(scanned.leading));
    result.value =
        exponent < 0 ? leading / kPowersOfTen[-exponent] : leading * kPowersOfTen[exponent];
  } else {
    result.value = __builtin_bit_cast(double, convert(text, scanned));
  }
  if (result.value > std::numeric_limits<double>::max()) {
    result.status = Status::kInvalidArgument;
  }
  if (scanned.negative) {
    result.value = -result.value;
  }
  return result;
}

}  // namespace emax
