// The watchdog of Arm's Cortex-M System Design Kit.
#pragma once

#include <cstdint>

#include "emax/hal/watchdog.hpp"

namespace emax::board {

/// At the end of the first period it raises the interrupt that cannot be masked, which leads the
/// drive to zero, reports where the program hangs, and resets the board; should that fail, it
/// resets the board itself after the second one.
class CmsdkWatchdog final : public hal::Watchdog {
 public:
  /// @param[in] base Of its registers.
  /// @param[in] period_us At most 2^32/cycles_per_us.
  constexpr CmsdkWatchdog(std::uintptr_t base, std::uint32_t cycles_per_us,
                          std::uint32_t period_us) noexcept
      : Watchdog(period_us), base_(base), cycles_per_us_(cycles_per_us) {}

  /// For startup, which knows the cause of the last reset.
  void set_cause(bool caused_reset) noexcept { caused_reset_ = caused_reset; }

 private:
  Status do_start() noexcept override;
  void do_kick() noexcept override;
  bool do_caused_reset() const noexcept override { return caused_reset_; }

  const std::uintptr_t base_;
  const std::uint32_t cycles_per_us_;
  bool caused_reset_ = false;
};

}  // namespace emax::board
