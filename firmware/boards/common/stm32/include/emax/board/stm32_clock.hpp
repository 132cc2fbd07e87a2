// The timebase of an STM32 as the clock, and a tick of it for the LED.
#pragma once

#include <atomic>
#include <cstdint>

#include "emax/hal/clock.hpp"

namespace emax::board {

/// Microseconds of `timebase.hpp`; the interrupt carries them past 32 bits, every 72 minutes.
class Stm32Clock final : public hal::Clock {
 public:
  static constexpr std::uint32_t kTick_us = 100'000;

  constexpr Stm32Clock() noexcept : Clock(1) {}

  /// The timebase runs. Lets its interrupts come: at each wrap, and every tick.
  void start() noexcept;

  /// For the interrupt. @returns True at a tick.
  bool on_interrupt() noexcept;

 private:
  std::uint64_t do_now_us() noexcept override;

  std::atomic<std::uint32_t> wraps_ = 0;
};

}  // namespace emax::board
