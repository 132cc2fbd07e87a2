// The log of copies in two sectors: it keeps the contract of a store, a cut in any of its
// operations leaves each slot as before or as after, and what is damaged is told and harms nothing
// else.
#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

#include "emax/app/store/record_store.hpp"
#include "emax/board/log_store.hpp"

#include "boards/fakes/fake_sectors.hpp"
#include "hal/board_conformance.hpp"

namespace emax::test {
namespace {

using board::LogStore;
using Bytes = std::vector<std::uint8_t>;

struct Shape {
  hal::StoreFormat format;
  std::uint32_t sector_bytes;
};
// The units of an STM32G474 and of an STM32H743; six slots of three units each.
constexpr Shape kShapes[] = {{{6, 24, 8}, 1024}, {{6, 96, 32}, 2048}};

/// A memory and the store on it, from power on to power on.
class Bench {
 public:
  explicit Bench(const Shape& shape)
      : shape_(shape), memory_(shape.sector_bytes, shape.format.unit_bytes) {
    start_ = power_on();
  }
  Bench(const Bench& other) : shape_(other.shape_), memory_(other.memory_) { start_ = power_on(); }

  LogStore& store() { return store_; }
  FakeSectors& memory() { return memory_; }
  Status start_status() const { return start_; }
  Status power_on() {
    memory_.restore_power();
    start_ = store_.start();
    return start_;
  }

  // For the suite of stores.
  void cut_power_after(std::uint64_t operations) {
    memory_.cut_power_after(operations, Cut::kUnreadable);
  }
  void restore_power() { (void)power_on(); }
  bool powered() const { return memory_.powered(); }

  Status write(std::uint32_t slot, const Bytes& bytes) {
    return store_.write(slot, {bytes.data(), bytes.size()});
  }
  /// The whole slot, or nothing where it cannot be read.
  Bytes read(std::uint32_t slot) {
    Bytes bytes(shape_.format.slot_bytes);
    return store_.read(slot, {bytes.data(), bytes.size()}) == Status::kOk ? bytes : Bytes();
  }
  /// What a slot reads as after these were written.
  Bytes filled(Bytes bytes) const {
    bytes.resize(shape_.format.slot_bytes, hal::kErasedByte);
    return bytes;
  }
  std::uint32_t slots() const { return shape_.format.slot_count; }
  std::uint32_t unit() const { return shape_.format.unit_bytes; }

