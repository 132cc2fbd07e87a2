// Registers as in the Cortex-M System Design Kit Technical Reference Manual (DDI 0479), 4.4.
#include "emax/board/cmsdk_clock.hpp"

#include "emax/board/registers.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kControl = 0x00;
constexpr std::uintptr_t kValue = 0x04;
constexpr std::uintptr_t kReload = 0x08;
constexpr std::uintptr_t kInterruptClear = 0x0C;

constexpr std::uint32_t kEnableWithInterrupt = 0x9;
constexpr std::uint32_t kMaxCount = 0xFFFFFFFF;

}  // namespace

void CmsdkClock::start() noexcept {
  reg(base_ + kReload) = kMaxCount;
  reg(base_ + kValue) = kMaxCount;
  reg(base_ + kControl) = kEnableWithInterrupt;
}

void CmsdkClock::on_wrap() noexcept {
  reg(base_ + kInterruptClear) = 1;
  wraps_.store(wraps_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

std::uint64_t CmsdkClock::do_now_us() noexcept {
  // Should the interrupt be late, this is one turn of the timer behind, and `Clock` stands still.
  std::uint32_t wraps = 0;
  std::uint32_t passed = 0;
  do {
    wraps = wraps_.load(std::memory_order_acquire);
    passed = kMaxCount - reg(base_ + kValue);
  } while (wraps != wraps_.load(std::memory_order_acquire));
  return (std::uint64_t{wraps} << 32U | passed) / cycles_per_us_;
}

}  // namespace emax::board
