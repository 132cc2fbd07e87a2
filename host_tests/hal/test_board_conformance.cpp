// The suites for console, clock, watchdog and store pass the ones in memory and find, clause by
// clause, what broken ones violate; beside them, what the public functions check for any board.
#include <algorithm>
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "hal/board_conformance.hpp"
#include "support/manual_clock.hpp"
#include "support/manual_watchdog.hpp"
#include "support/memory_byte_stream.hpp"
#include "support/memory_store.hpp"

namespace emax::test {
namespace {

using hal::StoreFormat;

constexpr std::size_t kRoom = 300;
constexpr StoreFormat kStoreFormat = {3, 64, 8};

TEST(ByteStreamConformance, MemoryPasses) {
  for (const std::size_t room : {std::size_t{256}, kRoom, std::size_t{4096}}) {
    MemoryByteStream stream(room);
    EXPECT_TRUE(violated_by_byte_stream(stream).none()) << room;
  }
}

/// A console that has the public functions of a stream, over one that works.
class BrokenConsole {
 public:
  explicit BrokenConsole(ByteStreamClause defect) : defect_(defect) {}

  BrokenConsole& stream() { return *this; }
  void send(const std::string& bytes) { stream_.send(bytes); }
  void connect(bool connected) { stream_.connect(connected); }
  bool connected() const { return stream_.connected(); }

  std::string receive() {
    std::string bytes = stream_.receive();
    if (has(ByteStreamClause::kOutput)) {
      std::replace(bytes.begin(), bytes.end(), '\n', '\r');
    }
    return bytes;
  }

  std::size_t read(Span<char> bytes) {
    const std::size_t count = stream_.read(bytes);
    if (has(ByteStreamClause::kNothingToRead) && count == 0 && !bytes.empty()) {
      bytes[0] = '\0';
      return 1;
    }
    if (has(ByteStreamClause::kInput)) {
      for (std::size_t i = 0; i < count; ++i) {
        bytes[i] = static_cast<char>(bytes[i] & 0x7F);
      }
    }
    return count;
  }

  std::size_t write(Span<const char> bytes) {
    if (has(ByteStreamClause::kPeer) && !connected()) {
      return bytes.size();
    }
    const std::size_t count = stream_.write(bytes);
    return has(ByteStreamClause::kRoom) ? bytes.size() : count;
  }

  std::uint32_t take_lost_count() {
    return has(ByteStreamClause::kLostCount) ? 0 : stream_.take_lost_count();
  }

 private:
  bool has(ByteStreamClause defect) const { return defect_ == defect; }

  ByteStreamClause defect_;
  MemoryByteStream stream_{kRoom};
};

TEST(ByteStreamConformance, EachClauseFindsItsBrokenConsole) {
  for (const ByteStreamClause clause :
       {ByteStreamClause::kNothingToRead, ByteStreamClause::kInput, ByteStreamClause::kOutput,
        ByteStreamClause::kRoom, ByteStreamClause::kPeer, ByteStreamClause::kLostCount}) {
    BrokenConsole console(clause);
    EXPECT_TRUE(violated_by_byte_stream(console).has(clause)) << static_cast<int>(clause);
  }
}

/// A board that claims to have moved more bytes than there were.
class BoastingConsole final : public hal::ByteStream {
 public:
  void connect(bool connected) { connected_ = connected; }
  int calls() const { return calls_; }

 private:
  std::size_t do_read(Span<char> bytes) noexcept override {
    ++calls_;
    return bytes.size() + 1;
  }
  std::size_t do_write(Span<const char> bytes) noexcept override {
    ++calls_;
    return bytes.size() + 1;
  }
  bool do_connected() const noexcept override { return connected_; }
  std::uint32_t do_take_lost_count() noexcept override { return 0; }

  bool connected_ = true;
  int calls_ = 0;
};

TEST(ByteStream, CountsStayWithinTheCallersBytes) {
  BoastingConsole console;
  std::array<char, 5> bytes = {};
  EXPECT_EQ(console.read(bytes), bytes.size());
  EXPECT_EQ(console.write(Span<const char>(bytes)), bytes.size());
  EXPECT_EQ(console.calls(), 2);
}

TEST(ByteStream, BoardIsNotAskedForNothing) {
  BoastingConsole console;
  EXPECT_EQ(console.read({}), 0U);
  EXPECT_EQ(console.write({}), 0U);
  console.connect(false);
  EXPECT_EQ(console.write(Span<const char>("abc", 3)), 0U);
  EXPECT_EQ(console.calls(), 0);
}

TEST(ClockConformance, ManualClockPasses) {
  for (const std::uint32_t resolution_us : {1U, 8U, 1000U}) {
    ManualClock clock(resolution_us);
    EXPECT_TRUE(violated_by_clock(clock).none()) << resolution_us;
  }
}

/// A clock that has the public functions of one, over one that works.
class BrokenClock {
 public:
  explicit BrokenClock(ClockClause defect) : defect_(defect) {}

