// The units that a table of points may be in.
#include "desk/import/input_units.hpp"

#include <cstddef>
#include <iterator>

#include "desk/import/letters.hpp"

namespace emax::desk {

namespace {

constexpr double kGravity = 9.80665;  // m/s^2 per g, exactly.

// What a spelling becomes: letters are small; "per" is a slash; powers are plain digits; brackets,
// blanks, dots and underscores are gone.
struct Spelling {
  std::string_view canonical;
  Unit unit;
};

constexpr Spelling kSpellings[] = {
    {"hz", kHertz},
    {"1/s", kHertz},
    {"khz", {Quantity::kFrequency, "kHz", 1e3}},
    {"mhz", {Quantity::kFrequency, "MHz", 1e6}},
    {"rad/s", kRadiansPerSecond},
    {"rads", kRadiansPerSecond},
    {"rads-1", kRadiansPerSecond},
    {"v/m/s2", kVoltsPerAcceleration},
    {"v/ms2", kVoltsPerAcceleration},
    {"v/mps2", kVoltsPerAcceleration},
    {"v/ms-2", kVoltsPerAcceleration},
    {"vs2/m", kVoltsPerAcceleration},
    {"mv/m/s2", {Quantity::kAmplitude, "mV/(m/s2)", 1e-3}},
    {"mv/ms2", {Quantity::kAmplitude, "mV/(m/s2)", 1e-3}},
    {"mv/mps2", {Quantity::kAmplitude, "mV/(m/s2)", 1e-3}},
    {"mv/ms-2", {Quantity::kAmplitude, "mV/(m/s2)", 1e-3}},
    {"mvs2/m", {Quantity::kAmplitude, "mV/(m/s2)", 1e-3}},
    {"uv/m/s2", {Quantity::kAmplitude, "uV/(m/s2)", 1e-6}},
    {"uv/ms2", {Quantity::kAmplitude, "uV/(m/s2)", 1e-6}},
    {"uv/ms-2", {Quantity::kAmplitude, "uV/(m/s2)", 1e-6}},
    {"v/g", {Quantity::kAmplitude, "V/g", 1.0 / kGravity}},
    {"v/gn", {Quantity::kAmplitude, "V/g", 1.0 / kGravity}},
    {"mv/g", {Quantity::kAmplitude, "mV/g", 1e-3 / kGravity}},
    {"mv/gn", {Quantity::kAmplitude, "mV/g", 1e-3 / kGravity}},
    {"uv/g", {Quantity::kAmplitude, "uV/g", 1e-6 / kGravity}},
    {"pc/m/s2", {Quantity::kAmplitude, "pC/(m/s2)", 1.0, true}},
    {"pc/ms2", {Quantity::kAmplitude, "pC/(m/s2)", 1.0, true}},
    {"pc/mps2", {Quantity::kAmplitude, "pC/(m/s2)", 1.0, true}},
    {"pc/ms-2", {Quantity::kAmplitude, "pC/(m/s2)", 1.0, true}},
    {"pcs2/m", {Quantity::kAmplitude, "pC/(m/s2)", 1.0, true}},
    {"pc/g", {Quantity::kAmplitude, "pC/g", 1.0 / kGravity, true}},
    {"pc/gn", {Quantity::kAmplitude, "pC/g", 1.0 / kGravity, true}},
    {"deg", kDegree},
    {"degree", kDegree},
    {"degrees", kDegree},
    {"grad", kGrad},
    {"gon", {Quantity::kPhase, "gon", 0.9 * kDegree.scale}},
    {"gradian", {Quantity::kPhase, "gon", 0.9 * kDegree.scale}},
    {"gradians", {Quantity::kPhase, "gon", 0.9 * kDegree.scale}},
    {"degr\xC3\xA9", kDegree},
    {"degr\xC3\xA9s", kDegree},
    {"gradi", kDegree},
    {"grados", kDegree},
    {"\xC2\xB0", kDegree},
    {"\xC2\xBA", kDegree},
    {"rad", kRadian},
    {"radian", kRadian},
    {"radians", kRadian},
    {"mrad", {Quantity::kPhase, "mrad", 1e-3}},
    {"%", kPercent},
    {"percent", kPercent},
    {"pct", kPercent},
    {"prozent", kPercent},
    {"pourcent", kPercent},
    {"percento", kPercent},
    {"db", kDecibelUnit},
};

struct Replacement {
  std::string_view from;
  std::string_view to;
};

// Longer ones first where one is the beginning of another.
constexpr Replacement kReplacements[] = {
    {"\xE2\x81\xBB", "-"},
    {"\xC2\xB2", "2"},
    {"\xC2\xB9", "1"},
    {"\xC2\xB5", "u"},
    {"\xCE\xBC", "u"},
    {"\xE2\x88\x92", "-"},
    {"\xC2\xB7", ""},
    {"\xE2\x8B\x85", ""},
    {"\xE2\x88\x95", "/"},
    {"\xE2\x84\x85", "%"},
    {"**", ""},
    {"^", ""},
    {"*", ""},
    {"(", ""},
    {")", ""},
    {"[", ""},
    {"]", ""},
    {"{", ""},
    {"}", ""},
    {" ", ""},
    {"\t", ""},
    {"_", ""},
    {".", ""},
    {",", ""},
    {":", ""},
    {";", ""},
    {"\xC2\xA0", ""},
};

// "per" as a word by itself.
bool is_per(std::string_view text, std::size_t at) noexcept {
  const bool begins = at == 0 || !is_small_letter(text[at - 1]);
  const bool ends = at + 3 >= text.size() || !is_small_letter(text[at + 3]);
  return begins && ends && text.substr(at, 3) == "per";
}

std::string canonical(std::string_view spelling) {
  std::string small;
  for (const char c : spelling) {
    small += small_letter(c);
  }
  std::string result;
  for (std::size_t at = 0; at < small.size();) {
    if (is_per(small, at)) {
      result += '/';
      at += 3;
      continue;
    }
    bool replaced = false;
    for (const Replacement& replacement : kReplacements) {
      if (std::string_view(small).substr(at, replacement.from.size()) == replacement.from) {
        result += replacement.to;
        at += replacement.from.size();
        replaced = true;
        break;
      }
    }
    if (!replaced) {
      result += small[at++];
    }
  }
  return result;
}

bool drop_end(std::string& text, std::string_view end) {
  if (text.size() <= end.size() || text.compare(text.size() - end.size(), end.size(), end) != 0) {
    return false;
  }
  text.resize(text.size() - end.size());
  return true;
}

}  // namespace

bool are_same(const Unit& one, const Unit& other) noexcept {
  return std::string_view(one.name) == other.name;
}

Unit find_unit(std::string_view spelling) {
  std::string wanted = canonical(spelling);
  (void)(drop_end(wanted, "peak") || drop_end(wanted, "rms"));
  for (const Spelling& known : kSpellings) {
    if (known.canonical == wanted) {
      return known.unit;
    }
  }
  return {};
}

DecibelUnit as_decibel(std::string_view spelling) {
  std::string text = canonical(spelling);
  DecibelUnit result;
  if (text.compare(0, 2, "db") != 0) {
    return result;
  }
  text.erase(0, 2);
  if (text.compare(0, 4, "rel1") == 0) {
    text.erase(0, 4);
  } else if (text.compare(0, 2, "re") == 0) {
    text.erase(0, 2);
    if (text.compare(0, 1, "1") == 0) {
      text.erase(0, 1);
    }
  } else if (!text.empty()) {
    return result;
  }
  result.is_decibel = true;
  result.reference = text;
  return result;
}

const char* expected_units(Quantity quantity) noexcept {
  switch (quantity) {
    case Quantity::kFrequency:
      return "expected Hz, kHz, MHz or rad/s";
    case Quantity::kAmplitude:
      return "expected V/(m/s2), mV/(m/s2), V/g, mV/g, pC/(m/s2), pC/g, or dB re 1 of one of these";
    case Quantity::kPhase:
      return "expected deg, rad, mrad or gon";
    case Quantity::kRatio:
    case Quantity::kDecibel:
      return "expected the unit of the amplitude, percent or dB";
  }
  return "expected a unit";
}

}  // namespace emax::desk
