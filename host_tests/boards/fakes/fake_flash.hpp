// The second bank of an STM32G474's flash memory, whose power can be cut at any moment of an
// operation. It refuses what the memory refuses: keys in the wrong order, flags of before, what is
// programmed twice; and it raises the interrupt for what it cannot correct.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "emax/board/g474.hpp"
#include "emax/board/registers.hpp"

namespace emax::test {

class FakeFlash final : public FakeChip {
 public:
  static constexpr std::uint32_t kPageBytes = 2048;
  static constexpr std::uint32_t kPages = 128;
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::uint32_t kTwoBanks = 1U << 22;

  FakeFlash() : memory_(std::size_t{kPages} * kPageBytes, 0xFF) {}

  /// What the processor does when the memory cannot correct what it reads.
  void set_interrupt(std::function<void()> handler) { handler_ = std::move(handler); }

  /// The power fails in the operation after these: in the middle of it, so that what it works on is
  /// neither as before nor as after. Everything is as without memory then.
  void cut_power_after(std::uint64_t operations) { operations_left_ = operations; }
  void restore_power() {
    operations_left_ = kNever;
    is_powered_ = true;
    status_ = 0;
    control_ = kLock;
    correction_ = 0;
    keys_ = 0;
    half_ = {};
  }
  bool powered() const { return is_powered_; }
  std::uint64_t operations() const { return operations_; }

  void set_options(std::uint32_t options) { options_ = options; }
  /// An error flag that somebody has left.
  void leave_flag(std::uint32_t flag) { status_ |= flag; }
  void stay_busy(bool busy) { is_stuck_ = busy; }
  bool is_locked() const { return (control_ & kLock) != 0; }
  bool is_data_cache_on() const { return (access_ & 1U << 10) != 0; }
  /// Operations begun while the data cache was on.
  std::uint64_t cached_operations() const { return cached_operations_; }
  std::uint8_t byte_at(std::uint32_t offset) const { return memory_[offset]; }

  std::uint32_t read(std::uintptr_t address, unsigned bytes) override {
    ++time_us_;
    switch (address) {
      case 0x40000024:
        return static_cast<std::uint32_t>(time_us_);
      case board::kFlash:
        return access_;
      case board::kFlash + 0x10:
        return status_ | (is_stuck_ ? kBusy : 0);
      case board::kFlash + 0x14:
        return control_;
      case board::kFlash + 0x18:
        return correction_;
      case board::kFlash + 0x20:
        return options_;
      default:
        return load(static_cast<std::uint32_t>(address - board::kFlashBank2), bytes);
    }
  }

  void write(std::uintptr_t address, std::uint32_t value) override {
    ++time_us_;
    switch (address) {
      case board::kFlash:
        access_ = value;
        return;
      case board::kFlash + 0x08:
        take_key(value);
        return;
      case board::kFlash + 0x10:
        status_ &= ~value;
        return;
      case board::kFlash + 0x14:
        take_control(value);
        return;
      case board::kFlash + 0x18:
        correction_ &= ~(value & kNotCorrected);
        return;
      default:
        program(static_cast<std::uint32_t>(address - board::kFlashBank2), value);
    }
  }

 private:
  static constexpr std::uint32_t kLock = 1U << 31;
  static constexpr std::uint32_t kNotCorrected = 1U << 31;
  static constexpr std::uint32_t kBusy = 1U << 16;
  static constexpr std::uint32_t kErrors = 0xC3FA;
  static constexpr std::uint32_t kProgrammingError = 1U << 3;
  static constexpr std::uint32_t kSequenceError = 1U << 7;

  struct Half {
    std::uint32_t offset = 0;
    std::uint32_t word = 0;
    bool is_there = false;
  };

  void take_key(std::uint32_t key) {
    const bool is_right = key == (keys_ == 0 ? 0x45670123U : 0xCDEF89ABU);
    keys_ = is_right ? keys_ + 1 : 1000;
    if (keys_ == 2) {
      control_ &= ~kLock;
      keys_ = 0;
    }
  }

