// Reset and clock control, as far as all chips have it: gates, resets of blocks, why there was a
// reset. The clock tree is the chip's own.
#pragma once

#include <cstdint>
#include <vector>

#include "chip/clocks.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

/// Why the chip starts; bits of the register that tells.
struct ResetCauses {
  std::uint32_t power_on;
  std::uint32_t pin;
  std::uint32_t software;  ///< The chip pulls its own pin, too.
  std::uint32_t watchdog;
};

class Rcc : public RegisterBlock {
 public:
  /// Bit of an enable register that is the clock of a block, and of its register of resets.
  void attach(std::uint32_t enable_offset, unsigned bit, RegisterBlock& block) {
    gated_.push_back({enable_offset, bit, &block.gate(), &block});
  }
  /// The same for a memory.
  void attach(std::uint32_t enable_offset, unsigned bit, Gate& gate) {
    gated_.push_back({enable_offset, bit, &gate, nullptr});
  }
  /// Hears of each change of a gate.
  void on_gates(std::function<void()> action) { gates_changed_ = std::move(action); }

  const ResetCauses& cause_bits() const { return map_.causes; }
  void note_reset(std::uint32_t cause) { causes_ |= cause; }
  void forget_causes() { causes_ = 0; }
  std::uint32_t causes() const { return causes_; }

  bool lsi_runs() const { return has(map_.slow_clock, 2) || watchdog_runs_; }
  void set_watchdog_runs(bool runs) { watchdog_runs_ = runs; }

  /// Test: the external clock does not start, or stops.
  void set_hse_dead(bool dead);

 protected:
  /// The clock control register of all, and what of it is the same in all.
  static constexpr std::uint32_t kCr = 0x00;
  static constexpr std::uint32_t kHseOn = 1U << 16, kHseReady = 1U << 17;
  static constexpr std::uint32_t kSecurity = 1U << 19;
  static constexpr std::uint32_t kPllOn = 1U << 24, kPllReady = 1U << 25;

  /// Where a chip has what all have.
  struct Map {
    std::uint32_t hsi;  ///< HSION and HSIRDY.
    std::uint32_t flags, security_flag;
    std::uint32_t first_enable, last_enable;
    std::uint32_t reset_below;  ///< An enable register's offset less that of its resets.
    std::uint32_t slow_clock;   ///< LSION in bit 0, LSIRDY in bit 1.
    std::uint32_t cause_register, cause_mask, forget;
    ResetCauses causes;
  };

  Rcc(Context context, Clocks& clocks, Registers registers, const Map& map)
      : RegisterBlock(context, "RCC", std::move(registers)), clocks_(clocks), map_(map) {}

  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;

  /// Registers that are the chip's own.
  virtual void write_own(std::uint32_t offset, std::uint32_t value) = 0;
  virtual void update() = 0;
  virtual bool pll_takes_hse() const = 0;
  /// What the system clock comes from: 2 for HSE, 3 for the PLL.
  virtual unsigned used_clock() const = 0;
  virtual void use_hsi() = 0;
  void write_slow_clock(std::uint32_t value);

  Clocks& clocks_;
  bool hse_dead_ = false;

 private:
  struct Gated {
    std::uint32_t offset;
    unsigned bit;
    Gate* gate;
    RegisterBlock* block;  ///< Null for a memory.
  };
  void write_gates(std::uint32_t offset, std::uint32_t value);
  void write_resets(std::uint32_t offset, std::uint32_t value);

  Map map_;
  std::vector<Gated> gated_;
  std::function<void()> gates_changed_;
  std::uint32_t causes_ = 0;
  bool watchdog_runs_ = false;
};

constexpr unsigned ahb_divider(std::uint32_t code) {
  constexpr unsigned kDividers[] = {2, 4, 8, 16, 64, 128, 256, 512};
  return code < 8 ? 1 : kDividers[code - 8];
}
constexpr unsigned apb_divider(std::uint32_t code) { return code < 4 ? 1 : 2U << (code - 4); }

}  // namespace emax::chip
