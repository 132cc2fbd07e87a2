// From the supply to 400 MHz, step by step.
#include "emax/board/h743.hpp"
#include "emax/board/h743_chain.hpp"
#include "emax/board/register_bits.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/stm32_clocks.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kControl = kRcc + 0x00;
constexpr std::uintptr_t kConfiguration = kRcc + 0x10;
constexpr std::uintptr_t kDomain1 = kRcc + 0x18;
constexpr std::uintptr_t kDomain2 = kRcc + 0x1C;
constexpr std::uintptr_t kDomain3 = kRcc + 0x20;
constexpr std::uintptr_t kPllSource = kRcc + 0x28;
constexpr std::uintptr_t kPllConfiguration = kRcc + 0x2C;
constexpr std::uintptr_t kPllDividers = kRcc + 0x30;
constexpr std::uintptr_t kConsoleClock = kRcc + 0x54;
constexpr std::uintptr_t kConverterClock = kRcc + 0x58;
constexpr std::uintptr_t kInterruptFlags = kRcc + 0x64;
constexpr std::uintptr_t kInterruptClear = kRcc + 0x68;
constexpr std::uintptr_t kAhb1Enable = kRcc + 0xD8;
constexpr std::uintptr_t kAhb2Enable = kRcc + 0xDC;
constexpr std::uintptr_t kAhb4Enable = kRcc + 0xE0;
constexpr std::uintptr_t kApb1Enable = kRcc + 0xE8;
constexpr std::uintptr_t kFlashAccess = kFlash + 0x00;
constexpr std::uintptr_t kPowerStatus = kPower + 0x04;
constexpr std::uintptr_t kPowerSupply = kPower + 0x0C;
constexpr std::uintptr_t kPowerScale = kPower + 0x18;

constexpr std::uint32_t kInternalOn = 1U << 0;
constexpr std::uint32_t kInternalReady = 1U << 2;
constexpr std::uint32_t kCrystalOn = 1U << 16;
constexpr std::uint32_t kCrystalReady = 1U << 17;
constexpr std::uint32_t kCrystalIsClock = 1U << 18;
constexpr std::uint32_t kCrystalWatched = 1U << 19;
constexpr std::uint32_t kPllOn = 1U << 24;
constexpr std::uint32_t kPllReady = 1U << 25;
constexpr std::uint32_t kCrystalLost = 1U << 10;

// The chip's linear regulator makes the core's voltage, and nothing else does: a chip with a
// converter, too, would need other bits here.
constexpr std::uint32_t kSupplies = 7;
constexpr std::uint32_t kLinearRegulator = 1U << 1;
constexpr std::uint32_t kSupplyReady = 1U << 13;
constexpr std::uint32_t kScale = 3U << 14;
constexpr std::uint32_t kScale1 = 3U << 14;
constexpr std::uint32_t kScaleReady = 1U << 13;

// 8 MHz from the debugger, undivided, in the range of 8 to 16 MHz (3): by 100 to 800 MHz, by 2.
constexpr std::uint32_t kSourceBits = 3U | 0x3FU << 4U;
constexpr std::uint32_t kSourceCrystalBy1 = 2U | 1U << 4;
constexpr std::uint32_t kPllBits = 0xFU | 7U << 16U;
constexpr std::uint32_t kPllRange3AndOutputP = 3U << 2 | 1U << 16;
constexpr std::uint32_t kPllBy100AndBy2 = (100U - 1) | (2U - 1) << 9U | 1U << 16 | 1U << 24;

// The processor's clock undivided; half of it, 200 MHz, for memory and buses; a quarter for
// peripherals, whose timers have twice that.
constexpr std::uint32_t kDomain1Bits = 0xF7FU;
constexpr std::uint32_t kDomain2Bits = 0x770U;
constexpr std::uint32_t kDomain3Bits = 0x070U;
constexpr std::uint32_t kBusesByTwo = 8U << 0 | 4U << 4;
constexpr std::uint32_t kBothPeripheralsByTwo = 4U << 4 | 4U << 8;
constexpr std::uint32_t kPeripheralsByTwo = 4U << 4;

constexpr std::uint32_t kSwitch = 7U << 0;
constexpr std::uint32_t kSwitched = 7U << 3;
constexpr std::uint32_t kSwitchToPll = 3;
constexpr unsigned kSwitchedAt = 3;

// One more than the memory needs at 200 MHz (2), which the caches make up for.
constexpr std::uint32_t kAccessBits = 0x3F;
constexpr std::uint32_t kThreeWaitStates = 3U << 0 | 2U << 4;

// The internal oscillator's 64 MHz (2), which the ADCs of old revisions take.
constexpr std::uint32_t kConverterClockBits = 3U << 16;
constexpr std::uint32_t kConvertersByInternal = 2U << 16;

