// The numbers of an axis, with a power of ten in its unit.
#include "desk/pictures/axis_scale.hpp"

#include <cmath>
#include <cstdlib>

namespace emax::desk {

namespace {

std::string superscript(int exponent) {
  constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "⁻" : "";
  for (const char digit : std::to_string(std::abs(exponent))) {
    text += kDigits[digit - '0'];
  }
  return text;
}

}  // namespace

int thousands_of(double largest) {
  const double size = std::abs(largest);
  return size > 0.0 ? static_cast<int>(std::floor(std::log10(size) / 3.0 + 1e-9)) : 0;
}

Scale scaled(double largest, const std::string& unit, double plain) {
  const int exponent = 3 * thousands_of(largest);
  if (exponent == 0 || (exponent < 0 && std::abs(largest) >= plain)) {
    return {1.0, unit};
  }
  return {std::pow(10.0, -exponent), "10" + superscript(exponent) + " " + unit};
}

}  // namespace emax::desk
