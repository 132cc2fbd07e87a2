// Power control of the STM32H743: the supply, which is chosen once, and the core's voltage.
#pragma once

#include <functional>
#include <utility>

#include "chip/clocks.hpp"
#include "chip/rcc_h7.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

/// Found here: "supply_set_twice", "supply_wrong", "supply_not_set", "voltage_scale_reserved",
/// "overdrive_not_allowed".
class PwrH7 final : public RegisterBlock {
 public:
  PwrH7(Context context, Clocks& clocks, RccH7& rcc);

  /// The core has no supply any more.
  void on_power_lost(std::function<void()> action) { lost_ = std::move(action); }
  /// Only power makes the choice of the supply free again.
  void forget_supply() { supply_ = 0; }
  /// SYSCFG_PWRCR.ODEN, which makes scale 0 of scale 1.
  void set_overdrive(bool on, Revision revision);

 private:
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;
  void write_supply(std::uint32_t value);
  void write_scale(std::uint32_t value);
  void change_voltage(bool faster, const std::function<void()>& arrive);

  Clocks& clocks_;
  RccH7& rcc_;
  std::function<void()> lost_;
  std::uint32_t supply_ = 0;  ///< As it was written; zero: not yet.
  Events::Id change_ = 0;
};

}  // namespace emax::chip
