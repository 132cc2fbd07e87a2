// A console of two rings passes the suite that every console must pass; beside that, the edges of
// the rings and their count of lost bytes.
#include <array>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>

#include "emax/board/byte_ring.hpp"
#include "emax/board/console_rings.hpp"
#include "emax/hal/byte_stream.hpp"

#include "hal/board_conformance.hpp"

namespace {

using emax::Span;
using emax::board::ByteRing;
using emax::board::ConsoleRings;
using emax::board::kReceiveRoom;
using emax::board::kTransmitRoom;

/// The rings with a UART whose interrupts come when the peer wants them.
class RingConsole final : public emax::hal::ByteStream {
 public:
  RingConsole& stream() { return *this; }
  void connect(bool connected) { connected_ = connected; }

  void send(const std::string& bytes) {
    for (const char byte : bytes) {
      rings_.received(byte);
    }
  }

  std::string receive() {
    std::string bytes;
    for (char byte = 0; rings_.take_next(byte);) {
      bytes += byte;
    }
    return bytes;
  }

 private:
  std::size_t do_read(Span<char> bytes) noexcept override { return rings_.read(bytes); }
  std::size_t do_write(Span<const char> bytes) noexcept override { return rings_.write(bytes); }
  bool do_connected() const noexcept override { return connected_; }
  std::uint32_t do_take_lost_count() noexcept override { return rings_.take_lost_count(); }

  ConsoleRings rings_;
  bool connected_ = true;
};

TEST(ConsoleRings, PassTheSuiteOfConsoles) {
  RingConsole console;
  EXPECT_TRUE(emax::test::violated_by_byte_stream(console).none());
}

TEST(ConsoleRings, HoldAsManyBytesAsTheyState) {
  ConsoleRings rings;
  const std::string sent(kTransmitRoom + 1, 'x');
  EXPECT_EQ(rings.write({sent.data(), sent.size()}), kTransmitRoom);
  EXPECT_FALSE(rings.sent());
  char byte = 0;
  for (std::size_t i = 0; i < kTransmitRoom; ++i) {
    ASSERT_TRUE(rings.take_next(byte));
  }
  EXPECT_FALSE(rings.take_next(byte));
  EXPECT_TRUE(rings.sent());

  for (std::size_t i = 0; i < kReceiveRoom; ++i) {
    rings.received('a');
  }
  EXPECT_EQ(rings.take_lost_count(), 0U);
  rings.received('b');
  rings.received('c');
  EXPECT_EQ(rings.take_lost_count(), 2U);
  EXPECT_EQ(rings.take_lost_count(), 0U);
  std::array<char, kReceiveRoom + 1> bytes = {};
  EXPECT_EQ(rings.read(bytes), kReceiveRoom);
  EXPECT_EQ(std::string(bytes.data(), kReceiveRoom), std::string(kReceiveRoom, 'a'));
}

TEST(ByteRing, KeepsTheOrderPastTheEndOfItsRoom) {
  ByteRing<4> ring;
  EXPECT_TRUE(ring.empty());
  char next = 0;
  char expected = 0;
  // 1000 turns of 1 to 4 bytes: every place in the room is first once, and the bytes wrap around.
  for (int turn = 0; turn < 1000; ++turn) {
    const int count = 1 + turn % 4;
    for (int i = 0; i < count; ++i) {
      ASSERT_TRUE(ring.put(next));
      next = static_cast<char>(next + 1);
    }
    ASSERT_EQ(ring.put('?'), count < 4);
    if (count < 4) {
      char last = 0;
      for (int i = 0; i < count; ++i) {
        ASSERT_TRUE(ring.take(last));
        ASSERT_EQ(last, expected);
        expected = static_cast<char>(expected + 1);
      }
      ASSERT_TRUE(ring.take(last));
      ASSERT_EQ(last, '?');
      continue;
    }
    char byte = 0;
    while (ring.take(byte)) {
      ASSERT_EQ(byte, expected);
      expected = static_cast<char>(expected + 1);
    }
    ASSERT_TRUE(ring.empty());
  }
}

TEST(ByteRing, LeavesTheByteAloneIfThereIsNone) {
  ByteRing<2> ring;
  char byte = 'k';
  EXPECT_FALSE(ring.take(byte));
  EXPECT_EQ(byte, 'k');
}

TEST(ConsoleRings, ABreakDropsWhatCameBeforeIt) {
  ConsoleRings rings;
  const auto read = [&rings] {
    std::array<char, 16> bytes = {};
    return std::string(bytes.data(), rings.read(Span<char>(bytes)));
  };
  EXPECT_FALSE(rings.take_break());
  rings.received('a');
  rings.broken();
  rings.received('b');
  EXPECT_TRUE(rings.take_break());
  EXPECT_FALSE(rings.take_break());
  EXPECT_EQ(read(), "b");
  for (std::size_t i = 0; i < kReceiveRoom; ++i) {
    rings.received('x');
  }
  rings.broken();  // No byte more has room.
  EXPECT_TRUE(rings.take_break());
  rings.received('c');
  EXPECT_EQ(read(), "c");
}

}  // namespace
