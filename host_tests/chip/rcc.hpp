// Reset and clock control: sources, PLL, prescalers, gates, and why there was a reset.
#pragma once

#include <functional>
#include <vector>

#include "chip/clocks.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

/// Why the chip starts; bits of RCC_CSR.
inline constexpr std::uint32_t kPowerOnReset = 0x0C000000;  ///< Brown-out and pin.
inline constexpr std::uint32_t kPinReset = 0x04000000;
inline constexpr std::uint32_t kSoftwareReset = 0x14000000;  ///< The chip pulls its own pin, too.
inline constexpr std::uint32_t kWatchdogReset = 0x24000000;

/// Found here: "pll_changed_while_on", "pll_input_out_of_range", "vco_out_of_range",
/// "pll_without_source", "pll_output_off", "clock_source_switched_off", "switch_to_dead_clock",
/// "clock_step_too_big", "clock_step_too_soon", "clock_lost".
class Rcc final : public RegisterBlock {
 public:
  Rcc(Context context, Clocks& clocks);

  /// Bit of an ENR register that is the clock of a block; the reset's bit is 0x20 below.
  void attach(std::uint32_t enable_offset, unsigned bit, RegisterBlock& block);
  void note_reset(std::uint32_t cause) { causes_ |= cause; }
  void forget_causes() { causes_ = 0; }

  bool lsi_runs() const { return has(0x94, 2) || watchdog_runs_; }
  void set_watchdog_runs(bool runs) { watchdog_runs_ = runs; }

  /// Test: the crystal does not start, or stops.
  void set_hse_dead(bool dead);

 private:
  struct Gated {
    std::uint32_t offset;
    unsigned bit;
    RegisterBlock* block;
  };

  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;

  void write_control(std::uint32_t value);
  void start_source(std::uint32_t on, std::uint32_t ready, bool works, Time delay);
  void check_pll() const;
  std::uint32_t pll_source_hz() const;
  void write_configuration(std::uint32_t value);
  void switch_done();
  std::uint32_t source_hz(unsigned choice) const;
  void update();
  void write_gates(std::uint32_t offset, std::uint32_t value);
  void write_resets(std::uint32_t offset, std::uint32_t value);

  Clocks& clocks_;
  std::vector<Gated> gated_;
  std::uint32_t causes_ = 0;
  bool watchdog_runs_ = false;
  bool hse_dead_ = false;
  Time switched_at_ = 0;
};

}  // namespace emax::chip
