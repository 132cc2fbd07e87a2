// One port of pins.
#pragma once

#include <string>
#include <utility>

#include "chip/register_block.hpp"

namespace emax::chip {

enum class PinMode { kInput, kOutput, kAlternate, kAnalog };

class Gpio final : public RegisterBlock {
 public:
  Gpio(Context context, char letter, Registers registers)
      : RegisterBlock(context, std::string("GPIO") + letter, std::move(registers)) {}

  PinMode mode(unsigned pin) const { return static_cast<PinMode>(field(get(0x00), 2 * pin, 2)); }
  unsigned alternate(unsigned pin) const {
    return field(get(pin < 8 ? 0x20 : 0x24), 4 * (pin % 8), 4);
  }
  bool output(unsigned pin) const { return (get(0x14) >> pin & 1) != 0; }
  /// What is connected to a pin from outside.
  void set_input(unsigned pin, bool high);

 private:
  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  unsigned widths(std::uint32_t) const override { return 1 + 2 + 4; }

  std::uint32_t inputs_ = 0;
};

}  // namespace emax::chip