constexpr std::uint32_t kInternal_hz = 64'000'000;
constexpr std::uint32_t kConsole_hz = 100'000'000;

// The debugger's clock comes with the board's power; the others take some tens of microseconds.
constexpr std::uint32_t kMostCrystal_us = 100'000;
constexpr std::uint32_t kMost_us = 10'000;

// All that the board uses. Timers count the buses' clock until these are divided.
void start_peripheral_clocks() noexcept {
  switch_on(kAhb1Enable, 1U << 0 | 1U << 5);                                // DMA1, ADC1 and 2.
  switch_on(kAhb2Enable, 1U << 29);                                         // SRAM1.
  switch_on(kAhb4Enable, 1U << 0 | 1U << 1 | 1U << 2 | 1U << 3 | 1U << 4);  // GPIOA to E.
  // TIM2, 6, 7, USART3 and DAC1.
  switch_on(kApb1Enable, 1U << 0 | 1U << 4 | 1U << 5 | 1U << 18 | 1U << 29);
  replace_bits(kConsoleClock, 7U << 0, 0);            // By its bus,
  replace_bits(kConverterClock, kConverterClockBits,  // and ADCs that want a clock of their own
               kConvertersByInternal);                // by the internal oscillator.
}

// Which supply the core has is to be said once after power on, and before its voltage is chosen.
bool raise_voltage() noexcept {
  if ((reg(kPowerSupply) & kSupplies) != kLinearRegulator) {
    replace_bits(kPowerSupply, kSupplies, kLinearRegulator);
  }
  if (!is_set(kPowerStatus, kSupplyReady, kMost_us)) {
    return false;
  }
  replace_bits(kPowerScale, kScale, kScale1);
  return is_set(kPowerScale, kScaleReady, kMost_us);
}

bool start_crystal() noexcept {
  // Whether it is a crystal or a clock is taken while it is off only.
  reg(kControl) |= kCrystalIsClock;
  reg(kControl) |= kCrystalOn;
  return is_set(kControl, kCrystalReady, kMostCrystal_us);
}

bool start_pll() noexcept {
  reg(kControl) &= ~kPllOn;
  if (!become(kControl, kPllReady, 0, kMost_us)) {
    return false;
  }
  replace_bits(kPllSource, kSourceBits, kSourceCrystalBy1);
  replace_bits(kPllConfiguration, kPllBits, kPllRange3AndOutputP);
  reg(kPllDividers) = kPllBy100AndBy2;
  reg(kControl) |= kPllOn;
  return is_set(kControl, kPllReady, kMost_us);
}

// The dividers first, so that nothing is ever too fast.
bool switch_to_pll() noexcept {
  replace_bits(kFlashAccess, kAccessBits, kThreeWaitStates);
  if (!become(kFlashAccess, kAccessBits, kThreeWaitStates, kMost_us)) {
    return false;
  }
  replace_bits(kDomain1, kDomain1Bits, kBusesByTwo);
  replace_bits(kDomain2, kDomain2Bits, kBothPeripheralsByTwo);
  replace_bits(kDomain3, kDomain3Bits, kPeripheralsByTwo);
  replace_bits(kConfiguration, kSwitch, kSwitchToPll);
  return become(kConfiguration, kSwitched, kSwitchToPll << kSwitchedAt, kMost_us);
}

// The internal oscillator, undivided, for everything: as after a reset. The wait states stay.
Clocks use_internal() noexcept {
  reg(kControl) |= kInternalOn;
  (void)is_set(kControl, kInternalReady, kMost_us);
  replace_bits(kConfiguration, kSwitch, 0);
  (void)become(kConfiguration, kSwitched, 0, kMost_us);
  replace_bits(kDomain1, kDomain1Bits, 0);
  replace_bits(kDomain2, kDomain2Bits, 0);
  replace_bits(kDomain3, kDomain3Bits, 0);
  start_timebase(kInternal_hz);
  return {kInternal_hz, kInternal_hz, false};
}

}  // namespace

Clocks start_clocks() noexcept {
  start_peripheral_clocks();
  start_timebase(kInternal_hz);
  if (!raise_voltage() || !start_crystal() || !start_pll() || !switch_to_pll()) {
    const Clocks clocks = use_internal();
    // The PLL first, which may run from the crystal.
    reg(kControl) &= ~kPllOn;
    reg(kControl) &= ~kCrystalOn;
    return clocks;
  }
  start_timebase(kH743Timers_hz);
  reg(kControl) |= kCrystalWatched;
  return {kH743Timers_hz, kConsole_hz, true};
}

bool take_crystal_lost() noexcept {
  return take_flag(kInterruptFlags, kInterruptClear, kCrystalLost);
}

Clocks restart_clocks() noexcept { return use_internal(); }

}  // namespace emax::board
