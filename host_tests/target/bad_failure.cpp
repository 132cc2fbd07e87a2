// A test that fails.

#include <gtest/gtest.h>

TEST(Bad, Passes) { EXPECT_EQ(1, 1); }
TEST(Bad, Fails) { EXPECT_EQ(1, 2); }
