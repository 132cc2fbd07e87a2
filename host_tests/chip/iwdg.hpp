// The independent watchdog and its slow clock.
#pragma once

#include <functional>

#include "chip/rcc.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

/// Found here: "watchdog_wrong_key", "watchdog_locked", "watchdog_updating".
class Iwdg final : public RegisterBlock {
 public:
  Iwdg(Context context, Rcc& rcc, Registers registers)
      : RegisterBlock(context, "IWDG", std::move(registers)), rcc_(rcc) {}

  void on_bite(std::function<void()> action) { bite_ = std::move(action); }
  bool runs() const { return runs_; }
  /// Until it bites, if nobody kicks it.
  double period_s() const;
  /// The clock is that of an oscillator without a crystal.
  double lsi_hz = kLsi_hz;

 private:
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;
  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  unsigned widths(std::uint32_t) const override { return 2 + 4; }
  void write_key(std::uint32_t value);
  void kick();

  Rcc& rcc_;
  std::function<void()> bite_;
  bool runs_ = false;
  bool open_ = false;
  Time updated_at_[3] = {};
  Events::Id event_ = 0;
};

}  // namespace emax::chip
