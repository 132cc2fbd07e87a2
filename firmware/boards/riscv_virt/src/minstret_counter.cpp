// The counter of retired instructions that every RISC-V core has.
#include "emax/board/instruction_counter.hpp"

namespace emax::cost {

void start_counter() noexcept {}

Ticks now() noexcept {
  std::uint32_t high = 0;
  std::uint32_t low = 0;
  std::uint32_t high_again = 0;
  do {
    asm volatile(
        "csrr %0, minstreth\n"
        "csrr %1, minstret\n"
        "csrr %2, minstreth"
        : "=r"(high), "=r"(low), "=r"(high_again)::"memory");
  } while (high != high_again);
  return std::uint64_t{high} << 32U | low;
}

Ticks passed(Ticks from, Ticks to) noexcept { return to - from; }

std::uint64_t instructions_of(Ticks ticks) noexcept { return ticks; }

}  // namespace emax::cost
