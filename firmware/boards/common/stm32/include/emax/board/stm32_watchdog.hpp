// The watchdog of an STM32, and the timer that warns before it bites.
#pragma once

#include <cstdint>

#include "emax/hal/watchdog.hpp"

namespace emax::board {

/// The independent watchdog resets the board without a word. So a basic timer with the highest
/// priority of all interrupts ends first: its handler leads the drive to zero, reports where the
/// program hangs, and resets the board. The watchdog, which has a clock of its own, ends later, and
/// resets the board should all that fail.
class Stm32Watchdog final : public hal::Watchdog {
 public:
  /// The timer ends after this at 1 % of clock error, too.
  static constexpr std::uint32_t kPeriod_us = 8'000'000;

  /// @param[in] watchdog Its registers, which are the same on all STM32.
  /// @param[in] timer Of the basic timer that warns.
  constexpr Stm32Watchdog(std::uintptr_t watchdog, std::uintptr_t timer) noexcept
      : Watchdog(kPeriod_us), watchdog_(watchdog), timer_(timer) {}

  /// For startup: the clock of the timer, and the cause of the last reset.
  void prepare(std::uint32_t clock_hz, bool caused_reset) noexcept;

 private:
  Status do_start() noexcept override;
  void do_kick() noexcept override;
  bool do_caused_reset() const noexcept override { return caused_reset_; }

  const std::uintptr_t watchdog_;
  const std::uintptr_t timer_;
  std::uint32_t clock_hz_ = 0;
  bool caused_reset_ = false;
};

}  // namespace emax::board
