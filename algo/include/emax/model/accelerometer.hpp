// The accelerometer as a second-order system: transfer function and frequency response.
#pragma once

#include "emax/base/status.hpp"
#include "emax/model/mode.hpp"

namespace emax {

/// K(s) = S w0^2 / (s^2 + 2 beta w0 s + w0^2), paper equation (1).
struct Accelerometer {
  double sensitivity = 0.0;           ///< S in V/(m/s^2).
  double natural_frequency_hz = 0.0;  ///< f0, undamped.
  double damping = 0.0;               ///< beta, without unit.
};

inline constexpr double kMinDamping = 1e-4;
inline constexpr double kMinFrequency_hz = 1e-3;
inline constexpr double kMaxFrequency_hz = 1e9;

/// @returns
/// * kOk: Sensitivity finite and above 0, frequency 1 mHz to 1 GHz, damping 1e-4 to below 1.
/// * kOverdamped: Damping of 1 or more. Such a device has two real poles and no resonance; the
///   identification and the grid, which is laid out by the resonance, do not apply to it.
/// * kInvalidArgument: Any other value outside its range, or not a number.
Status validate(const Accelerometer& device) noexcept;

/// @returns |K(j 2 pi f)| in V/(m/s^2), paper equation (22).
double amplitude(const Accelerometer& device, double frequency_hz) noexcept;

/// @returns The phase of K(j 2 pi f) in radians, from 0 down to -pi, paper equation (23) with the
///   angle continued past f0, where the printed arctan would jump by 180 degrees.
double phase_rad(const Accelerometer& device, double frequency_hz) noexcept;

/// @returns The impulse response of K as one mode. The device must be valid.
Mode mode_of(const Accelerometer& device) noexcept;

}  // namespace emax
