// Channel 1 of an STM32's DAC, which drives the shaker.
#pragma once

#include <cstdint>

#include "emax/hal/word.hpp"

namespace emax::board {

/// What differs from chip to chip.
struct DacSettings {
  std::uintptr_t base;    ///< Of its registers.
  std::uintptr_t timer;   ///< Of the basic timer that triggers it.
  std::uint32_t trigger;  ///< That timer's number in TSEL1.
};

/// The pin is driven through the DAC's own amplifier. Zero volts of drive are half of the supply:
/// while nothing runs, the DAC holds that, and each write goes out at once; while the stream runs,
/// the timer lets the next value out.
class Stm32Dac {
 public:
  constexpr explicit Stm32Dac(const DacSettings& settings) noexcept : settings_(settings) {}

  /// Where DMA puts the next value, as `dac_of_word()` makes it, in words of 32 bits.
  std::uintptr_t data_register() const noexcept;

  /// Puts zero volts of drive onto the pin, which the reset has left to the resistors outside. Once
  /// its clock is on.
  ///
  /// @param[in] mode In MCR beside the channel's mode, which is 0: what its bus's clock asks for.
  void park(std::uint32_t mode) const noexcept;

  /// From now on the timer's triggers let values out, and ask DMA for the next ones.
  void follow_timer() const noexcept;

  /// Asks for no more: after the one that waits, the pin keeps its value. Also for interrupts.
  void hold() const noexcept;

  /// Back to zero volts at once, for a drive that is there.
  void rest() const noexcept;

  /// @returns True if DMA was too slow for it.
  bool has_underrun() const noexcept;

  /// @returns What it puts out now, of which the lowest 20 bits are zero.
  hal::Word word() const noexcept;

  /// As `AnalogStream::do_ramp_to_zero()`: value by value at the timer's triggers, or, should these
  /// fail to come, without them.
  std::uint32_t ramp_to_zero(hal::Word permitted_step) const noexcept;

 private:
  bool wait_for_trigger(std::uint32_t most_looks) const noexcept;

  const DacSettings settings_;
};

}  // namespace emax::board
