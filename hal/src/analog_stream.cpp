// The contract of the analog stream, checked once for all boards.
#include "emax/hal/analog_stream.hpp"

#include <limits>

namespace emax::hal {
namespace {

// A double of which both are true is neither an infinity nor not a number.
constexpr bool positive_and_finite(double value) {
  return value > 0.0 && value <= std::numeric_limits<double>::max();
}

constexpr bool usable(const StreamFormat& format) {
  return positive_and_finite(format.sample_rate_hz) &&
         positive_and_finite(format.drive_full_scale_v) &&
         positive_and_finite(format.input_full_scale_v) && format.block_frames >= 1 &&
         format.block_frames <= kMaxBlockFrames;
}

constexpr bool usable(const DriveLimits& limits) {
  return limits.amplitude >= 1 && limits.step_per_frame >= 1 &&
         std::int64_t{limits.step_per_frame} * std::int64_t{kMaxRampFrames} >=
             std::int64_t{limits.amplitude};
}

// |value| <= limit. Differences of words need 33 bits, so they come as 64.
constexpr bool within(std::int64_t value, std::int64_t limit) {
  return value <= limit && value >= -limit;
}

constexpr Status fault_of(Status answer) {
  return answer == Status::kLateBlock || answer == Status::kLostBlock ? answer
                                                                      : Status::kHardwareFault;
}

}  // namespace

Status AnalogStream::start(const DriveLimits& limits) noexcept {
  if (running_) {
    return Status::kAlreadyRunning;
  }
  if (!usable(limits)) {
    return Status::kInvalidArgument;
  }
  if (!usable(format_)) {
    return Status::kHardwareFault;
  }
  if (do_start() != Status::kOk) {
    do_stop();
    return Status::kHardwareFault;
  }
  limits_ = limits;
  next_frame_ = 0;
  last_drive_ = 0;
  running_ = true;
  return Status::kOk;
}

Exchange AnalogStream::exchange(Span<const Word> drive, Span<Frame> response) noexcept {
  if (!running_) {
    return {Status::kNotRunning, next_frame_};
  }
  if (drive.size() != format_.block_frames || response.size() != format_.block_frames) {
    return {Status::kInvalidArgument, next_frame_};
  }
  if (!within_limits(drive)) {
    return fail(Status::kDriveLimit, next_frame_);
  }
  const Exchange answer = do_exchange(drive, response);
  if (answer.status != Status::kOk) {
    return fail(fault_of(answer.status), next_frame_);
  }
  if (answer.first_frame != next_frame_) {
    return fail(Status::kLostBlock, answer.first_frame);
  }
  last_drive_ = drive[drive.size() - 1];
  next_frame_ += format_.block_frames;
  return answer;
}

std::uint32_t AnalogStream::stop() noexcept { return running_ ? halt() : 0; }

bool AnalogStream::within_limits(Span<const Word> drive) const noexcept {
  std::int64_t previous = last_drive_;
  for (const Word word : drive) {
    const std::int64_t next = word;
    if (!within(next, limits_.amplitude) || !within(next - previous, limits_.step_per_frame)) {
      return false;
    }
    previous = next;
  }
  return true;
}

std::uint32_t AnalogStream::halt() noexcept {
  running_ = false;
  const std::uint32_t frames = do_ramp_to_zero(limits_.step_per_frame);
  do_stop();
  return frames;
}

Exchange AnalogStream::fail(Status status, std::uint64_t first_frame) noexcept {
  halt();
  return {status, first_frame};
}

}  // namespace emax::hal
