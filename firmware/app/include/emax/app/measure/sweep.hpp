// The back-to-back calibration: stepped sine over the frequencies, levelled, fitted, budgeted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/measure/channel_monitor.hpp"
#include "emax/app/measure/drive_oscillator.hpp"
#include "emax/app/measure/silence_record.hpp"
#include "emax/app/measure/sweep_budget.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/complex.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/frame_sine_fit.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// One measured point with what was seen on the way.
struct SweepPoint {
  ResponsePoint point;  ///< Without the common part in its uncertainties.
  PointBudget budget;
  double acceleration_mps2 = 0.0;  ///< Peak.
  double drive_v = 0.0;            ///< Peak.
  double residual_percent = 0.0;   ///< What the sine leaves over, of the amplitude, worse channel.
  bool flagged = false;            ///< Residual, distortion or scatter beyond its limit.
  bool scatters = false;           ///< Flagged for its scatter.
};

enum class SweepStage : std::uint8_t {
  kIdle,
  kSilence,      ///< Offsets, noise and hum, with the drive at zero.
  kCheckBefore,  ///< The check frequency.
  kPoints,
  kCheckAfter,
  kDone,
  kFailed,
};

/// What a sweep needs only while it runs: 13 KiB that the caller lends it.
///
/// What it holds before a start and after the end does not matter, so it may share its memory with
/// other work that never runs at the same time.
class SweepWorkspace {
 private:
  friend class Sweep;

  enum class Activity : std::uint8_t { kSilence, kSettling, kMeasuring, kRampingDown };

  /// One frequency while it is measured.
  struct Target {
    double frequency_hz = 0.0;
    double acceleration_mps2 = 0.0;
    std::uint32_t repeat_frames = 0;
    std::uint32_t tries = 0;
    bool was_suspect = false;
    bool was_overrange = false;
    bool is_close = false;  // The level of this frequency has been seen.
  };

  void begin(const hal::StreamFormat& format) noexcept;

  hal::StreamFormat format_;
  DriveOscillator drive_;
  ChannelMonitor reference_monitor_;
  ChannelMonitor device_monitor_;
  SilenceRecord silence_;
  FrameSineFit fit_;
  Target target_;
  Repeats repeats_;
  std::array<PointScatter, kMaxPoints> scatter_ = {};
  std::array<hal::Word, hal::kMaxBlockFrames> words_ = {};
  std::array<hal::Frame, hal::kMaxBlockFrames> frames_ = {};
  Complex last_ratio_;                   // Of the frequency before; zero if there was none.
  double drive_per_acceleration_ = 0.0;  // V/(m/s^2); 0 until known.
  double level_scale_ = 0.0;             // 1; overrange halves it.
  double first_reference_offset_v_ = 0.0;
  double first_device_offset_v_ = 0.0;
  double reference_rest2_ = 0.0;  // Sums of the squares of the repeats' residuals.
  double device_rest2_ = 0.0;
  std::uint32_t left_ = 0;         // Frames until this activity ends.
  std::uint32_t settle_left_ = 0;  // When this few frames are left, the ramp has passed.
  Activity activity_ = Activity::kSilence;
  bool block_is_spent_ = false;  // A new drive was ordered: the rest of the block is of no use.
  bool is_lowering_ = false;
};

static_assert(std::is_trivially_copyable_v<SweepWorkspace>);
static_assert(!kHasDefaultCapacities || sizeof(SweepWorkspace) <= 13 * 1024);

/// Runs the calibration block by block; nothing ever waits longer than one block.
///
///     sweep.start(settings, stream, workspace);
///     while (!sweep.done()) {
///       sweep.step(stream, workspace);
///     }
///
/// At each frequency the drive moves to the amplitude that the last one needed per acceleration,
/// rests, and takes repeats of whole periods, each with a fit on both channels. The first repeat
/// also tells the level: where it is off, the drive is corrected by the ratio and the frequency
/// begins anew. Overrange halves the drive and with it the level, for this frequency and, doubling
/// again, for those after it.
///
/// Results take at most 11 KiB and the workspace 13, whatever the number of samples, and no
/// call takes longer for a longer record. From its start to its end a sweep needs the same stream
/// and the same workspace, which nobody else may write meanwhile.
/// Every end, good or bad, leaves the drive at zero: a normal one along a ramp, a fault along the
/// permitted slope within 256 frames.
class Sweep {
 public:
  /// Starts the stream and the sweep. Results of before are lost if it answers kOk.
  ///
  /// @returns
  /// * kOk: `step()` until `done()`.
  /// * kInvalidArgument: A setting that is refused: `refused_setting()` names it. Nothing else has
  ///   changed.
  /// * kAlreadyRunning: A sweep runs. Nothing has changed.
  /// * Else what the stream answered. Nothing has changed.
  Status start(const SweepSettings& settings, hal::AnalogStream& stream,
               SweepWorkspace& work) noexcept;

