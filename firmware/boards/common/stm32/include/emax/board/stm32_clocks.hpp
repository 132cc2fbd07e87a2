// The clock tree of a board's STM32, and what depends on its clock source: of the board.
#pragma once

#include <cstdint>

namespace emax::board {

/// What the drivers need to know of it.
struct Clocks {
  std::uint32_t hz = 0;          ///< Of the timers.
  std::uint32_t console_hz = 0;  ///< Of the console's UART.
  /// From the crystal: its frequency is right to some ppm. Else from the chip's own oscillator,
  /// which is good for a console, and 1 % off for a measurement.
  bool is_exact = false;
};

/// After a reset: full speed from the board's crystal, or, if that does not start, what the
/// internal oscillator gives; all within 0.2 s. The timebase counts microseconds from here on. With
/// the crystal, its loss raises the interrupt that cannot be masked.
Clocks start_clocks() noexcept;

/// In that interrupt. @returns True if the crystal has been lost, and the processor runs at the
/// internal oscillator's frequency. Clears the flag.
bool take_crystal_lost() noexcept;

/// After such a loss: as fast as the internal oscillator can.
Clocks restart_clocks() noexcept;

}  // namespace emax::board
