// Time since the board started.
#pragma once

#include <cstdint>

namespace emax::hal {

/// A clock that never goes back and lasts for 584 000 years.
class Clock {
 public:
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;

  /// @returns Microseconds since a fixed moment before the first call, rounded down. Never less
  ///          than before: if the board's count goes back, the time stands still until the count
  ///          has caught up. Not from an interrupt: the object remembers the last time.
  std::uint64_t now_us() noexcept;

  /// @returns The greatest step of the time that is read, in microseconds; 1 or more.
  std::uint32_t resolution_us() const noexcept { return resolution_us_; }

 protected:
  constexpr explicit Clock(std::uint32_t resolution_us) noexcept : resolution_us_(resolution_us) {}
  ~Clock() = default;

 private:
  /// Reads the board's count, which has been carried past the width of its register. Does not wait.
  virtual std::uint64_t do_now_us() noexcept = 0;

  const std::uint32_t resolution_us_;
  std::uint64_t last_us_ = 0;
};

}  // namespace emax::hal
