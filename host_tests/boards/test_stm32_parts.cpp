// Clock, watchdog, LED and number of an STM32, over fake registers.
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <memory>
#include <string>

#include "emax/board/registers.hpp"
#include "emax/board/status_led.hpp"
#include "emax/board/stm32_clock.hpp"
#include "emax/board/stm32_watchdog.hpp"
#include "emax/board/timebase.hpp"
#include "emax/board/unique_id.hpp"

#include "hal/board_conformance.hpp"

namespace emax::test {
namespace {

constexpr std::uintptr_t kTim7 = 0x40001400;
constexpr std::uintptr_t kIwdg = 0x40003000;

/// TIM2, a basic timer and the watchdog, in microseconds.
class FakeTimers final : public FakeChip {
 public:
  void set_clock_interrupt(std::function<void()> handler) { handler_ = std::move(handler); }
  void wait_us(std::uint64_t us) {
    for (std::uint64_t left = us; left > 0;) {
      // As far as the next moment at which something happens.
      const std::uint64_t step = std::min<std::uint64_t>(left, 50'000);
      left -= step;
      pass(step);
    }
  }
  /// The clock is this much away from its wrap.
  void set_count(std::uint32_t count) { offset_us_ = count - static_cast<std::uint32_t>(now_us_); }
  bool has_warned() const { return has_warned_; }
  bool has_reset() const { return has_reset_; }
  /// The watchdog's clock is so many percent fast.
  void set_watchdog_percent(std::uint64_t percent) { watchdog_percent_ = percent; }
  void hold_watchdog_status(bool held) { is_status_held_ = held; }
  void set_word(std::uintptr_t address, std::uint32_t value) { registers_[address] = value; }

  std::uint32_t read(std::uintptr_t address, unsigned /*bytes*/) override {
    pass(1);
    if (address == board::kTimebase + 0x24) {
      return count();
    }
    if (address == kIwdg + 0x0C) {
      return is_status_held_ ? 3 : 0;
    }
    return registers_[address];
  }

  void write(std::uintptr_t address, std::uint32_t value) override {
    pass(1);
    if (address == board::kTimebase + 0x10) {
      registers_[address] &= value;
      return;
    }
    if (address == kTim7 + 0x24) {
      warn_us_ = now_us_;
    }
    if (address == kTim7 && (value & 1U) != 0) {
      warn_us_ = now_us_;
      is_timer_on_ = true;
    }
    if (address == kIwdg) {
      is_watchdog_on_ = is_watchdog_on_ || value == 0xCCCC;
      is_unlocked_ = value == 0x5555;
      kick_us_ = value == 0xAAAA || value == 0xCCCC ? now_us_ : kick_us_;
      return;
    }
    if ((address == kIwdg + 4 || address == kIwdg + 8) && !is_unlocked_) {
      return;
    }
    registers_[address] = value;
  }

 private:
  std::uint32_t count() const { return static_cast<std::uint32_t>(now_us_) + offset_us_; }

  void pass(std::uint64_t us) {
    const std::uint32_t before = count();
    now_us_ += us;
    const std::uint32_t after = count();
    if (after < before) {
      registers_[board::kTimebase + 0x10] |= 1U;
    }
    const std::uint32_t to_match = registers_[board::kTimebase + 0x34] - before;
    if (to_match != 0 && to_match <= us) {
      registers_[board::kTimebase + 0x10] |= 2U;
    }
    if (is_timer_on_) {
      const std::uint64_t ticks = registers_[kTim7 + 0x2C] + std::uint64_t{1};
      const std::uint64_t tick_us = (registers_[kTim7 + 0x28] + std::uint64_t{1}) / 170;
      has_warned_ = has_warned_ || now_us_ - warn_us_ >= ticks * tick_us;
    }
    if (is_watchdog_on_) {
      const std::uint64_t period_us = (registers_[kIwdg + 8] + std::uint64_t{1}) *
                                      (std::uint64_t{4} << registers_[kIwdg + 4]) * 1'000'000 /
                                      32'000 * 100 / (100 + watchdog_percent_);
      has_reset_ = has_reset_ || now_us_ - kick_us_ >= period_us;
    }
    const bool asks =
        (registers_[board::kTimebase + 0x0C] & registers_[board::kTimebase + 0x10]) != 0;
    if (asks && handler_ && !is_in_handler_) {
      is_in_handler_ = true;
      handler_();
      is_in_handler_ = false;
    }
  }

  std::map<std::uintptr_t, std::uint32_t> registers_;
  std::function<void()> handler_;
  std::uint64_t now_us_ = 0;
  std::uint32_t offset_us_ = 0;
  std::uint64_t warn_us_ = 0;
  std::uint64_t kick_us_ = 0;
  std::uint64_t watchdog_percent_ = 0;
  bool is_timer_on_ = false;
  bool is_watchdog_on_ = false;
  bool is_unlocked_ = false;
  bool is_status_held_ = false;
  bool is_in_handler_ = false;
  bool has_warned_ = false;
  bool has_reset_ = false;
};

class ClockBench {
 public:
  ClockBench() {
    board::start_timebase(170'000'000);
    clock_.start();
    timers_.set_clock_interrupt([this] { ticks_ += clock_.on_interrupt() ? 1 : 0; });
  }
  ClockBench(const ClockBench&) = delete;
  board::Stm32Clock& clock() { return clock_; }
  FakeTimers& timers() { return timers_; }
  int ticks() const { return ticks_; }
  void wait_us(std::uint64_t us) { timers_.wait_us(us); }

