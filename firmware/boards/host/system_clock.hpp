// The time of the PC as the instrument reads it.
#pragma once

#include <chrono>
#include <cstdint>

#include "emax/hal/clock.hpp"

namespace emax::host {

class SystemClock final : public hal::Clock {
 public:
  SystemClock() noexcept : Clock(1), start_(std::chrono::steady_clock::now()) {}

 private:
  std::uint64_t do_now_us() noexcept override {
    const auto elapsed = std::chrono::steady_clock::now() - start_;
    return static_cast<std::uint64_t>(
        std::chrono::duration_cast<std::chrono::microseconds>(elapsed).count());
  }

  std::chrono::steady_clock::time_point start_;
};

}  // namespace emax::host
