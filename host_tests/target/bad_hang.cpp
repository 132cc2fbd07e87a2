// A test that never ends.

#include <gtest/gtest.h>

TEST(Bad, Passes) { EXPECT_EQ(1, 1); }

TEST(Bad, Hangs) {
  for (;;) {
    asm volatile("");
  }
}
