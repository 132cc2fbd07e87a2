// What the channels carry while the drive is at zero: offset, noise and hum.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/sine_fit.hpp"
#include "emax/span.hpp"

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

/// Records both channels with one sine fit per line of the mains.
///
/// 0.2 s are whole periods of all lines, so they do not disturb each other. 1.9 KiB.
class SilenceRecord {
 public:
  static constexpr double kDuration_s = 0.2;

  void start(double sample_rate_hz) noexcept;
  /// @returns The frames that the record takes in all.
  std::uint32_t frames() const noexcept { return 2 * half_; }
  void add(Span<const double> reference_v, Span<const double> device_v) noexcept;
  SilentChannel reference() const noexcept { return evaluate(reference_); }
  SilentChannel device() const noexcept { return evaluate(device_); }

 private:
  using Fits = std::array<SineFit, kHumLines>;

  struct Channel {
    Fits fits;
    double first_sum_v = 0.0;  // Of the two halves.
    double second_sum_v = 0.0;
  };

  void add(Channel& channel, Span<const double> samples_v) const noexcept;
  SilentChannel evaluate(const Channel& record) const noexcept;

  Channel reference_;
  Channel device_;
  std::uint32_t half_ = 0;  // Frames of half a record.
  std::uint32_t frames_ = 0;
};

static_assert(std::is_trivially_copyable_v<SilenceRecord>);

}  // namespace emax::app
