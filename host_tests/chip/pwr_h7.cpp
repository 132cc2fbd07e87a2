#include "chip/pwr_h7.hpp"

#include "chip/stm32h743_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCr1 = 0x00, kCsr1 = 0x04, kCr3 = 0x0C, kD3cr = 0x18;
constexpr std::uint32_t kBypass = 1, kRegulator = 2, kUpdate = 4, kSupply = 7;
constexpr std::uint32_t kReady = 1U << 13;
const Time kVoltageTime = ticks(20e-6);

/// VOS 3 is scale 1, VOS 1 is scale 3.
unsigned scale_of(std::uint32_t register_value) { return 4 - field(register_value, 14, 2); }

}  // namespace

PwrH7::PwrH7(Context context, Clocks& clocks, RccH7& rcc)
    : RegisterBlock(context, "PWR", h743::pwr_registers()), clocks_(clocks), rcc_(rcc) {}

void PwrH7::on_reset() {
  change_ = 0;
  if (supply_ != 0) {
    put(kCr3, (stored(kCr3) & ~kSupply) | (supply_ & kSupply));
    set_bits(kCsr1, kReady);
  }
  set_bits(kD3cr, kReady);
  clocks_.voltage_range = 3;
  clocks_.boost = false;
  rcc_.set_backup_open(false);
  clocks_.check_speed();
}

void PwrH7::write_supply(std::uint32_t value) {
  if (supply_ != 0) {
    if ((value & kSupply) != (supply_ & kSupply)) {
      report("supply_set_twice", kCr3, value);  // And stays as it is.
    }
    put(kCr3, (masked(kCr3, value) & ~kSupply) | (supply_ & kSupply));
    return;
  }
  put(kCr3, masked(kCr3, value));
  supply_ = 0x80000000 | (value & kSupply);
  // This chip has no step-down converter: nothing but its regulator supplies the core.
  if ((value & kRegulator) == 0 || (value & kBypass) != 0) {
    report("supply_wrong", kCr3, value);
    lost_();
    return;
  }
  if ((value & kUpdate) != 0) {
    report("supply_not_set", kCr3, value);  // SCUEN stays: the choice is not taken over.
    supply_ = 0;
    return;
  }
  context_.events.after(kVoltageTime, [this] { set_bits(kCsr1, kReady); });
}

// A lower voltage counts at once, a higher one when it is there.
void PwrH7::change_voltage(bool higher, const std::function<void()>& arrive) {
  clear_bits(kD3cr, kReady);
  context_.events.cancel(change_);
  if (!higher) {
    arrive();
  }
  change_ = context_.events.after(kVoltageTime, [this, higher, arrive] {
    change_ = 0;
    if (higher) {
      arrive();
    }
    set_bits(kD3cr, kReady);
  });
}

void PwrH7::write_scale(std::uint32_t value) {
  if (field(value, 14, 2) == 0) {
    report("voltage_scale_reserved", kD3cr, value);
    return;
  }
  if (!has(kCsr1, kReady)) {
    report("supply_not_set", kD3cr, value);
    return;
  }
  const unsigned old = scale_of(stored(kD3cr)), scale = scale_of(value);
  put(kD3cr, masked(kD3cr, value));
  if (scale == old) {
    return;
  }
  change_voltage(scale < old, [this, scale] {
    clocks_.voltage_range = scale;
    put(kCsr1, (stored(kCsr1) & ~0xC000U) | (4 - scale) << 14);
    clocks_.check_speed();
  });
}

void PwrH7::set_overdrive(bool on, Revision revision) {
  if (on && (revision == Revision::kY || clocks_.voltage_range != 1)) {
    context_.findings.report("overdrive_not_allowed", "SYSCFG.PWRCR", on);
    return;
  }
  if (on != clocks_.boost) {
    change_voltage(on, [this, on] {
      clocks_.boost = on;
      clocks_.check_speed();
    });
  }
}

void PwrH7::on_write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kCr3:
      write_supply(value);
      break;
    case kD3cr:
      write_scale(value);
      break;
    case kCr1:
      put(offset, masked(offset, value));
      rcc_.set_backup_open((value >> 8 & 1) != 0);
      break;
    default:
      put(offset, masked(offset, value));
      break;
  }
}

}  // namespace emax::chip
