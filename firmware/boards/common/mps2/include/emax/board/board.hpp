// Arm's MPS2 board, as its application notes AN386 (Cortex-M4F) and AN500 (Cortex-M7) make it.
#pragma once

#include <cstdint>

#include "emax/base/status.hpp"
#include "emax/board/cmsdk_clock.hpp"
#include "emax/board/cmsdk_uart.hpp"
#include "emax/board/cmsdk_watchdog.hpp"
#include "emax/board/ram_store.hpp"
#include "emax/sim/sim_bench.hpp"

namespace emax::board {

inline constexpr std::uint32_t kClock_hz = 25'000'000;
inline constexpr std::uint32_t kBaud = 115200;
inline constexpr std::uint32_t kWatchdogPeriod_us = 10'000'000;

inline constexpr std::uintptr_t kTimer1 = 0x40001000;
inline constexpr std::uintptr_t kUart0 = 0x40004000;
inline constexpr std::uintptr_t kWatchdog = 0x40008000;
inline constexpr unsigned kUart0ReceiveInterrupt = 0;
inline constexpr unsigned kUart0TransmitInterrupt = 1;
inline constexpr unsigned kTimer1Interrupt = 9;

static_assert(kClock_hz % 1'000'000 == 0);
inline constexpr std::uint32_t kCyclesPer_us = kClock_hz / 1'000'000;
// UART0 rounds its divider down; it must stay within 1 % of the rate.
static_assert(kClock_hz / kBaud * kBaud > kClock_hz / 100 * 99);
static_assert(kWatchdogPeriod_us <= 0xFFFFFFFF / kCyclesPer_us);

/// What the instrument gets of the board. Timer 0 is free, for measurements.
class Board final {
 public:
  constexpr Board() noexcept;

  /// Starts clock and console and builds the simulated bench. Once, first of all.
  ///
  /// @returns What `SimBench::configure()` answers.
  Status start() noexcept;

  CmsdkUart& console() noexcept { return console_; }
  CmsdkClock& clock() noexcept { return clock_; }
  CmsdkWatchdog& watchdog() noexcept { return watchdog_; }
  RamStore& store() noexcept { return store_; }
  sim::SimBench& stream() noexcept { return stream_; }

 private:
  CmsdkUart console_;
  CmsdkClock clock_;
  CmsdkWatchdog watchdog_;
  RamStore store_;
  sim::SimBench stream_;
};

/// The one board there is.
Board& board() noexcept;

}  // namespace emax::board
