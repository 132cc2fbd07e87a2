// What a channel carries while the drive is at zero: offset, noise and hum.
#pragma once

#include <array>
#include <cstddef>

namespace emax::app {

inline constexpr std::size_t kHumLines = 6;
/// Mains of both kinds with their second and third harmonic.
inline constexpr std::array<double, kHumLines> kHum_hz = {50.0, 100.0, 150.0, 60.0, 120.0, 180.0};

/// One channel without drive.
struct SilentChannel {
  double offset_v = 0.0;
  double drift_v = 0.0;                      ///< Mean of the second half minus mean of the first.
  double noise_v = 0.0;                      ///< Standard deviation of a sample, without the hum.
  std::array<double, kHumLines> hum_v = {};  ///< Amplitudes.

  /// @returns The root-mean-square part of the hum that a sine fit at this frequency takes for
  /// signal, over a record of this duration: |sin(x)/x|, x = pi (difference of frequencies)
  /// duration, by its envelope min(1, 1/x). Of the real part and of the imaginary part alike.
  double hum_in_fit_v(double frequency_hz, double duration_s) const noexcept;
};

}  // namespace emax::app
