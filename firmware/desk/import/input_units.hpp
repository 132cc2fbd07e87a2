// The units that a table of points may be in.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace emax::desk {

enum class Quantity : std::uint8_t { kFrequency, kAmplitude, kPhase, kRatio, kDecibel };

/// A unit by the name that reports print. `scale` takes a number in it to Hz, V/(m/s^2), rad or 1.
struct Unit {
  Quantity quantity = Quantity::kRatio;
  const char* name = "";
  double scale = 1.0;
  bool is_charge = false;  ///< Of pC: 1 pC is taken as 1 V.

  constexpr bool is_given() const noexcept { return name[0] != '\0'; }
};

/// @returns Whether both are the same unit, or both none.
bool are_same(const Unit& one, const Unit& other) noexcept;

inline constexpr Unit kHertz = {Quantity::kFrequency, "Hz", 1.0};
inline constexpr Unit kRadiansPerSecond = {Quantity::kFrequency, "rad/s", 0.15915494309189535};
inline constexpr Unit kVoltsPerAcceleration = {Quantity::kAmplitude, "V/(m/s2)", 1.0};
inline constexpr Unit kDegree = {Quantity::kPhase, "deg", 0.017453292519943295};
/// "Grad" of a German text are degrees; the grad of others is the gon, a 400th of a turn.
inline constexpr Unit kGrad = {Quantity::kPhase, "grad", kDegree.scale};
inline constexpr Unit kRadian = {Quantity::kPhase, "rad", 1.0};
inline constexpr Unit kPercent = {Quantity::kRatio, "percent", 0.01};
inline constexpr Unit kPartOfOne = {Quantity::kRatio, "relative", 1.0};
inline constexpr Unit kDecibelUnit = {Quantity::kDecibel, "dB", 1.0};

/// Finds a unit by one of its spellings: "mV/(m/s^2)", "mV_per_m_s2", "mV/(m/s²)" are the same.
/// Capital and small letters are the same. "Peak" and "RMS" behind it are not looked at.
///
/// @returns A unit that is not `is_given()` if the spelling is none.
Unit find_unit(std::string_view spelling);

/// "dB re 1 V/g" and its like.
struct DecibelUnit {
  bool is_decibel = false;
  std::string reference;  ///< The spelling of the unit behind "re" and "1"; empty if none.
};
DecibelUnit as_decibel(std::string_view spelling);

/// All units of a quantity, for words such as "expected Hz, kHz, MHz or rad/s".
const char* expected_units(Quantity quantity) noexcept;

}  // namespace emax::desk
