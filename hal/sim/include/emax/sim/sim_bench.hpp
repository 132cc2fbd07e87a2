// A test bench as a stream of words: the bench in volts behind converters with latency.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/sim/volt_bench.hpp"

namespace emax::sim {

/// 100 kS/s, +-10 V both ways, blocks of 64, 37 frames of latency.
inline constexpr hal::StreamFormat kBenchFormat = {100000.0, 10.0, 10.0, 64, 37};
inline constexpr std::uint32_t kMaxLatencyFrames = 127;
inline constexpr unsigned kDacBits = 12;
inline constexpr unsigned kAdcBits = 16;

/// What has gone out through the DAC since `configure()`.
struct DacRecord {
  hal::Word last = 0;
  std::uint32_t max_amplitude = 0;  ///< Greatest |word|.
  std::uint32_t max_step = 0;       ///< Greatest |change| from one frame to the next.
  std::uint64_t frames = 0;
  std::uint64_t frames_since_nonzero = 0;  ///< Frames of zero up to now.
};

/// An honest bench, the same to the last bit on every target.
///
/// Drive words -> latency -> 12-bit DAC (which drops the other bits) -> front end -> `VoltBench` ->
/// front end -> 16-bit ADCs.
/// While the stream has been started once only, the frame of a fault is also the index of the
/// first response frame that is wrong; a lost or late block is the one that contains it.
///
/// `loop_back()` puts a wire from the DAC to both ADCs: the drive as an ideal reconstruction filter
/// makes it, at the device's input seen later by the skew, with offset, noise, hum and faults of
/// the conditioners as before. It needs a latency of two frames.
///
/// Time is virtual: the clock counts frames and moves only when the stream does. While nothing is
/// exchanged, the bench stands still.
///
/// 2.5 KiB, no heap, no pointers; `configure()` takes 1.5 KiB of stack. One frame costs about 60 ns
/// on a PC.
class SimBench final : public hal::AnalogStream {
 public:
  /// A bench without parts: `start()` answers kHardwareFault until `configure()` has been called.
  ///
  /// @param[in] format Blocks of 1 to kMaxBlockFrames, latency up to kMaxLatencyFrames, rate and
  ///                   full scales above 0; `configure()` checks.
  constexpr explicit SimBench(const hal::StreamFormat& format = kBenchFormat) noexcept
      : hal::AnalogStream(format) {}

  /// Builds the bench anew: draws its truth, at rest, clock and record at zero.
  ///
  /// @returns
  /// * kOk: Ready for `start()`.
  /// * kInvalidArgument: What `VoltBench` refuses, or a format outside its ranges. Nothing has
  ///   changed.
  /// * kAlreadyRunning: Nothing has changed.
  Status configure(const BenchSettings& settings) noexcept;

  const BenchSettings& settings() const noexcept { return bench_.settings(); }
  const BenchTruth& truth() const noexcept { return bench_.truth(); }
  const DacRecord& dac() const noexcept { return dac_; }

  /// Largest |acceleration| of the shaker since `configure()`.
  double peak_mps2() const noexcept { return bench_.peak_mps2(); }
  /// Frames since `configure()`.
  std::uint64_t clock_frames() const noexcept { return bench_.clock_frames(); }
  double now_s() const noexcept;

 private:
  Status do_start() noexcept override;
  hal::Exchange do_exchange(Span<const hal::Word> drive,
                            Span<hal::Frame> response) noexcept override;
  std::uint32_t do_ramp_to_zero(hal::Word step_per_frame) noexcept override;
  void do_stop() noexcept override;
  bool do_drive_is_at_zero() const noexcept override { return dac_.last == 0; }
  bool do_loop_back(bool is_on) noexcept override {
    is_looped_ = is_on;
    return true;
  }

  /// From volts outside the front end to words.
  struct Converter {
    double reference_codes_per_v = 0.0;
    double device_codes_per_v = 0.0;
    double half_scale = 0.0;  ///< Codes go from -half_scale to half_scale - 1.
    std::int64_t words_per_code = 1;
  };

  hal::Frame advance(hal::Word word) noexcept;
  hal::Word word_at(std::uint64_t frame) const noexcept;
  std::int64_t code_at(std::uint64_t frame) const noexcept;
  double later_v(std::uint64_t frame) const noexcept;
  void record(hal::Word word) noexcept;
  bool event_due(FaultKind kind) noexcept;
  double drive_v(hal::Word word) const noexcept;
  hal::Word digitised(double code) const noexcept;

  VoltBench bench_ = {};
  DacRecord dac_ = {};
  Converter adc_ = {};
  double drive_full_scale_v_ = 0.0;  ///< Outside the front end.
  std::uint64_t started_at_ = 0;
  std::array<hal::Word, kMaxLatencyFrames + 1> pipeline_ = {};  ///< Drive on its way.
  hal::Word last_device_ = 0;
  bool configured_ = false;
  std::array<bool, 2> event_over_ = {};  ///< The lost or late block has been, of each fault.
  bool stuck_ = false;
  bool is_looped_ = false;  // A wire feeds the drive to both inputs.
};

static_assert(sizeof(SimBench) <= 2560);

}  // namespace emax::sim
