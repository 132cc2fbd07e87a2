#include "chip/iwdg.hpp"

#include <utility>

namespace emax::chip {
namespace {

constexpr std::uint32_t kKr = 0x00, kPr = 0x04, kRlr = 0x08, kSr = 0x0C, kWinr = 0x10;
constexpr double kUpdateCycles = 6.0;  // Of the slow clock.

unsigned update_of(std::uint32_t offset) { return offset == kPr ? 0 : offset == kRlr ? 1 : 2; }

}  // namespace

void Iwdg::on_reset() {
  context_.events.cancel(std::exchange(event_, 0));
  runs_ = open_ = false;
  for (Time& at : updated_at_) {
    at = 0;
  }
}

double Iwdg::period_s() const {
  const unsigned code = stored(kPr) & 7;
  const unsigned divider = 4U << (code < 6 ? code : 6);
  return static_cast<double>((stored(kRlr) + 1) * divider) / lsi_hz;
}

std::uint32_t Iwdg::on_read(std::uint32_t offset, std::uint32_t value) {
  if (offset != kSr) {
    return offset == kKr ? 0 : value;
  }
  std::uint32_t flags = 0;
  for (unsigned i = 0; i < 3; ++i) {
    // Without its clock an update never ends.
    const bool over =
        rcc_.lsi_runs() && context_.events.now() >= updated_at_[i] + ticks(kUpdateCycles / lsi_hz);
    flags |= std::uint32_t{updated_at_[i] != 0 && !over} << i;
  }
  // What a test holds, it holds.
  return flags | value;
}

void Iwdg::on_write(std::uint32_t offset, std::uint32_t value) {
  if (offset == kKr) {
    write_key(value);
    return;
  }
  if (!open_) {
    report("watchdog_locked", offset, value);
    return;
  }
  if ((on_read(kSr, 0) >> update_of(offset) & 1) != 0) {
    report("watchdog_updating", offset, value);
    return;
  }
  put(offset, masked(offset, value));
  updated_at_[update_of(offset)] = context_.events.now();
  if (offset == kWinr && runs_) {
    kick();
  }
}

void Iwdg::write_key(std::uint32_t value) {
  switch (value) {
    case 0xCCCC:
      runs_ = true;
      open_ = false;
      rcc_.set_watchdog_runs(true);
      kick();
      break;
    case 0xAAAA:
      open_ = false;
      if (runs_) {
        kick();
      }
      break;
    case 0x5555:
      open_ = true;
      break;
    default:
      report("watchdog_wrong_key", kKr, value);
      break;
  }
}

void Iwdg::kick() {
  context_.events.cancel(std::exchange(event_, 0));
  event_ = context_.events.after(ticks(period_s()), [this] { bite_(); });
}

}  // namespace emax::chip
