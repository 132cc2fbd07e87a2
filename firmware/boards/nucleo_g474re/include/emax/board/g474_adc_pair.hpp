// ADC1 and ADC2 of an STM32G474, which convert both inputs at the same moments.
#pragma once

#include <cstdint>

#include "emax/base/status.hpp"

namespace emax::board {

/// Both ADCs start at the triggers of TIM6. A result of each is the mean of 32 conversions of 12
/// bits, scaled to 16 bits; both come as one word, the reference (ADC1, PA0) in the lower half, the
/// device (ADC2, PA1) in the upper one.
class G474AdcPair {
 public:
  /// Where DMA fetches both results.
  static std::uintptr_t data_register() noexcept;

  /// Switches both on and calibrates their offsets, which takes some 0.3 ms. Their DMA channel does
  /// not run.
  /// @returns kOk, or kHardwareFault if one of them does not get ready; `stop()` follows.
  Status prepare() noexcept;

  /// Lets them wait for the first trigger. Their DMA channel runs.
  void start() noexcept;

  /// Also after a start that failed halfway. @returns False if one of them does not stop.
  bool stop() noexcept;

  /// @returns True if a result was not fetched in time.
  bool has_overrun() const noexcept;
};

}  // namespace emax::board
