// A watchdog in virtual time that only notes that it would have reset the board.
#pragma once

#include <cstdint>

#include "emax/hal/watchdog.hpp"

namespace emax::test {

class ManualWatchdog final : public hal::Watchdog {
 public:
  constexpr explicit ManualWatchdog(std::uint32_t period_us, bool caused_reset = false) noexcept
      : Watchdog(period_us), caused_reset_(caused_reset) {}

  void break_down() { works_ = false; }
  void wait_us(std::uint64_t time_us) {
    time_us_ += time_us;
    bitten_ = bitten_ || (running() && time_us_ - kicked_us_ >= period_us());
  }
  /// Whether the board would have been reset.
  bool bitten() const { return bitten_; }

  ManualWatchdog& watchdog() { return *this; }

 private:
  Status do_start() noexcept override {
    kicked_us_ = time_us_;
    return works_ ? Status::kOk : Status::kHardwareFault;
  }
  void do_kick() noexcept override { kicked_us_ = time_us_; }
  bool do_caused_reset() const noexcept override { return caused_reset_; }

  std::uint64_t time_us_ = 0;
  std::uint64_t kicked_us_ = 0;
  bool bitten_ = false;
  bool works_ = true;
  bool caused_reset_;
};

}  // namespace emax::test
