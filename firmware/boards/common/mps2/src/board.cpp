// The board's peripherals, and what its interrupts and faults lead to.
#include "emax/board/board.hpp"

#include "emax/board/cortex_m.hpp"
#include "emax/board/fault_report.hpp"
#include "emax/board/reset_cause.hpp"
#include "emax/board/store_format.hpp"

namespace emax::board {
namespace {

[[gnu::section(".store")]] std::uint8_t records[kStoreFormat.slot_count * kStoreFormat.slot_bytes];

}  // namespace

constexpr Board::Board() noexcept
    : console_(kUart0, kUart0TransmitInterrupt),
      clock_(kTimer1, kCyclesPer_us),
      watchdog_(kWatchdog, kCyclesPer_us, kWatchdogPeriod_us),
      store_(kStoreFormat, records) {}

namespace {

Board instance;

void on_receive() { instance.console().on_receive(); }
void on_transmit() { instance.console().on_transmit(); }
void on_clock() { instance.clock().on_wrap(); }

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
[[gnu::section(".start")]] constexpr VectorTable vectors = make_vectors();
}

Status Board::start() noexcept {
  watchdog_.set_cause(take_watchdog_reset());
  clock_.start();
  console_.start(kClock_hz, kBaud);
  enable_interrupt(kTimer1Interrupt);
  enable_interrupt(kUart0ReceiveInterrupt);
  enable_interrupt(kUart0TransmitInterrupt);
  return stream_.configure(sim::BenchSettings{});
}

Board& board() noexcept { return instance; }

bool lead_drive_to_zero() noexcept {
  sim::SimBench& stream = instance.stream();
  stream.stop();
  return stream.drive_is_at_zero();
}

void write_polled(Span<const char> text) noexcept { instance.console().write_polled(text); }

}  // namespace emax::board
