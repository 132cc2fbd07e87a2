// What outlives a power cut, as bytes: the settings of a slot, and the last identification.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/settings_rows.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/app/settings/sweep_settings_rows.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// Slots of *SAV and *RCL, which are the records of the same numbers.
inline constexpr std::uint32_t kSavedSlots = 4;
inline constexpr std::uint32_t kIdentificationRecord = kSavedSlots;
inline constexpr std::uint32_t kSavedRecords = kIdentificationRecord + 1;

/// The most bytes that `encode()` makes of settings, all tables full.
inline constexpr std::size_t kMaxSavedSettingsBytes =
    4 + most_saved_bytes(kSettingRows) + most_saved_bytes(kSweepSettingRows);
/// All that it makes of an identification.
inline constexpr std::size_t kSavedIdentificationBytes = 113;

/// The settings that *SAV keeps.
struct SavedSettings {
  Settings settings;
  SweepSettings sweep;
};

/// A device with where it comes from and how good the fit was.
struct Identification {
  Source source = Source::kModel;
  Device device;
  double covariance[3][3] = {};  ///< Of S, f0 and beta; symmetric.
  double chi2 = 0.0;             ///< Source::kPoints only, as `dof`.
  std::uint32_t dof = 0;
};

static_assert(std::is_trivially_copyable_v<SavedSettings>);
static_assert(std::is_trivially_copyable_v<Identification>);

/// @param[in] results    With a device: `has_model()`.
Identification identification_of(const EvaluationResults& results) noexcept;

/// Writes settings as bytes: kind and version, then each setting in little endian, doubles by their
/// bits, of each table as many entries as are in use. The same on every target.
///
/// @param[out] bytes kMaxSavedSettingsBytes are always enough.
/// @returns The number of bytes written; 0 if there is no room, or a table says that it is longer
/// than it can be.
std::size_t encode(const Settings& settings, const SweepSettings& sweep,
                   Span<std::uint8_t> bytes) noexcept;

/// The same of an identification.
std::size_t encode(const Identification& identification, Span<std::uint8_t> bytes) noexcept;

/// Reads what `encode()` has written.
///
/// @param[in]  format  Of the stream that the sweep's settings are for.
/// @param[out] scratch Lent; anything may be in it afterwards.
/// @returns
/// * kOk: Both targets are replaced. They have passed `check()`.
/// * kUnknownRecord: Another kind or version, too few or too many bytes, a number that is not
///   finite, an unknown choice, or settings that `check()` refuses here. Both targets are as
///   before.
Status decode(Span<const std::uint8_t> bytes, const hal::StreamFormat& format,
              SavedSettings& scratch, Settings& settings, SweepSettings& sweep) noexcept;

/// The same for an identification: the device must be valid, the covariance one that there can be,
/// with the squares of the uncertainties on its diagonal.
Status decode(Span<const std::uint8_t> bytes, Identification& identification) noexcept;

}  // namespace emax::app
