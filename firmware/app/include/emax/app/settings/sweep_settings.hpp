// What the bench is told before a sweep, and the defaults of the simulated bench.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/settings/setting_field.hpp"
#include "emax/app/settings/settings_error.hpp"
#include "emax/base/capacity.hpp"
#include "emax/hal/analog_stream.hpp"

namespace emax::app {

// 512 bytes of a board's memory for each 32: a PC has them, whose tables come from calibration
// laboratories.
#if EMAX_MAX_POINTS > 64
#define EMAX_MAX_REFERENCE_POINTS 64
#else
#define EMAX_MAX_REFERENCE_POINTS 32
#endif
inline constexpr std::size_t kMaxReferencePoints = EMAX_MAX_REFERENCE_POINTS;
inline constexpr std::size_t kMaxRepeats = 16;
/// The largest frequency is the sample rate over this.
inline constexpr double kMinSamplesPerPeriod = 2.5;

/// The reference sensor's calibration: one value, or a table over frequency with straight lines
/// between its points and the first and last value beyond them.
struct ReferenceCalibration {
  std::array<double, kMaxReferencePoints> frequency_hz = {};  ///< Ascending; unused if count is 1.
  std::array<double, kMaxReferencePoints> sensitivity = {};   ///< S_r in V/(m/s^2).
  std::size_t count = 0;
  double expanded_percent = 0.0;  ///< Expanded uncertainty (k = 2), common to all frequencies.
};

/// @returns S_r at this frequency in V/(m/s^2).
double sensitivity_at(const ReferenceCalibration& calibration, double frequency_hz) noexcept;

/// `SweepSettings{}` is all zero, which `check()` refuses.
struct SweepSettings {
  std::array<double, kMaxPoints> frequency_hz = {};  ///< Ascending.
  std::size_t frequency_count = 0;
  double level_mps2 = 0.0;               ///< Peak acceleration to reach.
  double acceleration_limit_mps2 = 0.0;  ///< Peak acceleration of the shaker never to exceed.
  double drive_limit_v = 0.0;            ///< Peak drive never to exceed.
  double slew_v_per_s = 0.0;             ///< Of the drive.
  double settle_s = 0.0;                 ///< After each ramp; three periods at least.
  std::uint32_t cycles = 0;              ///< Least number of whole periods per repeat.
  double repeat_s = 0.0;                 ///< Least duration of a repeat.
  std::uint32_t repeats = 0;             ///< 2 to kMaxRepeats.
  ReferenceCalibration reference;
  double reference_gain = 0.0;                   ///< Conditioner of the reference.
  double reference_gain_expanded_percent = 0.0;  ///< All uncertainties: k = 2.
  double device_gain = 0.0;                      ///< Conditioner of the device under test.
  double device_gain_expanded_percent = 0.0;
  /// True gain of the device's channel over that of the reference's, over the nominal one: what a
  /// loopback finds. The measured ratio is divided by it.
  double ratio_correction = 0.0;
  double ratio_expanded_percent = 0.0;
  double mounting_expanded_percent = 0.0;  ///< Mounting, transverse motion, temperature.
  double skew_s = 0.0;  ///< The device's channel samples later than the reference's.
  double skew_expanded_s = 0.0;
  double clock_expanded_ppm = 0.0;          ///< Of the rate of sampling: of every frequency.
  double crosstalk_expanded_percent = 0.0;  ///< Of either channel's voltage seen in the other.
  double linearity_expanded_percent = 0.0;  ///< Change of a channel's gain up to full scale.
  double check_hz = 0.0;                    ///< Measured before and after the sweep.
  /// What the device's data sheet says, V/(m/s^2), within a factor of kPlausibleFactor; 0 if it
  /// says nothing, and then channels that are swapped are told by their phase only.
  double expected_sensitivity = 0.0;
  /// Volts outside the front end that are full scale of the converters; 0 for those at their pins.
  double drive_full_scale_v = 0.0;
  double reference_full_scale_v = 0.0;
  double device_full_scale_v = 0.0;
};

static_assert(std::is_trivially_copyable_v<SweepSettings>);

/// Full scales in volts outside the front end.
struct FullScales {
  double drive_v = 0.0;
  double reference_v = 0.0;
  double device_v = 0.0;
};

/// @returns Those of the settings, and of the stream where these say nothing.
FullScales full_scales(const SweepSettings& settings, const hal::StreamFormat& format) noexcept;

/// The sweep that the simulated bench is made for, at the 42 frequencies of the paper's Table 1. A
/// function, because it takes a sixth of the flash that the constant would take.
SweepSettings default_sweep_settings() noexcept;

inline constexpr double kPlausibleFactor = 3.0;

/// Checks each setting against its range, against the others and against the stream.
///
/// @returns The first that is wrong, in the order of `SweepSettings`; nulls if there is none.
SettingsError check(const SweepSettings& settings, const hal::StreamFormat& format) noexcept;

/// Sets those limits of a setting that other settings or the stream make.
///
/// @param[in]     index  Of its field in `fields_of(settings)`.
/// @param[in,out] limits Of its range by itself.
void narrow(std::size_t index, const SweepSettings& settings, const hal::StreamFormat& format,
            SettingLimits& limits) noexcept;

/// The settings' limits as the stream takes them. The settings must have passed `check()`.
hal::DriveLimits drive_limits(const SweepSettings& settings,
                              const hal::StreamFormat& format) noexcept;

}  // namespace emax::app
