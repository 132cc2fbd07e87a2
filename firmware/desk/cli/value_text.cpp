// Values of options as text: numbers, lists of numbers, words.
#include "desk/cli/value_text.hpp"

#include <charconv>
#include <cmath>

#include "emax/base/decimal.hpp"

namespace emax::desk {

namespace {

// Beyond these, text without an exponent has too many zeros.
constexpr double kLeastPlain = 1e-5;
constexpr double kMostPlain = 1e15;

std::string_view without_spaces(std::string_view text) noexcept {
  while (!text.empty() && text.front() == ' ') {
    text.remove_prefix(1);
  }
  while (!text.empty() && text.back() == ' ') {
    text.remove_suffix(1);
  }
  return text;
}

}  // namespace

bool take_number(std::string_view text, double& value) noexcept {
  text = without_spaces(text);
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  if (number.status != Status::kOk || number.length != text.size() || !is_finite(number.value)) {
    return false;
  }
  value = number.value;
  return true;
}

Numbers take_list(std::string_view text) noexcept {
  Numbers list;
  for (;;) {
    const std::string_view item = text.substr(0, text.find(','));
    if (list.count == Numbers::kMost || !take_number(item, list.values[list.count])) {
      return list;
    }
    ++list.count;
    if (item.size() == text.size()) {
      list.valid = true;
      return list;
    }
    text.remove_prefix(item.size() + 1);
  }
}

bool take_text(std::string_view text, std::string& value) {
  value = text;
  return !text.empty();
}

std::vector<std::string_view> alternatives(std::string_view text) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t bar = text.find('|');
    parts.push_back(text.substr(0, bar));
    if (bar == std::string_view::npos) {
      return parts;
    }
    text.remove_prefix(bar + 1);
  }
}

std::string shortest_text(double value) {
  const double size = std::fabs(value);
  const bool is_plain = value == 0.0 || (size >= kLeastPlain && size < kMostPlain);
  char text[32];
  const std::to_chars_result end =
      std::to_chars(text, text + sizeof text, value,
                    is_plain ? std::chars_format::fixed : std::chars_format::scientific);
  std::string number(text, end.ptr);
  // "2e-06" is "2e-6" to whoever writes it.
  const std::size_t exponent = number.find('e');
  if (exponent != std::string::npos && number[exponent + 2] == '0') {
    number.erase(exponent + 2, 1);
  }
  return number;
}

}  // namespace emax::desk