  void take_control(std::uint32_t value) {
    if ((control_ & kLock) != 0) {
      return;
    }
    control_ = value & ~(1U << 16);
    const bool is_erase = (value & 2U) != 0 && (value & 1U << 11) != 0;
    if ((value & 1U << 16) == 0 || !is_erase) {
      return;
    }
    if ((status_ & kErrors) != 0) {
      status_ |= kSequenceError;
      return;
    }
    const std::uint32_t begin = (value >> 3U & 0x7FU) * kPageBytes;
    const bool is_whole = begin_operation();
    if (!is_powered_before_) {
      return;
    }
    for (std::uint32_t i = 0; i < kPageBytes; i += 8) {
      spoiled_.erase(begin + i);
      if (is_whole) {
        programmed_.erase(begin + i);
        set(begin + i, 0xFFFFFFFF, 0xFFFFFFFF);
      } else if (i % 24 == 0) {
        // Some of it is erased, some is not, some is neither.
        set(begin + i, 0xFFFFFFFF, 0xFFFFFFFF);
      } else if (i % 24 == 8) {
        spoiled_.insert(begin + i);
      }
    }
  }

  void program(std::uint32_t offset, std::uint32_t word) {
    if ((control_ & kLock) != 0 || (control_ & 1U) == 0 || (status_ & kErrors) != 0) {
      status_ |= kSequenceError;
      return;
    }
    if (offset % 8 == 0) {
      half_ = {offset, word, true};
      return;
    }
    if (!half_.is_there || half_.offset + 4 != offset) {
      status_ |= kSequenceError;
      return;
    }
    half_.is_there = false;
    if (programmed_.count(half_.offset) != 0) {
      status_ |= kProgrammingError;
      return;
    }
    const bool is_whole = begin_operation();
    if (!is_powered_before_) {
      return;
    }
    programmed_.insert(half_.offset);
    if (is_whole) {
      set(half_.offset, half_.word, word);
    } else {
      set(half_.offset, half_.word, 0xFFFF0000U & word);
      spoiled_.insert(half_.offset);
    }
  }

  // @returns Whether it ends; without power nothing even begins.
  bool begin_operation() {
    is_powered_before_ = is_powered_;
    if (!is_powered_) {
      status_ |= kProgrammingError;
      return false;
    }
    ++operations_;
    cached_operations_ += is_data_cache_on() ? 1U : 0U;
    if (operations_left_ == 0) {
      is_powered_ = false;
      status_ |= kProgrammingError;
      return false;
    }
    --operations_left_;
    return true;
  }

  void set(std::uint32_t offset, std::uint32_t low, std::uint32_t high) {
    for (std::uint32_t i = 0; i < 4; ++i) {
      memory_[offset + i] = static_cast<std::uint8_t>(low >> (8U * i));
      memory_[offset + 4 + i] = static_cast<std::uint8_t>(high >> (8U * i));
    }
  }

  std::uint32_t load(std::uint32_t offset, unsigned bytes) {
    if (!is_powered_ || spoiled_.count(offset / 8 * 8) != 0) {
      correction_ |= kNotCorrected;
      if (handler_) {
        handler_();
      }
    }
    std::uint32_t value = 0;
    for (unsigned i = 0; i < bytes; ++i) {
      value |= std::uint32_t{memory_[offset + i]} << (8U * i);
    }
    return value;
  }

  std::vector<std::uint8_t> memory_;
  std::set<std::uint32_t> programmed_;
  std::set<std::uint32_t> spoiled_;
  std::function<void()> handler_;
  Half half_;
  std::uint64_t time_us_ = 0;
  std::uint64_t operations_ = 0;
  std::uint64_t cached_operations_ = 0;
  std::uint64_t operations_left_ = kNever;
  std::uint32_t access_ = 0x40704;
  std::uint32_t status_ = 0;
  std::uint32_t control_ = kLock;
  std::uint32_t correction_ = 0;
  std::uint32_t options_ = kTwoBanks;
  std::uint32_t keys_ = 0;
  bool is_powered_ = true;
  bool is_powered_before_ = true;
  bool is_stuck_ = false;
};

}  // namespace emax::test
