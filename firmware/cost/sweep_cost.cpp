// A short sweep, of which only the instrument's own work is counted.
#include <algorithm>
#include <array>

#include "emax/app/measure/sweep.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/board/instruction_counter.hpp"
#include "emax/hal/analog_stream.hpp"

#include "memory.hpp"
#include "rows.hpp"

namespace emax::cost {
namespace {

constexpr std::array<double, 3> kFrequencies_hz = {1000.0, 1500.0, 2000.0};
constexpr hal::StreamFormat kFormat = {100000.0, 10.0, 10.0, hal::kMaxBlockFrames, 0};

/// Hands the drive back on both channels, a quarter of it and with a little noise, and counts what
/// that takes.
class EchoStream final : public hal::AnalogStream {
 public:
  EchoStream() noexcept : hal::AnalogStream(kFormat) {}

  Ticks own_ticks() const noexcept { return own_ticks_; }

 private:
  static constexpr hal::Word kAttenuation = 4;
  static constexpr std::uint32_t kFactor = 1664525;  // A generator of Numerical Recipes.
  static constexpr std::uint32_t kIncrement = 1013904223;
  static constexpr unsigned kNoiseShift = 12;

  Status do_start() noexcept override {
    next_frame_ = 0;
    last_ = 0;
    return Status::kOk;
  }

  hal::Exchange do_exchange(Span<const hal::Word> drive,
                            Span<hal::Frame> response) noexcept override {
    own_ticks_ += ticks_of([&] {
      for (std::size_t i = 0; i < drive.size(); ++i) {
        response[i].reference = drive[i] / kAttenuation + noise();
        response[i].device = drive[i] / kAttenuation + noise();
      }
    });
    const std::uint64_t first = next_frame_;
    next_frame_ += drive.size();
    last_ = drive[drive.size() - 1];
    return {Status::kOk, first};
  }

  std::uint32_t do_ramp_to_zero(hal::Word step_per_frame) noexcept override {
    const hal::Word distance = last_ < 0 ? -last_ : last_;
    last_ = 0;
    return static_cast<std::uint32_t>((distance + step_per_frame - 1) / step_per_frame);
  }

  void do_stop() noexcept override {}

  bool do_drive_is_at_zero() const noexcept override { return last_ == 0; }

  hal::Word noise() noexcept {
    state_ = kFactor * state_ + kIncrement;
    return static_cast<hal::Word>(state_ >> kNoiseShift);
  }

  Ticks own_ticks_ = 0;
  std::uint64_t next_frame_ = 0;
  std::uint32_t state_ = 1;
  hal::Word last_ = 0;
};

}  // namespace

Status count_sweep(Rows& rows) noexcept {
  Sweeps& work = memory().sweeps.make();
  app::SweepSettings settings = app::default_sweep_settings();
  std::copy(kFrequencies_hz.begin(), kFrequencies_hz.end(), settings.frequency_hz.begin());
  settings.frequency_count = kFrequencies_hz.size();
  settings.check_hz = kFrequencies_hz.front();
  EchoStream stream;
  app::Sweep sweep(work.results, work.workspace, stream);
  const Status status = sweep.start(settings);
  if (status != Status::kOk) {
    return status;
  }
  Ticks ticks = 0;
  while (!sweep.done()) {
    ticks += ticks_of([&] { sweep.step(); });
  }
  const std::uint64_t frames = work.results.blocks * kFormat.block_frames;
  rows.add("sweep_frame", instructions_of((ticks - stream.own_ticks()) / frames));
  return work.results.status;
}

}  // namespace emax::cost
