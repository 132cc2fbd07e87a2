// Reads that may be answered by a fault.
#pragma once

#include <cstdint>

#include "emax/board/fault_mask.hpp"
#include "emax/board/registers.hpp"

namespace emax::board {

/// While it lives, no interrupt comes, and a read that the bus answers by a fault goes on with
/// anything (Armv7-M Architecture Reference Manual, B3.2.8: BFHFNMIGN). Short.
class IgnoredBusFaults {
 public:
  IgnoredBusFaults() noexcept {
    mask_faults();
    reg(kConfiguration) |= kIgnore;
    reg(kFaultStatus) = kBusFaults;
  }
  ~IgnoredBusFaults() {
    reg(kFaultStatus) = kBusFaults;
    reg(kConfiguration) &= ~kIgnore;
    unmask_faults();
  }
  IgnoredBusFaults(const IgnoredBusFaults&) = delete;
  IgnoredBusFaults& operator=(const IgnoredBusFaults&) = delete;

  /// @returns True if there was one so far.
  bool happened() const noexcept { return (reg(kFaultStatus) & kBusFaults) != 0; }

 private:
  static constexpr std::uintptr_t kConfiguration = 0xE000ED14;
  static constexpr std::uintptr_t kFaultStatus = 0xE000ED28;
  static constexpr std::uint32_t kIgnore = 1U << 8;
  static constexpr std::uint32_t kBusFaults = 0xFF00;  // Writing 1 clears.
};

}  // namespace emax::board
