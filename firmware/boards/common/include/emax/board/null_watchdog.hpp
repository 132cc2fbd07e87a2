// The watchdog of a machine that has none.
#pragma once

#include "emax/hal/watchdog.hpp"

namespace emax::board {

/// States a period of zero, so that `start()` answers kHardwareFault: a program that needs a
/// watchdog learns that there is none.
class NullWatchdog final : public hal::Watchdog {
 public:
  constexpr NullWatchdog() noexcept : Watchdog(0) {}

 private:
  Status do_start() noexcept override { return Status::kHardwareFault; }
  void do_kick() noexcept override {}
  bool do_caused_reset() const noexcept override { return false; }
};

}  // namespace emax::board
