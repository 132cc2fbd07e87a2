// Wraps and ticks of TIM2.
#include "emax/board/stm32_clock.hpp"

#include "emax/board/registers.hpp"
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kInterruptEnable = kTimebase + 0x0C;
constexpr std::uintptr_t kStatus = kTimebase + 0x10;
constexpr std::uintptr_t kCompare1 = kTimebase + 0x34;

constexpr std::uint32_t kUpdate = 1U << 0;
constexpr std::uint32_t kCompare1Match = 1U << 1;
constexpr std::uint32_t kFlags = kUpdate | kCompare1Match;

}  // namespace

void Stm32Clock::start() noexcept {
  reg(kCompare1) = timebase_us() + kTick_us;
  reg(kStatus) = 0;
  reg(kInterruptEnable) = kFlags;
}

bool Stm32Clock::on_interrupt() noexcept {
  // Writing 0 clears a flag; one that comes meanwhile stays, as 1 leaves it as it is.
  const std::uint32_t status = reg(kStatus) & kFlags;
  reg(kStatus) = kFlags & ~status;
  if ((status & kUpdate) != 0) {
    wraps_.store(wraps_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  if ((status & kCompare1Match) == 0) {
    return false;
  }
  reg(kCompare1) = timebase_us() + kTick_us;
  return true;
}

std::uint64_t Stm32Clock::do_now_us() noexcept {
  // Should the interrupt be late, this is one turn of the timer behind, and `Clock` stands still.
  std::uint32_t wraps = 0;
  std::uint32_t passed_us = 0;
  do {
    wraps = wraps_.load(std::memory_order_acquire);
    passed_us = timebase_us();
  } while (wraps != wraps_.load(std::memory_order_acquire));
  return std::uint64_t{wraps} << 32U | passed_us;
}

}  // namespace emax::board
