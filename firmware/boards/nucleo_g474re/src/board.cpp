// ST's NUCLEO-G474RE: its peripherals, and what its interrupts and faults lead to.
#include "emax/board/board.hpp"

#include <cstdint>

#include "emax/board/cortex_m.hpp"
#include "emax/board/fault_report.hpp"
#include "emax/board/g474.hpp"
#include "emax/board/g474_clocks.hpp"
#include "emax/board/g474_flash_store.hpp"
#include "emax/board/g474_stream.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/reset_cause.hpp"
#include "emax/board/status_led.hpp"
#include "emax/board/stm32_clock.hpp"
#include "emax/board/stm32_uart.hpp"
#include "emax/board/stm32_watchdog.hpp"
#include "emax/board/unique_id.hpp"

namespace emax::board {
namespace {

constexpr std::uint32_t kBaud = 115200;

// Of a port: analog pins are 3, as a reset leaves all of them but those of the debugger.
constexpr std::uintptr_t kPinModes = kGpioA + 0x00;
constexpr std::uintptr_t kPinSetReset = kGpioA + 0x18;
constexpr std::uintptr_t kPinFunctions = kGpioA + 0x20;
constexpr std::uint32_t kConsolePinModes = 2U << 4 | 2U << 6;  // PA2, PA3
constexpr std::uint32_t kConsolePins = 3U << 4 | 3U << 6;
constexpr std::uint32_t kConsoleFunctions = 12U << 8 | 12U << 12;
constexpr std::uint32_t kConsoleFunctionBits = 15U << 8 | 15U << 12;
constexpr std::uint32_t kAnalogPins = 3U << 0 | 3U << 2 | 3U << 8;  // PA0, PA1, PA4
constexpr unsigned kLedPin = 5;
constexpr std::uint32_t kLedPinMode = 1U << (2 * kLedPin);
constexpr std::uint32_t kLedPinBits = 3U << (2 * kLedPin);

constexpr std::uintptr_t kResetCause = kRcc + 0x94;
constexpr std::uint32_t kForgetCause = 1U << 23;
constexpr std::uint32_t kByWatchdog = 1U << 29;

// A debugger reaches the processor while it sleeps; timers and the watchdog stand still while it is
// held.
constexpr std::uintptr_t kDebugControl = kDebug + 0x04;
constexpr std::uint32_t kDebugInSleep = 1U << 0;
constexpr std::uintptr_t kDebugFreeze = kDebug + 0x08;
constexpr std::uint32_t kTimersAndWatchdog = 1U << 0 | 1U << 4 | 1U << 5 | 1U << 12;

// Of 16 levels, of which a lower number comes first. All the others share one, so none of these
// interrupts another one.
constexpr std::uint8_t kOrdinaryPriority = 0x80;

struct Hardware {
  Stm32Uart console{kLpuart1, UartKind::kLpuart};
  Stm32Clock clock;
  Stm32Watchdog watchdog{kWatchdog, kTim7};
  G474FlashStore store;
  G474Stream stream;
  std::uint32_t ticks = 0;
  bool is_clock_exact = false;
};

Hardware hardware;
constexpr app::Ports kPorts = {hardware.stream, hardware.console, hardware.clock,
                               &hardware.watchdog, &hardware.store};

UniqueIdText serial = {};

// The pin's amplifier follows from 0.2 V of either end of the supply: 0.87 of full scale.
constexpr double kDriveLimit_v = 1.4;

// Both inputs are sampled at the same moment.
app::SweepSettings bench_of_board() noexcept {
  app::SweepSettings bench = app::default_sweep_settings();
  bench.drive_limit_v = kDriveLimit_v;
  bench.skew_s = 0.0;
  return bench;
}

constexpr app::Board kAbout = {EMAX_BOARD_NAME, serial.data(), nullptr,
                               nullptr,         nullptr,       bench_of_board};

void show(bool is_on) noexcept { reg(kPinSetReset) = is_on ? 1U << kLedPin : 1U << (kLedPin + 16); }

void start_pins() noexcept {
  show(false);
  reg(kPinFunctions) = (reg(kPinFunctions) & ~kConsoleFunctionBits) | kConsoleFunctions;
  reg(kPinModes) = (reg(kPinModes) & ~(kConsolePins | kLedPinBits)) | kConsolePinModes |
                   kLedPinMode | kAnalogPins;
}

bool take_watchdog_cause() noexcept {
  const bool is_told_by_chip = (reg(kResetCause) & kByWatchdog) != 0;
  reg(kResetCause) |= kForgetCause;
  return take_watchdog_reset() || is_told_by_chip;
}

void start_interrupts() noexcept {
  constexpr unsigned kOrdinary[] = {kDma1Channel2Interrupt, kTim2Interrupt, kLpuart1Interrupt};
  for (const unsigned number : kOrdinary) {
    set_interrupt_priority(number, kOrdinaryPriority);
    enable_interrupt(number);
  }
  set_interrupt_priority(kTim7Interrupt, 0);
  enable_interrupt(kTim7Interrupt);
}

LedState led_state() noexcept {
  if (!hardware.is_clock_exact || hardware.watchdog.failed()) {
    return LedState::kCannotMeasure;
  }
  return hardware.stream.running() ? LedState::kDriving : LedState::kReady;
}

void set_clocks(const Clocks& clocks) noexcept {
  hardware.is_clock_exact = clocks.is_exact;
  hardware.stream.set_clock_exact(clocks.is_exact);
  hardware.console.start(clocks.hz, kBaud);
}

void on_console() { hardware.console.on_interrupt(); }
void on_output() { hardware.stream.on_output_interrupt(); }
void on_clock() {
  if (hardware.clock.on_interrupt()) {
    ++hardware.ticks;
    show(is_led_on(led_state(), hardware.ticks));
  }
}

// Not the watchdog: the crystal has stopped, or the flash memory has read what it cannot correct.
void on_non_maskable() {
  if (take_crystal_lost()) {
    hardware.stream.lose_clock();
    set_clocks(restart_clocks());
    return;
  }
  if (hardware.store.take_read_error()) {
    return;
  }
  constexpr std::uintptr_t kFlashCorrection = kFlash + 0x18;
  const FaultNumber numbers[] = {{"eccr", reg(kFlashCorrection)}};
  report_fault("NMI", numbers);
  stop(kFaultStatus);
}

constexpr VectorTable make_vectors() {
  VectorTable table = {stack_top, start, on_non_maskable, {}, {}};
  for (InterruptHandler& handler : table.fault) {
    handler = on_fault;
  }
  for (InterruptHandler& handler : table.interrupt) {
    handler = on_fault;
  }
  table.interrupt[kDma1Channel2Interrupt] = on_output;
  table.interrupt[kTim2Interrupt] = on_clock;
  table.interrupt[kTim7Interrupt] = on_watchdog;
  table.interrupt[kLpuart1Interrupt] = on_console;
  return table;
}
static_assert(kVectorTableAlignment == 512, "118 vectors of four bytes");

}  // namespace

extern "C" {
[[gnu::section(".start")]] alignas(kVectorTableAlignment) constexpr VectorTable vectors =
    make_vectors();
}

Status start_board() noexcept {
  const Clocks clocks = start_clocks();
  hardware.stream.park(clocks.hz);
  start_pins();
  reg(kDebugControl) |= kDebugInSleep;
  reg(kDebugFreeze) |= kTimersAndWatchdog;
  serial = read_unique_id(kUniqueId);
  hardware.watchdog.prepare(clocks.hz, take_watchdog_cause());
  hardware.clock.start();
  set_clocks(clocks);
  start_interrupts();
  return clocks.is_exact ? Status::kOk : Status::kHardwareFault;
}

const app::Ports& ports() noexcept { return kPorts; }

const app::Board& about() noexcept { return kAbout; }

void rest() noexcept {
  // A byte that comes from here on ends the wait, although its interrupt is taken after it.
  asm volatile("cpsid i" ::: "memory");
  if (!hardware.console.has_received()) {
    asm volatile("dsb\nwfi" ::: "memory");
  }
  asm volatile("cpsie i" ::: "memory");
}

bool console_sent() noexcept { return hardware.console.sent(); }

bool lead_drive_to_zero() noexcept {
  const bool is_at_zero = hardware.stream.force_to_zero();
  show(is_led_on(LedState::kFault, 0));
  return is_at_zero;
}

void write_polled(Span<const char> text) noexcept { hardware.console.write_polled(text); }

}  // namespace emax::board
