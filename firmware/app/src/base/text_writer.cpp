// Words, numbers and columns by way of the decimal conversions.
#include "emax/app/base/text_writer.hpp"

#include "emax/app/base/utf8.hpp"
#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

// The longest number: a sign, 309 digits, a point and 17 decimals.
constexpr std::size_t kLongestNumber = 352;
constexpr std::size_t kLongestShortNumber = 32;
constexpr std::size_t kLongestInteger = 20;
constexpr char kBlanks[] = "                                ";
constexpr std::size_t kBlankCount = sizeof kBlanks - 1;

std::size_t length_of(const char* words) noexcept {
  std::size_t length = 0;
  while (words[length] != '\0') {
    ++length;
  }
  return length;
}

/// Of UTF-8: bytes that do not go on with a character begun before.
std::size_t characters_of(const char* bytes, std::size_t count) noexcept {
  std::size_t characters = 0;
  for (std::size_t i = 0; i < count; ++i) {
    characters += (static_cast<unsigned char>(bytes[i]) & 0xC0U) != 0x80U ? 1U : 0U;
  }
  return characters;
}

constexpr bool is_blank(char character) noexcept {
  return character == ' ' || (character >= '\t' && character <= '\r');
}

}  // namespace

TextWriter& TextWriter::text(const char* words) noexcept {
  if (words != nullptr) {
    put(words, length_of(words));
  }
  return *this;
}

TextWriter& TextWriter::text(Span<const char> words) noexcept {
  put(words.data(), words.size());
  return *this;
}

TextWriter& TextWriter::one_line(const char* words, std::uint32_t most) noexcept {
  for (std::uint32_t shown = 0; *words != '\0' && shown < most; ++shown) {
    const Character next = first_character(words);
    if (is_blank(*words)) {
      text(" ");
    } else if (next.code == kReplacement || !is_printable(next.code)) {
      text("?");
    } else {
      text(Span<const char>(words, next.length));
    }
    words += next.length;
  }
  return text(*words == '\0' ? "" : " ...");
}

TextWriter& TextWriter::fixed(double value, int decimals) noexcept {
  char number[kLongestNumber];
  put(number, format_fixed(value, decimals, number));
  return *this;
}

TextWriter& TextWriter::scientific(double value, int decimals) noexcept {
  char number[kLongestShortNumber];
  put(number, format_scientific(value, decimals, number));
  return *this;
}

TextWriter& TextWriter::general(double value, int significant_digits) noexcept {
  char number[kLongestShortNumber];
  put(number, format_general(value, significant_digits, number));
  return *this;
}

TextWriter& TextWriter::exact(double value) noexcept {
  if (!is_finite(value)) {
    return text("null");
  }
  // With 15 digits trailing zeros are dropped, so fewer digits need no attempt of their own.
  char number[kLongestShortNumber];
  std::size_t length = 0;
  for (int digits = 15; digits <= 17; ++digits) {
    length = format_general(value, digits, number);
    if (parse_decimal(Span<const char>(number, length)).value == value) {
      break;
    }
  }
  put(number, length);
  return *this;
}

TextWriter& TextWriter::integer(std::uint64_t value) noexcept {
  char number[kLongestInteger];
  std::size_t first = kLongestInteger;
  do {
    number[--first] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  put(number + first, kLongestInteger - first);
  return *this;
}

TextWriter& TextWriter::spaces(std::size_t count) noexcept {
  while (count > 0) {
    const std::size_t part = count < kBlankCount ? count : kBlankCount;
    sink_.write(Span<const char>(kBlanks, part));
    count -= part;
  }
  return *this;
}

TextWriter& TextWriter::left(std::size_t width) noexcept {
  width_ = width;
  flush_right_ = false;
  return *this;
}

TextWriter& TextWriter::right(std::size_t width) noexcept {
  width_ = width;
  flush_right_ = true;
  return *this;
}

void TextWriter::put(const char* characters, std::size_t count) noexcept {
  const std::size_t shown = width_ > 0 ? characters_of(characters, count) : count;
  const std::size_t padding = width_ > shown ? width_ - shown : 0;
  width_ = 0;
  if (flush_right_) {
    spaces(padding);
  }
  sink_.write(Span<const char>(characters, count));
  if (!flush_right_) {
    spaces(padding);
  }
}

}  // namespace emax::app
