// Records in the flash memory of the NUCLEO-H743ZI2, run on the PC over fake registers: the store
// keeps its contract, and a cut of the power in each operation leaves a record as before or as
// after.
#include <algorithm>
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include "emax/app/store/record_store.hpp"
#include "emax/board/h743.hpp"
#include "emax/board/h743_flash.hpp"
#include "emax/board/registers.hpp"

#include "hal/board_conformance.hpp"

namespace emax::test {
namespace {

using app::RecordStore;
using board::LogStore;
using Bytes = std::vector<std::uint8_t>;

/// Bank 2. It refuses what the memory refuses, and answers a read of what it cannot correct by a
/// fault of the bus.
class FakeFlash final : public FakeChip {
 public:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::uint32_t kSectorBytes = 128 * 1024;

  void cut_power_after(std::uint64_t operations) { operations_left_ = operations; }
  void restore_power() {
    operations_left_ = kNever;
    is_powered_ = true;
    status_ = 0;
    control_ = kLock;
    keys_ = 0;
    words_.clear();
  }
  bool powered() const { return is_powered_; }
  std::uint64_t operations() const { return operations_; }
  std::uint64_t erasures() const { return erasures_; }
  /// Faults while they were not masked: the program would have stopped.
  int strays() const { return strays_; }
  void swap_banks(bool swapped) { is_swapped_ = swapped; }
  void leave_flag(std::uint32_t flag) { status_ |= flag; }
  void stay_busy(bool busy) { is_stuck_ = busy; }
  bool is_locked() const { return (control_ & kLock) != 0; }
  bool masks_faults() const { return (configuration_ & 1U << 8) != 0; }
  std::uint8_t byte_at(std::uint32_t offset) { return byte(offset); }

  std::uint32_t read(std::uintptr_t address, unsigned bytes) override {
    ++time_us_;
    switch (address) {
      case 0x40000024:
        return static_cast<std::uint32_t>(time_us_);
      case 0xE000ED14:
        return configuration_;
      case 0xE000ED28:
        return fault_status_;
      case board::kFlash + 0x18:
      case board::kFlash + 0x1C:
        return is_swapped_ ? 1U << 31 : 0;
      case board::kFlash + 0x10C:
        return control_;
      case board::kFlash + 0x110:
        return status_ | (is_stuck_ ? 4U : 0U);
      default:
        EXPECT_GE(address, board::kFlashBank2);
        EXPECT_LT(address, board::kFlashBank2 + 8 * kSectorBytes);
        return load(static_cast<std::uint32_t>(address - board::kFlashBank2), bytes);
    }
  }

  void write(std::uintptr_t address, std::uint32_t value) override {
    ++time_us_;
    switch (address) {
      case 0xE000ED14:
        configuration_ = value;
        return;
      case 0xE000ED28:
        fault_status_ &= ~value;
        return;
      case board::kFlash + 0x104:
        take_key(value);
        return;
      case board::kFlash + 0x10C:
        take_control(value);
        return;
      case board::kFlash + 0x114:
        status_ &= ~value;
        return;
      default:
        EXPECT_GE(address, board::kFlashBank2);
        program(static_cast<std::uint32_t>(address - board::kFlashBank2), value);
    }
  }

 private:
  static constexpr std::uint32_t kLock = 1U << 0;
  static constexpr std::uint32_t kErrors = 0x01EE0000;
  static constexpr std::uint32_t kSequenceError = 1U << 18;
  static constexpr std::uint32_t kNotCorrected = 1U << 26;

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
      status_ |= kSequenceError;
      return;
    }
    control_ = value & ~(1U << 7);
    if ((value & 1U << 7) == 0) {
      return;
    }
    if ((value & 4U) == 0 || (value >> 4U & 3U) != 3 || (status_ & kErrors) != 0) {
      status_ |= kSequenceError;
      return;
    }
    ++erasures_;
    erase((value >> 8U & 7U) * kSectorBytes);
  }

  void erase(std::uint32_t begin) {
    const bool is_whole = begin_operation();
    if (!was_powered_) {
      return;
    }
    for (std::uint32_t at = begin; at < begin + kSectorBytes; at += 32) {
      const std::uint32_t unit = at / 32;
      if (is_whole || unit % 3 == 0) {
        units_.erase(unit);
        spoiled_.erase(unit);
      } else if (unit % 3 == 1) {
        spoiled_.insert(unit);
      }
    }
  }

