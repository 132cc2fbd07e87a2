// The analog side of a board: one drive output and two inputs that run from one clock, block by
// block.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/word.hpp"

namespace emax::hal {

/// The most frames that a block may have.
inline constexpr std::size_t kMaxBlockFrames = 64;
/// After a fault the drive is at zero within this many frames.
inline constexpr std::size_t kMaxRampFrames = 256;

/// What a stream is built for. Constant for the life of the object.
struct StreamFormat {
  double sample_rate_hz = 0.0;      ///< Of drive and inputs alike; greater than 0.
  double drive_full_scale_v = 0.0;  ///< Volts at the DAC for a word of 2^31.
  double input_full_scale_v = 0.0;  ///< Volts at each ADC for a word of 2^31.
  std::uint32_t block_frames = 0;   ///< Frames per block, 1 to kMaxBlockFrames.
  /// The response to the drive's frame n comes in as frame n + latency: converters, filters in
  /// hardware and buffers. The same for every frame, after every start. It is the latency of the
  /// reference channel; the skew, by which the device's input samples later, is not part of it.
  std::uint32_t latency_frames = 0;
};

/// What the drive may do at most, as words. Checked by `exchange()` on every frame.
struct DriveLimits {
  Word amplitude = 0;       ///< |drive| of any frame; 1 to 2^31 - 1.
  Word step_per_frame = 0;  ///< |change| from one frame to the next; at least amplitude/256.
};

/// Both inputs at one frame.
struct Frame {
  Word reference = 0;
  Word device = 0;
};

/// One exchange. The index counts frames since `start()`, so a gap shows.
struct Exchange {
  Status status = Status::kNotRunning;
  /// kOk: index of the first frame that came in. kLostBlock: the index that came instead of the one
  /// expected. Otherwise the index that the next frame has, or would have had.
  std::uint64_t first_frame = 0;
};

/// A duplex stream: each exchange hands over one block of drive and takes one block of response.
///
/// The public functions check the contract once, for all boards, and call the private `do_...`
/// functions of the board. They keep the drive safe: it starts at zero, every frame is checked
/// against the limits, and after a fault the drive ramps to zero along the permitted slope, within
/// kMaxRampFrames frames. Between `stop()` (or a fault) and the first word of the next run, the
/// drive is zero.
///
/// For one caller: no two of its functions at the same time. Cost: four comparisons per frame
/// beside what the board does.
class AnalogStream {
 public:
  AnalogStream(const AnalogStream&) = delete;
  AnalogStream& operator=(const AnalogStream&) = delete;

  const StreamFormat& format() const noexcept { return format_; }
  const DriveLimits& limits() const noexcept { return limits_; }

  /// Starts both directions, with the drive at zero and frame index 0. The conditions are checked
  /// in the order of this list.
  ///
  /// @returns
  /// * kOk: `exchange()` from now on, one after the other without a pause longer than a block.
  /// * kAlreadyRunning: Nothing has changed.
  /// * kInvalidArgument: Limits outside their ranges, or a slope that needs more than
  ///   kMaxRampFrames frames from the amplitude to zero. Nothing has changed.
  /// * kHardwareFault: The board did not start, or states a format outside its ranges. The drive is
  ///   at zero, nothing runs, and the limits are those of before.
  Status start(const DriveLimits& limits) noexcept;

  /// Hands over the next block of drive and waits for the next block of response: at most two
  /// block times, then kLateBlock. The conditions are checked in the order of this list.
  ///
  /// @param[in]  drive    `block_frames` words within the limits, the first one measured against
  ///                      the last one of the block before, or against zero after `start()`.
  /// @param[out] response `block_frames` frames. Untouched by kNotRunning, kInvalidArgument and
  ///                      kDriveLimit; not to be used after the other faults.
  /// @returns
  /// * kNotRunning: Before `start()`, or after `stop()` or a fault. Nothing has changed.
  /// * kInvalidArgument: A wrong number of frames. Nothing has changed; the stream runs on.
  /// * kDriveLimit: A word beyond amplitude or slope. Nothing of the block goes out. The drive
  /// ramps
  ///   to zero from the last word that went out, and the stream stops.
  /// * kLateBlock: Nothing came in time. Stopped as above, even if the inputs are dead.
  /// * kLostBlock: The frame index has a gap: frames were lost. Stopped as above.
  /// * kHardwareFault: The board reports a fault. Stopped as above.
  /// * kOk: `response` is filled. Its first frame follows the last one of the block before.
  Exchange exchange(Span<const Word> drive, Span<Frame> response) noexcept;

  /// Ramps the drive to zero along the slope and stops. Safe at any time, more than once. Takes at
  /// most kMaxRampFrames frames, the latency and two block times; so does the end after a fault.
  ///
  /// @returns The number of frames from the last word that went out to the first zero: 0 if the
  ///          drive was at zero or nothing ran.
  std::uint32_t stop() noexcept;

  bool running() const noexcept { return running_; }

  /// Feeds the drive to both inputs in place of what is connected to them, or no longer.
  ///
  /// @returns False if there is no switch for it, or while something runs: nothing has changed. A
  ///          wire from the drive to both inputs does the same.
  bool loop_back(bool is_on) noexcept { return !running_ && do_loop_back(is_on); }

  /// @returns True if nothing runs and the DAC puts out zero. The board answers from its converter,
  ///          so a drive that did not get to zero shows. Also for fault handlers: changes nothing.
  bool drive_is_at_zero() const noexcept { return !running_ && do_drive_is_at_zero(); }

 protected:
  constexpr explicit AnalogStream(const StreamFormat& format) noexcept : format_(format) {}
  ~AnalogStream() = default;

 private:
  /// Starts the converters with the drive at zero and their count of frames at 0. Only called while
  /// stopped.
  /// @returns kOk or kHardwareFault; `do_stop()` follows the latter.
  virtual Status do_start() noexcept = 0;

  /// Exchanges one block that has been checked, waiting for two block times at most.
  /// @returns kOk with the index that the hardware counts; kLateBlock, kHardwareFault, or
  ///          kLostBlock where it knows of lost frames by itself. `do_ramp_to_zero()` and
  ///          `do_stop()` follow these, and any other answer counts as kHardwareFault.
  virtual Exchange do_exchange(Span<const Word> drive, Span<Frame> response) noexcept = 0;

  /// Puts out one frame after the other, from the last word that went out towards zero by at most
  /// `step_per_frame`, without waiting for a response, and leaves the drive at zero; words that
  /// wait in a buffer are dropped. Needs no more than kMaxRampFrames frames, even if the inputs are
  /// dead.
  /// @returns The number of frames that it took, 0 if the drive is at zero.
  virtual std::uint32_t do_ramp_to_zero(Word step_per_frame) noexcept = 0;

  /// Stops the converters, also after a start that failed halfway. The drive is already at zero and
  /// stays there.
  virtual void do_stop() noexcept = 0;

  /// @returns True if the word that the DAC holds is 0: read back from it where it can be, else the
  ///          last word that went out. Does not wait.
  virtual bool do_drive_is_at_zero() const noexcept = 0;

  /// Only called while stopped, for boards that have a switch.
  virtual bool do_loop_back(bool /*is_on*/) noexcept { return false; }

  bool within_limits(Span<const Word> drive) const noexcept;
  std::uint32_t halt() noexcept;
  Exchange fail(Status status, std::uint64_t first_frame) noexcept;

  const StreamFormat format_;
  DriveLimits limits_ = {};
  std::uint64_t next_frame_ = 0;
  Word last_drive_ = 0;
  bool running_ = false;
};

}  // namespace emax::hal