  BrokenClock& clock() { return *this; }
  void wait_us(std::uint64_t time_us) { clock_.wait_us(time_us); }
  std::uint32_t resolution_us() const { return 10; }

  std::uint64_t now_us() {
    const std::uint64_t now_us = clock_.now_us();
    if (defect_ == ClockClause::kNeverBack) {
      return now_us % 65536;
    }
    if (defect_ == ClockClause::kResolution) {
      return now_us / 1000 * 1000;
    }
    return now_us + now_us / 100;
  }

 private:
  ClockClause defect_;
  ManualClock clock_;
};

TEST(ClockConformance, EachClauseFindsItsBrokenClock) {
  for (const ClockClause clause :
       {ClockClause::kResolution, ClockClause::kNeverBack, ClockClause::kKeepsTime}) {
    BrokenClock clock(clause);
    EXPECT_TRUE(violated_by_clock(clock).has(clause)) << static_cast<int>(clause);
  }
}

TEST(ClockConformance, ToleranceIsRelative) {
  BrokenClock fast(ClockClause::kKeepsTime);
  EXPECT_TRUE(violated_by_clock(fast, 0.011).none());
  BrokenClock faster(ClockClause::kKeepsTime);
  EXPECT_FALSE(violated_by_clock(faster, 0.009).none());
}

TEST(Clock, StandsStillWhileTheBoardsCountGoesBack) {
  ManualClock clock;
  clock.set_us(1000);
  EXPECT_EQ(clock.now_us(), 1000U);
  clock.set_us(10);
  EXPECT_EQ(clock.now_us(), 1000U);
  clock.set_us(1001);
  EXPECT_EQ(clock.now_us(), 1001U);
}

TEST(WatchdogConformance, ManualWatchdogPasses) {
  for (const std::uint32_t period_us : {100U, 1000000U, 0xFFFFFFFFU}) {
    EXPECT_TRUE(violated_by_watchdog([=] { return ManualWatchdog(period_us); }).none())
        << period_us;
  }
}

/// A watchdog that has the public functions of one.
class BrokenWatchdog {
 public:
  explicit BrokenWatchdog(WatchdogClause defect) : defect_(defect) {}

  BrokenWatchdog& watchdog() { return *this; }
  std::uint32_t period_us() const { return has(WatchdogClause::kPeriod) ? 0 : 1000; }
  bool running() const { return watchdog_.running(); }
  bool bitten() const { return !has(WatchdogClause::kBites) && watchdog_.bitten(); }
  void wait_us(std::uint64_t time_us) { watchdog_.wait_us(time_us); }

  void kick() {
    if (!has(WatchdogClause::kKickHolds)) {
      watchdog_.kick();
    }
  }

  Status start() {
    if (has(WatchdogClause::kStart)) {
      watchdog_.kick();
    }
    return watchdog_.start();
  }

 private:
  bool has(WatchdogClause defect) const { return defect_ == defect; }

  WatchdogClause defect_;
  ManualWatchdog watchdog_{1000};
};

TEST(WatchdogConformance, EachClauseFindsItsBrokenWatchdog) {
  for (const WatchdogClause clause : {WatchdogClause::kPeriod, WatchdogClause::kStart,
                                      WatchdogClause::kKickHolds, WatchdogClause::kBites}) {
    EXPECT_TRUE(violated_by_watchdog([=] { return BrokenWatchdog(clause); }).has(clause))
        << static_cast<int>(clause);
  }
}

TEST(Watchdog, PeriodOfZeroDoesNotStart) {
  ManualWatchdog watchdog(0);
  EXPECT_EQ(watchdog.start(), Status::kHardwareFault);
  EXPECT_FALSE(watchdog.running());
}

// A timer that cannot be relied on may run nevertheless, and nothing but kicks holds it.
TEST(Watchdog, IsKickedAlsoAfterAStartThatFailed) {
  class Unsure final : public hal::Watchdog {
   public:
    constexpr Unsure() noexcept : Watchdog(1000) {}
    int kicks = 0;

   private:
    Status do_start() noexcept override { return Status::kHardwareFault; }
    void do_kick() noexcept override { ++kicks; }
    bool do_caused_reset() const noexcept override { return false; }
  };
  Unsure watchdog;
  watchdog.kick();
  EXPECT_FALSE(watchdog.failed());
  EXPECT_EQ(watchdog.start(), Status::kHardwareFault);
  watchdog.kick();
  EXPECT_EQ(watchdog.kicks, 1);
  EXPECT_TRUE(watchdog.failed());
  EXPECT_FALSE(watchdog.running());
}

TEST(Watchdog, SaysThatItCausedTheReset) {
  EXPECT_TRUE(ManualWatchdog(1000, true).caused_reset());
  EXPECT_FALSE(ManualWatchdog(1000).caused_reset());
}

TEST(StoreConformance, MemoryPasses) {
  for (const StoreFormat& format : {kStoreFormat, StoreFormat{2, 1, 1}, StoreFormat{5, 21, 7},
                                    StoreFormat{2, 512, 256}, StoreFormat{2, 32, 32}}) {
    MemoryStore store(format);
    EXPECT_TRUE(violated_by_store(store).none())
        << format.slot_count << " slots of " << format.slot_bytes << ", unit " << format.unit_bytes;
    EXPECT_EQ(store.misuses(), 0U);
  }
}

/// A store that has the public functions of one, over one that works.
class BrokenStore {
 public:
  explicit BrokenStore(StoreClause defect) : defect_(defect) {}

