// Values of the options that say what a table does not.
#include "desk/import/import_options.hpp"

#include <cstddef>
#include <string>

#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax::desk {

namespace {

constexpr double kLongestDelay_s = 1.0;

std::string_view without_blanks(std::string_view text) noexcept {
  while (!text.empty() && text.front() == ' ') {
    text.remove_prefix(1);
  }
  while (!text.empty() && text.back() == ' ') {
    text.remove_suffix(1);
  }
  return text;
}

// Cuts the text up to the next comma, or all of it, off.
std::string_view take_item(std::string_view& text) noexcept {
  const std::size_t comma = text.find(',');
  const std::string_view item = text.substr(0, comma);
  text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
  return without_blanks(item);
}

bool take_one_uncertainty(std::string_view item, ImportOptions& options) {
  const ParsedNumber number = parse_decimal(Span<const char>(item.data(), item.size()));
  if (number.status != Status::kOk || !is_finite(number.value) || !(number.value > 0.0)) {
    return false;
  }
  const Unit unit = find_unit(item.substr(number.length));
  if (!unit.is_given() || unit.quantity == Quantity::kFrequency || are_same(unit, kGrad)) {
    return false;
  }
  GivenUncertainty& taken =
      unit.quantity == Quantity::kPhase ? options.phase_uncertainty : options.amplitude_uncertainty;
  if (taken.value > 0.0) {
    return false;
  }
  taken = {number.value, unit};
  return true;
}

bool take_one_unit(std::string_view item, ImportOptions& options) {
  const Unit unit = find_unit(item);
  if (!unit.is_given() || unit.quantity == Quantity::kRatio ||
      unit.quantity == Quantity::kDecibel || are_same(unit, kGrad)) {
    return false;
  }
  Unit& taken = unit.quantity == Quantity::kFrequency   ? options.frequency_unit
                : unit.quantity == Quantity::kAmplitude ? options.amplitude_unit
                                                        : options.phase_unit;
  if (taken.is_given()) {
    return false;
  }
  taken = unit;
  return true;
}

template <typename TakeOne>
bool take_list(std::string_view text, ImportOptions& options, TakeOne take_one) {
  ImportOptions changed = options;
  if (text.empty() || text.back() == ',') {
    return false;
  }
  while (!text.empty()) {
    if (!take_one(take_item(text), changed)) {
      return false;
    }
  }
  options = changed;
  return true;
}

}  // namespace

bool take_uncertainty(std::string_view text, ImportOptions& options) {
  return take_list(text, options, take_one_uncertainty);
}

bool take_input_units(std::string_view text, ImportOptions& options) {
  return take_list(text, options, take_one_unit);
}

bool take_channel_delay(std::string_view text, ImportOptions& options) {
  text = without_blanks(text);
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  if (number.status != Status::kOk || number.length != text.size() ||
      !(abs(number.value) <= kLongestDelay_s)) {
    return false;
  }
  options.channel_delay_s = number.value;
  return true;
}

}  // namespace emax::desk
