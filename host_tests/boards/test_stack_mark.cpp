// Marks on a stack are counted from the end that is used last.
#include <array>
#include <cstdint>
#include <gtest/gtest.h>

#include "emax/base/status.hpp"
#include "emax/board/null_watchdog.hpp"
#include "emax/board/stack_mark.hpp"

namespace {

using emax::Span;
using emax::board::kStackMark;
using emax::board::mark_stack;
using emax::board::used_stack_bytes;

TEST(StackMark, CountsDownToTheLastWordUsed) {
  std::array<std::uint32_t, 100> stack = {};
  EXPECT_EQ(used_stack_bytes(stack), 400U) << "never marked: all may have been used";
  mark_stack(stack);
  EXPECT_EQ(used_stack_bytes(stack), 0U);
  stack[99] = 1;
  EXPECT_EQ(used_stack_bytes(stack), 4U);
  stack[40] = 1;
  EXPECT_EQ(used_stack_bytes(stack), 240U) << "what lies between may be room that was never filled";
  stack[0] = kStackMark - 1;
  EXPECT_EQ(used_stack_bytes(stack), 400U);
}

TEST(StackMark, LeavesWhatIsBeyondAlone) {
  std::array<std::uint32_t, 4> stack = {7, 7, 7, 7};
  mark_stack(Span<std::uint32_t>(stack).first(3));
  EXPECT_EQ(stack, (std::array<std::uint32_t, 4>{kStackMark, kStackMark, kStackMark, 7}));
}

TEST(NullWatchdog, SaysThatThereIsNone) {
  emax::board::NullWatchdog watchdog;
  watchdog.kick();
  EXPECT_EQ(watchdog.start(), emax::Status::kHardwareFault);
  EXPECT_FALSE(watchdog.running());
  EXPECT_FALSE(watchdog.failed()) << "there is none that could";
  EXPECT_FALSE(watchdog.caused_reset());
}

}  // namespace
