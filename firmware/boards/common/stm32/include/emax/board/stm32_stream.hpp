// The analog side of an STM32G4 or STM32H7: DAC1 drives, ADC1 and ADC2 listen.
#pragma once

#include <atomic>
#include <cstdint>

#include "emax/board/converter_rings.hpp"
#include "emax/board/stm32_adc_pair.hpp"
#include "emax/board/stm32_dac.hpp"
#include "emax/board/stm32_dma.hpp"
#include "emax/hal/analog_stream.hpp"

namespace emax::board {

inline constexpr std::uint32_t kBlockFrames = 64;
inline constexpr std::uint32_t kBlocksPerRing = 8;
inline constexpr std::uint32_t kRingFrames = kBlocksPerRing * kBlockFrames;

/// What differs from board to board.
struct StreamSettings {
  std::uint32_t frame_us;  ///< From trigger to trigger.
  std::uint32_t timer_hz;  ///< What the timer that triggers counts: whole megahertz.
  AdcPairSettings inputs;
  DmaSettings input_dma;
  DacSettings dac;
  DmaSettings output_dma;
};

/// TIM6 triggers both directions; DMA carries the words in two rings of 8 blocks, 4 KiB. While the
/// program waits for a block it looks at the counts of the DMA. A program that comes too late for
/// the output stops there: an interrupt, twice a turn, sees that what comes next is old, and the
/// drive keeps its value until the program, or the watchdog, leads it to zero. The least pause that
/// this takes for too late is half a turn, 256 frames.
class Stm32Stream final : public hal::AnalogStream {
 public:
  /// The volts are those at the pins, around half of the supply.
  static constexpr double kFullScale_v = 1.65;

  /// @param[in] settings Outlive this object.
  constexpr explicit Stm32Stream(const StreamSettings& settings) noexcept
      : AnalogStream(
            {1e6 / settings.frame_us, kFullScale_v, kFullScale_v, kBlockFrames, kRingFrames + 1}),
        settings_(settings),
        dac_(settings.dac),
        input_dma_(settings.input_dma),
        output_dma_(settings.output_dma),
        inputs_(settings.inputs) {}

  /// Zero volts of drive on the pin, before anything else. The clocks of the peripherals are on.
  ///
  /// @param[in] mode As that of `Stm32Dac::park()`.
  void park(std::uint32_t mode) noexcept { dac_.park(mode); }

  /// As `Stm32AdcPair::use()`.
  void use_inputs(const AdcPairSettings& settings) noexcept { inputs_.use(settings); }

  /// For a self test, while no stream runs: the inputs on, and off again.
  /// @returns As `Stm32AdcPair::prepare()`, or kHardwareFault if they do not stop.
  Status check_inputs() noexcept;

  /// As `Stm32AdcPair::conversion_cycles()`.
  std::uint32_t conversion_cycles() const noexcept { return inputs_.conversion_cycles(); }

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
  bool start_dma() noexcept;
  void start_timer() noexcept;
  std::uint32_t most_wait_us() const noexcept { return 2 * kBlockFrames * settings_.frame_us; }

  const StreamSettings& settings_;
  const Stm32Dac dac_;
  const Stm32Dma input_dma_;
  const Stm32Dma output_dma_;
  Stm32AdcPair inputs_;
  ConverterRings rings_{kRingFrames, kBlockFrames};
  std::uint64_t first_frame_ = 0;    // Of the next block.
  std::uint32_t clock_us_ = 0;       // When the clock had counted
  std::uint32_t clock_frames_ = 0;   // so many frames, modulo 2^32.
  std::uint32_t output_halves_ = 0;  // Of the ring, that DMA has gone through.
  std::atomic<std::uint32_t> output_written_ = 0;
  std::atomic<bool> is_clock_exact_ = false;
  std::atomic<bool> is_starved_ = false;
};

}  // namespace emax::board
