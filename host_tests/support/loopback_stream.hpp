// Converters in memory whose output is wired to both inputs, and a stream that uses them well.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "emax/hal/analog_stream.hpp"

#include "hal/stream_conformance.hpp"

namespace emax::test {

inline constexpr hal::StreamFormat kLoopbackFormat = {100000.0, 10.0, 10.0, 64, 37};
inline constexpr unsigned kLoopbackInputBits = 16;

/// A DAC of full width, a line that delays by whole frames, and two ADCs of 16 bits, in virtual
/// time. One fault strikes once, at the frame that it was made with.
class Loopback {
 public:
  /// Latencies are up to this.
  static constexpr std::uint32_t kMaxLatency = 255;

  constexpr Loopback(std::uint32_t latency_frames, double sample_rate_hz, StreamFault fault,
                     std::uint64_t at_frame) noexcept
      : latency_frames_(latency_frames),
        sample_rate_hz_(sample_rate_hz),
        fault_(fault),
        at_frame_(at_frame) {}

  const DriveProbe& drive() const { return drive_; }
  double now_s() const { return static_cast<double>(time_frames_) / sample_rate_hz_; }
  void set_latency(std::uint32_t frames) { latency_frames_ = frames; }

  /// @returns kHardwareFault if the power is on already, also after a start that failed.
  Status power_on() {
    if (on_) {
      return Status::kHardwareFault;
    }
    on_ = true;
    if (strikes(StreamFault::kStartFault, at_frame_ + 1)) {
      return Status::kHardwareFault;
    }
    line_.fill(0);
    index_ = 0;
    return Status::kOk;
  }

  void power_off() { on_ = false; }

  hal::Exchange transfer(Span<const hal::Word> drive, Span<hal::Frame> response) {
    if (strikes(StreamFault::kHardwareFault, drive.size())) {
      return {Status::kHardwareFault, index_};
    }
    if (strikes(StreamFault::kLateBlock, drive.size())) {
      wait(2 * drive.size());
      return {Status::kLateBlock, index_};
    }
    if (strikes(StreamFault::kLostBlock, drive.size())) {
      for (std::size_t i = 0; i < drive.size(); ++i) {
        (void)tick(drive_.last);
      }
    }
    const std::uint64_t first = index_;
    for (std::size_t i = 0; i < drive.size(); ++i) {
      response[i] = tick(drive[i]);
    }
    return {Status::kOk, first};
  }

  /// Gives up after many frames, should the step be 0.
  std::uint32_t ramp_to_zero(hal::Word step) {
    constexpr std::uint32_t kMany = 4096;
    std::uint32_t frames = 0;
    for (std::int64_t word = drive_.last; word != 0 && frames < kMany; ++frames) {
      const std::int64_t most = std::max(std::int64_t{step}, std::int64_t{0});
      word -= std::clamp(word, -most, most);
      put(static_cast<hal::Word>(word));
    }
    return frames;
  }

  /// One word through the DAC, in one frame's time.
  void put(hal::Word word) {
    const std::int64_t amplitude = std::abs(std::int64_t{word});
    const std::int64_t step = std::abs(std::int64_t{word} - std::int64_t{drive_.last});
    drive_.max_amplitude = std::max(drive_.max_amplitude, static_cast<std::uint32_t>(amplitude));
    drive_.max_step = std::max(drive_.max_step, static_cast<std::uint32_t>(step));
    drive_.frames_since_nonzero = word == 0 ? drive_.frames_since_nonzero + 1 : 0;
    drive_.last = word;
    ++drive_.frames;
    wait(1);
  }

  /// One word through the DAC, and what comes in meanwhile.
  hal::Frame tick(hal::Word word) {
    put(word);
    const auto slot = [this](std::uint64_t index) {
      return static_cast<std::size_t>(index % line_.size());
    };
    line_[slot(index_)] = word;
    const hal::Word delayed = index_ < latency_frames_ ? 0 : line_[slot(index_ - latency_frames_)];
    ++index_;
    const std::int64_t unused = std::int64_t{1} << (32U - kLoopbackInputBits);
    const std::int64_t converted = delayed - ((delayed % unused) + unused) % unused;
    return {static_cast<hal::Word>(converted), static_cast<hal::Word>(converted)};
  }

  void wait(std::uint64_t frames) { time_frames_ += frames; }

 private:
  /// Whether this fault happens within the next frames; then it never does again.
  bool strikes(StreamFault fault, std::uint64_t frames) {
    if (fault_ != fault || drive_.frames + frames <= at_frame_) {
      return false;
    }
    fault_ = StreamFault::kNone;
    return true;
  }

  std::uint32_t latency_frames_;
  double sample_rate_hz_;
  StreamFault fault_;
  std::uint64_t at_frame_;
  DriveProbe drive_;
  std::array<hal::Word, kMaxLatency + 1> line_ = {};
  std::uint64_t index_ = 0;
  std::uint64_t time_frames_ = 0;
  bool on_ = false;
};

/// The plainest stream that keeps the contract: the response is the drive, `latency_frames` later,
/// rounded down to 16 bits.
class LoopbackStream final : public hal::AnalogStream {
 public:
  constexpr explicit LoopbackStream(const hal::StreamFormat& format = kLoopbackFormat,
                                    StreamFault fault = StreamFault::kNone,
                                    std::uint64_t at_frame = 0) noexcept
      : AnalogStream(format),
        loopback_(format.latency_frames, format.sample_rate_hz, fault, at_frame) {}

  LoopbackStream& stream() { return *this; }
  DriveProbe drive() const { return loopback_.drive(); }
  double now_s() const { return loopback_.now_s(); }

 private:
  Status do_start() noexcept override { return loopback_.power_on(); }
  hal::Exchange do_exchange(Span<const hal::Word> drive,
                            Span<hal::Frame> response) noexcept override {
    return loopback_.transfer(drive, response);
  }
  std::uint32_t do_ramp_to_zero(hal::Word step_per_frame) noexcept override {
    return loopback_.ramp_to_zero(step_per_frame);
  }
  void do_stop() noexcept override { loopback_.power_off(); }
  bool do_drive_is_at_zero() const noexcept override { return loopback_.drive().last == 0; }

  Loopback loopback_;
};

}  // namespace emax::test
