#include "chip/pwr.hpp"

#include "chip/stm32g474_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCr1 = 0x00, kSr2 = 0x14, kCr5 = 0x80;
constexpr std::uint32_t kChanging = 1U << 10;
const Time kRegulator = ticks(20e-6);

}  // namespace

Pwr::Pwr(Context context, Clocks& clocks)
    : RegisterBlock(context, "PWR", pwr_registers()), clocks_(clocks) {}

void Pwr::on_reset() { update(); }

void Pwr::update() {
  clocks_.voltage_range = field(stored(kCr1), 9, 2);
  clocks_.boost = !has(kCr5, 1U << 8);
  clocks_.check_speed();
}

void Pwr::on_write(std::uint32_t offset, std::uint32_t value) {
  const std::uint32_t old = stored(offset);
  put(offset, masked(offset, value));
  if (offset != kCr1 && offset != kCr5) {
    return;
  }
  if (stored(offset) != old && offset == kCr1 && ((old ^ value) & 0x600) != 0) {
    set_bits(kSr2, kChanging);
    context_.events.after(kRegulator, [this] { clear_bits(kSr2, kChanging); });
  }
  update();
}

}  // namespace emax::chip
