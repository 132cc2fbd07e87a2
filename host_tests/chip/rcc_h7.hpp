// Clock tree of the STM32H743: sources, PLL1, prescalers of its domains, clock security.
#pragma once

#include "chip/rcc.hpp"

namespace emax::chip {

/// Two revisions of the silicon; their rules differ.
enum class Revision { kY, kV };

/// Found here: "too_few_wait_states", "flash_write_delay", "too_fast_for_voltage".
void check_speed_h7(const Clocks& clocks, Findings& findings);

/// PLL2 and PLL3, and what is made of them, are not modelled.
///
/// Found here: "pll_changed_while_on", "pll_input_out_of_range", "pll_range_wrong",
/// "vco_out_of_range", "pll_output_divider", "pll_without_source", "pll_output_off",
/// "clock_source_switched_off", "switch_to_dead_clock", "hse_not_bypassed",
/// "backup_domain_locked", "clock_lost".
class RccH7 final : public Rcc {
 public:
  RccH7(Context context, Clocks& clocks);
  void set_revision(Revision revision) { revision_ = revision; }
  /// PWR_CR1.DBP lets through what is written to BDCR.
  void set_backup_open(bool open) { backup_open_ = open; }

 private:
  void write_own(std::uint32_t offset, std::uint32_t value) override;
  void update() override;
  bool pll_takes_hse() const override;
  unsigned used_clock() const override;
  void use_hsi() override;

  void write_control(std::uint32_t value);
  void start(std::uint32_t on, std::uint32_t ready, Time delay);
  void write_pll(std::uint32_t offset, std::uint32_t value);
  void write_configuration(std::uint32_t value);
  void write_backup(std::uint32_t value);
  std::uint32_t keep_what_is_used(std::uint32_t old, std::uint32_t next);
  std::uint32_t pll_input_hz() const;
  void check_pll() const;
  std::uint32_t source_hz(unsigned choice) const;

  Revision revision_ = Revision::kV;
  bool backup_open_ = false;
};

}  // namespace emax::chip
