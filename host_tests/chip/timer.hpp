// Timers that count up: TIM2 with its compare flags, TIM6 and TIM7.
#pragma once

#include <functional>
#include <vector>

#include "chip/clocks.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

/// Found here: "not_modelled" for modes that are not.
class Timer final : public RegisterBlock {
 public:
  enum class Kind { kBasic, kGeneral };

  Timer(Context context, Clocks& clocks, const std::string& name, Kind kind, Registers registers,
        unsigned interrupt_line);

  /// What hears of each update that goes out as a trigger (CR2.MMS = 2).
  void on_trigger(std::function<void()> listener) { listeners_.push_back(std::move(listener)); }
  bool runs() const { return has(0x00, 1); }
  /// From one update to the next.
  double period_s() const;

 private:
  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;
  unsigned widths(std::uint32_t) const override { return 2 + 4; }

  std::uint64_t tick_cycles() const { return std::uint64_t{prescaler_} + 1; }
  std::uint32_t count() const;
  /// Takes the count as it is now as the start of a new stretch, and asks for what comes next.
  void settle(std::uint32_t count);
  void arm();
  void update(bool by_counter);
  void compare(std::uint32_t count);
  void refresh_line();
  void settings_changed(std::uint32_t offset, std::uint32_t value);

  Clocks& clocks_;
  Kind kind_;
  unsigned line_;
  std::vector<std::function<void()>> listeners_;
  std::uint32_t prescaler_ = 0;  ///< In use; the register's becomes so with the next update.
  std::uint32_t reload_ = 0;
  std::uint32_t start_count_ = 0;
  Time start_ = 0;
  std::uint32_t clock_hz_ = 0;  ///< Zero: stands.
  Events::Id event_ = 0;
};

}  // namespace emax::chip
