// The sine approximation of both channels at once, from the converters' words in integers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/base/complex.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax {

/// y = cosine_v cos(wt) + sine_v sin(wt) + offset_v, with t = 0 at the first sample.
struct SineFitResult {
  Status status = Status::kTooFewPoints;
  double cosine_v = 0.0;
  double sine_v = 0.0;
  double offset_v = 0.0;
  double amplitude_v = 0.0;     ///< sqrt(cosine^2 + sine^2).
  double phase_rad = 0.0;       ///< Sine reference: y = amplitude sin(wt + phase) + offset.
  double residual_std_v = 0.0;  ///< Of a sample: sqrt(sum of squares/(samples - 3)).
  std::uint64_t samples = 0;

  /// @returns P of y = Re(P e^(jwt)) + offset. The ratio of two channels' P is a complex response.
  constexpr Complex phasor() const noexcept { return {cosine_v, -sine_v}; }
};

/// Fits y = A cos(wt) + B sin(wt) + C by least squares (ISO 16063-21; IEEE 1057) to both channels
/// of a record, in one pass, without storing samples. The result does not depend on how the frames
/// are cut into blocks, bit for bit.
///
/// A frame is a struct with the members `reference` and `device`, each a signed word of 32 bits.
///
/// Cosine and sine of 64 frames stand in a table of integers, and the sums of their products with
/// the words are exact in 64 bits: a dozen instructions per frame and channel, also where `double`
/// is software. Each 64 frames the sums are turned to the phase of the whole record, in `double`.
/// The equations hold the sums of the table as it is, so its rounding (2^-29) does not look like a
/// residual. Coefficients are good to 1e-8 of the largest word, the residual down to 1e-7 of it;
/// words are taken to 28 bits. 720 bytes.
///
/// A record of N samples with white noise of standard deviation s has u(A) = u(B) = s sqrt(2/N), so
/// u(amplitude) = s sqrt(2/N) and u(phase) = s sqrt(2/N)/amplitude.
class FrameSineFit {
 public:
  /// Starts a new fit. Costs about 400 operations with `double`.
  ///
  /// @param[in] frequency_hz   0 < frequency < sample_rate / 2.
  /// @param[in] sample_rate_hz Greater than 0, of frames.
  /// @param[in] volts_per_word Greater than 0, of both channels.
  /// @returns
  /// * kOk: Ready for `add()`.
  /// * kInvalidArgument: A rate outside its range, or not a number. The running fit is kept.
  Status start(double frequency_hz, double sample_rate_hz, double volts_per_word) noexcept;

  /// Starts a new fit of the same frequency.
  void restart() noexcept;

  /// Takes the next frames, in the order of time. Ignored before a `start()`.
  template <typename Frame>
  void add(Span<const Frame> frames) noexcept {
    static_assert(std::is_same_v<decltype(Frame::reference), std::int32_t> &&
                  std::is_same_v<decltype(Frame::device), std::int32_t>);
    if (!(sample_rate_hz_ > 0.0) || frames.empty()) {
      return;
    }
    if (frames_ == 0) {
      reference_.base = frames[0].reference / kWordUnit;
      device_.base = frames[0].device / kWordUnit;
    }
    while (!frames.empty()) {
      const std::size_t at = frames_ % kTableFrames;
      const std::size_t room = kTableFrames - at;
      const std::size_t count = frames.size() < room ? frames.size() : room;
      add_block<&Frame::reference>(frames.first(count), at, reference_);
      add_block<&Frame::device>(frames.first(count), at, device_);
      frames_ += count;
      if (count == room) {
        end_table();
      }
      frames = frames.from(count);
    }
  }

  /// @returns The fit of one channel to all frames since the start, with t = 0 at the first of
  /// them. `add()` may go on after it. The status is
  /// * kOk
  /// * kTooFewPoints: Below one period, or fewer than 4 frames. The other values are zero.
  /// * kNotIdentifiable: The frames do not determine the sine (next to half the sample rate). The
  ///   other values are zero.
  SineFitResult reference() const noexcept { return result(reference_); }
  SineFitResult device() const noexcept { return result(device_); }

 private:
  static constexpr std::size_t kTableFrames = 64;
  // 64 products of a word less another one, 28 bits then, and of the table's keep within 63 bits.
  static constexpr std::int32_t kWordUnit = 16;

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

  template <auto kWord, typename Frame>
  void add_block(Span<const Frame> frames, std::size_t at, Channel& channel) const noexcept {
    BlockSums sums = channel.block;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const std::int32_t word = frames[i].*kWord / kWordUnit - channel.base;
      sums.word += word;
      sums.word_cosine += std::int64_t{word} * cosine_[at + i];
      sums.word_sine += std::int64_t{word} * sine_[at + i];
      sums.word2 += std::int64_t{word} * word;
    }
    channel.block = sums;
  }

  void end_table() noexcept;
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

}  // namespace emax
