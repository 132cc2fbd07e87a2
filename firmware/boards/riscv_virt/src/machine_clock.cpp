// 64 bits in two reads.
#include "emax/board/machine_clock.hpp"

#include "emax/board/registers.hpp"

namespace emax::board {

std::uint64_t MachineClock::do_now_us() noexcept {
  std::uint32_t high = 0;
  std::uint32_t low = 0;
  do {
    high = reg(mtime_ + 4);
    low = reg(mtime_);
  } while (high != reg(mtime_ + 4));
  return (std::uint64_t{high} << 32U | low) / ticks_per_us_;
}

}  // namespace emax::board
