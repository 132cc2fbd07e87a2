// What all boards with an STM32 have in common: their drivers, and what interrupts lead to.
#pragma once

#include <atomic>
#include <cstdint>

#include "emax/app/instrument/instrument.hpp"
#include "emax/board/cortex_m.hpp"
#include "emax/board/status_led.hpp"
#include "emax/board/stm32_clock.hpp"
#include "emax/board/stm32_clocks.hpp"
#include "emax/board/stm32_stream.hpp"
#include "emax/board/stm32_uart.hpp"
#include "emax/board/stm32_watchdog.hpp"
#include "emax/board/unique_id.hpp"

namespace emax::board {

inline constexpr std::uint32_t kConsoleBaud = 115200;

struct Stm32Drivers {
  Stm32Uart console;
  Stm32Watchdog watchdog;
  Stm32Stream stream;
  Stm32Clock clock = {};
  std::uint32_t ticks = 0;  ///< Tenths of a second.
  std::atomic<bool> is_clock_exact = false;
  UniqueIdText serial = {};
};

/// Of the board.
extern Stm32Drivers drivers;
/// Of the board: lights its LEDs. @param[in] tick As that of `is_led_on()`.
void show(LedState state, std::uint32_t tick) noexcept;

/// The timers of an STM32 that the drivers use have these numbers on all of them.
inline constexpr unsigned kTim2Interrupt = 28;
inline constexpr unsigned kTim7Interrupt = 55;

/// Handlers of interrupts.
void on_console();
void on_output();
void on_clock();
/// Not the watchdog: the crystal has been lost. @returns Whether it was that; the instrument goes
/// on without measuring.
bool take_lost_clock() noexcept;

/// The table of a board whose console and output's DMA have these interrupts.
constexpr VectorTable make_vectors(InterruptHandler non_maskable, unsigned console_interrupt,
                                   unsigned output_interrupt) noexcept {
  VectorTable table = {stack_top, start, non_maskable, {}, {}};
  for (InterruptHandler& handler : table.fault) {
    handler = on_fault;
  }
  for (InterruptHandler& handler : table.interrupt) {
    handler = on_fault;
  }
  table.interrupt[output_interrupt] = on_output;
  table.interrupt[kTim2Interrupt] = on_clock;
  table.interrupt[kTim7Interrupt] = on_watchdog;
  table.interrupt[console_interrupt] = on_console;
  return table;
}

/// @param[in] cause The register that tells what the last reset came of: which bit is the
/// independent watchdog's, and which one forgets.
/// @returns Whether it came of either watchdog; the next call says no.
bool take_watchdog_cause(std::uintptr_t cause, std::uint32_t by_watchdog,
                         std::uint32_t forget) noexcept;

/// Starts the drivers with these clocks: the pins are as they should be.
///
/// @param[in] caused_reset That of the watchdog.
void start_drivers(const Clocks& clocks, bool caused_reset, unsigned console_interrupt,
                   unsigned output_interrupt) noexcept;

/// Sleeps until an interrupt. @returns True if a byte has come.
bool sleep_until_byte() noexcept;

/// What the instrument is told of the board. The pin's amplifier follows from 0.2 V of either end
/// of the supply, and both inputs are sampled at the same moment.
app::SweepSettings bench_of_board() noexcept;

}  // namespace emax::board
