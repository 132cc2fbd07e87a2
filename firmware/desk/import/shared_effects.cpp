// What points share, as a comment in a table that emax has written.
#include "desk/import/shared_effects.hpp"

#include "emax/base/decimal.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax::desk {

namespace {

constexpr std::string_view kStart = "# shared:";

double* effect_of(std::string_view name, SharedEffects& shared) noexcept {
  const struct {
    std::string_view name;
    double* effect;
  } effects[] = {{"skew", &shared.skew_s},         {"clock", &shared.clock},
                 {"drift", &shared.drift},         {"corner", &shared.corner_hz},
                 {"images", &shared.images},       {"leak", &shared.leak},
                 {"leak_back", &shared.leak_back}, {"linearity", &shared.linearity}};
  for (const auto& known : effects) {
    if (known.name == name) {
      return known.effect;
    }
  }
  return nullptr;
}

bool take(std::string_view item, SharedEffects& shared) {
  const std::size_t sign = item.find('=');
  double* const effect = effect_of(item.substr(0, sign), shared);
  if (effect == nullptr || sign == std::string_view::npos) {
    return false;
  }
  const std::string_view text = item.substr(sign + 1);
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  if (number.status != Status::kOk || number.length != text.size() || !(number.value >= 0.0) ||
      !is_finite(number.value)) {
    return false;
  }
  *effect = number.value;
  return true;
}

}  // namespace

SharedLine read_shared(std::string_view line, SharedEffects& shared) {
  if (line.substr(0, kStart.size()) != kStart) {
    return SharedLine::kOther;
  }
  line.remove_prefix(kStart.size());
  // Spreadsheets fill the row with separators.
  line = line.substr(0, line.find_last_not_of(",; \t\"") + 1);
  SharedEffects found;
  while (!line.empty()) {
    const std::size_t begin = line.find_first_not_of(' ');
    if (begin == std::string_view::npos) {
      break;
    }
    line.remove_prefix(begin);
    const std::size_t end = line.find(' ');
    if (!take(line.substr(0, end), found)) {
      return SharedLine::kWrong;
    }
    line.remove_prefix(end == std::string_view::npos ? line.size() : end);
  }
  shared = found;
  return SharedLine::kTaken;
}

}  // namespace emax::desk