  // Eight words of one unit, one after the other.
  void program(std::uint32_t offset, std::uint32_t word) {
    const bool is_next = offset % 32 == 4 * words_.size();
    if ((control_ & 3U) != 2U || (control_ >> 4U & 3U) != 3 || (status_ & kErrors) != 0 ||
        !is_next) {
      status_ |= kSequenceError;
      return;
    }
    words_.push_back(word);
    if (words_.size() < 8) {
      return;
    }
    const std::uint32_t unit = offset / 32;
    std::array<std::uint8_t, 32> bytes = {};
    for (std::size_t i = 0; i < 32; ++i) {
      bytes[i] = static_cast<std::uint8_t>(words_[i / 4] >> (8 * (i % 4)));
    }
    words_.clear();
    if (units_.count(unit) != 0 || spoiled_.count(unit) != 0) {
      status_ |= kSequenceError;
      return;
    }
    const bool is_whole = begin_operation();
    if (!was_powered_) {
      return;
    }
    units_[unit] = bytes;
    if (!is_whole) {
      spoiled_.insert(unit);
    }
  }

  // @returns Whether it ends; without power nothing even begins.
  bool begin_operation() {
    was_powered_ = is_powered_;
    if (!is_powered_) {
      status_ |= kSequenceError;
      return false;
    }
    ++operations_;
    if (operations_left_ == 0) {
      is_powered_ = false;
      status_ |= kSequenceError;
      return false;
    }
    operations_left_ -= operations_left_ == kNever ? 0 : 1;
    return true;
  }

  std::uint8_t byte(std::uint32_t offset) {
    const auto found = units_.find(offset / 32);
    return found == units_.end() ? 0xFF : found->second[offset % 32];
  }

  std::uint32_t load(std::uint32_t offset, unsigned bytes) {
    if (!is_powered_ || spoiled_.count(offset / 32) != 0) {
      status_ |= kNotCorrected;
      fault_status_ |= 1U << 9;
      strays_ += masks_faults() ? 0 : 1;
    }
    std::uint32_t value = 0;
    for (unsigned i = 0; i < bytes; ++i) {
      value |= std::uint32_t{byte(offset + i)} << (8U * i);
    }
    return value;
  }

  std::map<std::uint32_t, std::array<std::uint8_t, 32>> units_;
  std::set<std::uint32_t> spoiled_;
  std::vector<std::uint32_t> words_;
  std::uint64_t time_us_ = 0;
  std::uint64_t operations_ = 0;
  std::uint64_t erasures_ = 0;
  std::uint64_t operations_left_ = kNever;
  std::uint32_t status_ = 0;
  std::uint32_t control_ = kLock;
  std::uint32_t keys_ = 0;
  std::uint32_t configuration_ = 0;
  std::uint32_t fault_status_ = 0;
  int strays_ = 0;
  bool is_powered_ = true;
  bool was_powered_ = true;
  bool is_swapped_ = false;
  bool is_stuck_ = false;
};

/// A chip, and the store on it from power on to power on.
class Bench {
 public:
  Bench() { restore_power(); }
  Bench(const Bench&) = delete;

  LogStore& store() { return store_; }
  FakeFlash& flash() { return flash_; }
  void cut_power_after(std::uint64_t operations) { flash_.cut_power_after(operations); }
  void restore_power() {
    flash_.restore_power();
    EXPECT_EQ(store_.start(), Status::kOk);
  }
  bool powered() const { return flash_.powered(); }

  Bytes record(std::uint32_t number) {
    Bytes bytes(RecordStore(store_).capacity());
    bytes.resize(RecordStore(store_).read(number, {bytes.data(), bytes.size()}).bytes);
    return bytes;
  }

  Status keep(std::uint32_t number, const Bytes& bytes) {
    Bytes frame(bytes.size() + RecordStore::kFrameBytes);
    std::copy(bytes.begin(), bytes.end(), frame.begin() + RecordStore::kHeaderBytes);
    return RecordStore(store_).write(number, {frame.data(), frame.size()});
  }

