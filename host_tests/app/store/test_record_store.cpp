// Records in two copies: whatever the power and the memory do, the old one or the new one is read.
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "emax/app/base/crc32.hpp"
#include "emax/app/store/record_store.hpp"

#include "support/memory_store.hpp"

namespace emax::app {
namespace {

using hal::StoreFormat;
using test::MemoryStore;

using Bytes = std::vector<std::uint8_t>;

constexpr StoreFormat kFormat = {6, 64, 8};

std::uint32_t crc_of(const std::string& text) {
  Crc32 crc;
  crc.add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  return crc.value();
}

// https://reveng.sourceforge.io/crc-catalogue, CRC-32/ISO-HDLC: check value, and residue by which
// every CRC of a message with its own CRC behind it is known.
TEST(Crc32, PublishedCheckValue) {
  EXPECT_EQ(crc_of("123456789"), 0xCBF43926U);
  EXPECT_EQ(crc_of(""), 0U);
  const std::uint32_t crc = crc_of("emax");
  std::string message = "emax";
  for (unsigned i = 0; i < 4; ++i) {
    message += static_cast<char>(crc >> (8U * i));
  }
  EXPECT_EQ(crc_of(message), ~0xDEBB20E3U);
}

TEST(Crc32, PiecesDoNotMatter) {
  const std::array<std::uint8_t, 9> digits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  const Span<const std::uint8_t> all = digits;
  for (std::size_t cut = 0; cut <= all.size(); ++cut) {
    Crc32 crc;
    crc.add(all.first(cut));
    crc.add(all.from(cut));
    EXPECT_EQ(crc.value(), 0xCBF43926U) << cut;
  }
}

Bytes pattern(std::size_t count, unsigned seed) {
  Bytes bytes(count);
  for (std::uint8_t& byte : bytes) {
    seed = seed * 1664525U + 1013904223U;
    byte = static_cast<std::uint8_t>(seed >> 24U);
  }
  return bytes;
}

Status write(hal::Store& store, std::uint32_t number, const Bytes& record) {
  Bytes frame(record.size() + RecordStore::kFrameBytes, 0x33);
  const Span<std::uint8_t> place = RecordStore::record_in({frame.data(), frame.size()});
  EXPECT_EQ(place.size(), record.size());
  std::copy(record.begin(), record.end(), place.begin());
  return RecordStore(store).write(number, {frame.data(), frame.size()});
}

// A copy of what is read, or of what cannot be any record if nothing is.
Bytes read(hal::Store& store, std::uint32_t number) {
  Bytes bytes(100, 0x55);
  const StoredRecord stored = RecordStore(store).read(number, {bytes.data(), bytes.size()});
  if (stored.status != Status::kOk) {
    EXPECT_EQ(stored.bytes, 0U);
    return Bytes(1, static_cast<std::uint8_t>(stored.status));
  }
  bytes.resize(stored.bytes);
  return bytes;
}

Bytes nothing() { return Bytes(1, static_cast<std::uint8_t>(Status::kNothingStored)); }

TEST(RecordStore, HoldsWhatWasWritten) {
  MemoryStore memory(kFormat);
  const RecordStore records(memory);
  EXPECT_EQ(records.count(), 3U);
  EXPECT_EQ(records.capacity(), 44U);
  for (std::uint32_t number = 0; number < 3; ++number) {
    EXPECT_EQ(read(memory, number), nothing());
  }
  for (const std::size_t size : {44U, 0U, 1U, 43U, 7U}) {
    for (std::uint32_t number = 0; number < 3; ++number) {
      ASSERT_EQ(write(memory, number, pattern(size, number)), Status::kOk);
    }
    for (std::uint32_t number = 0; number < 3; ++number) {
      EXPECT_EQ(read(memory, number), pattern(size, number)) << size;
    }
  }
  EXPECT_EQ(memory.misuses(), 0U);
}

TEST(RecordStore, RefusesWhatItCannotHold) {
  MemoryStore memory(kFormat);
  ASSERT_EQ(write(memory, 2, pattern(5, 1)), Status::kOk);
  EXPECT_EQ(write(memory, 3, pattern(5, 2)), Status::kInvalidArgument);
  EXPECT_EQ(write(memory, 2, pattern(45, 2)), Status::kInvalidArgument);
  Bytes short_frame(RecordStore::kFrameBytes - 1);
  RecordStore records(memory);
  EXPECT_EQ(records.write(2, {short_frame.data(), short_frame.size()}), Status::kInvalidArgument);
  EXPECT_EQ(read(memory, 2), pattern(5, 1));
  std::array<std::uint8_t, 4> room = {};
  EXPECT_EQ(records.read(3, room).status, Status::kInvalidArgument);
  EXPECT_EQ(records.read(2, room).status, Status::kBufferTooSmall);
  MemoryStore tiny({2, 16, 1});
  EXPECT_EQ(RecordStore(tiny).capacity(), 0U);
  EXPECT_EQ(write(tiny, 0, {}), Status::kInvalidArgument);
  MemoryStore odd({3, 64, 8});
  EXPECT_EQ(RecordStore(odd).count(), 1U);
}

TEST(RecordStore, CutAtEveryByteLeavesTheOldOrTheNew) {
  for (const StoreFormat& format :
       {StoreFormat{6, 64, 8}, StoreFormat{4, 60, 1}, StoreFormat{4, 64, 64}}) {
    // The first write of a record, the second, and one over a longer and a shorter one.
    for (const int writes_before : {0, 1, 2, 3}) {
      for (const std::size_t next_size : {3U, 40U}) {
        bool was_old = false;
        bool was_cut = true;
        for (std::uint64_t at = 0; was_cut; ++at) {
          MemoryStore memory(format);
          const Bytes other = pattern(20, 77);
          ASSERT_EQ(write(memory, 1, other), Status::kOk);
          Bytes old = nothing();
          for (int i = 0; i < writes_before; ++i) {
            old = pattern(10 + 9 * static_cast<std::size_t>(i), static_cast<unsigned>(i));
            ASSERT_EQ(write(memory, 0, old), Status::kOk);
          }
          const Bytes next = pattern(next_size, 99);
          memory.cut_power_after(at);
          const Status status = write(memory, 0, next);
          was_cut = !memory.powered();
          EXPECT_EQ(status, was_cut ? Status::kHardwareFault : Status::kOk);
          memory.restore_power();
          const Bytes found = read(memory, 0);
          EXPECT_TRUE(found == next || (was_cut && found == old)) << at;
          was_old = was_old || found == old;
          EXPECT_EQ(read(memory, 1), other) << at;
          // Life goes on.
          const Bytes after = pattern(30, 5);
          EXPECT_EQ(write(memory, 0, after), Status::kOk) << at;
          EXPECT_EQ(read(memory, 0), after) << at;
          EXPECT_EQ(memory.misuses(), 0U);
        }
        EXPECT_TRUE(was_old);
      }
    }
  }
}

TEST(RecordStore, CutsInARowNeverLoseTheRecord) {
  MemoryStore memory(kFormat);
  Bytes held = pattern(12, 0);
  ASSERT_EQ(write(memory, 0, held), Status::kOk);
  for (unsigned i = 1; i < 2000; ++i) {
    const Bytes next = pattern(1 + i % 44, i);
    memory.cut_power_after((i * 37U) % 150U);
    (void)write(memory, 0, next);
    memory.restore_power();
    const Bytes found = read(memory, 0);
    ASSERT_TRUE(found == held || found == next) << i;
    held = found;
  }
}

// What a cut leaves of a copy may be any bytes at all.
TEST(RecordStore, GarbageInOneCopyIsNotRead) {
  for (unsigned seed = 0; seed < 2000; ++seed) {
    MemoryStore memory(kFormat);
    const Bytes old = pattern(17, 1);
    ASSERT_EQ(write(memory, 0, old), Status::kOk);
    const Bytes garbage = pattern(64, seed);
    for (std::uint32_t i = 0; i < 64; ++i) {
      memory.at(1, i) = garbage[i];
    }
    // Half of them begin as a copy does.
    if (seed % 2 == 0) {
      for (std::uint32_t i = 0; i < 8; ++i) {
        memory.at(1, i) = memory.at(0, i);
      }
    }
    EXPECT_EQ(read(memory, 0), old) << seed;
    ASSERT_EQ(write(memory, 0, pattern(9, 2)), Status::kOk);
    EXPECT_EQ(read(memory, 0), pattern(9, 2)) << seed;
  }
}

TEST(RecordStore, EveryFlippedBitIsFound) {
  MemoryStore memory(kFormat);
  const Bytes old = pattern(30, 1);
  const Bytes next = pattern(30, 2);
  ASSERT_EQ(write(memory, 0, old), Status::kOk);
  ASSERT_EQ(write(memory, 0, next), Status::kOk);
  const auto bits = static_cast<std::uint32_t>(8 * (30 + RecordStore::kFrameBytes));
  const auto flip = [&memory](std::uint32_t slot, std::uint32_t bit) {
    memory.at(slot, bit / 8) =
        static_cast<std::uint8_t>(memory.at(slot, bit / 8) ^ (1U << bit % 8));
  };
  for (std::uint32_t bit = 0; bit < bits; ++bit) {
    flip(1, bit);
    EXPECT_EQ(read(memory, 0), old) << bit;
    flip(0, bit);
    EXPECT_EQ(read(memory, 0), nothing()) << bit;
    flip(1, bit);
    EXPECT_EQ(read(memory, 0), next) << bit;
    flip(0, bit);
    // Two at once.
    for (std::uint32_t second = bit + 1; second < bits; second += 13) {
      flip(1, bit);
      flip(1, second);
      EXPECT_EQ(read(memory, 0), old) << bit << ' ' << second;
      flip(1, bit);
      flip(1, second);
    }
  }
}

bool is_damaged(hal::Store& store) {
  Bytes bytes(100);
  return RecordStore(store).read(0, {bytes.data(), bytes.size()}).is_damaged;
}

// Otherwise the record before would pass for the newest one. One bit may make an older copy of a
// newer one, so damage of either copy is told.
TEST(RecordStore, EveryFlippedBitIsTold) {
  for (const int writes : {1, 2, 3, 4}) {
    MemoryStore memory(kFormat);
    for (int i = 0; i < writes; ++i) {
      EXPECT_FALSE(is_damaged(memory));
      ASSERT_EQ(write(memory, 0, pattern(30, static_cast<unsigned>(i))), Status::kOk);
    }
    EXPECT_FALSE(is_damaged(memory));
    const auto bits = static_cast<std::uint32_t>(8 * (30 + RecordStore::kFrameBytes));
    for (std::uint32_t bit = 0; bit < (writes == 1 ? 1U : 2U) * bits; ++bit) {
      std::uint8_t& byte = memory.at(bit / bits, bit % bits / 8);
      byte = static_cast<std::uint8_t>(byte ^ (1U << bit % 8));
      EXPECT_TRUE(is_damaged(memory)) << writes << ' ' << bit;
      byte = static_cast<std::uint8_t>(byte ^ (1U << bit % 8));
    }
  }
}

TEST(RecordStore, WritesEndTheDamage) {
  MemoryStore memory(kFormat);
  ASSERT_EQ(write(memory, 0, pattern(30, 1)), Status::kOk);
  ASSERT_EQ(write(memory, 0, pattern(30, 2)), Status::kOk);
  memory.at(1, 20) ^= 1U;
  ASSERT_TRUE(is_damaged(memory));
  ASSERT_EQ(write(memory, 0, pattern(30, 3)), Status::kOk);
  EXPECT_FALSE(is_damaged(memory));
  EXPECT_EQ(read(memory, 0), pattern(30, 3));
  // With both copies damaged, one write is enough, too.
  memory.at(0, 20) ^= 1U;
  memory.at(1, 20) ^= 1U;
  EXPECT_EQ(read(memory, 0), nothing());
  ASSERT_TRUE(is_damaged(memory));
  ASSERT_EQ(write(memory, 0, pattern(30, 4)), Status::kOk);
  EXPECT_FALSE(is_damaged(memory));
  EXPECT_EQ(read(memory, 0), pattern(30, 4));
}

TEST(RecordStore, NothingWrittenIsNoDamage) {
  MemoryStore memory(kFormat);
  EXPECT_FALSE(is_damaged(memory));
  for (std::uint32_t i = 0; i < 64; ++i) {
    memory.at(0, i) = 0;
    memory.at(1, i) = 0;
  }
  EXPECT_FALSE(is_damaged(memory)) << "memory that nobody has erased yet";
  for (std::uint32_t i = 0; i < 64; ++i) {
    memory.at(0, i) = 0x11;
  }
  EXPECT_TRUE(is_damaged(memory));
}

// The checksum is that of all before it; sizes of one byte only.
void set_checksum(MemoryStore& memory, std::uint32_t slot) {
  const std::uint32_t size = memory.at(slot, 12);
  Crc32 crc;
  crc.add({&memory.at(slot, 0), 16 + size});
  for (std::uint32_t i = 0; i < 4; ++i) {
    memory.at(slot, 16 + size + i) = static_cast<std::uint8_t>(crc.value() >> (8U * i));
  }
}

TEST(RecordStore, CopyOfAnotherRecordIsNotRead) {
  MemoryStore memory(kFormat);
  ASSERT_EQ(write(memory, 0, pattern(30, 1)), Status::kOk);
  for (std::uint32_t i = 0; i < 64; ++i) {
    memory.at(2, i) = memory.at(0, i);
  }
  EXPECT_EQ(read(memory, 1), nothing());
}

TEST(RecordStore, CopyOfAnotherFormatIsNotRead) {
  MemoryStore memory(kFormat);
  ASSERT_EQ(write(memory, 0, pattern(30, 1)), Status::kOk);
  set_checksum(memory, 0);
  ASSERT_EQ(read(memory, 0), pattern(30, 1));
  memory.at(0, 3) = '2';
  set_checksum(memory, 0);
  EXPECT_EQ(read(memory, 0), nothing());
}

TEST(RecordStore, AThousandWritesWearBothCopiesAlike) {
  MemoryStore memory(kFormat);
  std::array<int, 2> writes = {};
  std::array<Bytes, 2> before = {Bytes(64, hal::kErasedByte), Bytes(64, hal::kErasedByte)};
  for (unsigned i = 0; i < 1000; ++i) {
    ASSERT_EQ(write(memory, 0, pattern(20, i)), Status::kOk);
    ASSERT_EQ(read(memory, 0), pattern(20, i)) << i;
    for (std::uint32_t slot = 0; slot < 2; ++slot) {
      const Bytes now(&memory.at(slot, 0), &memory.at(slot, 0) + 64);
      writes[slot] += now == before[slot] ? 0 : 1;
      before[slot] = now;
    }
  }
  EXPECT_EQ(writes[0], 500);
  EXPECT_EQ(writes[1], 500);
  EXPECT_EQ(memory.misuses(), 0U);
}

TEST(RecordStore, GenerationsGoRound) {
  MemoryStore memory(kFormat);
  ASSERT_EQ(write(memory, 0, pattern(4, 1)), Status::kOk);
  // Little endian, at offset 8.
  memory.at(0, 8) = 0xFE;
  for (std::uint32_t i = 9; i < 12; ++i) {
    memory.at(0, i) = 0xFF;
  }
  set_checksum(memory, 0);
  for (unsigned i = 2; i < 8; ++i) {
    ASSERT_EQ(write(memory, 0, pattern(4, i)), Status::kOk);
    EXPECT_EQ(read(memory, 0), pattern(4, i)) << i;
  }
  EXPECT_LT(memory.at(0, 8), 8);
}

/// Memory with error correction: what a cut has left of a slot cannot be read until it is erased.
class CorrectingStore final : public hal::Store {
 public:
  CorrectingStore() : Store(kFormat) {}

