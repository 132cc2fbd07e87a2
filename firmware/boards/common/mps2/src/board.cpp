// Arm's MPS2 board, as its application notes AN386 (Cortex-M4F) and AN500 (Cortex-M7) make it: its
// peripherals, and what its interrupts and faults lead to.
#include "emax/board/board.hpp"

#include <cstdint>

#include "emax/board/cmsdk_clock.hpp"
#include "emax/board/cmsdk_uart.hpp"
#include "emax/board/cmsdk_watchdog.hpp"
#include "emax/board/cortex_m.hpp"
#include "emax/board/fault_report.hpp"
#include "emax/board/ram_store.hpp"
#include "emax/board/reset_cause.hpp"
#include "emax/board/simulated_bench.hpp"
#include "emax/board/store_format.hpp"
#include "emax/sim/sim_bench.hpp"

namespace emax::board {
namespace {

constexpr std::uint32_t kClock_hz = EMAX_BOARD_CLOCK_HZ;
constexpr std::uint32_t kBaud = 115200;
constexpr std::uint32_t kWatchdogPeriod_us = 10'000'000;

// Timer 0 is free, for measurements.
constexpr std::uintptr_t kTimer1 = 0x40001000;
constexpr std::uintptr_t kUart0 = 0x40004000;
constexpr std::uintptr_t kWatchdog = 0x40008000;
constexpr unsigned kUart0ReceiveInterrupt = 0;
constexpr unsigned kUart0TransmitInterrupt = 1;
constexpr unsigned kTimer1Interrupt = 9;

static_assert(kClock_hz % 1'000'000 == 0);
constexpr std::uint32_t kCyclesPer_us = kClock_hz / 1'000'000;
// UART0 rounds its divider down; it must stay within 1 % of the rate.
static_assert(kClock_hz / kBaud * kBaud > kClock_hz / 100 * 99);
static_assert(kWatchdogPeriod_us <= 0xFFFFFFFF / kCyclesPer_us);

[[gnu::section(".store")]] std::uint8_t records[kStoreFormat.slot_count * kStoreFormat.slot_bytes];

ConsoleRings console_rings;

struct Hardware {
  CmsdkUart console{kUart0, kUart0TransmitInterrupt, console_rings};
  CmsdkClock clock{kTimer1, kCyclesPer_us};
  CmsdkWatchdog watchdog{kWatchdog, kCyclesPer_us, kWatchdogPeriod_us};
  RamStore store{kStoreFormat, records};
  sim::SimBench stream;
};

Hardware hardware;
constexpr app::Ports kPorts = {hardware.stream, hardware.console, hardware.clock,
                               &hardware.watchdog, &hardware.store};

constexpr sim::BenchSettings kBench = {};
constexpr app::SimulatedBench kSimulated = describe(kBench);
constexpr app::Board kAbout = {EMAX_BOARD_NAME, "0", nullptr, &kSimulated, nullptr};

void on_receive() { hardware.console.on_receive(); }
void on_transmit() { hardware.console.on_transmit(); }
void on_clock() { hardware.clock.on_wrap(); }

constexpr VectorTable make_vectors() {
  VectorTable table = {stack_top, start, on_watchdog, {}, {}};
  for (InterruptHandler& handler : table.fault) {
    handler = on_fault;
  }
  for (InterruptHandler& handler : table.interrupt) {
    handler = on_fault;
  }
  table.interrupt[kUart0ReceiveInterrupt] = on_receive;
  table.interrupt[kUart0TransmitInterrupt] = on_transmit;
  table.interrupt[kTimer1Interrupt] = on_clock;
  return table;
}

}  // namespace

extern "C" {
[[gnu::section(".start")]] alignas(kVectorTableAlignment) constexpr VectorTable vectors =
    make_vectors();
}

Status start_board() noexcept {
  hardware.watchdog.set_cause(take_watchdog_reset());
  hardware.clock.start();
  hardware.console.start(kClock_hz, kBaud);
  enable_interrupt(kTimer1Interrupt);
  enable_interrupt(kUart0ReceiveInterrupt);
  enable_interrupt(kUart0TransmitInterrupt);
  return hardware.stream.configure(kBench);
}

const app::Ports& ports() noexcept { return kPorts; }

const app::Board& about() noexcept { return kAbout; }

void rest() noexcept {}

bool console_sent() noexcept { return hardware.console.sent(); }

bool lead_drive_to_zero() noexcept {
  sim::SimBench& stream = hardware.stream;
  stream.stop();
  return stream.drive_is_at_zero();
}

void write_polled(Span<const char> text) noexcept { hardware.console.write_polled(text); }

}  // namespace emax::board
