// The sine approximation of both channels at once, from the converters' words in integers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/elementary.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/sine_fit.hpp"

namespace emax::app {

/// What `SineFit` does for samples in volts, for both channels of a stream: y = A cos(wt) +
/// B sin(wt) + C by least squares (ISO 16063-21; IEEE 1057), in one pass, without storing samples.
/// The result does not depend on how the frames are cut into blocks, bit for bit.
///
/// Cosine and sine of 64 frames stand in a table of integers, and the sums of their products with
/// the words are exact in 64 bits: a dozen instructions per frame and channel, also where `double`
/// is software. Each 64 frames the sums are turned to the phase of the whole record, in `double`.
/// The equations hold the sums of the table as it is, so its rounding (2^-29) does not look like a
/// residual. Coefficients are good to 1e-8 of the largest word, the residual down to 1e-7 of it;
/// words are taken to 28 bits. 720 bytes.
class FrameSineFit {
 public:
  /// Starts a new fit, for about 400 operations with `double`.
  ///
  /// @param[in] frequency_hz 0 < frequency < sample rate / 2.
  /// @param[in] format       Of the stream that the frames come from.
  /// @returns
  /// * kOk: Ready for `add()`.
  /// * kInvalidArgument: A frequency outside its range, or not a number. The running fit is kept.
  Status start(double frequency_hz, const hal::StreamFormat& format) noexcept;

  /// Starts a new fit of the same frequency.
  void restart() noexcept;

  /// Takes the next frames, in the order of time. Ignored before a `start()`.
  void add(Span<const hal::Frame> frames) noexcept;

  /// @returns The fit of one channel over all frames since the start, with time from the first of
  /// them on; `add()` may go on after it. The status is that of `SineFit::result()`.
  SineFitResult reference() const noexcept { return result(reference_); }
  SineFitResult device() const noexcept { return result(device_); }

 private:
  static constexpr std::size_t kTableFrames = 64;

  /// Sums of the frames since the table was last begun, in units of a word of 28 bits and of the
  /// table's.
  struct BlockSums {
    std::int64_t word = 0;
    std::int64_t word_cosine = 0;
    std::int64_t word_sine = 0;
    std::int64_t word2 = 0;
  };

  struct Channel {
    BlockSums block;
    double word = 0.0;  // Of the blocks before.
    double word_cosine = 0.0;
    double word_sine = 0.0;
    double word2 = 0.0;
    std::int32_t base = 0;  // The first word; sums are taken about it.

    void end_block(const SinCos& start) noexcept;
  };

  /// Of cosine and sine alone, over the frames of the blocks before.
  struct BasisSums {
    double cosine = 0.0;
    double sine = 0.0;
    double cosine2 = 0.0;
    double cosine_sine = 0.0;
    double sine2 = 0.0;
  };

  template <hal::Word hal::Frame::*kWord>
  void add_block(Span<const hal::Frame> frames, std::size_t at, Channel& channel) const noexcept;
  SinCos phase_of_frame(std::uint64_t frame) const noexcept;
  BasisSums basis_with(std::size_t frames, const SinCos& start) const noexcept;
  SineFitResult result(const Channel& channel) const noexcept;
  SineFitResult solve(const Channel& channel, const BasisSums& basis) const noexcept;

  double frequency_hz_ = 0.0;
  double sample_rate_hz_ = 0.0;  // 0 before a start.
  double unit_v_ = 0.0;          // Of a word of 28 bits.
  std::array<std::int32_t, kTableFrames> cosine_ = {};
  std::array<std::int32_t, kTableFrames> sine_ = {};
  Channel reference_;
  Channel device_;
  BasisSums basis_;
  std::uint64_t frames_ = 0;
};

static_assert(std::is_trivially_copyable_v<FrameSineFit>);
static_assert(sizeof(FrameSineFit) <= 736);

}  // namespace emax::app
