// A clock that a test moves by hand.
#pragma once

#include <cstdint>

#include "emax/hal/clock.hpp"

namespace emax::test {

class ManualClock final : public hal::Clock {
 public:
  constexpr explicit ManualClock(std::uint32_t resolution_us = 1) noexcept : Clock(resolution_us) {}

  void wait_us(std::uint64_t time_us) { time_us_ += time_us; }
  /// As a board does whose count starts over.
  void set_us(std::uint64_t time_us) { time_us_ = time_us; }

  ManualClock& clock() { return *this; }

 private:
  std::uint64_t do_now_us() noexcept override {
    return time_us_ / resolution_us() * resolution_us();
  }

  std::uint64_t time_us_ = 0;
};

}  // namespace emax::test
