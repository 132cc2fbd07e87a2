// The contract of the watchdog, checked once for all boards.
#include "emax/hal/watchdog.hpp"

namespace emax::hal {

Status Watchdog::start() noexcept {
  if (running_) {
    return Status::kAlreadyRunning;
  }
  has_begun_ = period_us_ != 0;
  running_ = has_begun_ && do_start() == Status::kOk;
  return running_ ? Status::kOk : Status::kHardwareFault;
}

void Watchdog::kick() noexcept {
  if (has_begun_) {
    do_kick();
  }
}

}  // namespace emax::hal
