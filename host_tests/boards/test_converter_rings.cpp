// Blocks in two rings: which place is whose, what is late, lost or stopped.
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>

#include "emax/board/converter_rings.hpp"
#include "emax/board/converter_words.hpp"

namespace {

using emax::board::ConverterRings;
using emax::board::dac_of_word;
using emax::board::frame_of_adcs;
using emax::board::ramp_step;
using emax::board::RingLook;
using emax::board::RingState;
using emax::board::towards_zero;
using emax::board::word_of_adc;
using emax::board::word_of_dac;
using emax::hal::kMaxRampFrames;
using emax::hal::Word;

constexpr std::uint32_t kRing = 32;
constexpr std::uint32_t kBlock = 4;

/// Hardware that counts down in a ring.
RingLook look_at(std::uint32_t clock, std::uint32_t inputs, std::uint32_t outputs) {
  return {clock, kRing - inputs % kRing, kRing - outputs % kRing};
}
RingLook look_at(std::uint32_t frames) { return look_at(frames + 1, frames, frames); }

ConverterRings settled(bool is_output_ahead = false) {
  ConverterRings rings(kRing, kBlock);
  rings.start(is_output_ahead);
  const std::uint32_t ahead = is_output_ahead ? 1 : 0;
  EXPECT_EQ(rings.settle(look_at(kBlock, kBlock - 1, kBlock - 1 + ahead)), RingState::kWaiting);
  EXPECT_EQ(rings.settle(look_at(kBlock + 1, kBlock, kBlock + ahead)), RingState::kHere);
  return rings;
}

TEST(ConverterRings, DropTheFirstBlockAndGoOnForManyTurns) {
  ConverterRings rings = settled();
  for (std::uint32_t begin = kBlock; begin < 100 * kRing; begin += kBlock) {
    EXPECT_EQ(rings.look(look_at(begin + kBlock - 1)), RingState::kWaiting);
    ASSERT_EQ(rings.look(look_at(begin + kBlock)), RingState::kHere);
    for (std::uint32_t i = 0; i < kBlock; ++i) {
      EXPECT_EQ(rings.input_place(i), (begin + i) % kRing);
      EXPECT_EQ(rings.output_place(i), (begin + i) % kRing);
    }
    ASSERT_TRUE(rings.finish(look_at(begin + kBlock)));
    // One turn beyond what has just gone out.
    EXPECT_EQ(rings.output_written(), begin + kBlock + kRing);
  }
}

TEST(ConverterRings, PutTheOutputOnePlaceFurtherWhereItIsAhead) {
  ConverterRings rings = settled(true);
  EXPECT_EQ(rings.look(look_at(2 * kBlock + 1, 2 * kBlock, 2 * kBlock + 1)), RingState::kHere);
  EXPECT_EQ(rings.input_place(0), kBlock);
  EXPECT_EQ(rings.output_place(0), kBlock + 1);
  EXPECT_EQ(rings.output_place(kRing - kBlock - 1), 0U);
}

TEST(ConverterRings, TakeWhatIsNearlyOneTurnLate) {
  // The block's first frame is overwritten by the frame one turn later, three of margin before.
  ConverterRings rings = settled();
  EXPECT_EQ(rings.look(look_at(kBlock + kRing - 3)), RingState::kHere);
  EXPECT_TRUE(rings.finish(look_at(kBlock + kRing - 3)));
  ConverterRings late = settled();
  EXPECT_EQ(late.look(look_at(kBlock + kRing - 2)), RingState::kLost);
  ConverterRings slow = settled();
  EXPECT_EQ(slow.look(look_at(2 * kBlock)), RingState::kHere);
  EXPECT_FALSE(slow.finish(look_at(kBlock + kRing - 2)));
  // By whole turns, where only the clock tells them.
  ConverterRings turns = settled();
  EXPECT_EQ(turns.look(look_at(2 * kBlock + 1000 * kRing)), RingState::kLost);
}

TEST(ConverterRings, TellLostFramesByTheClock) {
  for (std::uint32_t lost = 3; lost < 2 * kBlock; ++lost) {
    ConverterRings rings = settled();
    EXPECT_EQ(rings.look(look_at(kBlock + 1 + lost + 1, kBlock + 1, kBlock + 1 + lost)),
              RingState::kLost)
        << lost;
  }
  // Clock and count are not read at the same moment.
  ConverterRings rings = settled();
  EXPECT_EQ(rings.look(look_at(kBlock + 4, kBlock + 1, kBlock + 1)), RingState::kWaiting);
}

TEST(ConverterRings, WaitForInputsThatStandStill) {
  ConverterRings rings = settled();
  EXPECT_EQ(rings.look(look_at(kBlock + 2)), RingState::kWaiting);
  for (std::uint32_t clock = kBlock + 3; clock < kBlock + kRing / 2; ++clock) {
    EXPECT_EQ(rings.look(look_at(clock, kBlock + 2, clock)), RingState::kWaiting) << clock;
  }
}

TEST(ConverterRings, TellAnOutputThatStandsStill) {
  ConverterRings rings = settled();
  EXPECT_EQ(rings.look(look_at(kBlock + 3, kBlock + 2, kBlock)), RingState::kWaiting);
  EXPECT_EQ(rings.look(look_at(kBlock + 4, kBlock + 3, kBlock)), RingState::kOutputStopped);
}

TEST(ConverterRings, SettleOnlyWhereAllGoTogether) {
  ConverterRings slow(kRing, kBlock);
  slow.start(false);
  EXPECT_EQ(slow.settle(look_at(kBlock + 3, kBlock, kBlock + 3)), RingState::kLost);
  ConverterRings silent(kRing, kBlock);
  silent.start(false);
  EXPECT_EQ(silent.settle(look_at(kBlock + 1, kBlock, 0)), RingState::kOutputStopped);
}

TEST(ConverterWords, AreTheHighestBits) {
  EXPECT_EQ(dac_of_word(0), 0x8000U);
  EXPECT_EQ(dac_of_word(emax::hal::kGreatestWord), 0xFFF0U);
  EXPECT_EQ(dac_of_word(-emax::hal::kGreatestWord - 1), 0U);
  EXPECT_EQ(dac_of_word((std::int32_t{1} << 20) - 1), 0x8000U);
  EXPECT_EQ(dac_of_word(std::int32_t{1} << 20), 0x8010U);
  EXPECT_EQ(dac_of_word(-1), 0x7FF0U);
  EXPECT_EQ(word_of_dac(0x800), 0);
  EXPECT_EQ(word_of_dac(0x801), std::int32_t{1} << 20);
  EXPECT_EQ(word_of_dac(0), -emax::hal::kGreatestWord - 1);
  EXPECT_EQ(word_of_adc(0x8000), 0);
  EXPECT_EQ(word_of_adc(0x8001), 65536);
  // The mean of 32 conversions of 12 bits ends at 65520.
  EXPECT_EQ(word_of_adc(65520), 0x7FF00000);
  EXPECT_EQ(frame_of_adcs(0x8001FFF0).reference, 0x7FF00000);
  EXPECT_EQ(frame_of_adcs(0x8001FFF0).device, 65536);
}

TEST(ConverterWords, RampsReachZeroInTime) {
  const Word words[] = {
      1, -1, 255, -1048576, 1048576, emax::hal::kGreatestWord, -emax::hal::kGreatestWord - 1};
  for (const Word from : words) {
    const Word step = ramp_step(from, 1);
    Word word = from;
    std::uint32_t frames = 0;
    while (word != 0 && frames <= kMaxRampFrames) {
      const Word next = towards_zero(word, step);
      EXPECT_LE(std::abs(std::int64_t{next} - word), step);
      EXPECT_LT(std::abs(std::int64_t{next}), std::abs(std::int64_t{word}));
      word = next;
      ++frames;
    }
    EXPECT_LE(frames, kMaxRampFrames) << from;
    EXPECT_EQ(word, 0) << from;
  }
  // Where the permitted step suffices, it is that.
  EXPECT_EQ(ramp_step(std::int32_t{1} << 30, std::int32_t{1} << 22), std::int32_t{1} << 22);
  EXPECT_EQ(ramp_step(0, 7), 7);
  EXPECT_EQ(towards_zero(-10, 7), -3);
  EXPECT_EQ(towards_zero(7, 7), 0);
}

}  // namespace
