// Where the blocks of a stream are in the two rings that the converters' DMA goes round in.
#pragma once

#include <cstdint>

namespace emax::board {

/// What the hardware tells at a moment.
struct RingLook {
  std::uint32_t clock_frames = 0;  ///< Frames since the start by the clock, modulo 2^32.
  std::uint32_t input_left = 0;    ///< What the DMA of the inputs counts down from the ring's size.
  std::uint32_t output_left = 0;   ///< Likewise of the output.
};

enum class RingState : std::uint8_t {
  kWaiting,        ///< The next block has not come in yet.
  kHere,           ///< It has, and its place in the output's ring is free.
  kLost,           ///< Frames are missing, or the program was too late for them.
  kOutputStopped,  ///< The output does not go with the inputs.
};

/// Accounts for blocks in two rings of the same size. The hardware counts frames modulo that size;
/// the clock, which runs from the same oscillator, tells the turns, and so a gap of the inputs
/// shows however long it is.
///
/// Frame n of the inputs is the n-th trigger since the timer was started. The drive that is handed
/// over for a block takes the place of the one that has just gone out, and goes out one turn later:
/// the response to frame n of the drive is frame n + ring + 1 of the inputs. The 1 is the register
/// in which the DAC holds its next value. A DAC whose DMA has fetched its first value before the
/// first trigger is one frame ahead, and its blocks lie one place further.
class ConverterRings {
 public:
  /// @param[in] ring_frames A power of two, four blocks or more.
  constexpr ConverterRings(std::uint32_t ring_frames, std::uint32_t block_frames) noexcept
      : ring_frames_(ring_frames), block_frames_(block_frames) {}

  /// Before the first trigger.
  ///
  /// @param[in] is_output_ahead The DAC has the first value from DMA.
  /// @param[in] fetched What the DMA has counted without the DAC: 1 if it fetches ahead of
  /// requests.
  void start(bool is_output_ahead, std::uint32_t fetched = 0) noexcept;

  /// Until the first block, which is dropped, has come in; to be called before half a ring has.
  /// @returns kHere once it has, and both directions have gone with the clock; from then on
  /// `look()`.
  RingState settle(const RingLook& look) noexcept;

  RingState look(const RingLook& look) noexcept;

  /// Places of the next block: `block_frames` of them, each modulo the ring.
  std::uint32_t input_place(std::uint32_t i) const noexcept { return (next_ + i) & mask(); }
  std::uint32_t output_place(std::uint32_t i) const noexcept {
    return (next_ + ahead_ + i) & mask();
  }

  /// After the block was taken and the drive's put in its place.
  /// @returns False if that took so long that the hardware has gone over it.
  bool finish(const RingLook& look) noexcept;

  /// Values of the output, counted since the start, that are those of a block in time: behind this
  /// number the ring has old ones.
  std::uint32_t output_written() const noexcept { return next_ + ahead_ + ring_frames_; }

 private:
  std::uint32_t mask() const noexcept { return ring_frames_ - 1; }
  std::uint32_t nearest(std::uint32_t left, std::uint32_t expected) const noexcept;
  bool is_too_late(std::uint32_t input) const noexcept;

  const std::uint32_t ring_frames_;
  const std::uint32_t block_frames_;
  std::uint32_t ahead_ = 0;
  std::uint32_t fetched_ = 0;
  std::uint32_t next_ = 0;         // The block's first frame.
  std::uint32_t input_ = 0;        // Frames that had come in at the last look.
  std::uint32_t input_lag_ = 0;    // Of the inputs behind the clock.
  std::uint32_t output_lead_ = 0;  // Of the output before the inputs.
};

}  // namespace emax::board