  BrokenStore& store() { return *this; }
  void cut_power_after(std::uint64_t bytes) { store_.cut_power_after(bytes); }
  void restore_power() { store_.restore_power(); }
  bool powered() const { return store_.powered(); }

  StoreFormat format() const {
    return has(StoreClause::kFormat) ? StoreFormat{3, 63, 8} : kStoreFormat;
  }

  Status read(std::uint32_t slot, Span<std::uint8_t> bytes) { return read(slot, 0, bytes); }
  Status read(std::uint32_t slot, std::uint32_t offset, Span<std::uint8_t> bytes) {
    const Status status = store_.read(slot, offset, bytes);
    if (has(StoreClause::kRange) && status == Status::kInvalidArgument && !bytes.empty()) {
      bytes[0] = 0;
    }
    return status;
  }

  Status write(std::uint32_t slot, Span<const std::uint8_t> bytes) {
    std::vector<std::uint8_t> all(bytes.begin(), bytes.end());
    if (has(StoreClause::kKeeps) && !all.empty()) {
      all.back() = 0;
    }
    if (has(StoreClause::kRestErased) && all.size() < kStoreFormat.slot_bytes) {
      all.resize(kStoreFormat.slot_bytes, 0);
    }
    if (has(StoreClause::kSlotsApart) && slot == 0 && !all.empty()) {
      (void)store_.write(kStoreFormat.slot_count - 1, {all.data(), 1});
    }
    const Status status = store_.write(slot, {all.data(), all.size()});
    if (has(StoreClause::kCut) && !powered()) {
      store_.at(kStoreFormat.slot_count - 1, 0) ^= 1U;
    }
    return has(StoreClause::kFault) && status == Status::kHardwareFault ? Status::kOk : status;
  }

 private:
  bool has(StoreClause defect) const { return defect_ == defect; }

  StoreClause defect_;
  MemoryStore store_{kStoreFormat};
};

TEST(StoreConformance, EachClauseFindsItsBrokenStore) {
  for (const StoreClause clause :
       {StoreClause::kFormat, StoreClause::kRange, StoreClause::kKeeps, StoreClause::kRestErased,
        StoreClause::kSlotsApart, StoreClause::kCut, StoreClause::kFault}) {
    BrokenStore store(clause);
    EXPECT_TRUE(violated_by_store(store).has(clause)) << static_cast<int>(clause);
  }
}

TEST(Store, ProgramsWholeUnitsOnceAndInOrder) {
  // Two bytes of a unit of eight: a slot erased, one unit programmed.
  MemoryStore store(kStoreFormat);
  const std::uint8_t bytes[] = {1, 2};
  EXPECT_EQ(store.write(1, bytes), Status::kOk);
  EXPECT_EQ(store.bytes_changed(), 64U + 8U);
  // Cut after the first unit of two: the first has come, the second has not.
  const std::array<std::uint8_t, 16> next = {3, 3, 3, 3, 3, 3, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4};
  store.cut_power_after(64 + 8);
  EXPECT_EQ(store.write(1, next), Status::kHardwareFault);
  EXPECT_EQ(store.at(1, 7), 3);
  EXPECT_EQ(store.at(1, 9), hal::kErasedByte);
}

/// A memory one byte of which always reads the same.
class StuckStore final : public hal::Store {
 public:
  explicit StuckStore(const StoreFormat& format) : Store(format) {}

