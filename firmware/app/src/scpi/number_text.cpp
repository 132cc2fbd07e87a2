// Digits, exponents, multipliers and units of numeric parameters.
#include "number_text.hpp"

#include <cstddef>
#include <cstdint>

#include "emax/app/scpi/pattern.hpp"
#include "emax/base/decimal.hpp"

#include "characters.hpp"

namespace emax::app::scpi {
namespace {

// Limits of IEEE 488.2, 7.7.2 and 7.7.3.
constexpr std::size_t kMaxDigits = 255;
constexpr std::int32_t kMaxExponent = 32000;
constexpr std::size_t kMaxSuffix = 12;

constexpr std::size_t kExponentRoom = 8;

struct Multiplier {
  const char* name;
  int exponent;
};

// The suffix multipliers of IEEE 488.2. Longer names first: MA before M, PE before P, EX alone.
constexpr Multiplier kMultipliers[] = {{"EX", 18}, {"PE", 15}, {"T", 12},  {"G", 9},
                                       {"MA", 6},  {"K", 3},   {"M", -3},  {"U", -6},
                                       {"N", -9},  {"P", -12}, {"F", -15}, {"A", -18}};

/// What is left of a text.
class Cursor {
 public:
  explicit Cursor(Span<const char> text) noexcept : text_(text) {}

  bool at_end() const noexcept { return text_.empty(); }
  /// @returns The next character; a zero at the end.
  char peek() const noexcept { return text_.empty() ? '\0' : text_[0]; }
  void skip() noexcept { text_ = text_.from(1); }
  bool skip_blanks() noexcept {
    const std::size_t before = text_.size();
    while (!at_end() && is_blank(peek())) {
      skip();
    }
    return text_.size() != before;
  }
  /// @returns True if there was a sign and it was '-'.
  bool take_minus() noexcept {
    const bool is_minus = peek() == '-';
    if (is_minus || peek() == '+') {
      skip();
    }
    return is_minus;
  }
  Span<const char> rest() const noexcept { return text_; }

