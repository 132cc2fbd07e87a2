// The analog side of a NUCLEO-G474RE: DAC1 drives, ADC1 and ADC2 listen.
#pragma once

#include <atomic>
#include <cstdint>

#include "emax/board/converter_rings.hpp"
#include "emax/board/g474_adc_pair.hpp"
#include "emax/board/stm32_dac.hpp"
#include "emax/hal/analog_stream.hpp"

namespace emax::board {

inline constexpr std::uint32_t kBlockFrames = 64;
inline constexpr std::uint32_t kBlocksPerRing = 8;
inline constexpr std::uint32_t kRingFrames = kBlocksPerRing * kBlockFrames;
inline constexpr std::uint32_t kFrame_us = 20;

/// The volts are those at the pins, around half of the supply.
inline constexpr hal::StreamFormat kG474Format = {1e6 / kFrame_us, 1.65, 1.65, kBlockFrames,
                                                  kRingFrames + 1};

/// TIM6 triggers both directions; DMA carries the words in two rings of 8 blocks, 4 KiB. While the
/// program waits for a block it looks at the counts of the DMA. A program that comes too late for
/// the output stops there: an interrupt, twice a turn, sees that what comes next is old, and the
/// drive keeps its value until the program, or the watchdog, leads it to zero. The least pause that
/// this takes for too late is half a turn, 5.1 ms.
class G474Stream final : public hal::AnalogStream {
 public:
  constexpr G474Stream() noexcept : AnalogStream(kG474Format) {}

  /// Zero volts of drive on the pin, before anything else. The clocks of the peripherals are on.
  ///
  /// @param[in] clock_hz Of the bus: 170 MHz, or 80 MHz at most.
  void park(std::uint32_t clock_hz) noexcept;

  /// @param[in] is_exact Whether the clock is the crystal's; without it, `start()` fails.
  void set_clock_exact(bool is_exact) noexcept { is_clock_exact_ = is_exact; }

  /// For the interrupt that cannot be masked: the clock is the crystal's no longer. The drive keeps
  /// its value, and the exchange under way, or the next one, is a fault.
  void lose_clock() noexcept;

  /// For the interrupt of the output's DMA, at each half of the ring.
  void on_output_interrupt() noexcept;

  /// For faults and the watchdog: leads the drive to zero whatever runs. @returns Whether it is.
  bool force_to_zero() noexcept;

 private:
  Status do_start() noexcept override;
  hal::Exchange do_exchange(Span<const hal::Word> drive,
                            Span<hal::Frame> response) noexcept override;
  std::uint32_t do_ramp_to_zero(hal::Word step_per_frame) noexcept override;
  void do_stop() noexcept override;
  bool do_drive_is_at_zero() const noexcept override;

  bool settle() noexcept;
  Status wait_for_block() noexcept;
  Status fault() const noexcept;
  RingLook look() noexcept;
  void stop_output() noexcept;

  ConverterRings rings_{kRingFrames, kBlockFrames};
  G474AdcPair inputs_;
  std::uint64_t first_frame_ = 0;    // Of the next block.
  std::uint32_t clock_us_ = 0;       // When the clock had counted
  std::uint32_t clock_frames_ = 0;   // so many frames, modulo 2^32.
  std::uint32_t output_halves_ = 0;  // Of the ring, that DMA has gone through.
  std::atomic<std::uint32_t> output_written_ = 0;
  std::atomic<bool> is_clock_exact_ = false;
  std::atomic<bool> is_starved_ = false;
};

}  // namespace emax::board