 private:
  Status do_read(std::uint32_t slot, std::uint32_t offset,
                 Span<std::uint8_t> bytes) noexcept override {
    (void)slot;
    (void)offset;
    std::fill(bytes.begin(), bytes.end(), std::uint8_t{0x5A});
    return Status::kOk;
  }
  Status do_erase(std::uint32_t) noexcept override { return Status::kOk; }
  Status do_program(std::uint32_t, std::uint32_t, Span<const std::uint8_t>) noexcept override {
    return Status::kOk;
  }
};

TEST(Store, WriteReadsBack) {
  StuckStore store(kStoreFormat);
  std::vector<std::uint8_t> bytes(64, 0x5A);
  EXPECT_EQ(store.write(0, {bytes.data(), 64}), Status::kOk);
  EXPECT_EQ(store.write(0, {bytes.data(), 63}), Status::kHardwareFault) << "rest not erased";
  bytes[63] = 0x5B;
  EXPECT_EQ(store.write(0, {bytes.data(), 64}), Status::kHardwareFault);
}

/// A memory that answers as it is told, and one byte of which cannot be programmed.
class ToldStore final : public hal::Store {
 public:
  explicit ToldStore(const StoreFormat& format) : Store(format), bytes_(format.slot_bytes, 0xFF) {}

  Status read_answer = Status::kOk;
  Status erase_answer = Status::kOk;
  Status program_answer = Status::kOk;
  std::size_t stuck = SIZE_MAX;

 private:
  Status do_read(std::uint32_t, std::uint32_t offset, Span<std::uint8_t> bytes) noexcept override {
    std::copy_n(bytes_.data() + offset, bytes.size(), bytes.data());
    return read_answer;
  }
  Status do_erase(std::uint32_t) noexcept override {
    std::fill(bytes_.begin(), bytes_.end(), hal::kErasedByte);
    return erase_answer;
  }
  Status do_program(std::uint32_t, std::uint32_t offset,
                    Span<const std::uint8_t> unit) noexcept override {
    for (std::size_t i = 0; i < unit.size(); ++i) {
      bytes_[offset + i] = offset + i == stuck ? hal::kErasedByte : unit[i];
    }
    return program_answer;
  }

  std::vector<std::uint8_t> bytes_;
};

TEST(Store, EveryByteIsReadBack) {
  const std::vector<std::uint8_t> bytes(64, 0x5A);
  for (std::size_t stuck = 0; stuck < 64; ++stuck) {
    ToldStore store(kStoreFormat);
    EXPECT_EQ(store.write(0, {bytes.data(), 64}), Status::kOk);
    store.stuck = stuck;
    EXPECT_EQ(store.write(0, {bytes.data(), 64}), Status::kHardwareFault) << stuck;
  }
}

// Whatever a board answers that is not kOk: the contract knows one fault only.
TEST(Store, AnyFaultOfTheMemoryIsAHardwareFault) {
  const std::uint8_t bytes[] = {1, 2};
  std::uint8_t found[2] = {};
  for (const Status answer :
       {Status::kHardwareFault, Status::kLateBlock, Status::kInvalidArgument}) {
    ToldStore store({1, 64, 8});
    EXPECT_EQ(store.write(0, bytes), Status::kOk);
    EXPECT_EQ(store.read(0, found), Status::kOk);
    store.read_answer = answer;
    EXPECT_EQ(store.read(0, found), Status::kHardwareFault);
    EXPECT_EQ(store.write(0, bytes), Status::kHardwareFault) << "it cannot be read back";
    store.read_answer = Status::kOk;
    store.erase_answer = answer;
    EXPECT_EQ(store.write(0, bytes), Status::kHardwareFault);
    store.erase_answer = Status::kOk;
    store.program_answer = answer;
    EXPECT_EQ(store.write(0, bytes), Status::kHardwareFault);
  }
}

TEST(Store, FormatsAtTheEndsOfTheirRangesAreWritten) {
  const std::uint8_t byte[] = {7};
  for (const StoreFormat& format :
       {StoreFormat{1, 1, 1}, StoreFormat{1, 256, 256}, StoreFormat{1, 512, 256}}) {
    ToldStore store(format);
    EXPECT_EQ(store.write(0, byte), Status::kOk) << format.slot_bytes;
    EXPECT_EQ(store.write(1, byte), Status::kInvalidArgument);
  }
}

TEST(Store, FormatsOutsideTheirRangesAreNotWritten) {
  for (const StoreFormat& format :
       {StoreFormat{2, 64, 0}, StoreFormat{2, 65, 8}, StoreFormat{2, 1024, 512},
        StoreFormat{2, 0, 8}, StoreFormat{2, 514, 257}}) {
    StuckStore store(format);
    EXPECT_EQ(store.write(0, Span<const std::uint8_t>()), Status::kHardwareFault)
        << format.unit_bytes;
  }
}

}  // namespace
}  // namespace emax::test
