// ST's NUCLEO-G474RE: its peripherals, and what its interrupts and faults lead to.
#include "emax/board/board.hpp"

#include <cstdint>

#include "emax/board/cortex_m.hpp"
#include "emax/board/fault_report.hpp"
#include "emax/board/g474.hpp"
#include "emax/board/g474_chain.hpp"
#include "emax/board/g474_flash_store.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/stm32_board.hpp"
#include "emax/board/stm32_clocks.hpp"

namespace emax::board {

Stm32Drivers drivers = {
    {kLpuart1, UartKind::kLpuart}, {kWatchdog, kTim7}, Stm32Stream(kG474Stream)};

namespace {

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

// Above 160 MHz the DAC needs the slower of its ways to the bus (HFSEL 2); 80 to 160 are not used.
constexpr std::uint32_t kSlowAccess = 2U << 14;
constexpr std::uint32_t kFastBus_hz = 160'000'000;

G474FlashStore store;
constexpr app::Ports kPorts = {drivers.stream, drivers.console, drivers.clock, &drivers.watchdog,
                               &store};

void light(bool is_on) noexcept {
  reg(kPinSetReset) = is_on ? 1U << kLedPin : 1U << (kLedPin + 16);
}

void start_pins() noexcept {
  light(false);
  reg(kPinFunctions) = (reg(kPinFunctions) & ~kConsoleFunctionBits) | kConsoleFunctions;
  reg(kPinModes) = (reg(kPinModes) & ~(kConsolePins | kLedPinBits)) | kConsolePinModes |
                   kLedPinMode | kAnalogPins;
}

// Not the watchdog: the crystal has stopped, or the flash memory has read what it cannot correct.
void on_non_maskable() {
  if (take_lost_clock() || store.take_read_error()) {
    return;
  }
  constexpr std::uintptr_t kFlashCorrection = kFlash + 0x18;
  const FaultNumber numbers[] = {{"eccr", reg(kFlashCorrection)}};
  report_fault("NMI", numbers);
  stop(kFaultStatus);
}

static_assert(kVectorTableAlignment == 512, "118 vectors of four bytes");

}  // namespace

extern "C" {
[[gnu::section(".start")]] alignas(kVectorTableAlignment) constexpr VectorTable vectors =
    make_vectors(on_non_maskable, kLpuart1Interrupt, kDma1Channel2Interrupt);
}

void show(LedState state, std::uint32_t tick) noexcept { light(is_led_on(state, tick)); }

Status start_board() noexcept {
  const Clocks clocks = start_clocks();
  drivers.stream.park(clocks.hz > kFastBus_hz ? kSlowAccess : 0);
  start_pins();
  reg(kDebugControl) |= kDebugInSleep;
  reg(kDebugFreeze) |= kTimersAndWatchdog;
  drivers.serial = read_unique_id(kUniqueId);
  start_drivers(clocks, take_watchdog_cause(kResetCause, kByWatchdog, kForgetCause),
                kLpuart1Interrupt, kDma1Channel2Interrupt);
  return clocks.is_exact ? Status::kOk : Status::kHardwareFault;
}

const app::Ports& ports() noexcept { return kPorts; }

void rest() noexcept { (void)sleep_until_byte(); }

}  // namespace emax::board
