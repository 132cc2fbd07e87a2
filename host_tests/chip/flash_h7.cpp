#include "chip/flash_h7.hpp"

#include <vector>

#include "chip/stm32h743_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kAcr = 0x00, kKeyr1 = 0x04, kOptsrCur = 0x1C, kBank2 = 0x100;
constexpr std::uint32_t kCr1 = 0x0C, kSr1 = 0x10, kCcr1 = 0x14;
constexpr std::uint32_t kKeyr2 = kKeyr1 + kBank2, kCr2 = kCr1 + kBank2, kSr2 = kSr1 + kBank2;
constexpr std::uint32_t kCcr2 = kCcr1 + kBank2, kEccAddress2 = 0x160;
constexpr std::uint32_t kLock = 1, kProgram = 2, kSectorErase = 4, kBankErase = 8;
constexpr std::uint32_t kForce = 1U << 6, kStart = 1U << 7;
constexpr std::uint32_t kBusy = 1, kBuffer = 2, kQueue = 4, kEnd = 1U << 16;
constexpr std::uint32_t kSequenceError = 1U << 18, kStrobeError = 1U << 19;
constexpr std::uint32_t kConsistencyError = 1U << 21, kOperationError = 1U << 22;
constexpr std::uint32_t kDoubleError = 1U << 26;
constexpr std::uint32_t kErrors = 0x01EE0000;  // But those of error correction, which reads set.
constexpr std::uint32_t kSwapped = 1U << 31;

/// At the widest parallelism.
constexpr double kEraseTime_s = 1.0, kProgramTime_s = 0.1e-3;

}  // namespace

FlashH7::FlashH7(Context context, Clocks& clocks)
    : Flash(context, clocks, h743::flash_registers(),
            {kBankBytes, kSectorBytes, kWordBytes, kEraseTime_s, kProgramTime_s}) {}

void FlashH7::on_reset() {
  keys_ = {};
  buffered_ = 0;
  clocks_.wait_states = field(stored(kAcr), 0, 4);
  clocks_.write_delay = field(stored(kAcr), 4, 2);
  put(kOptsrCur, swapped_ ? stored(kOptsrCur) | kSwapped : stored(kOptsrCur) & ~kSwapped);
}

bool FlashH7::is_busy() const { return (stored(kSr2) & kBusy) != 0; }

std::uint32_t FlashH7::on_read(std::uint32_t offset, std::uint32_t value) {
  return offset == kKeyr1 || offset == kKeyr2 ? 0 : value;
}

void FlashH7::on_write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kAcr:
      put(kAcr, masked(kAcr, value));
      clocks_.wait_states = field(value, 0, 4);
      clocks_.write_delay = field(value, 4, 2);
      clocks_.check_speed();
      break;
    case kKeyr1:
    case kKeyr2:
      write_key(offset == kKeyr1 ? 0 : 1, value);
      break;
    case kCr1:
    case kCr2:
      write_control(offset == kCr1 ? 0 : 1, value);
      break;
    case kCcr1:
    case kCcr2:
      put(offset - 4, stored(offset - 4) & ~(value & 0x0FEF0000));
      break;
    default:
      report("option_bytes_written", offset, value);
      break;
  }
}

void FlashH7::write_key(unsigned bank, std::uint32_t value) {
  constexpr std::uint32_t kKeys[] = {0x45670123, 0xCDEF89AB};
  unsigned& keys = keys_[bank];
  if (keys >= 2 || value != kKeys[keys]) {
    report("flash_wrong_key", bank == 0 ? kKeyr1 : kKeyr2, value);
    keys = 3;
    return;
  }
  if (++keys == 2) {
    clear_bits(bank == 0 ? kCr1 : kCr2, kLock);
    keys = 0;
  }
}

void FlashH7::refuse(const char* what, std::uint32_t flags, std::uint32_t value) {
  report(what, kSr2, value);
  set_bits(kSr2, flags);
}

