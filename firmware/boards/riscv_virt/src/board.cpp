// The machine's peripherals, and what its interrupts and faults lead to.
#include "emax/board/board.hpp"

#include "emax/board/fault_report.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/riscv.hpp"
#include "emax/board/startup.hpp"
#include "emax/board/store_format.hpp"

namespace emax::board {
namespace {

// The interrupt controller, for machine mode of the first core.
constexpr std::uintptr_t kPlicPriority = 0x0C000000;
constexpr std::uintptr_t kPlicEnable = 0x0C002000;
constexpr std::uintptr_t kPlicThreshold = 0x0C200000;
constexpr std::uintptr_t kPlicClaim = 0x0C200004;

constexpr std::uintptr_t kTestDevice = 0x00100000;
constexpr std::uint32_t kTestReset = 0x7777;

[[gnu::section(".store")]] std::uint8_t records[kStoreFormat.slot_count * kStoreFormat.slot_bytes];

}  // namespace

constexpr Board::Board() noexcept
    : console_(kUart0), clock_(kMtime, kMtime_hz / 1'000'000), store_(kStoreFormat, records) {}

namespace {

Board instance;

}  // namespace

Status Board::start() noexcept {
  reg(kPlicPriority + 4 * kUart0Interrupt) = 1;
  reg(kPlicThreshold) = 0;
  reg(kPlicEnable) = 1U << kUart0Interrupt;
  // After that: QEMU's controller overlooks what was pending before it was enabled.
  console_.start(kUartClock_hz, kBaud);
  enable_external_interrupts();
  return stream_.configure(sim::BenchSettings{});
}

Board& board() noexcept { return instance; }

// One at a time: what else is pending comes back at once.
void on_external_interrupt() noexcept {
  const std::uint32_t number = reg(kPlicClaim);
  if (number == 0) {
    return;
  }
  if (number == kUart0Interrupt) {
    instance.console().on_interrupt();
  }
  reg(kPlicClaim) = number;
}

void reset() noexcept {
  for (;;) {
    reg(kTestDevice) = kTestReset;
  }
}

bool lead_drive_to_zero() noexcept {
  sim::SimBench& stream = instance.stream();
  stream.stop();
  return stream.drive_is_at_zero();
}

void write_polled(Span<const char> text) noexcept { instance.console().write_polled(text); }

}  // namespace emax::board
