// Bounds in a few digits.
#include "desk/files/rounding.hpp"

#include <cmath>
#include <string>

#include "emax/base/decimal.hpp"

#include "desk/cli/console.hpp"

namespace emax::desk {

double rounded_up(double value, int decimals) {
  StringSink sink;
  app::TextWriter(sink).scientific(value, decimals);
  const std::string& shown = sink.text();
  if (!(parse_decimal(Span<const char>(shown.data(), shown.size())).value < value)) {
    return value;
  }
  // It has been rounded down, by at most half of its last digit.
  const Span<const char> digits(shown.data(), shown.size());
  const int exponent = static_cast<int>(parse_decimal(digits.from(shown.find('e') + 1)).value);
  return value + std::pow(10.0, exponent - decimals);
}

}  // namespace emax::desk
