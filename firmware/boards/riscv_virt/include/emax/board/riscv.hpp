// The parts of a RISC-V core in machine mode that a board uses.
#pragma once

namespace emax::board {

/// Lets the interrupts of the external controller through, to `on_external_interrupt()`.
void enable_external_interrupts() noexcept;

/// Of the board: serves what the external controller has.
void on_external_interrupt() noexcept;

}  // namespace emax::board
