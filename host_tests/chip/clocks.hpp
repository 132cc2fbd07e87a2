// The frequencies of the chip, and what supply and flash allow.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "chip/events.hpp"
#include "chip/findings.hpp"

namespace emax::chip {

inline constexpr std::uint32_t kLsi_hz = 32'000;

/// Time of some cycles of a clock, rounded down.
constexpr Time cycles_of(std::uint64_t cycles, std::uint32_t clock_hz) {
  return clock_hz == 0 ? kNever / 2
                       : cycles * (kTicksPerSecond / clock_hz) +
                             cycles * (kTicksPerSecond % clock_hz) / clock_hz;
}

/// Of one chip or the other; what is found at a speed depends on the chip.
class Clocks {
 public:
  /// What supply and flash allow at the clocks as they are.
  using Rule = std::function<void(const Clocks&, Findings&)>;

  Clocks(Findings& findings, std::uint32_t start_hz, Rule rule)
      : cpu_hz(start_hz),
        sysclk_hz(start_hz),
        hclk_hz(start_hz),
        pclk1_hz(start_hz),
        pclk2_hz(start_hz),
        timer1_hz(start_hz),
        uart_hz(start_hz),
        findings_(findings),
        rule_(std::move(rule)) {}

  std::uint32_t cpu_hz;
  std::uint32_t sysclk_hz;
  std::uint32_t hclk_hz;  ///< Of buses and memories; the processor may be faster.
  std::uint32_t pclk1_hz;
  std::uint32_t pclk2_hz;
  std::uint32_t timer1_hz;         ///< Of the timers at APB1.
  std::uint32_t uart_hz;           ///< Of the console.
  std::uint32_t adc_async_hz = 0;  ///< What RCC hands to ADC1 and ADC2; zero: nothing.
  unsigned voltage_range = 1;      ///< The chip's own number for it.
  bool boost = false;
  unsigned wait_states = 0;
  unsigned write_delay = 0;  ///< WRHIGHFREQ, where there is one.

  /// Everybody who counts time hears of a change.
  void on_change(std::function<void()> listener) { listeners_.push_back(std::move(listener)); }
  void changed() {
    check_speed();
    for (const auto& listener : listeners_) {
      listener();
    }
  }
  /// Looks whether flash and supply are fast enough.
  void check_speed() { rule_(*this, findings_); }

 private:
  Findings& findings_;
  Rule rule_;
  std::vector<std::function<void()>> listeners_;
};

}  // namespace emax::chip
