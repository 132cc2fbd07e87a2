// The microseconds that every wait on hardware is bounded by.
#pragma once

#include <cstdint>

#include "emax/board/registers.hpp"

namespace emax::board {

/// TIM2, 32 bits wide and at this address on every STM32 that has it.
inline constexpr std::uintptr_t kTimebase = 0x40000000;

/// Sets the timebase to microseconds and starts it, once its clock is on; again when that has
/// changed, and then it goes on from where it is.
///
/// @param[in] clock_hz What the timer counts: whole megahertz, 1 to 65536 of them.
void start_timebase(std::uint32_t clock_hz) noexcept;

/// Microseconds, modulo 2^32.
inline std::uint32_t timebase_us() noexcept { return reg(kTimebase + 0x24); }

/// A stop for loops that wait: when the time is over, or, should the timebase stand still, after so
/// many looks that it must be.
class Deadline {
 public:
  explicit Deadline(std::uint32_t most_us) noexcept
      : begin_us_(timebase_us()),
        most_us_(most_us),
        most_looks_(kFewLooks + most_us * kMostLooksPer_us) {}

  /// @returns True once more than the time has passed. One look.
  bool passed() noexcept {
    ++looks_;
    return timebase_us() - begin_us_ > most_us_ || looks_ > most_looks_;
  }

 private:
  // A look, which reads a register, takes more than four cycles, of a processor that may still be
  // far from its full speed.
  static constexpr std::uint32_t kMostLooksPer_us = EMAX_BOARD_CLOCK_HZ / 4'000'000;
  static constexpr std::uint32_t kFewLooks = 1000;

  const std::uint32_t begin_us_;
  const std::uint32_t most_us_;
  const std::uint32_t most_looks_;
  std::uint32_t looks_ = 0;
};

/// Looks until a condition holds. @returns False if it did not within this time.
template <typename Condition>
bool wait_for(const Condition& holds, std::uint32_t most_us) noexcept {
  Deadline deadline(most_us);
  while (!holds()) {
    if (deadline.passed()) {
      return holds();
    }
  }
  return true;
}

/// Lets at least this time pass.
inline void pause_us(std::uint32_t least_us) noexcept {
  Deadline deadline(least_us);
  while (!deadline.passed()) {
  }
}

}  // namespace emax::board
