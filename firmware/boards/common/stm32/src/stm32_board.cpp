// From the drivers to the instrument, the same for all boards with an STM32.
#include "emax/board/stm32_board.hpp"

#include <limits>

#include "emax/board/board.hpp"
#include "emax/board/fault_report.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/reset_cause.hpp"

namespace emax::board {
namespace {

// Of 16 levels, of which a lower number comes first. All the others share one, so none of these
// interrupts another one.
constexpr std::uint8_t kOrdinaryPriority = 0x80;

// 0.87 of full scale.
constexpr double kDriveLimit_v = 1.4;

LedState led_state() noexcept {
  if (!drivers.is_clock_exact.load(std::memory_order_relaxed) || drivers.watchdog.failed()) {
    return LedState::kCannotMeasure;
  }
  return drivers.stream.running() ? LedState::kDriving : LedState::kReady;
}

void set_clocks(const Clocks& clocks) noexcept {
  drivers.is_clock_exact.store(clocks.is_exact, std::memory_order_relaxed);
  drivers.stream.set_clock_exact(clocks.is_exact);
  drivers.console.start(clocks.console_hz, kConsoleBaud);
}

// The converters get ready, and a result takes no longer than a frame.
std::uint32_t check_hardware() noexcept {
  const bool is_right = drivers.stream.running() || drivers.stream.check_inputs() == Status::kOk;
  return is_right ? 0 : app::kFirstBoardCheck;
}

// By cycles, which are known as well as the crystal.
double measure_conversion_s() noexcept {
  (void)drivers.stream.check_inputs();
  const std::uint32_t cycles = drivers.stream.conversion_cycles();
  if (cycles == 0 || !drivers.is_clock_exact.load(std::memory_order_relaxed)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return static_cast<double>(cycles) / EMAX_BOARD_CLOCK_HZ;
}

}  // namespace

void on_console() { drivers.console.on_interrupt(); }

void on_output() { drivers.stream.on_output_interrupt(); }

void on_clock() {
  if (drivers.clock.on_interrupt()) {
    ++drivers.ticks;
    show(led_state(), drivers.ticks);
  }
}

bool take_lost_clock() noexcept {
  if (!take_crystal_lost()) {
    return false;
  }
  drivers.stream.lose_clock();
  set_clocks(restart_clocks());
  return true;
}

void start_drivers(const Clocks& clocks, bool caused_reset, unsigned console_interrupt,
                   unsigned output_interrupt) noexcept {
  drivers.watchdog.prepare(clocks.hz, caused_reset);
  drivers.clock.start();
  set_clocks(clocks);
  const unsigned ordinary[] = {output_interrupt, kTim2Interrupt, console_interrupt};
  for (const unsigned number : ordinary) {
    set_interrupt_priority(number, kOrdinaryPriority);
    enable_interrupt(number);
  }
  set_interrupt_priority(kTim7Interrupt, 0);
  enable_interrupt(kTim7Interrupt);
}

app::SweepSettings bench_of_board() noexcept {
  app::SweepSettings bench = app::default_sweep_settings();
  bench.drive_limit_v = kDriveLimit_v;
  bench.skew_s = 0.0;
  return bench;
}

const app::Board& about() noexcept {
  static constexpr app::Board kAbout = {
      EMAX_BOARD_NAME, drivers.serial.data(), nullptr,        nullptr,
      nullptr,         bench_of_board,        check_hardware, measure_conversion_s};
  return kAbout;
}

bool take_watchdog_cause(std::uintptr_t cause, std::uint32_t by_watchdog,
                         std::uint32_t forget) noexcept {
  const bool is_told_by_chip = (reg(cause) & by_watchdog) != 0;
  reg(cause) |= forget;
  return take_watchdog_reset() || is_told_by_chip;
}

bool sleep_until_byte() noexcept {
  // A byte that comes from here on ends the wait, although its interrupt is taken after it.
  asm volatile("cpsid i" ::: "memory");
  if (!drivers.console.has_received()) {
    asm volatile("dsb\nwfi" ::: "memory");
  }
  asm volatile("cpsie i" ::: "memory");
  return drivers.console.has_received();
}

bool console_sent() noexcept { return drivers.console.sent(); }

bool lead_drive_to_zero() noexcept {
  const bool is_at_zero = drivers.stream.force_to_zero();
  show(LedState::kFault, 0);
  return is_at_zero;
}

void write_polled(Span<const char> text) noexcept { drivers.console.write_polled(text); }

}  // namespace emax::board