 private:
  FakeTimers timers_;
  board::Stm32Clock clock_;
  int ticks_ = 0;
};

TEST(Stm32Clock, KeepsTheContract) {
  ClockBench bench;
  // Two accesses of a microsecond each to read it.
  EXPECT_TRUE(violated_by_clock(bench, 1e-3).none());
}

TEST(Stm32Clock, GoesOnOverTheEndOfItsCount) {
  ClockBench bench;
  bench.timers().set_count(0xFFFFFFFF - 100);
  const std::uint64_t before_us = bench.clock().now_us();
  bench.wait_us(1000);
  const std::uint64_t after_us = bench.clock().now_us();
  EXPECT_GE(after_us - before_us, 1000U);
  EXPECT_LE(after_us - before_us, 1020U);
  EXPECT_GT(after_us, 0xFFFFFFFFU);
}

TEST(Stm32Clock, TicksTenTimesASecond) {
  ClockBench bench;
  bench.wait_us(10'000'000);
  EXPECT_NEAR(bench.ticks(), 100, 1);
}

class WatchdogBench {
 public:
  explicit WatchdogBench(std::uint64_t percent = 0)
      : timers_(std::make_unique<FakeTimers>()),
        watchdog_(std::make_unique<board::Stm32Watchdog>(kIwdg, kTim7)) {
    timers_->set_watchdog_percent(percent);
    watchdog_->prepare(170'000'000, true);
  }
  board::Stm32Watchdog& watchdog() { return *watchdog_; }
  FakeTimers& timers() { return *timers_; }
  void wait_us(std::uint64_t us) { timers_->wait_us(us); }
  bool bitten() const { return timers_->has_warned(); }

 private:
  std::unique_ptr<FakeTimers> timers_;
  std::unique_ptr<board::Stm32Watchdog> watchdog_;
};

TEST(Stm32Watchdog, KeepsTheContract) {
  EXPECT_TRUE(violated_by_watchdog([] { return WatchdogBench(); }).none());
}

TEST(Stm32Watchdog, WarnsBeforeItBites) {
  // Its own clock may be 15 % fast.
  WatchdogBench bench(15);
  ASSERT_EQ(bench.watchdog().start(), Status::kOk);
  bench.wait_us(9'000'000);
  EXPECT_TRUE(bench.timers().has_warned());
  EXPECT_FALSE(bench.timers().has_reset());
  bench.wait_us(5'000'000);
  EXPECT_TRUE(bench.timers().has_reset());
}

TEST(Stm32Watchdog, TellsTheCauseAndAClockThatDoesNotStart) {
  WatchdogBench bench;
  EXPECT_TRUE(bench.watchdog().caused_reset());
  bench.timers().hold_watchdog_status(true);
  EXPECT_EQ(bench.watchdog().start(), Status::kHardwareFault);
}

TEST(UniqueId, IsThreeWordsAsHexadecimalDigits) {
  FakeTimers chip;
  chip.set_word(0x1FFF7590, 0x00320045);
  chip.set_word(0x1FFF7594, 0x5842500A);
  chip.set_word(0x1FFF7598, 0x20373939);
  EXPECT_EQ(std::string(board::read_unique_id(0x1FFF7590).data()), "003200455842500A20373939");
}

std::string pattern(board::LedState state) {
  std::string text;
  for (std::uint32_t tick = 0; tick < 20; ++tick) {
    text += board::is_led_on(state, tick) ? '#' : '.';
  }
  return text;
}

TEST(StatusLed, LooksDifferentInEachState) {
  EXPECT_EQ(pattern(board::LedState::kReady), "#...................");
  EXPECT_EQ(pattern(board::LedState::kDriving), "#####.....#####.....");
  EXPECT_EQ(pattern(board::LedState::kCannotMeasure), "#.#.#.#.#.#.#.#.#.#.");
  EXPECT_EQ(pattern(board::LedState::kFault), "####################");
}

}  // namespace
}  // namespace emax::test
