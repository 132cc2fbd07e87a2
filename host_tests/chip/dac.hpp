// DAC1, its first channel: holding and output register, trigger, DMA, and the pin.
#pragma once

#include <functional>
#include <utility>

#include "chip/clocks.hpp"
#include "chip/dma.hpp"
#include "chip/gpio.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

/// Found here: "dac_mode_while_enabled", "dac_hfsel", "dac_output_before_first_trigger",
/// "dac_pin_not_analog", "dac_underrun", "not_modelled".
class Dac final : public RegisterBlock {
 public:
  static constexpr double kReference_v = 3.3;

  /// What differs between chips.
  struct Kind {
    unsigned request;
    bool has_speed;    ///< MCR.HFSEL must fit the bus clock.
    bool tells_ready;  ///< SR.DAC1RDY
  };

  Dac(Context context, Clocks& clocks, DmaRequests& requests, const Gpio& port, const Kind& kind,
      Registers registers)
      : RegisterBlock(context, "DAC1", std::move(registers)),
        kind_(kind),
        clocks_(clocks),
        requests_(requests),
        port_(port) {}

  /// Hears of each change of the pin; not a number when the output is off.
  void on_output(std::function<void(double pin_v)> action) { output_ = std::move(action); }
  /// A trigger, by its number in TSEL1.
  void trigger(unsigned selection);
  bool enabled() const { return has(0x00, 1); }

 private:
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;

  void write_control(std::uint32_t value);
  void write_mode(std::uint32_t value);
  void hold(std::uint32_t code);
  void show();
  void request();
  void refresh();
  bool uses_trigger() const { return has(0x00, 2); }

  Kind kind_;
  Clocks& clocks_;
  DmaRequests& requests_;
  const Gpio& port_;
  std::function<void(double)> output_;
  std::uint32_t holding_ = 0;
  bool request_waits_ = false;
  bool underrun_ = false;  ///< Until DMAEN has been off.
};

}  // namespace emax::chip
