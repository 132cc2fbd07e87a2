// Words and volts, against the closed forms of a left-justified word.
#include <cmath>
#include <gtest/gtest.h>

#include "emax/hal/word.hpp"

namespace emax::hal {
namespace {

// Full scales that are powers of two, so that all quotients are exact.
TEST(Word, VoltsAndBack) {
  EXPECT_EQ(volts_per_word(2.0), std::ldexp(1.0, -30));
  EXPECT_EQ(words_per_volt(2.0), std::ldexp(1.0, 30));
  EXPECT_EQ(volts_per_word(0.5) * words_per_volt(0.5), 1.0);
}

TEST(Word, NearestRoundsHalvesAwayFromZeroAndStopsAtFullScale) {
  EXPECT_EQ(nearest_word(0.0), 0);
  EXPECT_EQ(nearest_word(0.49), 0);
  EXPECT_EQ(nearest_word(0.5), 1);
  EXPECT_EQ(nearest_word(-0.49), 0);
  EXPECT_EQ(nearest_word(-0.5), -1);
  EXPECT_EQ(nearest_word(-7.4), -7);
  EXPECT_EQ(nearest_word(2147483646.4), 2147483646);
  EXPECT_EQ(nearest_word(2147483647.2), kGreatestWord);
  EXPECT_EQ(nearest_word(2147483648.0), kGreatestWord);
  EXPECT_EQ(nearest_word(1e12), kGreatestWord);
  EXPECT_EQ(nearest_word(-2147483648.0), -2147483647 - 1);
}

TEST(Word, AWordOfALimitIsNeverAboveIt) {
  EXPECT_EQ(greatest_word_within(1.0, 2.0), 1 << 30);
  EXPECT_EQ(greatest_word_within(std::nextafter(1.0, 0.0), 2.0), (1 << 30) - 1);
  EXPECT_EQ(greatest_word_within(0.0, 2.0), 0);
  EXPECT_EQ(greatest_word_within(-std::ldexp(1.0, -40), 2.0), -1);
  EXPECT_EQ(greatest_word_within(2.0, 2.0), kGreatestWord);
  EXPECT_EQ(greatest_word_within(100.0, 2.0), kGreatestWord);
}

}  // namespace
}  // namespace emax::hal
