// The clock tree of an STM32G474, and what depends on its clock source.
#pragma once

#include <cstdint>

namespace emax::board {

/// What the processor, its buses and their timers run at.
struct Clocks {
  std::uint32_t hz = 0;
  /// From the crystal: its frequency is right to some ppm. Else from the chip's own oscillator,
  /// which is good for a console, and 1 % off for a measurement.
  bool is_exact = false;
};

/// After a reset: 170 MHz from the crystal of 24 MHz, or, if that does not start, from the internal
/// oscillator of 16 MHz, or those 16 MHz as they are; all within 0.2 s. The timebase counts
/// microseconds from here on. With the crystal, its loss raises the interrupt that cannot be
/// masked.
Clocks start_clocks() noexcept;

/// In that interrupt. @returns True if the crystal has been lost, and the processor runs at
/// 16 MHz. Clears the flag.
bool take_crystal_lost() noexcept;

/// After such a loss: 170 MHz from the internal oscillator, if it can be.
Clocks restart_clocks() noexcept;

/// Switches on the clocks of all peripherals that the board uses.
void start_peripheral_clocks() noexcept;

}  // namespace emax::board
