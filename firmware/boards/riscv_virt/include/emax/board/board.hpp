// QEMU's machine `virt` with a 32-bit RISC-V core.
#pragma once

#include <cstdint>

#include "emax/base/status.hpp"
#include "emax/board/machine_clock.hpp"
#include "emax/board/ns16550.hpp"
#include "emax/board/null_watchdog.hpp"
#include "emax/board/ram_store.hpp"
#include "emax/sim/sim_bench.hpp"

namespace emax::board {

inline constexpr std::uint32_t kMtime_hz = 10'000'000;
inline constexpr std::uint32_t kUartClock_hz = 3'686'400;
inline constexpr std::uint32_t kBaud = 115200;

inline constexpr std::uintptr_t kMtime = 0x0200BFF8;
inline constexpr std::uintptr_t kUart0 = 0x10000000;
inline constexpr unsigned kUart0Interrupt = 10;

static_assert(kMtime_hz % 1'000'000 == 0);
static_assert(kUartClock_hz % (16 * kBaud) == 0);

/// What the instrument gets of the machine, which has no watchdog.
class Board final {
 public:
  constexpr Board() noexcept;

  /// Starts the console and builds the simulated bench. Once, first of all.
  ///
  /// @returns What `SimBench::configure()` answers.
  Status start() noexcept;

  Ns16550& console() noexcept { return console_; }
  MachineClock& clock() noexcept { return clock_; }
  NullWatchdog& watchdog() noexcept { return watchdog_; }
  RamStore& store() noexcept { return store_; }
  sim::SimBench& stream() noexcept { return stream_; }

 private:
  Ns16550 console_;
  MachineClock clock_;
  NullWatchdog watchdog_;
  RamStore store_;
  sim::SimBench stream_;
};

/// The one board there is.
Board& board() noexcept;

}  // namespace emax::board
