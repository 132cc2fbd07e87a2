// The frequencies of the chip, and what supply and flash allow.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "chip/events.hpp"
#include "chip/findings.hpp"

namespace emax::chip {

inline constexpr std::uint32_t kHsi_hz = 16'000'000;
inline constexpr std::uint32_t kHse_hz = 24'000'000;  ///< The board's crystal.
inline constexpr std::uint32_t kLsi_hz = 32'000;

/// Time of some cycles of a clock.
constexpr Time cycles_of(std::uint64_t cycles, std::uint32_t clock_hz) {
  return clock_hz == 0 ? kNever / 2 : cycles * kTicksPerSecond / clock_hz;
}

/// Found here: "too_few_wait_states", "too_fast_for_voltage".
class Clocks {
 public:
  explicit Clocks(Findings& findings) : findings_(findings) {}

  std::uint32_t sysclk_hz = kHsi_hz;
  std::uint32_t hclk_hz = kHsi_hz;
  std::uint32_t pclk1_hz = kHsi_hz;
  std::uint32_t pclk2_hz = kHsi_hz;
  std::uint32_t timer1_hz = kHsi_hz;  ///< Of the timers at APB1.
  std::uint32_t pll_p_hz = 0;         ///< Zero: off.
  std::uint32_t lpuart_hz = kHsi_hz;
  std::uint32_t adc_async_hz = 0;  ///< What RCC hands to ADC1 and ADC2; zero: nothing.
  unsigned voltage_range = 1;
  bool boost = false;
  unsigned wait_states = 0;

  /// Everybody who counts time hears of a change.
  void on_change(std::function<void()> listener) { listeners_.push_back(std::move(listener)); }
  void changed();
  /// Looks whether flash and supply are fast enough for HCLK.
  void check_speed();

 private:
  Findings& findings_;
  std::vector<std::function<void()>> listeners_;
};

}  // namespace emax::chip
