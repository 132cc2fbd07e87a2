// TIM2 as a counter of microseconds.
#include "emax/board/timebase.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kControl1 = kTimebase + 0x00;
constexpr std::uintptr_t kStatus = kTimebase + 0x10;
constexpr std::uintptr_t kEventGeneration = kTimebase + 0x14;
constexpr std::uintptr_t kCount = kTimebase + 0x24;
constexpr std::uintptr_t kPrescaler = kTimebase + 0x28;
constexpr std::uintptr_t kAutoReload = kTimebase + 0x2C;

constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kUpdate = 1U << 0;
constexpr std::uint32_t kMaxCount = 0xFFFFFFFF;

}  // namespace

void start_timebase(std::uint32_t clock_hz) noexcept {
  reg(kControl1) = 0;
  const std::uint32_t count = reg(kCount);
  reg(kPrescaler) = clock_hz / 1'000'000 - 1;
  reg(kAutoReload) = kMaxCount;
  // The prescaler is taken at an update only, and that begins the count anew and leaves a flag as
  // if it had wrapped.
  reg(kEventGeneration) = kUpdate;
  reg(kCount) = count;
  reg(kStatus) = 0;
  reg(kControl1) = kEnable;
}

}  // namespace emax::board
