// The contract of the clock, checked once for all boards.
#include "emax/hal/clock.hpp"

#include <algorithm>

namespace emax::hal {

std::uint64_t Clock::now_us() noexcept {
  last_us_ = std::max(last_us_, do_now_us());
  return last_us_;
}

}  // namespace emax::hal
