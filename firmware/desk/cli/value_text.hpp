// Values of options as text: numbers, lists of numbers, words.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "emax/app/settings/settings.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"

namespace emax::desk {

/// Numbers with commas between them.
struct Numbers {
  /// A list longer than any that is expected.
  static constexpr std::size_t kMost =
      (kMaxPoints > app::kMaxTrendPoints ? kMaxPoints : app::kMaxTrendPoints) + 1;

  double values[kMost] = {};
  std::size_t count = 0;
  bool valid = false;
};

/// Takes a finite number, blanks around it or not. False, with the value as it was, for any other
/// text.
bool take_number(std::string_view text, double& value) noexcept;

/// Takes such numbers, with commas between them.
Numbers take_list(std::string_view text) noexcept;

/// @returns False, with the value as it was, for a number that is not whole or does not fit.
template <typename Integer>
bool to_integer(double number, Integer& value) noexcept {
  using Limits = std::numeric_limits<Integer>;
  if (!(number >= static_cast<double>(Limits::min())) ||
      !(number <= static_cast<double>(Limits::max())) || number != emax::floor(number)) {
    return false;
  }
  value = static_cast<Integer>(number);
  return true;
}

template <typename Integer>
bool take_integer(std::string_view text, Integer& value) noexcept {
  double number = 0.0;
  return take_number(text, number) && to_integer(number, value);
}

/// Takes any text but an empty one.
bool take_text(std::string_view text, std::string& value);

/// @returns The parts of "auto|NUMBER|track".
std::vector<std::string_view> alternatives(std::string_view text);

/// @returns The shortest text that is read as this number: "0.002", "200000", "2e-6".
std::string shortest_text(double value);

}  // namespace emax::desk