  void damage(std::uint32_t slot) { unreadable_[slot] = true; }
  /// After so many reads that succeed, one fails.
  void fail_read_after(int reads) { reads_left_ = reads; }
  /// The slot of the read that failed; none yet: the number of slots.
  std::uint32_t failed_slot() const { return failed_slot_; }

 private:
  Status do_read(std::uint32_t slot, std::uint32_t offset,
                 Span<std::uint8_t> bytes) noexcept override {
    if (reads_left_-- == 0) {
      failed_slot_ = slot;
      return Status::kHardwareFault;
    }
    if (unreadable_[slot]) {
      return Status::kHardwareFault;
    }
    std::copy_n(&memory_[slot][offset], bytes.size(), bytes.data());
    return Status::kOk;
  }
  Status do_erase(std::uint32_t slot) noexcept override {
    memory_[slot].fill(hal::kErasedByte);
    unreadable_[slot] = false;
    return Status::kOk;
  }
  Status do_program(std::uint32_t slot, std::uint32_t offset,
                    Span<const std::uint8_t> unit) noexcept override {
    std::copy_n(unit.data(), unit.size(), &memory_[slot][offset]);
    return Status::kOk;
  }

  std::array<std::array<std::uint8_t, 64>, 6> memory_ = {};
  std::array<bool, 6> unreadable_ = {};
  int reads_left_ = -1;
  std::uint32_t failed_slot_ = 6;
};

TEST(RecordStore, ACopyThatCannotBeReadIsLikeNone) {
  CorrectingStore memory;
  EXPECT_EQ(read(memory, 0), nothing()) << "all bytes zero";
  memory.damage(0);
  EXPECT_EQ(read(memory, 0), nothing());
  EXPECT_TRUE(is_damaged(memory));
  ASSERT_EQ(write(memory, 0, pattern(8, 1)), Status::kOk);
  EXPECT_FALSE(is_damaged(memory));
  memory.damage(1);
  EXPECT_EQ(read(memory, 0), pattern(8, 1));
  EXPECT_TRUE(is_damaged(memory));
  ASSERT_EQ(write(memory, 0, pattern(8, 2)), Status::kOk);
  EXPECT_EQ(read(memory, 0), pattern(8, 2));
  memory.damage(1);
  EXPECT_EQ(read(memory, 0), pattern(8, 1));
  memory.damage(0);
  EXPECT_EQ(read(memory, 0), Bytes(1, static_cast<std::uint8_t>(Status::kHardwareFault)));
  ASSERT_EQ(write(memory, 0, pattern(8, 3)), Status::kOk);
  EXPECT_EQ(read(memory, 0), pattern(8, 3));
}

// The older record or a fault where the newer one is not read to its end; never a part of it.
TEST(RecordStore, AnyOneReadMayFail) {
  const Bytes fault(1, static_cast<std::uint8_t>(Status::kHardwareFault));
  std::array<int, 3> found = {};
  for (int reads = 0;; ++reads) {
    CorrectingStore memory;
    ASSERT_EQ(write(memory, 0, pattern(8, 1)), Status::kOk);
    ASSERT_EQ(write(memory, 0, pattern(8, 2)), Status::kOk);
    CorrectingStore older;
    ASSERT_EQ(write(older, 0, pattern(8, 1)), Status::kOk);
    older.damage(1);
    const bool is_second_newest = read(older, 0) == pattern(8, 1);
    memory.fail_read_after(reads);
    const Bytes result = read(memory, 0);
    if (memory.failed_slot() == 6) {
      EXPECT_EQ(result, pattern(8, 2));
      break;
    }
    const bool is_newest = memory.failed_slot() == (is_second_newest ? 1U : 0U);
    EXPECT_TRUE(is_newest ? result == pattern(8, 1) || result == fault : result == pattern(8, 2))
        << reads;
    found[0] += result == pattern(8, 1) ? 1 : 0;
    found[1] += result == pattern(8, 2) ? 1 : 0;
    found[2] += result == fault ? 1 : 0;
  }
  // Of each copy its head, its bytes and its checksum, and the newest one's bytes once more.
  EXPECT_EQ(found, (std::array<int, 3>{3, 3, 1}));
}

}  // namespace
}  // namespace emax::app
