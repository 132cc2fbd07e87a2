// The machine timer of RISC-V as the clock.
#pragma once

#include <cstdint>

#include "emax/hal/clock.hpp"

namespace emax::board {

/// Reads `mtime`, 64 bits that start at 0 with the machine.
class MachineClock final : public hal::Clock {
 public:
  /// @param[in] mtime Address of the register.
  /// @param[in] ticks_per_us 1 or more.
  constexpr MachineClock(std::uintptr_t mtime, std::uint32_t ticks_per_us) noexcept
      : Clock(1), mtime_(mtime), ticks_per_us_(ticks_per_us) {}

 private:
  std::uint64_t do_now_us() noexcept override;

  const std::uintptr_t mtime_;
  const std::uint32_t ticks_per_us_;
};

}  // namespace emax::board
