// QEMU's machine `virt` with a 32-bit RISC-V core: its peripherals, and what its interrupts and
// faults lead to.
#include "emax/board/board.hpp"

#include <cstdint>

#include "emax/board/fault_report.hpp"
#include "emax/board/machine_clock.hpp"
#include "emax/board/ns16550.hpp"
#include "emax/board/null_watchdog.hpp"
#include "emax/board/ram_store.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/riscv.hpp"
#include "emax/board/simulated_bench.hpp"
#include "emax/board/startup.hpp"
#include "emax/board/store_format.hpp"
#include "emax/sim/sim_bench.hpp"

namespace emax::board {
namespace {

constexpr std::uint32_t kMtime_hz = EMAX_BOARD_CLOCK_HZ;
constexpr std::uint32_t kUartClock_hz = 3'686'400;
constexpr std::uint32_t kBaud = 115200;

constexpr std::uintptr_t kMtime = 0x0200BFF8;
constexpr std::uintptr_t kUart0 = 0x10000000;
constexpr unsigned kUart0Interrupt = 10;
static_assert(kUart0Interrupt < EMAX_BOARD_INTERRUPTS);

static_assert(kMtime_hz % 1'000'000 == 0);
static_assert(kUartClock_hz % (16 * kBaud) == 0);

// The interrupt controller, for machine mode of the first core.
constexpr std::uintptr_t kPlicPriority = 0x0C000000;
constexpr std::uintptr_t kPlicEnable = 0x0C002000;
constexpr std::uintptr_t kPlicThreshold = 0x0C200000;
constexpr std::uintptr_t kPlicClaim = 0x0C200004;

constexpr std::uintptr_t kTestDevice = 0x00100000;
constexpr std::uint32_t kTestReset = 0x7777;

[[gnu::section(".store")]] std::uint8_t records[kStoreFormat.slot_count * kStoreFormat.slot_bytes];

struct Hardware {
  Ns16550 console{kUart0};
  MachineClock clock{kMtime, kMtime_hz / 1'000'000};
  NullWatchdog watchdog;
  RamStore store{kStoreFormat, records};
  sim::SimBench stream;
};

Hardware hardware;
constexpr app::Ports kPorts = {hardware.stream, hardware.console, hardware.clock,
                               &hardware.watchdog, &hardware.store};

constexpr sim::BenchSettings kBench = {};
constexpr app::SimulatedBench kSimulated = describe(kBench);
constexpr app::Board kAbout = {EMAX_BOARD_NAME, "0", nullptr, &kSimulated, nullptr};

}  // namespace

Status start_board() noexcept {
  reg(kPlicPriority + 4 * kUart0Interrupt) = 1;
  reg(kPlicThreshold) = 0;
  reg(kPlicEnable) = 1U << kUart0Interrupt;
  // After that: QEMU's controller overlooks what was pending before it was enabled.
  hardware.console.start(kUartClock_hz, kBaud);
  enable_external_interrupts();
  return hardware.stream.configure(kBench);
}

const app::Ports& ports() noexcept { return kPorts; }

const app::Board& about() noexcept { return kAbout; }

void rest() noexcept {}

bool console_sent() noexcept { return hardware.console.sent(); }

// One at a time: what else is pending comes back at once.
void on_external_interrupt() noexcept {
  const std::uint32_t number = reg(kPlicClaim);
  if (number == 0) {
    return;
  }
  if (number == kUart0Interrupt) {
    hardware.console.on_interrupt();
  }
  reg(kPlicClaim) = number;
}

void reset() noexcept {
  for (;;) {
    reg(kTestDevice) = kTestReset;
  }
}

bool lead_drive_to_zero() noexcept {
  sim::SimBench& stream = hardware.stream;
  stream.stop();
  return stream.drive_is_at_zero();
}

void write_polled(Span<const char> text) noexcept { hardware.console.write_polled(text); }

}  // namespace emax::board
