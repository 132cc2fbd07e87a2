// A test that takes more memory than there is.

#include <gtest/gtest.h>
#include <vector>

TEST(Bad, TakesAllMemory) {
  const std::vector<int> values(5'000'000);
  EXPECT_EQ(values.back(), 0);
}
