// Measures the front end by a wire that feeds the drive to both inputs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/measure/drive_oscillator.hpp"
#include "emax/app/measure/silence_record.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/frame_sine_fit.hpp"

namespace emax::app {

/// What a loopback finds. Volts are outside the front end, as the full scales state them.
struct LoopbackResults {
  double latency_frames = 0.0;  ///< From the drive to the reference's channel.
  double reference_offset_v = 0.0;
  double device_offset_v = 0.0;
  double reference_gain = 0.0;  ///< Volts that come in over volts that go out.
  double device_gain = 0.0;
  double ratio = 0.0;          ///< Device's channel over reference's, mean over frequency.
  double ratio_percent = 0.0;  ///< Its expanded uncertainty: of one frequency, not of the mean.
  double skew_s = 0.0;         ///< The device's channel samples later than the reference's.
  double skew_expanded_s = 0.0;
  double reference_noise_v = 0.0;  ///< Standard deviation of a sample.
  double device_noise_v = 0.0;
  double distortion_percent = 0.0;  ///< What the sine leaves over beyond noise, of the amplitude.
  std::uint32_t lost_blocks = 0;    ///< On the way; the rest is of a run without.
};

/// Measures both channels without drive, looks with a hundredth of the drive limit whether there is
/// a wire at all, and then measures at five frequencies from the rate over 512 to the rate over 32,
/// with half of what drive limit and inputs permit. 1.5 s at 100 kS/s.
///
/// The ratio's uncertainty is 2.87 times the standard deviation of the five (Student's t for four
/// degrees of freedom, 95.45 %), and so is that of the skew with what the straight line of the
/// phases leaves over. Where a block is lost, it is counted and all begins anew, eight times at
/// most. 7.5 KiB, all zero before use.
class LoopbackRun {
 public:
  /// @param[in] settings Checked; of them the limits and full scales.
  /// @returns kOk: `step()` until `done()`. Else what the stream says.
  Status start(hal::AnalogStream& stream, const SweepSettings& settings) noexcept;
  /// One block.
  void step(hal::AnalogStream& stream) noexcept;
  /// Ends it with the drive at zero.
  void stop(hal::AnalogStream& stream) noexcept;

  bool done() const noexcept { return stage_ == Stage::kDone; }
  /// @returns kOk, the fault of the stream (kLostBlock if blocks were lost again and again),
  /// kNoReference: nothing like the drive comes in at one of the inputs, or kDistorted: the ratio
  /// differs by more than 2 % between the frequencies, or the phases are no skew.
  Status status() const noexcept { return status_; }
  double progress() const noexcept;
  /// When `done()`, with kOk.
  const LoopbackResults& results() const noexcept { return results_; }

 private:
  enum class Stage : std::uint8_t { kSilence, kSettling, kMeasuring, kDone };

  static constexpr std::size_t kFrequencies = 5;

  Status begin(hal::AnalogStream& stream, const hal::DriveLimits& limits) noexcept;
  void count_lost(hal::AnalogStream& stream, std::uint64_t first_frame) noexcept;
  void take(Span<const hal::Frame> drive, Span<const hal::Frame> response) noexcept;
  void end_stage() noexcept;
  void end_silence() noexcept;
  void begin_target() noexcept;
  void end_target() noexcept;
  Status check_wire(const SineFitResult& drive, const SineFitResult& reference,
                    const SineFitResult& device) noexcept;
  Status evaluate() noexcept;
  void end(Status status) noexcept;

  hal::StreamFormat format_;
  FullScales scales_;
  DriveOscillator drive_;
  SilenceRecord silence_;
  FrameSineFit response_fit_;
  FrameSineFit drive_fit_;  // Of the drive's words, in both channels.
  LoopbackResults results_;
  // Sums over the frequencies, which are 1, 2, 4, 8 and 16 in units of the first.
  double ratios_ = 0.0;  // Less 1.
  double ratios2_ = 0.0;
  double phases2_ = 0.0;
  double phases_by_frequency_ = 0.0;
  std::array<hal::Word, hal::kMaxBlockFrames> words_ = {};
  std::array<hal::Frame, hal::kMaxBlockFrames> sent_ = {};  // The words in both channels.
  std::array<hal::Frame, hal::kMaxBlockFrames> response_ = {};
  double drive_limit_v_ = 0.0;
  double slew_v_per_s_ = 0.0;
  double amplitude_v_ = 0.0;
  double frequency_hz_ = 0.0;
  std::uint64_t frames_ = 0;  // Since the stream was started.
  std::uint32_t restarts_ = 0;
  std::uint32_t left_ = 0;    // Frames until this stage ends.
  std::uint32_t target_ = 0;  // 0 is the look for the wire.
  Stage stage_ = Stage::kSilence;
  Status status_ = Status::kOk;
};

static_assert(std::is_trivially_copyable_v<LoopbackRun>);

}  // namespace emax::app
