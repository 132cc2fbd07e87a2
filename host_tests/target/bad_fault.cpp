// A test that the core stops at an address where there is nothing.

#include <cstdint>
#include <gtest/gtest.h>

TEST(Bad, Faults) { *reinterpret_cast<volatile std::uint32_t*>(0xf0000000U) = 1; }
