#include "chip/timer.hpp"

#include <algorithm>
#include <utility>

namespace emax::chip {
namespace {

constexpr std::uint32_t kCr1 = 0x00, kCr2 = 0x04, kSmcr = 0x08, kDier = 0x0C, kSr = 0x10;
constexpr std::uint32_t kEgr = 0x14, kCnt = 0x24, kPsc = 0x28, kArr = 0x2C, kCcr1 = 0x34;
constexpr std::uint32_t kCcr4 = 0x40;
constexpr std::uint32_t kEnable = 1, kNoUpdate = 2, kOnlyCounter = 4, kOnePulse = 8;
constexpr std::uint32_t kPreload = 1U << 7;
/// Direction, centre alignment, remap of the flag, dithering.
constexpr std::uint32_t kOtherModes = 0x1870;
constexpr std::uint32_t kUpdateFlag = 1;
constexpr unsigned kUpdateAsTrigger = 2;

}  // namespace

Timer::Timer(Context context, Clocks& clocks, const std::string& name, Kind kind,
             Registers registers, unsigned interrupt_line)
    : RegisterBlock(context, name, std::move(registers)),
      clocks_(clocks),
      kind_(kind),
      line_(interrupt(interrupt_line)) {
  clocks.on_change([this] {
    if (runs() && clock_hz_ != clocks_.timer1_hz) {
      settle(count());
    }
  });
}

void Timer::on_reset() {
  context_.events.cancel(std::exchange(event_, 0));
  prescaler_ = 0;
  reload_ = stored(kArr);
  start_count_ = 0;
  clock_hz_ = 0;
  refresh_line();
}

double Timer::period_s() const {
  return static_cast<double>(tick_cycles() * (std::uint64_t{reload_} + 1)) /
         static_cast<double>(clocks_.timer1_hz);
}

std::uint32_t Timer::count() const {
  if (clock_hz_ == 0) {
    return start_count_;
  }
  const Time tick = cycles_of(tick_cycles(), clock_hz_);
  const Time passed = context_.events.now() - start_;
  const std::uint64_t turn = std::uint64_t{reload_} + 1;
  return static_cast<std::uint32_t>((start_count_ + passed / tick) % turn);
}

void Timer::settle(std::uint32_t count) {
  start_count_ = count;
  start_ = context_.events.now();
  clock_hz_ = runs() ? clocks_.timer1_hz : 0;
  arm();
}

// The next update or compare.
void Timer::arm() {
  context_.events.cancel(std::exchange(event_, 0));
  if (clock_hz_ == 0 || reload_ == 0) {
    return;
  }
  const std::uint64_t turn = std::uint64_t{reload_} + 1;
  std::uint64_t next = start_count_ < turn ? turn - start_count_ : (1ULL << 32) - start_count_;
  bool updates = true;
  if (kind_ == Kind::kGeneral && (stored(kDier) & 0x1E) != 0) {
    for (std::uint32_t offset = kCcr1; offset <= kCcr4; offset += 4) {
      const std::uint32_t at = stored(offset);
      if (at <= reload_ && at > start_count_ && at - start_count_ < next) {
        next = at - start_count_;
        updates = false;
      }
    }
  }
  const Time due = start_ + cycles_of(next * tick_cycles(), clock_hz_);
  const auto reached = static_cast<std::uint32_t>(start_count_ + next);
  event_ = context_.events.at(due, [this, updates, reached] {
    event_ = 0;
    start_ = context_.events.now();
    start_count_ = updates ? 0 : reached;
    compare(start_count_);
    if (updates) {
      update(true);
    }
    if (clock_hz_ != 0) {
      arm();
    }
  });
}

void Timer::compare(std::uint32_t count) {
  if (kind_ == Kind::kBasic) {
    return;
  }
  for (std::uint32_t offset = kCcr1, flag = 2; offset <= kCcr4; offset += 4, flag <<= 1) {
    if (stored(offset) == count) {
      set_bits(kSr, flag);
    }
  }
  refresh_line();
}

void Timer::update(bool by_counter) {
  if (has(kCr1, kNoUpdate)) {
    return;
  }
  prescaler_ = stored(kPsc);
  reload_ = stored(kArr);
  if (by_counter || !has(kCr1, kOnlyCounter)) {
    set_bits(kSr, kUpdateFlag);
  }
  if (by_counter && has(kCr1, kOnePulse)) {
    clear_bits(kCr1, kEnable);
    clock_hz_ = 0;
  }
  refresh_line();
  if (field(stored(kCr2), 4, 3) == kUpdateAsTrigger) {
    for (const auto& listener : listeners_) {
      listener();
    }
  }
}

void Timer::refresh_line() { context_.wires.set(line_, this, (get(kSr) & get(kDier) & 0x1F) != 0); }

std::uint32_t Timer::on_read(std::uint32_t offset, std::uint32_t value) {
  return offset == kCnt ? count() : value;
}

void Timer::on_write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kSr:  // Written with zero, a flag is cleared.
      put(offset, stored(offset) & value);
      refresh_line();
      break;
    case kEgr:
      if ((value & 1) != 0) {
        update(false);
        settle(0);
      }
      break;
    case kCnt:
      settle(masked(offset, value));
      break;
    default:
      settings_changed(offset, value);
      break;
  }
}

void Timer::settings_changed(std::uint32_t offset, std::uint32_t value) {
  const std::uint32_t now = count();
  put(offset, masked(offset, value));
  if ((offset == kCr1 && (stored(kCr1) & kOtherModes) != 0) || (offset == kSmcr && value != 0)) {
    report("not_modelled", offset, value);
  }
  if (offset == kArr && !has(kCr1, kPreload)) {
    reload_ = stored(kArr);
  }
  refresh_line();
  if (offset == kCr1 || offset == kArr || offset == kDier || offset >= kCcr1) {
    settle(now);
  }
}

}  // namespace emax::chip
