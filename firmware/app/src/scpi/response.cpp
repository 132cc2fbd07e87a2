// Fields of answers into the output memory, and their way out of it.
#include "emax/app/scpi/response.hpp"

#include <algorithm>
#include <limits>

#include "emax/app/scpi/error_code.hpp"
#include "emax/app/scpi/pattern.hpp"
#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app::scpi {
namespace {

constexpr std::size_t kLongestNumber = 24;
constexpr std::size_t kLongestInteger = 20;
constexpr int kExactDigits = 17;
constexpr int kSafeDigits = 15;  // A number of so many digits is the rounding of what it reads as.

std::size_t length_of(const char* words) noexcept {
  std::size_t length = 0;
  while (words[length] != '\0') {
    ++length;
  }
  return length;
}

/// Writes the digits to the end of the memory and answers where they begin.
std::size_t put_digits(std::uint64_t value, char (&digits)[kLongestInteger]) noexcept {
  std::size_t first = kLongestInteger;
  do {
    digits[--first] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  return first;
}

/// "-d.ddde-dd", as `format_scientific()` has it.
struct ScientificText {
  char text[kLongestNumber];
  std::size_t length;
};

bool reads_as(const ScientificText& number, double magnitude) noexcept {
  return parse_decimal(Span<const char>(number.text, number.length)).value == magnitude;
}

/// The fewest digits that read back as this positive number.
ScientificText shortest_text(double magnitude) noexcept {
  constexpr double kSmallestNormal = std::numeric_limits<double>::min();
  ScientificText number = {};
  int digits = magnitude < kSmallestNormal ? 1 : kSafeDigits;
  for (; digits <= kExactDigits; ++digits) {
    number.length = format_scientific(magnitude, digits - 1, number.text);
    if (reads_as(number, magnitude)) {
      break;
    }
    // Below a power of two the numbers lie closer than above it: the next digits up may do.
    char& last = number.text[digits];
    if (digits == kSafeDigits + 1 && last < '9') {
      ++last;
      if (reads_as(number, magnitude)) {
        break;
      }
    }
  }
  return number;
}

/// The parts of it.
struct ShortestNumber {
  char digits[kExactDigits];  ///< The point is behind the first one.
  int count = 0;              ///< Without zeros at the end; at least 1.
  int exponent = 0;
};

ShortestNumber shortest_number(double magnitude) noexcept {
  ShortestNumber parts = {};
  const ScientificText number = shortest_text(magnitude);
  std::size_t i = 0;
  int count = 0;
  for (; number.text[i] != 'e'; ++i) {
    if (number.text[i] != '.') {
      parts.digits[count++] = number.text[i];
      parts.count = number.text[i] != '0' ? count : parts.count;
    }
  }
  const bool is_negative = number.text[i + 1] == '-';
  for (i += 2; i < number.length; ++i) {
    parts.exponent = parts.exponent * 10 + (number.text[i] - '0');
  }
  parts.exponent = is_negative ? -parts.exponent : parts.exponent;
  return parts;
}

}  // namespace

Response& Response::number(double value) noexcept {
  if (value != value) {
    return word("9.91E37");
  }
  if (!is_finite(value)) {
    return word(value > 0.0 ? "9.9E37" : "-9.9E37");
  }
  if (value == 0.0) {
    return word("0");
  }
  const ShortestNumber parts = shortest_number(abs(value));
  const bool has_exponent = parts.exponent < 0 || parts.exponent >= kExactDigits;
  const int whole = has_exponent ? 1 : parts.exponent + 1;  // Digits in front of the point.
  const int written = has_exponent && parts.count == 1 ? 2 : std::max(whole, parts.count);
  separate();
  put("-", value < 0.0 ? 1 : 0);
  for (int i = 0; i < written; ++i) {
    put(".", i == whole ? 1 : 0);
    put(i < parts.count ? parts.digits + i : "0", 1);
  }
  if (has_exponent) {
    put(parts.exponent < 0 ? "E-" : "E+", 2);
    put_number(static_cast<std::uint64_t>(parts.exponent < 0 ? -parts.exponent : parts.exponent));
  }
  return *this;
}

Response& Response::integer(std::int64_t value) noexcept {
  separate();
  put("-", value < 0 ? 1 : 0);
  const auto bits = static_cast<std::uint64_t>(value);
  put_number(value < 0 ? 0 - bits : bits);
  return *this;
}

Response& Response::word(const char* word) noexcept {
  separate();
  put(word, length_of(word));
  return *this;
}

Response& Response::word(Span<const char> word) noexcept {
  separate();
  put(word.data(), word.size());
  return *this;
}

Response& Response::short_form(const char* pattern) noexcept {
  return word(Span<const char>(pattern, short_form_length(pattern, length_of(pattern))));
}

Response& Response::string(Span<const char> text) noexcept {
  separate();
  put("\"", 1);
  put_quoted(text);
  put("\"", 1);
  return *this;
}

Response& Response::error(const ErrorEntry& entry) noexcept {
  separate();
  put("\"", 1);
  put_quoted(text_of(entry.code));
  if (entry.words != nullptr || entry.context_length > 0) {
    put(";", 1);
  }
  put_quoted(Span<const char>(entry.context, entry.context_length));
  if (entry.subject != nullptr) {
    put_quoted(entry.subject);
    put(": ", 2);
  }
  if (entry.words != nullptr) {
    put_quoted(entry.words);
  }
  put("\"", 1);
  return *this;
}

Response& Response::block_header(std::size_t length) noexcept {
  separate();
  char digits[kLongestInteger];
  const std::size_t first = put_digits(length, digits);
  const std::size_t count = kLongestInteger - first;
  const char head[2] = {'#', static_cast<char>('0' + count)};
  put(head, sizeof head);
  put(digits + first, count);
  return *this;
}

Response& Response::block(Span<const char> bytes) noexcept {
  block_header(bytes.size());
  block_ = fits_ ? bytes : block_;
  return *this;
}

Response& Response::piece(Span<const char> characters) noexcept {
  put(characters.data(), characters.size());
  return *this;
}

Response& Response::piece(const char* characters) noexcept {
  put(characters, length_of(characters));
  return *this;
}

Span<const char> Response::pending() const noexcept {
  if (begin_ == end_) {
    return block_;
  }
  return {text_ + begin_, static_cast<std::size_t>(end_ - begin_)};
}

void Response::consume(std::size_t count) noexcept {
  if (count > 0) {
    line_is_open_ = pending()[count - 1] != '\n';
  }
  if (begin_ == end_) {
    block_ = block_.from(count);
    return;
  }
  begin_ = static_cast<std::uint16_t>(begin_ + count);
  if (begin_ == end_) {
    begin_ = 0;
    end_ = 0;
  }
}

void Response::begin_answer(std::size_t limit) noexcept {
  has_field_ = false;
  begin_item(limit);
}

void Response::begin_item(std::size_t limit) noexcept {
  if (begin_ > 0) {
    for (std::size_t i = begin_; i < end_; ++i) {
      text_[i - begin_] = text_[i];
    }
    end_ = static_cast<std::uint16_t>(end_ - begin_);
    begin_ = 0;
  }
  mark_ = end_;
  limit_ = static_cast<std::uint16_t>(limit);
  was_open_ = open_;
  had_field_ = has_field_;
  had_block_ = holds_block();
  fits_ = true;
}

void Response::drop_answer() noexcept {
  end_ = mark_;
  block_ = had_block_ ? block_ : Span<const char>();
  open_ = was_open_;
  has_field_ = had_field_;
  fits_ = true;
}

void Response::end_message() noexcept {
  if (!open_) {
    return;
  }
  begin_item(1);
  put("\n", 1);
  open_ = false;
  has_field_ = false;
}

void Response::drop_unsent() noexcept {
  const bool ends_line = line_is_open_;
  clear();
  if (ends_line) {
    begin_item(1);
    put("\n", 1);
  }
}

void Response::clear() noexcept {
  line_is_open_ = false;
  block_ = {};
  begin_ = 0;
  end_ = 0;
  mark_ = 0;
  open_ = false;
  has_field_ = false;
  fits_ = true;
}

bool Response::consistent() const noexcept {
  return begin_ <= end_ && end_ <= kCapacity && (begin_ < end_ || (begin_ == 0 && end_ == 0));
}

void Response::put(const char* characters, std::size_t count) noexcept {
  if (!fits_ || count > kCapacity - end_ || end_ + count > mark_ + std::size_t{limit_}) {
    fits_ = false;
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    text_[end_ + i] = characters[i];
  }
  end_ = static_cast<std::uint16_t>(end_ + count);
}

void Response::put_number(std::uint64_t value) noexcept {
  char digits[kLongestInteger];
  const std::size_t first = put_digits(value, digits);
  put(digits + first, kLongestInteger - first);
}

void Response::put_quoted(Span<const char> text) noexcept {
  for (const char& character : text) {
    if (character == '"') {
      put("\"", 1);
    }
    put(&character, 1);
  }
}

void Response::put_quoted(const char* text) noexcept {
  put_quoted(Span<const char>(text, length_of(text)));
}

void Response::separate() noexcept {
  if (joins_) {
    joins_ = false;
  } else if (has_field_) {
    put(",", 1);
  } else if (open_) {
    put(";", 1);
  }
  has_field_ = true;
  open_ = true;
}

}  // namespace emax::app::scpi
