#include "chip/flash_g4.hpp"

#include <cstring>
#include <utility>

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

constexpr double kEraseTime_s = 22e-3, kProgramTime_s = 85e-6;

}  // namespace

FlashG4::FlashG4(Context context, Clocks& clocks)
    : Flash(context, clocks, g474::flash_registers(),
            {kBankBytes, kPageBytes, 8, kEraseTime_s, kProgramTime_s}) {}

void FlashG4::on_reset() {
  keys_ = 0;
  first_word_address_ = 0;
  clocks_.wait_states = 0;
  put(kOptr, dual_bank_ ? stored(kOptr) | kDualBank : stored(kOptr) & ~kDualBank);
  context_.wires.set(kNmi, this, false);
}

std::uint32_t FlashG4::on_read(std::uint32_t offset, std::uint32_t value) {
  return offset == kKeyr || offset == kOptkeyr ? 0 : value;
}

void FlashG4::on_write(std::uint32_t offset, std::uint32_t value) {
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

void FlashG4::write_access(std::uint32_t value) {
  const std::uint32_t old = stored(kAcr);
  if (((value & 1U << 11) != 0 && (old & kInstructionCache) != 0) ||
      ((value & 1U << 12) != 0 && (old & kDataCache) != 0)) {
    report("cache_reset_while_on", kAcr, value);
  }
  put(kAcr, masked(kAcr, value));
  clocks_.wait_states = field(value, 0, 4);
  clocks_.check_speed();
}

void FlashG4::write_key(std::uint32_t value) {
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

void FlashG4::refuse(const char* what, std::uint32_t flags, std::uint32_t value) {
  report(what, kSr, value);
  set_bits(kSr, flags);
}

void FlashG4::write_control(std::uint32_t value) {
  if (has(kCr, kLock)) {
    if (value != stored(kCr)) {
      report("flash_locked", kCr, value);
    }
    return;
  }
  if (has(kSr, kBusy)) {
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

void FlashG4::start_erase() {
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
  erase(kFlashBase + kBankBytes + field(control, 3, 7) * kPageBytes);
}

void FlashG4::begin_operation() {
  if (has(kAcr, kDataCache)) {
    report("flash_data_cache_on", kAcr, stored(kAcr));
  }
  set_bits(kSr, kBusy);
}

void FlashG4::end_operation(bool fails) {
  clear_bits(kSr, kBusy);
  if (fails) {
    set_bits(kSr, kOperationError);
  } else if (has(kCr, 1U << 24)) {
    set_bits(kSr, kEndOfOperation);
  }
}

void FlashG4::note_broken(std::uint32_t address) {
  if (!has(kEccr, kUncorrectable)) {  // The first one is kept.
    const bool second = address - kFlashBase >= kBankBytes;
    put(kEccr, (stored(kEccr) & 0x01000000) | kUncorrectable | (second ? kEccSecondBank : 0) |
                   ((address - kFlashBase) % kBankBytes & ~7U));
  }
  context_.wires.set(kNmi, this, has(kEccr, kUncorrectable));
}

void FlashG4::write_array(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  if (has(kCr, kLock) || !has(kCr, kProgram)) {
    refuse("flash_not_programming", kSequenceError, address);
    return;
  }
  if (bytes != 4) {
    refuse("wrong_width", kSizeError, address);
    return;
  }
  if (has(kSr, kBusy)) {
    // The bus waits; a program that does not look will not see an error.
    report("flash_busy", kSr, address);
    wait_while_busy();
  }
  take_word(address, value);
}

void FlashG4::take_word(std::uint32_t address, std::uint32_t value) {
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
  if ((!is_erased(begin, 8) && !zeros) || is_broken(begin)) {
    refuse("flash_not_erased", kProgramError, address);
    return;
  }
  std::vector<std::uint8_t> data(8);
  std::memcpy(data.data(), words, 8);
  program(begin, std::move(data));
}

}  // namespace emax::chip
