// ST's NUCLEO-H743ZI2: its peripherals, and what its interrupts and faults lead to.
#include "emax/board/board.hpp"

#include <cstdint>

#include "emax/board/cortex_m.hpp"
#include "emax/board/fault_report.hpp"
#include "emax/board/h743.hpp"
#include "emax/board/h743_chain.hpp"
#include "emax/board/h743_flash.hpp"
#include "emax/board/h743_memory.hpp"
#include "emax/board/log_store.hpp"
#include "emax/board/register_bits.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/stm32_board.hpp"
#include "emax/board/stm32_clocks.hpp"

namespace emax::board {

Stm32Drivers drivers = {{kUsart3, UartKind::kUsart}, {kWatchdog, kTim7}, Stm32Stream(kH743Stream)};

namespace {

// Of a port: analog pins are 3, as a reset leaves all of them but those of the debugger.
constexpr std::uintptr_t kPinModes = 0x00;
constexpr std::uintptr_t kPinSetReset = 0x18;
constexpr std::uintptr_t kHighPinFunctions = 0x24;

struct Led {
  std::uintptr_t port;
  unsigned pin;
};
constexpr Led kGreen = {kGpioB, 0};
constexpr Led kYellow = {kGpioE, 1};
constexpr Led kRed = {kGpioB, 14};

constexpr std::uintptr_t kResetCause = kRcc + 0xD0;
constexpr std::uint32_t kForgetCause = 1U << 16;
constexpr std::uint32_t kByWatchdog = 1U << 26;

constexpr std::uint32_t kDevice = 0x450;
constexpr std::uint32_t kDeviceBits = 0xFFF;
constexpr unsigned kRevisionAt = 16;
constexpr std::uint32_t kRevisionY = 0x1003;

// A debugger reaches the processor while it sleeps; timers and the watchdog stand still while it is
// held.
constexpr std::uintptr_t kDebugControl = kDebug + 0x04;
constexpr std::uint32_t kDebugInSleep = 1U << 0;
constexpr std::uintptr_t kDebugFreezeTimers = kDebug + 0x3C;
constexpr std::uint32_t kTimers = 1U << 0 | 1U << 4 | 1U << 5;
constexpr std::uintptr_t kDebugFreezeWatchdog = kDebug + 0x54;
constexpr std::uint32_t kIndependentWatchdog = 1U << 18;

H743Sectors sectors;
LogStore store(kH743StoreFormat, kH743SectorBytes, sectors);
constexpr app::Ports kPorts = {drivers.stream, drivers.console, drivers.clock, &drivers.watchdog,
                               &store};

// Nobody waits for anything after so long without a byte.
constexpr std::uint64_t kQuiet_us = 10'000'000;
std::uint64_t quiet_since_us = 0;

void light(const Led& led, bool is_on) noexcept {
  reg(led.port + kPinSetReset) = is_on ? 1U << led.pin : 1U << (led.pin + 16);
}

void set_mode(std::uintptr_t port, unsigned pin, std::uint32_t mode) noexcept {
  replace_bits(port + kPinModes, 3U << (2 * pin), mode << (2 * pin));
}

void start_pins() noexcept {
  constexpr Led kLeds[] = {kGreen, kYellow, kRed};
  for (const Led& led : kLeds) {
    light(led, false);
    set_mode(led.port, led.pin, 1);
  }
  // PD8 and PD9 are the console's (7). PA3, PC0 and PA4 are analog.
  replace_bits(kGpioD + kHighPinFunctions, 0xFFU, 7U << 0 | 7U << 4);
  set_mode(kGpioD, 8, 2);
  set_mode(kGpioD, 9, 2);
  set_mode(kGpioA, 3, 3);
  set_mode(kGpioA, 4, 3);
  set_mode(kGpioC, 0, 3);
}

// @returns Whether the chip is the one that all this was written for.
bool adapt_to_chip() noexcept {
  const std::uint32_t identity = reg(kDebug);
  if (identity >> kRevisionAt <= kRevisionY) {
    drivers.stream.use_inputs(kH743InputsOfRevisionY);
  }
  return (identity & kDeviceBits) == kDevice;
}

// Not the watchdog, and not the flash memory, whose errors are faults of the bus.
void on_non_maskable() {
  if (!take_lost_clock()) {
    report_fault("NMI", {});
    stop(kFaultStatus);
  }
}

static_assert(kVectorTableAlignment == 1024, "166 vectors of four bytes");

}  // namespace

extern "C" {
[[gnu::section(".start")]] alignas(kVectorTableAlignment) constexpr VectorTable vectors =
    make_vectors(on_non_maskable, kUsart3Interrupt, kDma1Stream1Interrupt);
}

void show(LedState state, std::uint32_t tick) noexcept {
  light(kGreen, is_led_on(state, tick));
  light(kYellow, state == LedState::kDriving);
  light(kRed, state == LedState::kCannotMeasure || state == LedState::kFault);
}

Status start_board() noexcept {
  Clocks clocks = start_clocks();
  drivers.stream.park(0);
  start_pins();
  start_memory();
  clocks.is_exact = adapt_to_chip() && clocks.is_exact;
  reg(kDebugControl) |= kDebugInSleep;
  reg(kDebugFreezeTimers) |= kTimers;
  reg(kDebugFreezeWatchdog) |= kIndependentWatchdog;
  drivers.serial = read_unique_id(kUniqueId);
  start_drivers(clocks, take_watchdog_cause(kResetCause, kByWatchdog, kForgetCause),
                kUsart3Interrupt, kDma1Stream1Interrupt);
  // Here, where nobody waits for an answer: it may have to erase.
  (void)store.start();
  return clocks.is_exact ? Status::kOk : Status::kHardwareFault;
}

const app::Ports& ports() noexcept { return kPorts; }

void rest() noexcept {
  const bool has_received = sleep_until_byte();
  const std::uint64_t now_us = drivers.clock.now_us();
  if (has_received) {
    quiet_since_us = now_us;
  } else if (now_us - quiet_since_us > kQuiet_us && store.wants_erase()) {
    (void)store.erase_ahead();
    quiet_since_us = now_us;
  }
}

}  // namespace emax::board
