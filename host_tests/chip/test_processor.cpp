// The processor around the emulator: order of exceptions, frames, SysTick, DWT, timer, MPU.
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "chip/virtual_board.hpp"

namespace emax::chip {
namespace {

class Interrupts : public testing::Test {
 protected:
  Interrupts() : board(EMAX_CHIP_IMAGES "/interrupts.elf", wire) {
    board.chip.power_on();
    why = board.chip.run_for(0.1);
  }

  Wire wire;
  VirtualBoard board;
  Halt why = Halt::kTime;
};

// 55 is interrupted by 54, that by 91; 11 has the priority of 54 and waits for its end, but not for
// that of 55. SysTick and TIM2 come when they are due, before and after.
TEST_F(Interrupts, NestByPriorityAndFollowEachOther) {
  std::vector<std::uint32_t> order;
  const std::uint32_t begin = board.chip.symbol("order");
  for (std::uint32_t i = 0; i < board.chip.word_at("entries"); ++i) {
    order.push_back(board.chip.ram_word(begin + 4 * i));
  }
  EXPECT_EQ(order, (std::vector<std::uint32_t>{7, 1, 3, 5, 4, 6, 2, 8}));
}

TEST_F(Interrupts, KeepTheFloatingPointRegistersOfWhatTheyInterrupt) {
  EXPECT_EQ(board.chip.word_at("sum_is_right"), 1U);
}

TEST_F(Interrupts, TheCycleCounterCountsInstructions) {
  EXPECT_GT(board.chip.word_at("cycles"), 3000U * 2);
  EXPECT_LT(board.chip.word_at("cycles"), 3000U * 40);
}

// One microsecond is 16 instructions: a handler of fewer than 48 takes less than three.
TEST_F(Interrupts, WaitingForATimerTakesItsTime) { EXPECT_LE(board.chip.word_at("tim2_time"), 3U); }

TEST_F(Interrupts, AGuardedPageIsAMemManageFault) {
  EXPECT_EQ(why, Halt::kBreak);
  EXPECT_EQ(board.chip.word_at("guard_address"), 0x20010010U);
}

TEST_F(Interrupts, NothingWasFound) { EXPECT_EQ(board.chip.findings.text(), ""); }

TEST(Nvic, TheLowerNumberOfEqualPrioritiesComesFirst) {
  Nvic nvic;
  nvic.reset();
  for (const unsigned number : {30U, 20U, 25U}) {
    nvic.enable(number, true);
    nvic.pend(number, true);
  }
  EXPECT_EQ(nvic.next({}), 20U);
  nvic.enter(20);
  EXPECT_EQ(nvic.next({}), 0U);
  nvic.set_priority(25, 0x80);
  nvic.leave(20);
  EXPECT_EQ(nvic.next({}), 30U);
}

TEST(Nvic, MasksKeepAwayWhatTheySay) {
  Nvic nvic;
  nvic.reset();
  nvic.enable(20, true);
  nvic.set_priority(20, 0x40);
  nvic.pend(20, true);
  EXPECT_EQ(nvic.next({true, false, 0}), 0U);
  EXPECT_EQ(nvic.next({false, true, 0}), 0U);
  EXPECT_EQ(nvic.next({false, false, 0x40}), 0U);
  EXPECT_EQ(nvic.next({false, false, 0x50}), 20U);
  EXPECT_TRUE(nvic.wakes({true, false, 0}));
  EXPECT_FALSE(nvic.wakes({true, false, 0x40}));
  nvic.pend(kNmi, true);
  EXPECT_EQ(nvic.next({true, true, 0x10}), kNmi);
}

TEST(Nvic, GroupsDecideWhoInterrupts) {
  Nvic nvic;
  nvic.reset();
  nvic.set_group(6);  // Two bits of group: 0x40 and 0x70 do not interrupt each other.
  nvic.enable(20, true);
  nvic.enable(21, true);
  nvic.set_priority(20, 0x70);
  nvic.set_priority(21, 0x40);
  nvic.pend(20, true);
  nvic.enter(20);
  nvic.pend(21, true);
  EXPECT_EQ(nvic.next({}), 0U);
  nvic.set_group(0);
  EXPECT_EQ(nvic.next({}), 21U);
}

TEST(Nvic, AHighLineComesAgainWhenItsHandlerEnds) {
  Nvic nvic;
  nvic.reset();
  nvic.enable(20, true);
  nvic.set_line(20, true);
  nvic.enter(20);
  EXPECT_FALSE(nvic.pending(20));
  nvic.leave(20);
  EXPECT_TRUE(nvic.pending(20));
  nvic.enter(20);
  nvic.set_line(20, false);
  nvic.leave(20);
  EXPECT_FALSE(nvic.pending(20));
}

TEST(Events, AreDoneInOrderOfTime) {
  Events events;
  std::vector<int> order;
  events.at(20, [&] { order.push_back(2); });
  const Events::Id gone = events.at(15, [&] { order.push_back(9); });
  events.at(10, [&] {
    order.push_back(1);
    events.after(5, [&] { order.push_back(static_cast<int>(events.now())); });
  });
  events.at(20, [&] { order.push_back(3); });
  events.cancel(gone);
  events.pass(30);
  events.run_due();
  EXPECT_EQ(order, (std::vector<int>{1, 15, 2, 3}));
  EXPECT_EQ(events.now(), 30U);
  EXPECT_EQ(events.next(), kNever);
}

}  // namespace
}  // namespace emax::chip
