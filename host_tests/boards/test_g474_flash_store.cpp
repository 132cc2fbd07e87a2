// The store in the flash memory of the NUCLEO-G474RE, run on the PC over fake registers: it keeps
// the contract of a store, and records survive a power cut in each of its operations.
#include <array>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "emax/app/store/record_store.hpp"
#include "emax/board/g474_flash_store.hpp"

#include "boards/fakes/fake_flash.hpp"
#include "hal/board_conformance.hpp"

namespace emax::test {
namespace {

using app::RecordStore;
using app::StoredRecord;
using board::G474FlashStore;
using Bytes = std::vector<std::uint8_t>;

/// A chip and the driver on it. The suite cuts the power after bytes, this after operations: there
/// are as many bytes in a slot, so all operations of a write have their turn.
class Bench {
 public:
  Bench() {
    flash_.set_interrupt([this] { strays_ += store_.take_read_error() ? 0 : 1; });
  }
  Bench(const Bench&) = delete;

  G474FlashStore& store() { return store_; }
  FakeFlash& flash() { return flash_; }
  void cut_power_after(std::uint64_t operations) { flash_.cut_power_after(operations); }
  void restore_power() { flash_.restore_power(); }
  bool powered() const { return flash_.powered(); }
  /// Interrupts that the store did not know.
  int strays() const { return strays_; }

  Bytes record(std::uint32_t number) {
    Bytes bytes(RecordStore(store_).capacity());
    const StoredRecord found = RecordStore(store_).read(number, {bytes.data(), bytes.size()});
    EXPECT_TRUE(found.status == Status::kOk || found.status == Status::kNothingStored);
    bytes.resize(found.bytes);
    return bytes;
  }

  Status keep(std::uint32_t number, const Bytes& bytes) {
    Bytes frame(bytes.size() + RecordStore::kFrameBytes);
    std::copy(bytes.begin(), bytes.end(), frame.begin() + RecordStore::kHeaderBytes);
    return RecordStore(store_).write(number, {frame.data(), frame.size()});
  }

 private:
  FakeFlash flash_;
  G474FlashStore store_;
  int strays_ = 0;
};

TEST(G474FlashStore, KeepsTheContract) {
  Bench bench;
  EXPECT_TRUE(violated_by_store(bench).none());
  EXPECT_EQ(bench.strays(), 0);
  EXPECT_GT(bench.flash().operations(), 1000U);
  EXPECT_EQ(bench.flash().cached_operations(), 0U);
  EXPECT_TRUE(bench.flash().is_locked());
  EXPECT_TRUE(bench.flash().is_data_cache_on());
}

TEST(G474FlashStore, RecordsSurviveACutInEachOperation) {
  const Bytes first(1200, 0x11);
  const Bytes second(1200, 0x22);
  const Bytes third(700, 0x33);
  for (std::uint64_t operations = 0; operations < 1000; ++operations) {
    Bench bench;
    ASSERT_EQ(bench.keep(0, first), Status::kOk);
    ASSERT_EQ(bench.keep(1, second), Status::kOk);
    bench.cut_power_after(operations);
    const bool is_done = bench.keep(0, third) == Status::kOk;
    EXPECT_EQ(is_done, bench.powered());
    bench.restore_power();
    // After the cut: the record of before; never a mixture, and the other one untouched.
    EXPECT_EQ(bench.record(0), is_done ? third : first) << operations;
    EXPECT_EQ(bench.record(1), second) << operations;
    EXPECT_EQ(bench.keep(0, second), Status::kOk) << operations;
    EXPECT_EQ(bench.record(0), second) << operations;
    EXPECT_EQ(bench.strays(), 0);
    if (is_done) {
      // The pages, and 720 bytes in double words.
      EXPECT_EQ(operations, board::kPagesPerSlot + 90U);
      return;
    }
  }
  ADD_FAILURE() << "no write was done";
}

TEST(G474FlashStore, FirstRecordSurvivesACutToo) {
  for (const std::uint64_t operations : {0U, 1U, 2U, 50U}) {
    Bench bench;
    bench.cut_power_after(operations);
    EXPECT_EQ(bench.keep(3, Bytes(1000, 0x44)), Status::kHardwareFault);
    bench.restore_power();
    EXPECT_EQ(bench.record(3), Bytes());
    EXPECT_EQ(bench.keep(3, Bytes(1000, 0x55)), Status::kOk);
    EXPECT_EQ(bench.record(3), Bytes(1000, 0x55));
  }
}

TEST(G474FlashStore, SlotsAreTheLastPagesOfTheSecondBank) {
  Bench bench;
  const std::array<std::uint8_t, 9> bytes = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  ASSERT_EQ(bench.store().write(3, bytes), Status::kOk);
  for (std::uint32_t i = 0; i < 9; ++i) {
    const std::uint32_t page = 128 - (board::kStoreFormat.slot_count - 3) * board::kPagesPerSlot;
    EXPECT_EQ(bench.flash().byte_at(page * 2048 + i), i + 1);
  }
}

TEST(G474FlashStore, ClearsTheFlagsOfBefore) {
  Bench bench;
  for (unsigned bit = 1; bit < 16; ++bit) {
    if ((0xC3FAU >> bit & 1U) != 0) {
      bench.flash().leave_flag(1U << bit);
      EXPECT_EQ(bench.store().write(0, std::array<std::uint8_t, 1>{7}), Status::kOk) << bit;
    }
  }
}

TEST(G474FlashStore, RefusesPagesOfOneBank) {
  Bench bench;
  ASSERT_EQ(bench.keep(0, Bytes(10, 1)), Status::kOk);
  bench.flash().set_options(0);
  const std::uint64_t operations = bench.flash().operations();
  std::array<std::uint8_t, 4> bytes = {};
  EXPECT_EQ(bench.store().read(0, bytes), Status::kHardwareFault);
  EXPECT_EQ(bench.store().write(0, bytes), Status::kHardwareFault);
  EXPECT_EQ(bench.flash().operations(), operations);
}

TEST(G474FlashStore, EndsWhereTheMemoryStaysBusy) {
  Bench bench;
  bench.flash().stay_busy(true);
  EXPECT_EQ(bench.store().write(0, std::array<std::uint8_t, 1>{7}), Status::kHardwareFault);
  bench.flash().stay_busy(false);
  EXPECT_EQ(bench.store().write(0, std::array<std::uint8_t, 1>{7}), Status::kOk);
}

TEST(G474FlashStore, LeavesErrorsThatAreNotItsOwnToOthers) {
  Bench bench;
  ASSERT_EQ(bench.keep(0, Bytes(10, 1)), Status::kOk);
  EXPECT_FALSE(bench.store().take_read_error());
}

}  // namespace
}  // namespace emax::test
