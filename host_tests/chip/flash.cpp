#include "chip/flash.hpp"

#include <algorithm>
#include <cstring>

namespace emax::chip {

bool Flash::is_erased(std::uint32_t address, std::uint32_t bytes) const {
  const auto begin = memory_.begin() + static_cast<std::ptrdiff_t>(address - kFlashBase);
  return std::all_of(begin, begin + static_cast<std::ptrdiff_t>(bytes),
                     [](std::uint8_t byte) { return byte == 0xFF; });
}

void Flash::erase_units(std::uint32_t begin, std::uint32_t every) {
  const std::uint32_t unit = layout_.unit_bytes;
  for (std::uint32_t address = begin; address < begin + layout_.erase_bytes;
       address += unit * every) {
    std::fill_n(at(address), unit, std::uint8_t{0xFF});
    broken_.erase(index_of(address));
  }
}

void Flash::erase(std::uint32_t begin) {
  operate(
      ticks(layout_.erase_time_s), [this, begin] { erase_units(begin, 1); },
      [this, begin] {
        erase_units(begin, 3);  // Some is erased, some as it was, some neither.
        const std::uint32_t unit = layout_.unit_bytes;
        for (std::uint32_t address = begin + unit; address < begin + layout_.erase_bytes;
             address += 3 * unit) {
          *at(address) |= 0x5A;
          break_unit(address);
        }
      });
}

void Flash::program(std::uint32_t begin, std::vector<std::uint8_t> data) {
  operate(
      ticks(layout_.program_time_s),
      [this, begin, data] { std::copy(data.begin(), data.end(), at(begin)); },
      [this, begin, data] {
        std::transform(data.begin(), data.end(), at(begin),
                       [](std::uint8_t byte) { return static_cast<std::uint8_t>(byte | 0xF0); });
        break_unit(begin);
      });
}

void Flash::operate(Time duration, const std::function<void()>& whole,
                    const std::function<void()>& half) {
  ++operations_;
  const bool cut = until_cut_ == 0;
  until_cut_ = until_cut_ == kNoCut || cut ? kNoCut : until_cut_ - 1;
  begin_operation();
  done_at_ = context_.events.now() + duration;
  if (cut && cut_ != PowerCut::kAfter) {
    context_.events.after(cut_ == PowerCut::kBefore ? 0 : duration / 2, [this, half] {
      if (cut_ == PowerCut::kWithin) {
        half();
      }
      power_cut_();
    });
    return;
  }
  const bool fails = std::exchange(fail_next_, false);
  context_.events.at(done_at_, [this, whole, cut, fails] {
    whole();
    end_operation(fails);
    if (cut) {
      power_cut_();
    }
  });
}

void Flash::cut_power_at(unsigned operation, PowerCut how) {
  until_cut_ = operation;
  cut_ = how;
}

void Flash::wait_while_busy() {
  if (is_busy()) {
    const Time now = context_.events.now();
    context_.events.pass(done_at_ > now ? done_at_ - now : 0);
    context_.events.run_due();
  }
}

std::uint32_t Flash::read_array(std::uint32_t address, unsigned bytes) {
  wait_while_busy();
  if (is_broken(address)) {
    note_broken(address);
  }
  std::uint32_t value = 0;
  std::memcpy(&value, at(address), bytes);
  return value;
}

}  // namespace emax::chip