 private:
  FakeFlash flash_;
  board::H743Sectors sectors_;
  LogStore store_{board::kH743StoreFormat, board::kH743SectorBytes, sectors_};
};

TEST(H743Flash, KeepsTheContract) {
  Bench bench;
  EXPECT_TRUE(violated_by_store(bench).none());
  EXPECT_EQ(bench.flash().strays(), 0);
  EXPECT_GT(bench.flash().operations(), 1000U);
  EXPECT_GT(bench.flash().erasures(), 0U);
  EXPECT_TRUE(bench.flash().is_locked());
  EXPECT_FALSE(bench.flash().masks_faults());
}

TEST(H743Flash, RecordsSurviveACutInEachOperation) {
  const Bytes first(1200, 0x11);
  const Bytes second(1200, 0x22);
  const Bytes third(700, 0x33);
  for (std::uint64_t operations = 0; operations < 100; ++operations) {
    Bench bench;
    ASSERT_EQ(bench.keep(0, first), Status::kOk);
    ASSERT_EQ(bench.keep(1, second), Status::kOk);
    bench.cut_power_after(operations);
    const bool is_done = bench.keep(0, third) == Status::kOk;
    EXPECT_EQ(is_done, bench.powered());
    bench.restore_power();
    const Bytes found = bench.record(0);
    EXPECT_TRUE(found == third || (!is_done && found == first)) << operations;
    EXPECT_EQ(bench.record(1), second) << operations;
    EXPECT_EQ(bench.keep(0, second), Status::kOk) << operations;
    EXPECT_EQ(bench.record(0), second) << operations;
    EXPECT_EQ(bench.flash().strays(), 0);
    EXPECT_EQ(bench.flash().erasures(), 0U);
    if (is_done) {
      // A label, 720 bytes in units of 32, and two labels.
      EXPECT_EQ(operations, 1U + 23U + 2U);
      return;
    }
  }
  ADD_FAILURE() << "no write was done";
}

TEST(H743Flash, RecordsAreInTheLastTwoSectorsOfBank2) {
  Bench bench;
  const std::array<std::uint8_t, 9> bytes = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  ASSERT_EQ(bench.store().write(3, bytes), Status::kOk);
  for (std::uint32_t i = 0; i < 9; ++i) {
    EXPECT_EQ(bench.flash().byte_at(6 * FakeFlash::kSectorBytes + 32 + i), i + 1);
  }
  for (std::uint32_t i = 0; i < bench.store().places(); ++i) {
    ASSERT_EQ(bench.store().write(3, bytes), Status::kOk);
  }
  for (std::uint32_t i = 0; i < 9; ++i) {
    EXPECT_EQ(bench.flash().byte_at(7 * FakeFlash::kSectorBytes + 32 + i), i + 1);
  }
}

TEST(H743Flash, ClearsTheFlagsOfBefore) {
  Bench bench;
  for (const unsigned bit : {16U, 17U, 18U, 19U, 21U, 22U, 23U, 24U, 25U, 26U}) {
    bench.flash().leave_flag(1U << bit);
    EXPECT_EQ(bench.store().write(0, std::array<std::uint8_t, 1>{7}), Status::kOk) << bit;
  }
}

TEST(H743Flash, RefusesSwappedBanks) {
  Bench bench;
  ASSERT_EQ(bench.keep(0, Bytes(10, 1)), Status::kOk);
  bench.flash().swap_banks(true);
  const std::uint64_t operations = bench.flash().operations();
  std::array<std::uint8_t, 4> bytes = {};
  EXPECT_EQ(bench.store().read(0, bytes), Status::kHardwareFault);
  EXPECT_EQ(bench.store().write(0, bytes), Status::kHardwareFault);
  EXPECT_EQ(bench.flash().operations(), operations);
}

TEST(H743Flash, EndsWhereTheMemoryStaysBusy) {
  Bench bench;
  bench.flash().stay_busy(true);
  EXPECT_EQ(bench.store().write(0, std::array<std::uint8_t, 1>{7}), Status::kHardwareFault);
  bench.flash().stay_busy(false);
  EXPECT_EQ(bench.store().write(0, std::array<std::uint8_t, 1>{7}), Status::kOk);
}

}  // namespace
}  // namespace emax::test
