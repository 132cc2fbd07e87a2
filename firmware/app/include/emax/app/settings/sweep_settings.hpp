// What the bench is told before a sweep, with the defaults of the simulated bench.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/settings/settings_error.hpp"
#include "emax/base/capacity.hpp"
#include "emax/hal/analog_stream.hpp"

namespace emax::app {

inline constexpr std::size_t kMaxReferencePoints = 32;
inline constexpr std::size_t kMaxRepeats = 16;
/// The largest frequency is the sample rate over this.
inline constexpr double kMinSamplesPerPeriod = 2.5;

/// The reference sensor's calibration: one value, or a table over frequency with straight lines
/// between its points and the first and last value beyond them.
struct ReferenceCalibration {
  std::array<double, kMaxReferencePoints> frequency_hz = {};  ///< Ascending; unused if count is 1.
  std::array<double, kMaxReferencePoints> sensitivity = {0.1};  ///< S_r in V/(m/s^2).
  std::size_t count = 1;
  double expanded_percent = 0.5;  ///< Expanded uncertainty (k = 2), common to all frequencies.
};

/// @returns S_r at this frequency in V/(m/s^2).
double sensitivity_at(const ReferenceCalibration& calibration, double frequency_hz) noexcept;

/// Selects a constructor that sets every number to zero.
struct AllZero {};
inline constexpr AllZero kAllZero = {};

/// `SweepSettings{}` is the default job: the 42 frequencies of the paper's Table 1.
struct SweepSettings {
  std::array<double, kMaxPoints> frequency_hz;  ///< Ascending.
  std::size_t frequency_count;
  double level_mps2 = 1.0;     ///< Peak acceleration to reach.
  double limit_mps2 = 20.0;    ///< Peak acceleration never to exceed.
  double drive_limit_v = 5.0;  ///< Peak drive never to exceed.
  double slew_v_per_s = 1e5;   ///< Of the drive.
  double settle_s = 0.01;      ///< After each ramp; three periods at least.
  std::uint32_t cycles = 3;    ///< Least number of whole periods per repeat.
  double repeat_s = 0.01;      ///< Least duration of a repeat.
  std::uint32_t repeats = 5;   ///< 2 to kMaxRepeats.
  ReferenceCalibration reference;
  double reference_gain = 10.0;            ///< Conditioner of the reference.
  double device_gain = 1.0;                ///< Conditioner of the device under test.
  double gain_expanded_percent = 0.1;      ///< Ratio of the two gains, k = 2.
  double mounting_expanded_percent = 0.2;  ///< Mounting, transverse motion, temperature; k = 2.
  double skew_s = 1.25e-6;  ///< The device's channel samples later than the reference's.
  double check_hz = 160.0;  ///< Measured before and after the sweep.
  /// What the device's data sheet says, V/(m/s^2), within a factor of kPlausibleFactor; 0 if it
  /// says nothing, and then channels that are swapped are told by their phase only.
  double expected_sensitivity = 1.02;

  SweepSettings() noexcept;
  /// No settings yet, every number zero: for objects that are to lie in .bss. `check()` refuses it.
  constexpr explicit SweepSettings(AllZero) noexcept
      : frequency_hz{},
        frequency_count(0),
        level_mps2(0.0),
        limit_mps2(0.0),
        drive_limit_v(0.0),
        slew_v_per_s(0.0),
        settle_s(0.0),
        cycles(0),
        repeat_s(0.0),
        repeats(0),
        reference{{}, {}, 0, 0.0},
        reference_gain(0.0),
        device_gain(0.0),
        gain_expanded_percent(0.0),
        mounting_expanded_percent(0.0),
        skew_s(0.0),
        check_hz(0.0),
        expected_sensitivity(0.0) {}
};

inline constexpr double kPlausibleFactor = 3.0;

static_assert(std::is_trivially_copyable_v<SweepSettings>);

/// Checks each setting against its range, against the others and against the stream.
///
/// @returns The first that is wrong, in the order of `SweepSettings`; nulls if there is none.
SettingsError check(const SweepSettings& settings, const hal::StreamFormat& format) noexcept;

/// The settings' limits as the stream takes them. The settings must have passed `check()`.
hal::DriveLimits drive_limits(const SweepSettings& settings,
                              const hal::StreamFormat& format) noexcept;

}  // namespace emax::app
