#include "chip/clocks.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kMega = 1'000'000;

}  // namespace

void Clocks::changed() {
  check_speed();
  for (const auto& listener : listeners_) {
    listener();
  }
}

// The most per wait state, and the most at all (RM0440, dynamic voltage scaling).
void Clocks::check_speed() {
  const std::uint32_t per_state_hz = (voltage_range == 2 ? 12 : boost ? 34 : 30) * kMega;
  const std::uint32_t most_hz = (voltage_range == 2 ? 26 : boost ? 170 : 150) * kMega;
  if (hclk_hz > per_state_hz * (wait_states + 1)) {
    findings_.report("too_few_wait_states", "FLASH.ACR", hclk_hz);
  }
  if (hclk_hz > most_hz || sysclk_hz > most_hz) {
    findings_.report("too_fast_for_voltage", "PWR", hclk_hz);
  }
}

}  // namespace emax::chip
