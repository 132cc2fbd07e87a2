// A mark in memory that a reset leaves alone.
#include "emax/board/reset_cause.hpp"

#include <cstdint>

namespace emax::board {
namespace {

constexpr std::uint32_t kWatchdogMark = 0x57D06B17;

// The complement tells the mark from what power-on happens to leave.
struct Cause {
  std::uint32_t mark;
  std::uint32_t complement;
};
[[gnu::section(".noinit")]] Cause cause;

}  // namespace

void remember_watchdog_reset() noexcept { cause = {kWatchdogMark, ~kWatchdogMark}; }

bool take_watchdog_reset() noexcept {
  const bool is_marked = cause.mark == kWatchdogMark && cause.complement == ~kWatchdogMark;
  cause = {0, 0};
  return is_marked;
}

}  // namespace emax::board
