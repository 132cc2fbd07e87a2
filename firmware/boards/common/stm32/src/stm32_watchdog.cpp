// Two timers: one that warns, one that resets.
#include "emax/board/stm32_watchdog.hpp"

#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

// Of the watchdog.
constexpr std::uintptr_t kKey = 0x00;
constexpr std::uintptr_t kPrescaler = 0x04;
constexpr std::uintptr_t kReload = 0x08;
constexpr std::uintptr_t kStatus = 0x0C;
constexpr std::uint32_t kStart = 0xCCCC;
constexpr std::uint32_t kUnlock = 0x5555;
constexpr std::uint32_t kKick = 0xAAAA;
constexpr std::uint32_t kDivideBy256 = 6;
// 12 s of a clock of 32 kHz; 10.2 s should that be 15 % fast.
constexpr std::uint32_t kReloadCount = 1500;
// It takes a few periods of that clock, divided, to take over its settings.
constexpr std::uint32_t kMostTakeover_us = 100'000;

// Of the timer.
constexpr std::uintptr_t kTimerControl1 = 0x00;
constexpr std::uintptr_t kTimerInterruptEnable = 0x0C;
constexpr std::uintptr_t kTimerStatus = 0x10;
constexpr std::uintptr_t kTimerEventGeneration = 0x14;
constexpr std::uintptr_t kTimerCount = 0x24;
constexpr std::uintptr_t kTimerPrescaler = 0x28;
constexpr std::uintptr_t kTimerAutoReload = 0x2C;
constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kUpdate = 1U << 0;

constexpr std::uint32_t kTicks_hz = 5000;
constexpr std::uint32_t kWarnTicks = 41'000;
// 1 % less than these must not be less than the period that a user may rely on.
static_assert(kWarnTicks / 100 * 99 >= Stm32Watchdog::kPeriod_us / (1'000'000 / kTicks_hz));
static_assert(kWarnTicks <= 0x10000);

}  // namespace

void Stm32Watchdog::prepare(std::uint32_t clock_hz, bool caused_reset) noexcept {
  clock_hz_ = clock_hz;
  caused_reset_ = caused_reset;
}

Status Stm32Watchdog::do_start() noexcept {
  reg(timer_ + kTimerControl1) = 0;
  reg(timer_ + kTimerPrescaler) = clock_hz_ / kTicks_hz - 1;
  reg(timer_ + kTimerAutoReload) = kWarnTicks - 1;
  // The prescaler is taken at an update only, and that leaves a flag.
  reg(timer_ + kTimerEventGeneration) = kUpdate;
  reg(timer_ + kTimerStatus) = 0;
  reg(timer_ + kTimerInterruptEnable) = kUpdate;
  reg(timer_ + kTimerControl1) = kEnable;

  reg(watchdog_ + kKey) = kStart;
  reg(watchdog_ + kKey) = kUnlock;
  reg(watchdog_ + kPrescaler) = kDivideBy256;
  reg(watchdog_ + kReload) = kReloadCount;
  const bool is_taken =
      wait_for([this] { return reg(watchdog_ + kStatus) == 0; }, kMostTakeover_us);
  reg(watchdog_ + kKey) = kKick;
  const bool warns = reg(timer_ + kTimerControl1) == kEnable;
  return is_taken && warns ? Status::kOk : Status::kHardwareFault;
}

void Stm32Watchdog::do_kick() noexcept {
  reg(timer_ + kTimerCount) = 0;
  reg(watchdog_ + kKey) = kKick;
}

}  // namespace emax::board
