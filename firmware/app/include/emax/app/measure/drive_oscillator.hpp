// The drive: one sine of continuous phase whose amplitude only changes along smooth ramps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/span.hpp"
#include "emax/hal/analog_stream.hpp"

namespace emax::app {

/// Makes the words of the drive, frame by frame, within the limits of amplitude and slope.
///
/// The phase never jumps: a new frequency begins where the old one is. Amplitudes change along
/// a^2 (3 - 2a), flat at both ends, over at least 256 frames and one period. On the way to another
/// frequency the amplitude is brought down first where the new one is smaller, so that a frequency
/// never sees more than was permitted for it. Nine tenths of the slope are for the sine, the rest
/// is for the ramp.
class DriveOscillator {
 public:
  /// Silent, at this rate and within these limits.
  void configure(const hal::StreamFormat& format, double limit_v, double slew_v_per_s) noexcept;

  /// @returns The largest amplitude at this frequency that the limits permit, in V.
  double max_amplitude_v(double frequency_hz) const noexcept;

  /// Moves to this frequency and amplitude, from the next frame on.
  ///
  /// @param[in] amplitude_v 0 to `max_amplitude_v(frequency_hz)`.
  /// @param[in] rise_s      That the amplitude takes at least to rise, at another frequency from a
  ///                        sixteenth of the smaller one of both amplitudes; 0: as it comes.
  /// @returns The number of frames until it is there.
  std::uint32_t go_to(double frequency_hz, double amplitude_v, double rise_s = 0.0) noexcept;

  /// Fills the next block. Two multiplications per frame, six on a ramp.
  void fill(Span<hal::Word> block) noexcept;

  /// @returns The amplitude that it moves to, in V.
  double amplitude_v() const noexcept { return target_v_; }

  /// @returns The amplitude of the last frame, in V.
  double present_v() const noexcept;

  /// @returns That over the one that it moves to; 0 before the frequency is reached.
  double risen_share() const noexcept {
    return frequency_hz_ == next_frequency_hz_ ? present_v() / target_v_ : 0.0;
  }

 private:
  struct Ramp {
    double to_v = 0.0;
    std::uint32_t frames = 0;
  };

  std::uint32_t ramp_frames(double change_v, double rise_s) const noexcept;
  void emit(Span<hal::Word> block) noexcept;
  void set_frequency(double frequency_hz) noexcept;
  void end_ramp() noexcept;

  double sample_rate_hz_ = 0.0;
  double full_scale_v_ = 0.0;
  double limit_v_ = 0.0;
  double step_v_ = 0.0;
  double frequency_hz_ = 0.0;
  double step_cosine_ = 0.0;
  double step_sine_ = 0.0;
  double start_turns_ = 0.0;  // Phase at the frame from which frames_ counts.
  std::uint64_t frames_ = 0;
  double from_v_ = 0.0;  // Amplitude at the start of the ramp that runs; else what it is.
  double target_v_ = 0.0;
  double next_frequency_hz_ = 0.0;
  Ramp down_;  // At the old frequency, then
  Ramp up_;    // at the new one.
  std::uint32_t ramp_frame_ = 0;
};

static_assert(std::is_trivially_copyable_v<DriveOscillator>);

}  // namespace emax::app
