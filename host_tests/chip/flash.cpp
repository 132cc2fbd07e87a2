#include "chip/flash.hpp"

#include <algorithm>
#include <cstring>

#include "chip/stm32g474_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kAcr = 0x00, kKeyr = 0x08, kOptkeyr = 0x0C, kSr = 0x10, kCr = 0x14;
constexpr std::uint32_t kEccr = 0x18, kOptr = 0x20;
constexpr std::uint32_t kBusy = 1U << 16, kEndOfOperation = 1;
constexpr std::uint32_t kOperationError = 1U << 1, kProgramError = 1U << 3;
constexpr std::uint32_t kAlignmentError = 1U << 5, kSizeError = 1U << 6, kSequenceError = 1U << 7;
constexpr std::uint32_t kErrors = 0xC3FA;
constexpr std::uint32_t kProgram = 1, kPageErase = 2, kBankErase = 0x8004, kSecondBank = 1U << 11;
constexpr std::uint32_t kStart = 1U << 16, kLock = 1U << 31;
constexpr std::uint32_t kDataCache = 1U << 10, kInstructionCache = 1U << 9;
constexpr std::uint32_t kUncorrectable = 1U << 31, kEccSecondBank = 1U << 21;
constexpr std::uint32_t kDualBank = 1U << 22;

const Time kEraseTime = ticks(22e-3);
const Time kProgramTime = ticks(85e-6);

}  // namespace

Flash::Flash(Context context, Clocks& clocks)
    : RegisterBlock(context, "FLASH", flash_registers()),
      clocks_(clocks),
      memory_(2 * kBankBytes, 0xFF) {}

void Flash::on_reset() {
  keys_ = 0;
  first_word_address_ = 0;
  clocks_.wait_states = 0;
  put(kOptr, dual_bank_ ? stored(kOptr) | kDualBank : stored(kOptr) & ~kDualBank);
  context_.wires.set(kNmi, this, false);
}

bool Flash::is_erased(std::uint32_t address, std::uint32_t bytes) const {
  const auto begin = memory_.begin() + static_cast<std::ptrdiff_t>(address - kFlashBase);
  return std::all_of(begin, begin + static_cast<std::ptrdiff_t>(bytes),
                     [](std::uint8_t byte) { return byte == 0xFF; });
}

std::uint32_t Flash::on_read(std::uint32_t offset, std::uint32_t value) {
  return offset == kKeyr || offset == kOptkeyr ? 0 : value;
}

void Flash::on_write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kAcr:
      write_access(value);
      break;
    case kKeyr:
      write_key(value);
      break;
    case kSr:  // Written with one, a flag is cleared.
      put(offset, stored(offset) & ~(value & (kErrors | kEndOfOperation)));
      break;
    case kCr:
      write_control(value);
      break;
    case kEccr:
      put(offset, (stored(offset) & ~(value & 0xF0000000) & ~(1U << 24)) | (value & 1U << 24));
      context_.wires.set(kNmi, this, has(kEccr, kUncorrectable));
      break;
    default:
      report("option_bytes_written", offset, value);
      break;
  }
}

void Flash::write_access(std::uint32_t value) {
  const std::uint32_t old = stored(kAcr);
  if (((value & 1U << 11) != 0 && (old & kInstructionCache) != 0) ||
      ((value & 1U << 12) != 0 && (old & kDataCache) != 0)) {
    report("cache_reset_while_on", kAcr, value);
  }
  put(kAcr, masked(kAcr, value));
  clocks_.wait_states = field(value, 0, 4);
  clocks_.check_speed();
}

void Flash::write_key(std::uint32_t value) {
  constexpr std::uint32_t kKeys[] = {0x45670123, 0xCDEF89AB};
  if (keys_ >= 2 || value != kKeys[keys_]) {
    report("flash_wrong_key", kKeyr, value);
    keys_ = 3;
    return;
  }
  if (++keys_ == 2) {
    clear_bits(kCr, kLock);
    keys_ = 0;
  }
}

void Flash::refuse(const char* what, std::uint32_t flags, std::uint32_t value) {
  report(what, kSr, value);
  set_bits(kSr, flags);
}

void Flash::write_control(std::uint32_t value) {
  if (has(kCr, kLock)) {
    if (value != stored(kCr)) {
      report("flash_locked", kCr, value);
    }
    return;
  }
  if (busy()) {
    report("flash_busy", kCr, value);
    return;
  }
  const std::uint32_t old = stored(kCr);
  put(kCr, masked(kCr, value) & ~kStart);
  if ((value & kProgram) != 0 && (old & kProgram) == 0 && (stored(kSr) & kErrors) != 0) {
    refuse("flash_old_error_flags", kSequenceError, stored(kSr));
  }
  if ((value & kProgram) == 0) {
    first_word_address_ = 0;
  }
  if ((value & kStart) != 0) {
    start_erase();
  }
}

