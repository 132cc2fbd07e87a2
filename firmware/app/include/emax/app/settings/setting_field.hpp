// What every target keeps of a setting: its name, its range, and where and how it is stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "emax/app/settings/settings_error.hpp"
#include "emax/base/span.hpp"

namespace emax::app {

struct Settings;
struct SweepSettings;

/// How a setting is stored, and so how it is read, checked, compared and saved.
enum class SettingKind : std::uint8_t {
  kNumber,        ///< A double.
  kWhole,         ///< An int or a std::uint32_t, never below 0.
  kSwitch,        ///< A bool.
  kChoice,        ///< An enumeration of one byte that counts from 0.
  kNumberOrWord,  ///< A double, and beside it a byte that says whether a word stands for it.
  kNumbers,       ///< An array of double, and beside it how many of them are in use.
  kMoreNumbers,   ///< The same with the count of another list.
  kWholes,        ///< An array of std::uint32_t, all of them in use.
};

/// What depends on a setting.
enum class Concern : std::uint8_t {
  kSweep,
  kEnergy,
  kPaper,       ///< The energy, by Method::kPaper only.
  kTrials,      ///< The Monte Carlo trials.
  kTrialCount,  ///< The same, unless their number is adaptive.
  kRandom,      ///< All random numbers: those of the trials and of the draws of the fit.
  kTrend,
};

/// The smallest double above 0 and the largest below 1, as ends of a range.
inline constexpr double kAboveZero = std::numeric_limits<double>::denorm_min();
inline constexpr double kBelowOne = 1.0 - std::numeric_limits<double>::epsilon() / 2.0;

/// One setting in a structure of settings.
struct SettingField {
  const char* name = nullptr;         ///< In errors.
  const char* expectation = nullptr;  ///< What it must be, in words.
  double min = 0.0;                   ///< Of kNumber, kWhole, and the number of kNumberOrWord.
  double max = 0.0;
  std::uint16_t offset = 0;  ///< Of the member in its structure.
  std::uint16_t beside = 0;  ///< Of the byte of kNumberOrWord, or the count of a list.
  std::uint16_t last = 0;    ///< The last value of a byte, or the room of a list.
  SettingKind kind = SettingKind::kNumber;
  Concern concern : 5;
  std::uint8_t number_mode : 3;  ///< The byte of kNumberOrWord where the number itself holds.

  constexpr SettingField() noexcept : concern(Concern::kSweep), number_mode(0) {}
};

/// Least and greatest value.
struct SettingLimits {
  double min = 0.0;
  double max = 0.0;
};

/// @returns All settings of the structure in the order of its members, which is also the order of
/// checks and of saved bytes.
Span<const SettingField> fields_of(const Settings& settings) noexcept;
Span<const SettingField> fields_of(const SweepSettings& settings) noexcept;

/// The member of type `T` at an offset. `settings` is the structure that the field belongs to.
template <typename T>
const T& member_at(const void* settings, std::size_t offset) noexcept {
  return *static_cast<const T*>(
      static_cast<const void*>(static_cast<const unsigned char*>(settings) + offset));
}
template <typename T>
T& member_at(void* settings, std::size_t offset) noexcept {
  return *static_cast<T*>(static_cast<void*>(static_cast<unsigned char*>(settings) + offset));
}

/// @returns The value of a kNumber or kWhole, and the number of kNumberOrWord; 0 of others.
double number_in(const SettingField& field, const void* settings) noexcept;

/// @returns False if the setting is outside its range or not a number. A list, a choice and a
/// switch have no range; nor has a number that a word stands for.
bool is_in_range(const SettingField& field, const void* settings) noexcept;

/// @returns Whether both structures hold the same value. A number that a word stands for does not
/// count, nor what a list holds behind its end.
bool is_same(const SettingField& field, const void* a, const void* b) noexcept;

}  // namespace emax::app
