// The contract of the watchdog, checked once for all boards.
#include "emax/hal/watchdog.hpp"

namespace emax::hal {

Status Watchdog::start() noexcept {
  if (running_) {
    return Status::kAlreadyRunning;
  }
  if (period_us_ == 0 || do_start() != Status::kOk) {
    return Status::kHardwareFault;
  }
  running_ = true;
  return Status::kOk;
}

void Watchdog::kick() noexcept {
  if (running_) {
    do_kick();
  }
}

}  // namespace emax::hal
