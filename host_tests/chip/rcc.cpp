#include "chip/rcc.hpp"

#include <utility>

namespace emax::chip {
namespace {

constexpr std::uint32_t kLsiOn = 1, kLsiReady = 2;
const Time kLsiStart = ticks(100e-6);

}  // namespace

void Rcc::on_reset() {
  watchdog_runs_ = false;
  for (const Gated& gated : gated_) {
    *gated.gate = {(stored(gated.offset) >> gated.bit & 1) != 0, false, false};
  }
  if (gates_changed_) {
    gates_changed_();
  }
  context_.wires.set(kNmi, this, false);
  update();
}

void Rcc::set_hse_dead(bool dead) {
  constexpr unsigned kFromHse = 2, kFromPll = 3;
  hse_dead_ = dead;
  if (!dead || !has(kCr, kHseReady)) {
    return;
  }
  clear_bits(kCr, kHseReady);
  const bool feeds_pll = has(kCr, kPllOn) && pll_takes_hse();
  const unsigned used = used_clock();
  const bool in_use = used == kFromHse || (used == kFromPll && feeds_pll);
  if (!has(kCr, kSecurity)) {
    if (in_use) {
      report("clock_lost", kCr);
    }
    return;
  }
  // The clock security system, RM0440 7.2.10: back to HSI, HSE and a PLL on it off, NMI.
  clear_bits(kCr, kHseOn | kSecurity | (feeds_pll ? kPllOn | kPllReady : 0));
  set_bits(kCr, map_.hsi);
  if (in_use) {
    use_hsi();
  }
  set_bits(map_.flags, map_.security_flag);
  context_.wires.set(kNmi, this, has(map_.flags, map_.security_flag));
  update();
}

std::uint32_t Rcc::on_read(std::uint32_t offset, std::uint32_t value) {
  // Reading any of these registers back takes as long as a clock needs to arrive.
  for (const Gated& gated : gated_) {
    if (gated.offset == offset) {
      gated.gate->fresh = false;
    }
  }
  if (offset == map_.slow_clock && (value & kLsiReady) != 0 && !lsi_runs()) {
    value &= ~kLsiReady;
  }
  if (offset == map_.cause_register) {
    value = (value & ~map_.forget & ~map_.cause_mask) | causes_;
  }
  return value;
}

void Rcc::on_write(std::uint32_t offset, std::uint32_t value) {
  if (offset >= map_.first_enable && offset <= map_.last_enable) {
    write_gates(offset, value);
  } else if (offset + map_.reset_below >= map_.first_enable &&
             offset + map_.reset_below <= map_.last_enable) {
    write_resets(offset, value);
  } else if (offset == map_.cause_register || offset == map_.slow_clock) {
    if (offset == map_.cause_register && (value & map_.forget) != 0) {
      causes_ = 0;
    }
    put(offset, masked(offset, value) & ~(offset == map_.cause_register ? map_.forget : 0U));
    if (offset == map_.slow_clock) {
      write_slow_clock(value);
    }
  } else {
    write_own(offset, value);
  }
}

void Rcc::write_slow_clock(std::uint32_t value) {
  if ((value & kLsiOn) != 0) {
    context_.events.after(kLsiStart, [this] { set_bits(map_.slow_clock, kLsiReady); });
  } else {
    clear_bits(map_.slow_clock, kLsiReady);
  }
}

void Rcc::write_gates(std::uint32_t offset, std::uint32_t value) {
  const std::uint32_t old = stored(offset);
  put(offset, masked(offset, value));
  for (const Gated& gated : gated_) {
    if (gated.offset != offset) {
      continue;
    }
    const bool on = (stored(offset) >> gated.bit & 1) != 0;
    gated.gate->fresh = on && ((old >> gated.bit & 1) == 0 || gated.gate->fresh);
    gated.gate->on = on;
  }
  if (gates_changed_) {
    gates_changed_();
  }
}

void Rcc::write_resets(std::uint32_t offset, std::uint32_t value) {
  put(offset, masked(offset, value));
  for (const Gated& gated : gated_) {
    if (gated.offset != offset + map_.reset_below || gated.block == nullptr) {
      continue;
    }
    const bool held = (stored(offset) >> gated.bit & 1) != 0;
    if (held && !gated.gate->in_reset) {
      gated.block->reset();
    }
    gated.gate->in_reset = held;
  }
}

}  // namespace emax::chip
