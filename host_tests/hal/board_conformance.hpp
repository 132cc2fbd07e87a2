// The contracts of console, clock, watchdog and store as suites that any implementation must pass:
// each finds the clauses that are violated.
#pragma once

#include <algorithm>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "emax/hal/byte_stream.hpp"
#include "emax/hal/clock.hpp"
#include "emax/hal/store.hpp"
#include "emax/hal/watchdog.hpp"

namespace emax::test {

/// The clauses of one contract that were seen violated.
template <typename Clause>
class Violations {
 public:
  void require(bool holds, Clause clause) {
    if (!holds) {
      bits_.set(static_cast<std::size_t>(clause));
    }
  }
  bool has(Clause clause) const { return bits_[static_cast<std::size_t>(clause)]; }
  bool none() const { return bits_.none(); }

 private:
  std::bitset<8> bits_;
};

enum class ByteStreamClause : std::uint8_t {
  kNothingToRead,  ///< Nothing came in: 0, and nothing is touched.
  kInput,          ///< All 256 bytes come in unchanged, in order, in pieces of any size.
  kOutput,         ///< And go out so.
  kRoom,           ///< What is not accepted does not go out; there is room again later.
  kPeer,           ///< connected() follows the peer; without one, nothing is accepted.
  kLostCount,      ///< What found no room is counted, once.
};

/// @param[in,out] bench Has `stream()`, `send(string)` and `receive()` of the peer, which together
///                      let at least 256 bytes wait each way and no more than 100 000, and
///                      `connect(bool)`. New, with a peer.
template <typename Bench>
Violations<ByteStreamClause> violated_by_byte_stream(Bench& bench) {
  using C = ByteStreamClause;
  Violations<C> violations;
  auto& stream = bench.stream();
  std::string all;
  for (int value = 0; value < 256; ++value) {
    all += static_cast<char>(value);
  }
  const auto read = [&stream, &violations](std::size_t most) {
    std::string bytes(most + 4, '#');
    const std::size_t count = stream.read({&bytes[0], most});
    violations.require(count <= most && bytes.find_first_not_of('#', count) == std::string::npos,
                       C::kInput);
    return bytes.substr(0, std::min(count, most));
  };
  const auto write = [&stream](const std::string& bytes) {
    return stream.write(Span<const char>(bytes.data(), bytes.size()));
  };

  violations.require(stream.connected(), C::kPeer);
  violations.require(read(8).empty() && read(0).empty(), C::kNothingToRead);
  bench.send(all);
  violations.require(read(0).empty(), C::kNothingToRead);
  std::string came = read(1);
  came += read(100);
  for (std::size_t piece = 0; piece < 300; ++piece) {
    came += read(1);
  }
  violations.require(came == all, C::kInput);
  violations.require(read(8).empty(), C::kNothingToRead);

  violations.require(write("") == 0 && bench.receive().empty(), C::kOutput);
  violations.require(write(all) == all.size() && bench.receive() == all, C::kOutput);
  std::string accepted;
  for (std::size_t piece = 0; piece < 2000; ++piece) {
    const std::string bytes = all.substr(piece % 7, 100);
    const std::size_t count = write(bytes);
    violations.require(count <= bytes.size(), C::kRoom);
    accepted += bytes.substr(0, count);
  }
  violations.require(bench.receive() == accepted, C::kRoom);
  violations.require(write(all) == all.size() && bench.receive() == all, C::kRoom);

  violations.require(stream.take_lost_count() == 0, C::kLostCount);
  const std::string flood(200000, 'x');
  bench.send(flood);
  const std::size_t kept = read(flood.size()).size();
  violations.require(stream.take_lost_count() == flood.size() - kept, C::kLostCount);
  violations.require(stream.take_lost_count() == 0, C::kLostCount);

  bench.send(all);
  bench.connect(false);
  violations.require(!stream.connected() && write(all) == 0, C::kPeer);
  violations.require(stream.read({&came[0], came.size()}) == all.size() && came == all, C::kPeer);
  bench.connect(true);
  violations.require(stream.connected() && bench.receive().empty(), C::kPeer);
  return violations;
}

enum class ClockClause : std::uint8_t {
  kResolution,  ///< Stated, and time is read in steps of no more.
  kNeverBack,   ///< Never less than before.
  kKeepsTime,   ///< As much passes as passes elsewhere.
};

/// @param[in,out] bench Has `clock()` and `wait_us(time)`.
/// @param[in] tolerance How much a waiting time may be off, relatively.
template <typename Bench>
Violations<ClockClause> violated_by_clock(Bench& bench, double tolerance = 0.0) {
  using C = ClockClause;
  Violations<C> violations;
  auto& clock = bench.clock();
  const std::uint64_t resolution_us = clock.resolution_us();
  violations.require(resolution_us >= 1, C::kResolution);
  std::uint64_t waited_us = 0;
  const std::uint64_t begin_us = clock.now_us();
  std::uint64_t last_us = begin_us;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const std::uint64_t wait_us = i % 10 == 0 ? 100000 * resolution_us : i % 7;
    bench.wait_us(wait_us);
    waited_us += wait_us;
    const std::uint64_t now_us = clock.now_us();
    violations.require(now_us >= last_us, C::kNeverBack);
    const double passed_us = static_cast<double>(now_us - begin_us);
    const double slack_us =
        static_cast<double>(resolution_us) + tolerance * static_cast<double>(waited_us);
    const double late_us = static_cast<double>(waited_us) - passed_us;
    violations.require(late_us <= slack_us && -late_us <= slack_us,
                       wait_us < resolution_us ? C::kResolution : C::kKeepsTime);
    last_us = now_us;
  }
  return violations;
}

