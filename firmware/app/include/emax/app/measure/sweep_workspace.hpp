// The memory that a sweep works in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/measure/channel_monitor.hpp"
#include "emax/app/measure/drive_oscillator.hpp"
#include "emax/app/measure/silence_record.hpp"
#include "emax/app/measure/sweep_budget.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/complex.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/frame_sine_fit.hpp"

namespace emax::app {

/// What a sweep needs only while it runs: 13 KiB that the caller lends it.
///
/// What it holds before a start and after the end does not matter, so it may share its memory with
/// other work that never runs at the same time.
class SweepWorkspace {
 private:
  friend class Sweep;

  /// Of the drive, beyond what the frequency before predicts, without a second look.
  static constexpr double kPermittedStep = 1.5;

  enum class Activity : std::uint8_t { kRest, kSilence, kSettling, kMeasuring, kRampingDown };

  /// One frequency while it is measured.
  struct Target {
    double frequency_hz = 0.0;
    double acceleration_mps2 = 0.0;
    std::uint32_t repeat_frames = 0;
    std::uint32_t tries = 0;
    // The most drive that the frequency before lets expect; more is refused until it is confirmed.
    double permitted_v = 0.0;
    double unconfirmed_v = 0.0;  // V/(m/s^2) of the first look that asked for more.
    double periods = 0.0;        // To settle, at least;
    double ringing_s = 0.0;      // for the device's own frequency;
    double settle_scale = 1.0;   // the time to settle times this.
    // At the first look that was clear: volts per volt of drive, and over the device's.
    double reference_v_per_v = 0.0;
    double by_device = 0.0;
    std::uint32_t looks = 0;  // Again, at what was suspect.
    bool was_overrange = false;
    bool exceeds_by_few_steps = false;  // Of the drive, the limit of acceleration.
    bool is_close = false;              // The level of this frequency has been seen.
  };

  void begin(const hal::StreamFormat& format, const FullScales& scales) noexcept;
  SineFitResult device_fit() const noexcept {
    return in_volts(fit_.device(), scales_.device_v / scales_.reference_v);
  }

  hal::StreamFormat format_;  // The drive's full scale is that outside the front end.
  FullScales scales_;
  DriveOscillator drive_;
  ChannelMonitor reference_monitor_;
  ChannelMonitor device_monitor_;
  Target target_;
  Complex last_ratio_;                   // Of the frequency before, or the check's.
  double last_hz_ = 0.0;                 // Its frequency.
  double drive_per_acceleration_ = 0.0;  // V/(m/s^2); 0 until known.
  double least_level_mps2_ = 0.0;        // Of few steps of the drive; 0 until known.
  double level_scale_ = 0.0;             // 1; overrange halves it.
  double level_room_mps2_ = 0.0;         // What takes a channel to full scale.
  double exchanged_share_ = 0.0;         // Of the limit that the reference may read; 1 if certain.
  double device_v_per_v_ = 0.0;          // Device's volts per volt of drive, of the one before.
  double first_reference_offset_v_ = 0.0;
  double first_device_offset_v_ = 0.0;
  double reference_rest2_ = 0.0;  // Sums of the squares of the repeats' residuals.
  double device_rest2_ = 0.0;
  std::uint32_t left_ = 0;         // Frames until this activity ends.
  std::uint32_t settle_left_ = 0;  // When this few frames are left, the ramp has passed.
  Activity activity_ = Activity::kSilence;
  bool block_is_spent_ = false;  // A new drive was ordered: the rest of the block is of no use.
  bool is_lowering_ = false;
  FrameSineFit fit_;
  Repeats repeats_;
  SilenceRecord silence_;
  PointScatter check_scatter_;
  std::array<PointScatter, kMaxPoints> scatter_ = {};
  std::array<hal::Word, hal::kMaxBlockFrames> words_ = {};
  std::array<hal::Frame, hal::kMaxBlockFrames> frames_ = {};
};

static_assert(std::is_trivially_copyable_v<SweepWorkspace>);
static_assert(!kHasDefaultCapacities || sizeof(SweepWorkspace) <= 13 * 1024);

}  // namespace emax::app