 private:
  Span<const char> text_;
};

/// The significant digits of a number as a whole number, and the power of ten it is multiplied by.
struct Digits {
  char text[kMaxDigits + kExponentRoom + 1];  ///< A sign, the digits, room for an exponent.
  std::size_t size = 0;
  std::size_t count = 0;  ///< Without leading zeros.
  std::int32_t exponent = 0;
  bool has_any = false;
};

void take_digits(Cursor& cursor, bool is_fraction, Digits& digits) noexcept {
  for (; is_digit(cursor.peek()); cursor.skip()) {
    digits.has_any = true;
    digits.exponent -= is_fraction ? 1 : 0;
    if (digits.count == 0 && cursor.peek() == '0') {
      continue;
    }
    if (digits.count < kMaxDigits) {
      digits.text[digits.size] = cursor.peek();
      ++digits.size;
    }
    ++digits.count;
  }
}

/// An exponent that is too large, of either sign, is answered as kMaxExponent + 1.
std::int32_t take_exponent_digits(Cursor& cursor) noexcept {
  const bool is_negative = cursor.take_minus();
  std::int32_t exponent = 0;
  for (; is_digit(cursor.peek()); cursor.skip()) {
    exponent = exponent * 10 + (cursor.peek() - '0');
    exponent = exponent > kMaxExponent ? kMaxExponent + 1 : exponent;
  }
  if (exponent > kMaxExponent) {
    return exponent;
  }
  return is_negative ? -exponent : exponent;
}

/// Takes "E3", "E +3" or nothing: an E without digits belongs to the unit.
std::int32_t take_exponent(Cursor& cursor) noexcept {
  Cursor ahead = cursor;
  ahead.skip_blanks();
  if (upper(ahead.peek()) != 'E') {
    return 0;
  }
  ahead.skip();
  ahead.skip_blanks();
  Cursor digits = ahead;
  (void)digits.take_minus();
  if (!is_digit(digits.peek())) {
    return 0;
  }
  cursor = ahead;
  return take_exponent_digits(cursor);
}

bool equals(Span<const char> text, const char* word) noexcept {
  std::size_t i = 0;
  for (; i < text.size(); ++i) {
    if (upper(text[i]) != word[i]) {
      return false;
    }
  }
  return word[i] == '\0';
}

/// As it is, or with the quotient as a product: "M.S-2" for "M/S2", "V.S-1" for "V/S".
bool is_unit(Span<const char> text, const char* unit) noexcept {
  if (equals(text, unit)) {
    return true;
  }
  std::size_t i = 0;
  while (unit[i] != '\0' && unit[i] != '/') {
    ++i;
  }
  if (unit[i] == '\0' || text.size() != i + 4) {
    return false;
  }
  const char power = unit[i + 2] == '\0' ? '1' : unit[i + 2];
  for (std::size_t k = 0; k < i; ++k) {
    if (upper(text[k]) != unit[k]) {
      return false;
    }
  }
  return text[i] == '.' && upper(text[i + 1]) == unit[i + 1] && text[i + 2] == '-' &&
         text[i + 3] == power;
}

bool starts_with(Span<const char> text, const char* word, std::size_t& length) noexcept {
  for (length = 0; word[length] != '\0'; ++length) {
    if (length >= text.size() || upper(text[length]) != word[length]) {
      return false;
    }
  }
  return true;
}

/// The power of ten that a suffix stands for.
struct Scale {
  int exponent = 0;
  ErrorCode error = ErrorCode::kNoError;
};

Scale scale_of(Span<const char> suffix, const char* unit) noexcept {
  if (unit == nullptr) {
    return {0, ErrorCode::kSuffixNotAllowed};
  }
  if (suffix.size() > kMaxSuffix) {
    return {0, ErrorCode::kSuffixTooLong};
  }
  if (is_unit(suffix, unit)) {
    return {};
  }
  // MHZ is mega, as everybody writes it.
  if (equals(suffix, "MHZ") && equals(Span<const char>("HZ", 2), unit)) {
    return {6, ErrorCode::kNoError};
  }
  for (const Multiplier& multiplier : kMultipliers) {
    std::size_t length = 0;
    if (starts_with(suffix, multiplier.name, length) && is_unit(suffix.from(length), unit)) {
      return {multiplier.exponent, ErrorCode::kNoError};
    }
  }
  return {0, ErrorCode::kInvalidSuffix};
}

ErrorCode check_suffix(Span<const char> suffix, bool follows_blank) noexcept {
  if (!is_letter(suffix[0]) && suffix[0] != '/') {
    return follows_blank ? ErrorCode::kInvalidSeparator : ErrorCode::kInvalidCharacterInNumber;
  }
  for (const char c : suffix) {
    if (is_blank(c)) {
      return ErrorCode::kInvalidSeparator;
    }
  }
  return ErrorCode::kNoError;
}

/// Appends "e<exponent>" and lets the decimal conversion round once.
double value_of(Digits& digits, std::int32_t exponent) noexcept {
  if (digits.count == 0) {
    digits.text[digits.size] = '0';
    return parse_decimal(Span<const char>(digits.text, digits.size + 1)).value;
  }
  std::size_t size = digits.size;
  digits.text[size++] = 'e';
  if (exponent < 0) {
    digits.text[size++] = '-';
  }
  std::int32_t rest = exponent < 0 ? -exponent : exponent;
  std::int32_t divisor = 10000;
  for (; divisor > 0; divisor /= 10) {
    digits.text[size++] = static_cast<char>('0' + rest / divisor);
    rest %= divisor;
  }
  return parse_decimal(Span<const char>(digits.text, size)).value;
}

/// @returns The value of a digit, letters from 10 on; 99 for other characters.
std::uint32_t digit_value(char c) noexcept {
  if (is_digit(c)) {
    return static_cast<std::uint32_t>(c - '0');
  }
  return is_letter(c) ? static_cast<std::uint32_t>(upper(c) - 'A') + 10U : 99U;
}

std::uint32_t base_of(char letter) noexcept {
  switch (upper(letter)) {
    case 'H':
      return 16;
    case 'Q':
      return 8;
    case 'B':
      return 2;
    default:
      return 0;
  }
}

}  // namespace

NumberText read_decimal(Span<const char> text, const char* unit) noexcept {
  Cursor cursor(text);
  Digits digits;
  if (cursor.take_minus()) {
    digits.text[digits.size++] = '-';
  }
  take_digits(cursor, false, digits);
  if (cursor.peek() == '.') {
    cursor.skip();
    take_digits(cursor, true, digits);
  }
  if (!digits.has_any) {
    return {0.0, ErrorCode::kInvalidCharacterInNumber};
  }
  if (digits.count > kMaxDigits) {
    return {0.0, ErrorCode::kTooManyDigits};
  }
  const std::int32_t exponent = take_exponent(cursor);
  if (exponent > kMaxExponent) {
    return {0.0, ErrorCode::kExponentTooLarge};
  }
  Scale scale;
  const bool follows_blank = cursor.skip_blanks();
  if (!cursor.at_end()) {
    const ErrorCode error = check_suffix(cursor.rest(), follows_blank);
    if (error != ErrorCode::kNoError) {
      return {0.0, error};
    }
    scale = scale_of(cursor.rest(), unit);
    if (scale.error != ErrorCode::kNoError) {
      return {0.0, scale.error};
    }
  }
  return {value_of(digits, digits.exponent + exponent + scale.exponent), ErrorCode::kNoError};
}

NumberText read_nondecimal(Span<const char> text) noexcept {
  const std::uint32_t base = text.size() > 1 ? base_of(text[1]) : 0U;
  if (base == 0 || text.size() == 2) {
    return {0.0, ErrorCode::kInvalidCharacterInNumber};
  }
  std::uint64_t value = 0;
  for (const char c : text.from(2)) {
    const std::uint32_t digit = digit_value(c);
    if (digit >= base) {
      return {0.0, ErrorCode::kInvalidCharacterInNumber};
    }
    if (value > (UINT64_MAX - digit) / base) {
      return {0.0, ErrorCode::kTooManyDigits};
    }
    value = value * base + digit;
  }
  return {static_cast<double>(value), ErrorCode::kNoError};
}

}  // namespace emax::app::scpi