enum class WatchdogClause : std::uint8_t {
  kPeriod,     ///< Stated, above 0.
  kStart,      ///< Nothing happens before; then kAlreadyRunning, which is no kick.
  kKickHolds,  ///< Kicks within the period keep the board running.
  kBites,      ///< Without them it is reset, within two periods.
};

/// @param[in] make Returns a new bench: `watchdog()`, `wait_us(time)`, and `bitten()`, whether the
///                 board would have been reset.
template <typename Make>
Violations<WatchdogClause> violated_by_watchdog(const Make& make) {
  using C = WatchdogClause;
  Violations<C> violations;
  auto bench = make();
  auto& watchdog = bench.watchdog();
  const std::uint64_t period_us = watchdog.period_us();
  violations.require(period_us > 0, C::kPeriod);
  watchdog.kick();
  bench.wait_us(3 * period_us);
  violations.require(!bench.bitten() && !watchdog.running(), C::kStart);
  violations.require(watchdog.start() == Status::kOk && watchdog.running(), C::kStart);
  for (int kick = 0; kick < 20; ++kick) {
    bench.wait_us(period_us - period_us / 10);
    watchdog.kick();
  }
  violations.require(!bench.bitten(), C::kKickHolds);
  bench.wait_us(period_us - period_us / 10);
  violations.require(!bench.bitten(), C::kKickHolds);
  bench.wait_us(period_us + period_us / 5);
  violations.require(bench.bitten(), C::kBites);

  auto second = make();
  violations.require(second.watchdog().start() == Status::kOk, C::kStart);
  for (int restart = 0; restart < 4; ++restart) {
    second.wait_us(period_us / 2);
    violations.require(second.watchdog().start() == Status::kAlreadyRunning, C::kStart);
  }
  violations.require(second.bitten(), C::kStart);
  return violations;
}

enum class StoreClause : std::uint8_t {
  kFormat,      ///< Within its ranges.
  kRange,       ///< A wrong slot or size: kInvalidArgument, nothing has changed.
  kKeeps,       ///< What was written is read, at any length and offset, once and again.
  kRestErased,  ///< Behind it is kErasedByte.
  kSlotsApart,  ///< A write touches no other slot.
  kCut,         ///< Nor does a cut one, at whatever byte; the slot can be written again.
  kFault,       ///< Without power: kHardwareFault.
};

namespace detail {

inline std::vector<std::uint8_t> pattern(std::size_t count, std::uint32_t seed) {
  std::vector<std::uint8_t> bytes(count);
  for (std::uint8_t& byte : bytes) {
    seed = seed * 1664525U + 1013904223U;
    byte = static_cast<std::uint8_t>(seed >> 24U);
  }
  return bytes;
}

}  // namespace detail

