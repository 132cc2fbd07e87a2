// The parts of a Cortex-M processor that every board with one uses.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/board/registers.hpp"

namespace emax::board {

using InterruptHandler = void (*)();

/// Interrupts that a vector table has room for: those of the board.
inline constexpr std::size_t kInterrupts = EMAX_BOARD_INTERRUPTS;

/// What the processor reads at address 0. The board defines it, in the section .start.
struct VectorTable {
  std::uint32_t* stack;
  InterruptHandler start;
  InterruptHandler non_maskable;
  InterruptHandler fault[13];  ///< HardFault to SysTick; this instrument uses none of them.
  InterruptHandler interrupt[kInterrupts];
};

/// The register of the table's address holds no lower bits than these (Armv7-M Architecture
/// Reference Manual, B1.5.3): the next power of two, 128 at least.
constexpr std::size_t vector_table_alignment(std::size_t bytes) noexcept {
  std::size_t alignment = 128;
  while (alignment < bytes) {
    alignment *= 2;
  }
  return alignment;
}
inline constexpr std::size_t kVectorTableAlignment = vector_table_alignment(sizeof(VectorTable));

extern "C" {

alignas(kVectorTableAlignment) extern const VectorTable vectors;
extern std::uint32_t stack_top[];

/// Where the processor starts: switches the floating point unit on, before anything could use it,
/// and then goes to `run_program()`.
void start();

/// For all vectors without a handler: a fault, or an interrupt that nobody expects. Changes to a
/// stack of its own, as the other one may be what has failed, reports the fault and stops.
void on_fault();

/// For the watchdog's interrupt: the same, but the end is a reset that `take_watchdog_reset()` will
/// tell of.
void on_watchdog();
}

/// Lets an interrupt through, sets when it may interrupt others, and makes one pending by software.
inline void enable_interrupt(unsigned number) noexcept {
  reg(0xE000E100 + 4 * (number / 32)) = 1U << (number % 32);
}
/// @param[in] priority In its highest bits, as many as the chip has; 0, as after a reset, comes
/// first.
inline void set_interrupt_priority(unsigned number, std::uint8_t priority) noexcept {
  reg<std::uint8_t>(0xE000E400 + number) = priority;
}
inline void trigger_interrupt(unsigned number) noexcept {
  reg(0xE000E200 + 4 * (number / 32)) = 1U << (number % 32);
}

/// Adds a region of the memory protection unit, once it is on.
///
/// @param[in] number     2 or more: 0 and 1 guard stack and code. A higher one wins.
/// @param[in] attributes As the unit's register has them, with the size, and without its enable.
void set_memory_region(std::uint32_t number, std::uintptr_t base,
                       std::uint32_t attributes) noexcept;

}  // namespace emax::board
