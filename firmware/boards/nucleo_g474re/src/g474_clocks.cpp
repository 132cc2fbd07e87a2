// Step by step from 16 to 170 MHz.
#include "emax/board/g474.hpp"
#include "emax/board/register_bits.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/stm32_clocks.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kControl = kRcc + 0x00;
constexpr std::uintptr_t kConfiguration = kRcc + 0x08;
constexpr std::uintptr_t kPllConfiguration = kRcc + 0x0C;
constexpr std::uintptr_t kInterruptFlags = kRcc + 0x1C;
constexpr std::uintptr_t kInterruptClear = kRcc + 0x20;
constexpr std::uintptr_t kAhb1Enable = kRcc + 0x48;
constexpr std::uintptr_t kAhb2Enable = kRcc + 0x4C;
constexpr std::uintptr_t kApb1Enable1 = kRcc + 0x58;
constexpr std::uintptr_t kApb1Enable2 = kRcc + 0x5C;
constexpr std::uintptr_t kKernelClocks = kRcc + 0x88;
constexpr std::uintptr_t kFlashAccess = kFlash + 0x00;
constexpr std::uintptr_t kPowerControl5 = kPower + 0x80;

constexpr std::uint32_t kInternalOn = 1U << 8;
constexpr std::uint32_t kInternalReady = 1U << 10;
constexpr std::uint32_t kCrystalOn = 1U << 16;
constexpr std::uint32_t kCrystalReady = 1U << 17;
constexpr std::uint32_t kCrystalWatched = 1U << 19;
constexpr std::uint32_t kPllOn = 1U << 24;
constexpr std::uint32_t kPllReady = 1U << 25;
constexpr std::uint32_t kCrystalLost = 1U << 8;

// SW and SWS.
constexpr std::uint32_t kSwitch = 3U << 0;
constexpr std::uint32_t kSwitchToInternal = 1;
constexpr std::uint32_t kSwitchToPll = 3;
constexpr unsigned kSwitchedAt = 2;
constexpr std::uint32_t kAhbDivider = 0xFU << 4;
constexpr std::uint32_t kAhbByTwo = 8U << 4;

// From 4 MHz, of a crystal of 24 MHz by 6 or of the internal 16 MHz by 4: by 85 to 340 MHz, by 2.
constexpr std::uint32_t kPllOfInternal = 2U | (4U - 1) << 4U;
constexpr std::uint32_t kPllOfCrystal = 3U | (6U - 1) << 4U;
constexpr std::uint32_t kPllBy85AndOutputBy2 = 85U << 8U | 1U << 24U;
constexpr std::uint32_t kInternal_hz = 16'000'000;
constexpr std::uint32_t kPll_hz = 170'000'000;

constexpr std::uint32_t kWaitStates = 0xF;
constexpr std::uint32_t kWaitStatesAt170MHz = 4;
constexpr std::uint32_t kPrefetchAndCaches = 7U << 8;

constexpr std::uint32_t kNormalRange = 1U << 8;

// A crystal takes 2 ms, the others some tens of microseconds.
constexpr std::uint32_t kMostCrystal_us = 100'000;
constexpr std::uint32_t kMost_us = 10'000;

void switch_to(std::uint32_t source) noexcept {
  reg(kConfiguration) = (reg(kConfiguration) & ~kSwitch) | source;
}

bool is_switched_to(std::uint32_t source) noexcept {
  return wait_for([=] { return ((reg(kConfiguration) >> kSwitchedAt) & kSwitch) == source; },
                  kMost_us);
}

// More than 150 MHz need the regulator's boost and four wait states, before.
bool prepare_speed() noexcept {
  reg(kPowerControl5) &= ~kNormalRange;
  const std::uint32_t access = (reg(kFlashAccess) & ~kWaitStates) | kWaitStatesAt170MHz;
  reg(kFlashAccess) = access | kPrefetchAndCaches;
  return wait_for([] { return (reg(kFlashAccess) & kWaitStates) == kWaitStatesAt170MHz; },
                  kMost_us);
}

// From the internal oscillator to the PLL, whose source runs.
bool switch_to_pll(std::uint32_t source) noexcept {
  reg(kControl) &= ~kPllOn;
  if (!wait_for([] { return (reg(kControl) & kPllReady) == 0; }, kMost_us)) {
    return false;
  }
  reg(kPllConfiguration) = source | kPllBy85AndOutputBy2;
  reg(kControl) |= kPllOn;
  if (!is_set(kControl, kPllReady, kMost_us)) {
    return false;
  }
  // In two steps, as the manual has it for more than 80 MHz.
  reg(kConfiguration) = (reg(kConfiguration) & ~kAhbDivider) | kAhbByTwo;
  switch_to(kSwitchToPll);
  const bool is_switched = is_switched_to(kSwitchToPll);
  if (!is_switched) {
    switch_to(kSwitchToInternal);
  }
  // The timebase may run ten times too fast by now: this is 2 us at least.
  pause_us(20);
  reg(kConfiguration) &= ~kAhbDivider;
  return is_switched;
}

Clocks from_internal() noexcept {
  const bool is_fast = prepare_speed() && switch_to_pll(kPllOfInternal);
  const std::uint32_t hz = is_fast ? kPll_hz : kInternal_hz;
  start_timebase(hz);
  return {hz, hz, false};
}

// All that the board uses.
void start_peripheral_clocks() noexcept {
  switch_on(kAhb1Enable, 1U << 0 | 1U << 2);                        // DMA1, DMAMUX.
  switch_on(kAhb2Enable, 1U << 0 | 1U << 13 | 1U << 16);            // GPIOA, ADC1 and 2, DAC1.
  switch_on(kApb1Enable1, 1U << 0 | 1U << 4 | 1U << 5 | 1U << 28);  // TIM2, 6, 7, power.
  switch_on(kApb1Enable2, 1U << 0);                                 // LPUART1,
  reg(kKernelClocks) = 1U << 10;                                    // by the processor's clock.
}

}  // namespace

Clocks start_clocks() noexcept {
  start_peripheral_clocks();
  start_timebase(kInternal_hz);
  reg(kControl) |= kCrystalOn;
  const bool has_crystal = is_set(kControl, kCrystalReady, kMostCrystal_us);
  if (!has_crystal || !prepare_speed() || !switch_to_pll(kPllOfCrystal)) {
    // The PLL first, which may run from it.
    reg(kControl) &= ~kPllOn;
    reg(kControl) &= ~kCrystalOn;
    return from_internal();
  }
  start_timebase(kPll_hz);
  reg(kControl) |= kCrystalWatched;
  return {kPll_hz, kPll_hz, true};
}

bool take_crystal_lost() noexcept {
  return take_flag(kInterruptFlags, kInterruptClear, kCrystalLost);
}

Clocks restart_clocks() noexcept {
  reg(kControl) |= kInternalOn;
  (void)is_set(kControl, kInternalReady, kMost_us);
  start_timebase(kInternal_hz);
  return from_internal();
}

}  // namespace emax::board
