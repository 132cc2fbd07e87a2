// Tests of which one is left out by a name that it no longer has.

#include <gtest/gtest.h>

TEST(Bad, Passes) { EXPECT_EQ(1, 1); }