void FlashH7::write_control(unsigned bank, std::uint32_t value) {
  const std::uint32_t offset = bank == 0 ? kCr1 : kCr2;
  const std::uint32_t old = stored(offset);
  if ((old & kLock) != 0) {
    if (value != old) {
      report("flash_locked", offset, value);
    }
    return;
  }
  if (bank == 0) {
    if ((value & (kProgram | kStart)) != 0) {
      report("flash_own_bank", offset, value);
      value &= ~(kProgram | kStart);
    }
    put(offset, masked(offset, value));
    return;
  }
  if (is_busy()) {
    report("flash_busy", offset, value);
    return;
  }
  put(offset, masked(offset, value) & ~(kStart | kForce));
  if ((old & kProgram) != 0 && (value & kProgram) == 0 && buffered_ != 0) {
    report("flash_word_incomplete", offset, buffered_);
  }
  if ((value & kForce) != 0 && buffered_ != 0) {
    program_buffer();
  }
  if ((value & kStart) != 0) {
    start_erase(value);
  }
}

void FlashH7::start_erase(std::uint32_t control) {
  if ((stored(kSr2) & kErrors) != 0) {
    refuse("flash_old_error_flags", kSequenceError, stored(kSr2));
    return;
  }
  if ((control & kBankErase) != 0) {
    report("not_modelled", kCr2, control);
    return;
  }
  if ((control & kSectorErase) == 0 || (control & kProgram) != 0) {
    refuse("flash_nothing_to_erase", kSequenceError, control);
    return;
  }
  erase(kFlashBase + kBankBytes + field(control, 8, 3) * kSectorBytes);
}

void FlashH7::begin_operation() { set_bits(kSr2, kBusy | kQueue); }

void FlashH7::end_operation(bool fails) {
  clear_bits(kSr2, kBusy | kQueue);
  set_bits(kSr2, fails ? kOperationError : kEnd);
}

void FlashH7::note_broken(std::uint32_t address) {
  if (!has(kSr2, kDoubleError)) {  // The first one is kept.
    put(kEccAddress2, (address - kFlashBase - kBankBytes) / kWordBytes);
  }
  set_bits(kSr2, kDoubleError);
  bus_error_(address);
}

void FlashH7::write_array(std::uint32_t address, unsigned bytes, std::uint32_t value) {
  if (has(kCr2, kLock) || !has(kCr2, kProgram)) {
    refuse("flash_not_programming", kSequenceError, address);
    return;
  }
  if (is_busy()) {
    // The bus waits; a program that does not look will not see an error.
    report("flash_busy", kSr2, address);
    wait_while_busy();
  }
  if ((stored(kSr2) & kErrors) != 0) {
    refuse("flash_old_error_flags", kSequenceError, stored(kSr2));
    return;
  }
  const std::uint32_t begin = address & ~(kWordBytes - 1);
  if (buffered_ != 0 && begin != buffer_begin_) {
    refuse("flash_word_order", kConsistencyError, address);
    return;
  }
  const std::uint32_t at = address - begin;
  const std::uint32_t mask = ((1U << bytes) - 1) << at;
  if ((buffered_ & mask) != 0) {
    refuse("flash_word_twice", kStrobeError, address);
    return;
  }
  if (buffered_ == 0) {
    buffer_.fill(0xFF);
  }
  buffer_begin_ = begin;
  buffered_ |= mask;
  for (unsigned i = 0; i < bytes; ++i) {
    buffer_[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  set_bits(kSr2, kBuffer);
  if (buffered_ == ~0U) {
    program_buffer();
  }
}

// A word that is not erased keeps the zeros of both, and error correction that fits neither.
void FlashH7::program_buffer() {
  buffered_ = 0;
  clear_bits(kSr2, kBuffer);
  std::vector<std::uint8_t> data(buffer_.begin(), buffer_.end());
  if (!is_erased(buffer_begin_, kWordBytes) || is_broken(buffer_begin_)) {
    report("flash_not_erased", kSr2, buffer_begin_);
    for (std::uint32_t i = 0; i < kWordBytes; ++i) {
      data[i] &= at(buffer_begin_)[i];
    }
    break_unit(buffer_begin_);
  }
  program(buffer_begin_, std::move(data));
}

}  // namespace emax::chip