/// @param[in,out] bench Has `store()` with two slots or more, `cut_power_after(bytes)`,
///                      `restore_power()` and `powered()`.
template <typename Bench>
Violations<StoreClause> violated_by_store(Bench& bench) {
  using C = StoreClause;
  using Bytes = std::vector<std::uint8_t>;
  Violations<C> violations;
  auto& store = bench.store();
  const hal::StoreFormat format = store.format();
  const std::size_t most = format.slot_bytes;
  const bool usable = format.slot_count >= 2 && format.unit_bytes >= 1 &&
                      format.unit_bytes <= hal::kMaxUnitBytes && most >= format.unit_bytes &&
                      most % format.unit_bytes == 0;
  violations.require(usable, C::kFormat);
  if (!usable) {
    return violations;
  }
  const auto write = [&store](std::uint32_t slot, const Bytes& bytes) {
    return store.write(slot, Span<const std::uint8_t>(bytes.data(), bytes.size()));
  };
  const auto holds = [&store, most](std::uint32_t slot, Bytes bytes, std::size_t count) {
    Bytes found(count, 0x55);
    bytes.resize(most, hal::kErasedByte);
    bytes.resize(count);
    bool same = store.read(slot, {found.data(), found.size()}) == Status::kOk && found == bytes;
    for (std::size_t offset = 0; offset <= count; offset += count / 3 + 1) {
      Bytes piece(count - offset, 0x55);
      same = same &&
             store.read(slot, static_cast<std::uint32_t>(offset), {piece.data(), piece.size()}) ==
                 Status::kOk &&
             std::equal(piece.begin(), piece.end(),
                        bytes.begin() + static_cast<std::ptrdiff_t>(offset));
    }
    return same;
  };

  const std::uint32_t last = format.slot_count - 1;
  const Bytes kept = detail::pattern(most, 1);
  violations.require(write(0, kept) == Status::kOk && write(last, kept) == Status::kOk, C::kKeeps);
  const std::size_t unit = format.unit_bytes;
  for (const std::size_t count : {most, std::size_t{0}, std::size_t{1}, unit, unit - 1,
                                  std::min(unit + 1, most), most - 1, most}) {
    const Bytes bytes = detail::pattern(count, static_cast<std::uint32_t>(count) + 2);
    violations.require(write(0, bytes) == Status::kOk && holds(0, bytes, count), C::kKeeps);
    violations.require(holds(0, bytes, count / 2), C::kKeeps);
    violations.require(holds(0, bytes, most), C::kRestErased);
    violations.require(holds(last, kept, most), C::kSlotsApart);
  }

  const Bytes now = detail::pattern(most, static_cast<std::uint32_t>(most) + 2);
  Bytes untouched(most + 1, 0x55);
  violations.require(
      write(format.slot_count, now) == Status::kInvalidArgument &&
          write(0xFFFFFFFFU, now) == Status::kInvalidArgument &&
          write(0, Bytes(most + 1, 0)) == Status::kInvalidArgument &&
          store.read(format.slot_count, {untouched.data(), 1}) == Status::kInvalidArgument &&
          store.read(0, {untouched.data(), most + 1}) == Status::kInvalidArgument &&
          store.read(0, 1, {untouched.data(), most}) == Status::kInvalidArgument &&
          store.read(0, 0xFFFFFFFFU, {untouched.data(), 1}) == Status::kInvalidArgument &&
          untouched == Bytes(most + 1, 0x55) && holds(0, now, most) && holds(last, kept, most),
      C::kRange);

  const Bytes next = detail::pattern(most, 3);
  bool cut = true;
  for (std::uint64_t bytes = 0; cut && bytes < 4 * most; ++bytes) {
    bench.cut_power_after(bytes);
    const Status status = write(0, next);
    cut = !bench.powered();
    violations.require((status == Status::kHardwareFault) == cut, C::kFault);
    if (cut) {
      Bytes found(most);
      violations.require(store.read(last, {found.data(), most}) == Status::kHardwareFault,
                         C::kFault);
    }
    bench.restore_power();
    violations.require(holds(last, kept, most), C::kCut);
    violations.require(write(0, now) == Status::kOk && holds(0, now, most), C::kCut);
  }
  return violations;
}

}  // namespace emax::test
