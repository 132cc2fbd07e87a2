#include "chip/gpio.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kIdr = 0x10, kOdr = 0x14, kBsrr = 0x18;
constexpr std::uint32_t kBrr = 0x28;  // Not in every chip.

}  // namespace

void Gpio::set_input(unsigned pin, bool high) {
  inputs_ = (inputs_ & ~(1U << pin)) | std::uint32_t{high} << pin;
}

std::uint32_t Gpio::on_read(std::uint32_t offset, std::uint32_t value) {
  if (offset != kIdr) {
    return value;
  }
  std::uint32_t seen = 0;
  for (unsigned pin = 0; pin < 16; ++pin) {
    const bool high = mode(pin) == PinMode::kOutput   ? output(pin)
                      : mode(pin) == PinMode::kAnalog ? false
                                                      : (inputs_ >> pin & 1) != 0;
    seen |= std::uint32_t{high} << pin;
  }
  return seen;
}

void Gpio::on_write(std::uint32_t offset, std::uint32_t value) {
  if (offset == kBsrr) {
    put(kOdr, (stored(kOdr) & ~(value >> 16)) | (value & 0xFFFF));
  } else if (offset == kBrr) {
    put(kOdr, stored(kOdr) & ~value);
  } else {
    put(offset, masked(offset, value));
  }
}

}  // namespace emax::chip