void Flash::start_erase() {
  const std::uint32_t control = stored(kCr);
  if ((stored(kSr) & kErrors) != 0) {
    refuse("flash_old_error_flags", kSequenceError, stored(kSr));
    return;
  }
  if ((control & kPageErase) == 0 || (control & kProgram) != 0) {
    refuse("flash_nothing_to_erase", kSequenceError, control);
    return;
  }
  if ((control & kBankErase) != 0 || (control & kSecondBank) == 0) {
    report("flash_own_bank", kCr, control);
    return;
  }
  const std::uint32_t begin = kBankBytes + field(control, 3, 7) * kPageBytes;
  const auto erase = [this, begin](std::uint32_t every) {
    for (std::uint32_t at = begin; at < begin + kPageBytes; at += 8 * every) {
      std::fill_n(memory_.begin() + static_cast<std::ptrdiff_t>(at), 8, std::uint8_t{0xFF});
      broken_.erase(at / 8);
    }
  };
  operate(
      kEraseTime, [erase] { erase(1); },
      [this, begin, erase] {
        erase(3);  // Some is erased, some as it was, some neither.
        for (std::uint32_t at = begin + 8; at < begin + kPageBytes; at += 24) {
          memory_[at] |= 0x5A;
          broken_.insert(at / 8);
        }
      });
}

void Flash::operate(Time duration, const std::function<void()>& whole,
                    const std::function<void()>& half) {
  if (has(kAcr, kDataCache)) {
    report("flash_data_cache_on", kAcr, stored(kAcr));
  }
  ++operations_;
  const bool cut = until_cut_ == 0;
  until_cut_ = until_cut_ == kNoCut || cut ? kNoCut : until_cut_ - 1;
  set_bits(kSr, kBusy);
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
    clear_bits(kSr, kBusy);
    if (fails) {
      set_bits(kSr, kOperationError);
    } else if (has(kCr, 1U << 24)) {
      set_bits(kSr, kEndOfOperation);
    }
    if (cut) {
      power_cut_();
    }
  });
}

void Flash::cut_power_at(unsigned operation, PowerCut how) {
  until_cut_ = operation;
  cut_ = how;
}

// The bus keeps the processor waiting.
void Flash::wait_while_busy() {
  if (stored(kSr) & kBusy) {
    const Time now = context_.events.now();
    context_.events.pass(done_at_ > now ? done_at_ - now : 0);
    context_.events.run_due();
  }
}

std::uint32_t Flash::read_array(std::uint32_t address, unsigned bytes) {
  wait_while_busy();
  if (broken_.count(index_of(address)) != 0) {
    note_broken(address);
  }
  std::uint32_t value = 0;
  std::memcpy(&value, memory_.data() + (address - kFlashBase), bytes);
  return value;
}

void Flash::note_broken(std::uint32_t address) {
  if (!has(kEccr, kUncorrectable)) {  // The first one is kept.
    const bool second = address - kFlashBase >= kBankBytes;
    put(kEccr, (stored(kEccr) & 0x01000000) | kUncorrectable | (second ? kEccSecondBank : 0) |
                   ((address - kFlashBase) % kBankBytes & ~7U));
  }
  context_.wires.set(kNmi, this, has(kEccr, kUncorrectable));
}

void Flash::write_array(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  if (has(kCr, kLock) || !has(kCr, kProgram)) {
    refuse("flash_not_programming", kSequenceError, address);
    return;
  }
  if (bytes != 4) {
    refuse("wrong_width", kSizeError, address);
    return;
  }
  if (busy()) {
    // The bus waits; a program that does not look will not see an error.
    report("flash_busy", kSr, address);
    wait_while_busy();
  }
  take_word(address, value);
}

void Flash::take_word(std::uint32_t address, std::uint32_t value) {
  if (first_word_address_ == 0) {
    if (address % 8 != 0) {
      refuse("flash_word_order", kAlignmentError, address);
      return;
    }
    first_word_address_ = address;
    first_word_ = value;
    return;
  }
  const std::uint32_t begin = std::exchange(first_word_address_, 0U);
  if (address != begin + 4) {
    refuse("flash_word_order", kSequenceError, address);
    return;
  }
  const std::uint32_t words[] = {first_word_, value};
  const bool zeros = first_word_ == 0 && value == 0;
  if ((!is_erased(begin, 8) && !zeros) || broken_.count(index_of(begin)) != 0) {
    refuse("flash_not_erased", kProgramError, address);
    return;
  }
  std::uint8_t* const target = memory_.data() + (begin - kFlashBase);
  std::uint64_t whole = 0;
  std::memcpy(&whole, words, 8);
  operate(
      kProgramTime, [target, whole] { std::memcpy(target, &whole, 8); },
      [this, target, whole, begin] {
        const std::uint64_t some = whole | 0xF0F0F0F0F0F0F0F0U;
        std::memcpy(target, &some, 8);
        broken_.insert(index_of(begin));
      });
}

}  // namespace emax::chip
