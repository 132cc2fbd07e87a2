// Records what the channels carry while the drive is at zero.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/measure/silent_channel.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/base/span.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/frame_sine_fit.hpp"

namespace emax::app {

/// @returns A fit whose volts are `scale` times as large.
constexpr SineFitResult in_volts(SineFitResult fit, double scale) noexcept {
  fit.cosine_v *= scale;
  fit.sine_v *= scale;
  fit.offset_v *= scale;
  fit.amplitude_v *= scale;
  fit.residual_std_v *= scale;
  return fit;
}

/// Records both channels with one sine fit per line of the mains.
///
/// 0.2 s are whole periods of all lines, so they do not disturb each other. 4.4 KiB.
class SilenceRecord {
 public:
  static constexpr double kDuration_s = 0.2;

  void start(const hal::StreamFormat& format, const FullScales& scales) noexcept;
  /// @returns The frames that the record takes in all.
  std::uint32_t frames() const noexcept { return 2 * half_; }
  void add(Span<const hal::Frame> frames) noexcept;
  SilentChannel reference() const noexcept;
  SilentChannel device() const noexcept;

 private:
  /// Sum of the words of the second half minus that of the first.
  struct Rise {
    std::int64_t reference = 0;
    std::int64_t device = 0;
  };

  using Lines = std::array<SineFitResult, kHumLines>;

  SilentChannel evaluate(const Lines& lines, std::int64_t rise,
                         double volts_per_word) const noexcept;

  std::array<FrameSineFit, kHumLines> fits_;
  Rise rise_;
  double volts_per_word_ = 0.0;  // Of the reference, as all fits.
  double device_scale_ = 0.0;    // Volts of the device's channel per volt of the reference's.
  std::uint32_t half_ = 0;       // Frames of half a record.
  std::uint32_t frames_ = 0;
};

static_assert(std::is_trivially_copyable_v<SilenceRecord>);

}  // namespace emax::app
