// Registers as in the Cortex-M System Design Kit Technical Reference Manual (DDI 0479), 4.6.
#include "emax/board/cmsdk_watchdog.hpp"

#include "emax/board/registers.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kLoad = 0x000;
constexpr std::uintptr_t kControl = 0x008;
constexpr std::uintptr_t kInterruptClear = 0x00C;
constexpr std::uintptr_t kLock = 0xC00;

constexpr std::uint32_t kInterruptAndReset = 0x3;
constexpr std::uint32_t kUnlock = 0x1ACCE551;

}  // namespace

Status CmsdkWatchdog::do_start() noexcept {
  reg(base_ + kLock) = kUnlock;
  reg(base_ + kLoad) = period_us() * cycles_per_us_;
  // QEMU's counts from the reset on, and might have come to its end before.
  reg(base_ + kInterruptClear) = 0;
  reg(base_ + kControl) = kInterruptAndReset;
  const bool runs = reg(base_ + kControl) == kInterruptAndReset;
  reg(base_ + kLock) = 0;
  return runs ? Status::kOk : Status::kHardwareFault;
}

void CmsdkWatchdog::do_kick() noexcept {
  reg(base_ + kLock) = kUnlock;
  reg(base_ + kInterruptClear) = 0;
  reg(base_ + kLock) = 0;
}

}  // namespace emax::board