  /// Exchanges one block; nothing unless a sweep runs.
  void step(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;

  /// Ends the sweep at once: the drive is led to zero; what was measured stays. Status kStopped.
  /// Nothing unless a sweep runs.
  void stop(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;

  /// @returns True unless a sweep runs.
  bool done() const noexcept {
    return stage_ == SweepStage::kIdle || stage_ == SweepStage::kDone ||
           stage_ == SweepStage::kFailed;
  }
  SweepStage stage() const noexcept { return stage_; }
  /// @returns 0 to 1, by the number of frequencies.
  double progress() const noexcept;

  /// @returns kOk while the sweep runs and after a good end; else why it failed:
  /// * kLostBlock, kLateBlock, kHardwareFault, kNotRunning: The stream.
  /// * kSaturated: A channel at full scale at a sixteenth of the level, or without drive, or a
  ///   ratio that is far off after the drive was lowered.
  /// * kStuckChannel: The same word for a whole period of the drive.
  /// * kNoReference, kNoDevice: One channel at the level of noise while the other has a signal.
  /// * kWeakSignal: Both, at the largest permitted drive.
  /// * kLevelNotReached: The level needs more drive than amplitude and slope permit.
  /// * kSwappedChannels: A ratio as of exchanged channels, or far from the expected one.
  /// * kInvertedPolarity: A phase half a turn off.
  /// * kDistorted: What the sine leaves over, or the differences between repeats, beyond 10 %.
  /// * kDcDrift: An offset that wanders.
  /// * kStopped: `stop()`.
  /// What disturbs a repeat is looked at twice: the frequency is measured again, once.
  Status status() const noexcept { return status_; }
  /// @returns Name of the setting that the last `start()` refused, and what it must be; null if
  /// none.
  const char* refused_setting() const noexcept { return refused_.setting; }
  const char* refused_expectation() const noexcept { return refused_.expectation; }
  /// @returns The frequency at which it failed, in Hz; 0 in the silence or if it has not.
  double failed_frequency_hz() const noexcept { return failed_frequency_hz_; }

  /// The points measured so far; their uncertainties are there when `done()`.
  Span<const SweepPoint> points() const noexcept {
    return Span<const SweepPoint>(points_).first(point_count_);
  }
  /// Complete when `done()`; without drift unless both checks were measured.
  const CommonBudget& common() const noexcept { return common_; }
  /// The ratio at the check frequency in V/(m/s^2), before and after the points; 0 if not measured.
  Complex check_before() const noexcept { return check_before_; }
  Complex check_after() const noexcept { return check_after_; }
  /// The pooled noise of the channels, when `done()`.
  const ChannelNoise& noise() const noexcept { return noise_; }
  const SilentChannel& silent_reference() const noexcept { return inputs_.silent_reference; }
  const SilentChannel& silent_device() const noexcept { return inputs_.silent_device; }
  const SweepSettings& settings() const noexcept { return settings_; }
  /// Blocks that this sweep has exchanged.
  std::uint64_t blocks() const noexcept { return blocks_; }

  /// Puts the points with their common part into a table for the fit, in place of what it held.
  ///
  /// @returns kOk, or kNotRunning if no sweep is done: the table is then empty.
  Status copy_to(FrequencyResponse& response) const noexcept;

 private:
  /// By how much an offset may move within the silence or within a frequency, of full scale.
  static constexpr double kWanderShare = 0.002;
  /// What noise hardly ever exceeds, in standard deviations.
  static constexpr double kNoisePeak = 6.0;

  using Activity = SweepWorkspace::Activity;
  using Target = SweepWorkspace::Target;

  /// What one repeat's fit says of one channel.
  struct Reading {
    SineFitResult fit;
    double weak_v = 0.0;  // Below this it may be noise.
    bool is_weak() const noexcept { return !(fit.amplitude_v > weak_v); }
    bool is_strong() const noexcept { return fit.amplitude_v > 10.0 * weak_v; }
  };

  void reset() noexcept;
  void take_frames(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  void watch(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  double reference_peak_v(const SweepWorkspace& work) const noexcept;
  void lower_level(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  static void consume(std::size_t from, std::size_t count, SweepWorkspace& work) noexcept;
  void end_activity(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  void end_silence(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  void begin_target(double frequency_hz, SweepWorkspace& work) noexcept;
  void drive_to(double amplitude_v, SweepWorkspace& work) noexcept;
  static void begin_repeat(SweepWorkspace& work) noexcept;
  void end_repeat(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  static Reading reading_of(const SineFitResult& fit, const SilentChannel& silent,
                            const SweepWorkspace& work) noexcept;
  void judge_first(const Reading& reference, const Reading& device, hal::AnalogStream& stream,
                   SweepWorkspace& work) noexcept;
  void raise_drive(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  double offset_change_v(double reference_v, double device_v,
                         const SweepWorkspace& work) const noexcept;
  Status disturbance_of(const Reading& reference, const Reading& device,
                        const SweepWorkspace& work) const noexcept;
  void suspect(Status status, hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  void end_target(hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  Status plausibility_of(Complex ratio, const SweepWorkspace& work) const noexcept;
  void store_point(const PointScatter& scatter, Complex ratio, SweepWorkspace& work) noexcept;
  void begin_next(SweepWorkspace& work) noexcept;
  void fail(Status status, hal::AnalogStream& stream, SweepWorkspace& work) noexcept;
  void finish(SweepWorkspace& work) noexcept;
  double acceleration_of(double reference_v, const SweepWorkspace& work) const noexcept;
  double aim_mps2(const SweepWorkspace& work) const noexcept;
  double ratio_factor(const SweepWorkspace& work) const noexcept;
  Complex ratio_of(const PointScatter& scatter, const SweepWorkspace& work) const noexcept;

  SweepSettings settings_;
  BudgetInputs inputs_;
  std::array<SweepPoint, kMaxPoints> points_ = {};
  CommonBudget common_;
  ChannelNoise noise_;
  SettingsError refused_;
  Complex check_before_;
  Complex check_after_;
  double failed_frequency_hz_ = 0.0;
  std::uint64_t blocks_ = 0;
  std::size_t point_count_ = 0;
  SweepStage stage_ = SweepStage::kIdle;
  Status status_ = Status::kOk;
};

static_assert(std::is_trivially_copyable_v<Sweep>);
static_assert(!kHasDefaultCapacities || sizeof(Sweep) <= 11 * 1024);
static_assert(!kHasDefaultCapacities || sizeof(Sweep) + sizeof(FrequencyResponse) <= 16 * 1024);

}  // namespace emax::app