 private:
  Shape shape_;
  FakeSectors memory_;
  LogStore store_{shape_.format, shape_.sector_bytes, memory_};
  Status start_ = Status::kOk;
};

Bytes content(std::size_t bytes, std::uint32_t seed) {
  Bytes all(bytes);
  for (std::size_t i = 0; i < bytes; ++i) {
    all[i] = static_cast<std::uint8_t>(seed * 37 + i * 11 + 1);
  }
  return all;
}

/// Writes until so many more have been done, over all slots, of all lengths.
void write_many(Bench& bench, std::map<std::uint32_t, Bytes>& kept, std::uint32_t count,
                std::uint32_t seed) {
  for (std::uint32_t i = 0; i < count; ++i) {
    // Slot 5 is never written.
    const std::uint32_t slot = i % 5;
    const Bytes bytes = content((i + seed) % (3 * bench.unit() + 1), i + seed);
    ASSERT_EQ(bench.write(slot, bytes), Status::kOk) << i;
    kept[slot] = bench.filled(bytes);
  }
}

void expect_kept(Bench& bench, const std::map<std::uint32_t, Bytes>& kept,
                 const std::string& where) {
  for (std::uint32_t slot = 0; slot < bench.slots(); ++slot) {
    const auto found = kept.find(slot);
    EXPECT_EQ(bench.read(slot), found == kept.end() ? bench.filled({}) : found->second)
        << where << ", slot " << slot;
  }
}

TEST(LogStore, PassesTheSuiteOfStores) {
  for (const Shape& shape : {kShapes[0], kShapes[1], Shape{{2, 256, 256}, 8192},
                             Shape{{16, 21, 7}, 4096}, Shape{{3, 5, 1}, 600}}) {
    Bench bench(shape);
    EXPECT_TRUE(violated_by_store(bench).none()) << shape.format.unit_bytes;
    EXPECT_EQ(bench.memory().misuses(), 0U);
  }
}

TEST(LogStore, HasRoomForTheRecordsOfABoard) {
  // 10 slots of 1504 bytes in a sector of 128 KiB: 32 + 1504 + 2 * 32 = 1600 bytes each.
  Bench bench({{10, 1504, 32}, 131072});
  EXPECT_EQ(bench.store().places(), 131072U / 1600U);
  EXPECT_EQ(bench.store().free_writes(), 81U + 71U);
  std::map<std::uint32_t, Bytes> kept;
  for (std::uint32_t i = 0; i < 81 + 71; ++i) {
    const Bytes bytes = content(1300, i);
    ASSERT_EQ(bench.write(i % 10, bytes), Status::kOk) << i;
    kept[i % 10] = bench.filled(bytes);
  }
  expect_kept(bench, kept, "full");
  EXPECT_EQ(bench.store().free_writes(), 0U);
}

TEST(LogStore, NeverErasesInAWrite) {
  for (const Shape& shape : kShapes) {
    Bench bench(shape);
    std::map<std::uint32_t, Bytes> kept;
    // All slots are in use, so this is exactly what there is room for.
    ASSERT_EQ(bench.write(5, {5}), Status::kOk);
    kept[5] = bench.filled({5});
    write_many(bench, kept, bench.store().free_writes(), 1);
    EXPECT_EQ(bench.memory().erasures(), 0U);
    // The full log says so, and keeps what it has.
    EXPECT_TRUE(bench.store().wants_erase());
    EXPECT_EQ(bench.write(0, {1}), Status::kHardwareFault);
    EXPECT_EQ(bench.memory().erasures(), 0U);
    expect_kept(bench, kept, "full");
    EXPECT_EQ(bench.store().erase_ahead(), Status::kOk);
    EXPECT_EQ(bench.memory().erasures(), 1U);
    EXPECT_FALSE(bench.store().wants_erase());
    write_many(bench, kept, bench.store().free_writes(), 2);
    expect_kept(bench, kept, "erased");
    EXPECT_EQ(bench.memory().misuses(), 0U);
  }
}

TEST(LogStore, LivesForManyTurns) {
  Bench bench({kShapes[1].format, 4096});
  std::map<std::uint32_t, Bytes> kept;
  for (std::uint32_t turn = 0; turn < 100; ++turn) {
    write_many(bench, kept, 7, turn);
    ASSERT_EQ(bench.power_on(), Status::kOk) << turn;
    expect_kept(bench, kept, "turn " + std::to_string(turn));
  }
  EXPECT_GT(bench.memory().erasures(), 20U);
  EXPECT_EQ(bench.memory().misuses(), 0U);
}

/// The operations of one write, with a move if it needs one, cut at each of them in each way; then
/// the operations of the next power on, cut at each of them, too.
void cut_everywhere(const Bench& before, const std::map<std::uint32_t, Bytes>& kept,
                    const std::string& name) {
  const Bytes next = content(2 * before.unit() + 3, 99);
  for (const Cut cut : kCuts) {
    bool is_done = false;
    for (std::uint64_t first = 0; !is_done; ++first) {
      Bench cut_once(before);
      cut_once.memory().cut_power_after(first, cut);
      is_done = cut_once.write(2, next) == Status::kOk;
      ASSERT_EQ(is_done, cut_once.powered());
      ASSERT_LT(first, 1000U);
      bool is_started = false;
      for (std::uint64_t second = 0; !is_started; ++second) {
        const std::string where = name + ": " + std::to_string(static_cast<int>(cut)) + " at " +
                                  std::to_string(first) + ", " + std::to_string(second);
        FakeSectors memory(cut_once.memory());
        LogStore store(cut_once.store().format(), static_cast<std::uint32_t>(memory.bytes() / 2),
                       memory);
        memory.cut_power_after(second, cut);
        is_started = store.start() == Status::kOk;
        ASSERT_EQ(is_started, memory.powered()) << where;
        ASSERT_LT(second, 1000U);
        memory.restore_power();
        ASSERT_EQ(store.start(), Status::kOk) << where;
        std::map<std::uint32_t, Bytes> now = kept;
        Bytes found(store.format().slot_bytes);
        for (std::uint32_t slot = 0; slot < store.format().slot_count; ++slot) {
          ASSERT_EQ(store.read(slot, {found.data(), found.size()}), Status::kOk)
              << where << ", slot " << slot;
          const bool is_new = slot == 2 && found == cut_once.filled(next);
          const auto old = kept.find(slot);
          const Bytes expected = old == kept.end() ? cut_once.filled({}) : old->second;
          EXPECT_TRUE(found == expected || is_new) << where << ", slot " << slot;
          EXPECT_FALSE(slot == 2 && is_done && !is_new) << where;
        }
        // And it goes on.
        EXPECT_EQ(store.write(2, {next.data(), next.size()}), Status::kOk) << where;
        EXPECT_EQ(store.read(2, {found.data(), found.size()}), Status::kOk) << where;
        EXPECT_EQ(found, cut_once.filled(next)) << where;
        EXPECT_EQ(memory.misuses(), 0U) << where;
      }
    }
  }
}

TEST(LogStore, SurvivesACutInEachOperation) {
  for (const Shape& shape : kShapes) {
    Bench bench(shape);
    std::map<std::uint32_t, Bytes> kept;
    cut_everywhere(bench, kept, "empty");
    write_many(bench, kept, 8, 3);
    cut_everywhere(bench, kept, "eight writes");
    // With the last place used the next write moves.
    write_many(bench, kept, bench.store().places() - 8, 4);
    cut_everywhere(bench, kept, "full");
  }
}

TEST(LogStore, FinishesTheErasureThatAPowerCutInterrupts) {
  for (const Shape& shape : kShapes) {
    for (const Cut cut : kCuts) {
      Bench bench(shape);
      std::map<std::uint32_t, Bytes> kept;
      write_many(bench, kept, bench.store().places() + 3, 5);
      ASSERT_TRUE(bench.store().wants_erase());
      bench.memory().cut_power_after(0, cut);
      EXPECT_EQ(bench.store().erase_ahead(), Status::kHardwareFault);
      EXPECT_EQ(bench.power_on(), Status::kOk);
      expect_kept(bench, kept, "cut");
      EXPECT_FALSE(bench.store().wants_erase());
      EXPECT_EQ(bench.store().free_writes(), 2 * bench.store().places() - 3 - 2 * 5 - 1);
      write_many(bench, kept, bench.store().free_writes(), 6);
      expect_kept(bench, kept, "after it");
      EXPECT_EQ(bench.memory().misuses(), 0U);
    }
  }
}

/// Reads all slots after damage: each as it was, or none at all for one of them.
/// @returns How many slots cannot be read.
int lost_slots(Bench& bench, const std::map<std::uint32_t, Bytes>& kept, const std::string& where) {
  int lost = 0;
  for (std::uint32_t slot = 0; slot < bench.slots(); ++slot) {
    const auto found = kept.find(slot);
    const Bytes expected = found == kept.end() ? bench.filled({}) : found->second;
    const Bytes now = bench.read(slot);
    lost += now.empty() ? 1 : 0;
    // Never an older copy, and never damaged bytes.
    EXPECT_TRUE(now.empty() || now == expected) << where << ", slot " << slot;
  }
  return lost;
}

TEST(LogStore, OneFlippedBitCostsOneSlotAtMostAndIsTold) {
  for (const Shape& shape : kShapes) {
    // Within the first sector, after a move, and with the spare not erased yet.
    for (const bool has_moved : {false, true}) {
      Bench bench(shape);
      const std::uint32_t writes = has_moved ? bench.store().places() + 4 : 9;
      std::map<std::uint32_t, Bytes> kept;
      write_many(bench, kept, writes, 7);
      int told = 0;
      for (std::size_t byte = 0; byte < bench.memory().bytes(); ++byte) {
        const std::string where = std::to_string(byte);
        Bench damaged(bench);
        damaged.memory().flip(byte, byte * 5 % 8);
        ASSERT_EQ(damaged.power_on(), Status::kOk) << where;
        const int lost = lost_slots(damaged, kept, where);
        ASSERT_LE(lost, 1) << where;
        told += lost;
        ASSERT_EQ(damaged.write(4, {1, 2, 3}), Status::kOk) << where;
        ASSERT_EQ(damaged.read(4), damaged.filled({1, 2, 3})) << where;
      }
      // The bytes of the copies that count, but not their labels.
      int programmed = 0;
      std::map<std::uint32_t, std::uint32_t> bytes_of;
      for (std::uint32_t i = 0; i < writes; ++i) {
        bytes_of[i % 5] = (i + 7) % (3 * bench.unit() + 1);
      }
      for (const auto& [slot, bytes] : bytes_of) {
        programmed += static_cast<int>((bytes + bench.unit() - 1) / bench.unit() * bench.unit());
      }
      EXPECT_EQ(told, programmed);
    }
  }
}

TEST(LogStore, OneUnreadableUnitCostsOneSlotAtMostAlsoAcrossAMove) {
  for (const Shape& shape : kShapes) {
    Bench bench(shape);
    std::map<std::uint32_t, Bytes> kept;
    write_many(bench, kept, bench.store().places(), 8);
    for (std::size_t byte = 0; byte < bench.memory().bytes(); byte += bench.unit()) {
      Bench damaged(bench);
      damaged.memory().spoil_unit_of(byte);
      const std::string where = std::to_string(byte);
      ASSERT_EQ(damaged.power_on(), Status::kOk) << where;
      const int lost = lost_slots(damaged, kept, where);
      EXPECT_LE(lost, 1) << where;
      // The next write moves all copies; what is lost stays told, and a write mends it.
      std::map<std::uint32_t, Bytes> now = kept;
      ASSERT_EQ(damaged.write(5, {9}), Status::kOk) << where;
      now[5] = damaged.filled({9});
      ASSERT_EQ(damaged.power_on(), Status::kOk) << where;
      EXPECT_EQ(lost_slots(damaged, now, where), lost) << where;
      write_many(damaged, now, 5, 1);
      EXPECT_EQ(lost_slots(damaged, now, where), 0) << where;
      EXPECT_EQ(damaged.memory().misuses(), 0U) << where;
    }
  }
}

TEST(LogStore, KeepsWhatItHasWhileTheMemoryRefusesToProgram) {
  Bench bench(kShapes[1]);
  std::map<std::uint32_t, Bytes> kept;
  write_many(bench, kept, 6, 9);
  for (const std::uint64_t operations : {0U, 1U, 3U, 4U, 5U}) {
    bench.memory().cut_power_after(operations, Cut::kUnreadable);
    EXPECT_EQ(bench.write(1, content(96, 50)), Status::kHardwareFault) << operations;
    // As a memory that fails for a moment: no power on in between.
    bench.memory().restore_power();
    if (operations < 5) {
      expect_kept(bench, kept, std::to_string(operations));
    }
  }
  EXPECT_EQ(bench.write(1, content(96, 51)), Status::kOk);
  EXPECT_EQ(bench.read(1), content(96, 51));
}

TEST(LogStore, RefusesWhatCannotWork) {
  Bench too_small({{6, 24, 8}, 6 * 96});
  EXPECT_EQ(too_small.start_status(), Status::kHardwareFault);
  EXPECT_EQ(too_small.write(0, {1}), Status::kHardwareFault);
  EXPECT_TRUE(too_small.read(0).empty());
  Bench too_many({{17, 8, 8}, 4096});
  EXPECT_EQ(too_many.start_status(), Status::kHardwareFault);

  FakeSectors memory(1024, 8);
  LogStore not_started({6, 24, 8}, 1024, memory);
  std::uint8_t byte = 0;
  EXPECT_EQ(not_started.read(0, {&byte, 1}), Status::kHardwareFault);
  EXPECT_EQ(not_started.write(0, {&byte, 1}), Status::kHardwareFault);
  EXPECT_EQ(not_started.erase_ahead(), Status::kHardwareFault);
  EXPECT_EQ(memory.operations(), 0U);
}

TEST(LogStore, RecordsOfTheInstrumentSurviveACutInEachOperation) {
  using app::RecordStore;
  const auto keep = [](Bench& bench, std::uint32_t number, const Bytes& bytes) {
    Bytes frame(bytes.size() + RecordStore::kFrameBytes);
    std::copy(bytes.begin(), bytes.end(), frame.begin() + RecordStore::kHeaderBytes);
    return RecordStore(bench.store()).write(number, {frame.data(), frame.size()});
  };
  const auto record = [](Bench& bench, std::uint32_t number) {
    Bytes bytes(RecordStore(bench.store()).capacity());
    bytes.resize(RecordStore(bench.store()).read(number, {bytes.data(), bytes.size()}).bytes);
    return bytes;
  };
  const Bytes first(50, 0x11);
  const Bytes second(60, 0x22);
  Bench before(kShapes[1]);
  ASSERT_EQ(keep(before, 0, first), Status::kOk);
  bool is_done = false;
  for (std::uint64_t operations = 0; !is_done; ++operations) {
    ASSERT_LT(operations, 100U);
    Bench bench(before);
    bench.cut_power_after(operations);
    is_done = keep(bench, 0, second) == Status::kOk;
    bench.restore_power();
    const Bytes found = record(bench, 0);
    EXPECT_TRUE(found == second || (!is_done && found == first)) << operations;
  }
}

}  // namespace
}  // namespace emax::test
