// UTF-8 by RFC 3629.
#include "emax/app/base/utf8.hpp"

namespace emax::app {
namespace {

/// How long a character is by its first byte, which bits of it count, and the least code that takes
/// as many bytes.
struct Form {
  std::size_t length;
  std::uint8_t mask;
  std::uint8_t mark;
  std::uint32_t least;
};

constexpr Form kForms[] = {{2, 0x1F, 0xC0, 0x80}, {3, 0x0F, 0xE0, 0x800}, {4, 0x07, 0xF0, 0x10000}};

constexpr std::uint32_t kLargestCode = 0x10FFFF;

bool is_within(std::uint32_t code, std::uint32_t first, std::uint32_t last) noexcept {
  return code >= first && code <= last;
}

/// 0 unless the bytes are a character of that form. A zero at the end of the text is no
/// continuation, so nothing beyond it is read.
std::uint32_t decode(const char* text, const Form& form) noexcept {
  std::uint32_t code = static_cast<unsigned char>(text[0]) & form.mask;
  for (std::size_t i = 1; i < form.length; ++i) {
    const std::uint32_t byte = static_cast<unsigned char>(text[i]);
    if ((byte & 0xC0U) != 0x80U) {
      return 0;
    }
    code = (code << 6U) | (byte & 0x3FU);
  }
  const bool is_valid =
      code >= form.least && code <= kLargestCode && !is_within(code, 0xD800, 0xDFFF);
  return is_valid ? code : 0;
}

}  // namespace

Character first_character(const char* text) noexcept {
  const std::uint32_t byte = static_cast<unsigned char>(text[0]);
  if (byte < 0x80) {
    return {byte, byte == 0 ? 0U : 1U};
  }
  for (const Form& form : kForms) {
    const std::uint32_t marked = byte & ~static_cast<std::uint32_t>(form.mask);
    if (marked == form.mark) {
      const std::uint32_t code = decode(text, form);
      return code != 0 ? Character{code, form.length} : Character{kReplacement, 1};
    }
  }
  return {kReplacement, 1};
}

bool is_printable(std::uint32_t code) noexcept {
  const bool is_control = code < 0x20 || is_within(code, 0x7F, 0x9F);
  const bool is_separator = is_within(code, 0x2028, 0x2029);
  const bool turns = is_within(code, 0x202A, 0x202E) || is_within(code, 0x2066, 0x2069);
  return !is_control && !is_separator && !turns && code != 0xFEFF;
}

}  // namespace emax::app
