#include "chip/pwr_g4.hpp"

#include "chip/stm32g474_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCr1 = 0x00, kSr2 = 0x14, kCr5 = 0x80;
constexpr std::uint32_t kChanging = 1U << 10;
const Time kRegulator = ticks(20e-6);

}  // namespace

PwrG4::PwrG4(Context context, Clocks& clocks)
    : RegisterBlock(context, "PWR", g474::pwr_registers()), clocks_(clocks) {}

void PwrG4::on_reset() { update(); }

void PwrG4::update() {
  clocks_.voltage_range = field(stored(kCr1), 9, 2);
  clocks_.boost = !has(kCr5, 1U << 8);
  clocks_.check_speed();
}

void PwrG4::on_write(std::uint32_t offset, std::uint32_t value) {
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
