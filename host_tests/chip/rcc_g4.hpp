// Clock tree of the STM32G4: sources, PLL, prescalers, clock security.
#pragma once

#include "chip/rcc.hpp"

namespace emax::chip {

inline constexpr std::uint32_t kHsi_hz = 16'000'000;

/// Found here: "too_few_wait_states", "too_fast_for_voltage".
void check_speed_g4(const Clocks& clocks, Findings& findings);

/// Found here: "pll_changed_while_on", "pll_input_out_of_range", "vco_out_of_range",
/// "pll_without_source", "pll_output_off", "clock_source_switched_off", "switch_to_dead_clock",
/// "clock_step_too_big", "clock_step_too_soon", "clock_lost".
class RccG4 final : public Rcc {
 public:
  RccG4(Context context, Clocks& clocks);

 private:
  void write_own(std::uint32_t offset, std::uint32_t value) override;
  void update() override;
  bool pll_takes_hse() const override;
  unsigned used_clock() const override;
  void use_hsi() override;

  void write_control(std::uint32_t value);
  void start_source(std::uint32_t on, std::uint32_t ready, bool works, Time delay);
  void check_pll() const;
  std::uint32_t pll_source_hz() const;
  void write_configuration(std::uint32_t value);
  void switch_done();
  std::uint32_t source_hz(unsigned choice) const;

  Time switched_at_ = 0;
};

}  // namespace emax::chip
