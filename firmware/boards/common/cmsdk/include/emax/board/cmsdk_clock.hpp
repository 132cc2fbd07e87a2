// A timer of Arm's Cortex-M System Design Kit as the clock.
#pragma once

#include <atomic>
#include <cstdint>

#include "emax/hal/clock.hpp"

namespace emax::board {

/// Counts cycles; the interrupt carries the count past 32 bits, every 172 s at 25 MHz.
class CmsdkClock final : public hal::Clock {
 public:
  /// @param[in] base Of the timer's registers.
  /// @param[in] cycles_per_us 1 or more.
  constexpr CmsdkClock(std::uintptr_t base, std::uint32_t cycles_per_us) noexcept
      : Clock(1), base_(base), cycles_per_us_(cycles_per_us) {}

  void start() noexcept;

  /// For the interrupt.
  void on_wrap() noexcept;

 private:
  std::uint64_t do_now_us() noexcept override;

  const std::uintptr_t base_;
  const std::uint32_t cycles_per_us_;
  std::atomic<std::uint32_t> wraps_ = 0;
};

}  // namespace emax::board
