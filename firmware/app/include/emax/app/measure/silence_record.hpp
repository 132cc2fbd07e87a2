// Records what the channels carry while the drive is at zero.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/measure/silent_channel.hpp"
#include "emax/base/span.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/frame_sine_fit.hpp"

namespace emax::app {

/// Records both channels with one sine fit per line of the mains.
///
/// 0.2 s are whole periods of all lines, so they do not disturb each other. 4.4 KiB.
class SilenceRecord {
 public:
  static constexpr double kDuration_s = 0.2;

  void start(const hal::StreamFormat& format) noexcept;
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

  SilentChannel evaluate(const Lines& lines, std::int64_t rise) const noexcept;

  std::array<FrameSineFit, kHumLines> fits_;
  Rise rise_;
  double volts_per_word_ = 0.0;
  std::uint32_t half_ = 0;  // Frames of half a record.
  std::uint32_t frames_ = 0;
};

static_assert(std::is_trivially_copyable_v<SilenceRecord>);

}  // namespace emax::app
