// Which signals are kept, which are the same one, and which matter.
#include <array>
#include <gtest/gtest.h>

#include "emax/uncertainty/branch_pool.hpp"

namespace emax {
namespace {

constexpr double kDuration_s = 2e-3;

SwitchingSignal signal_at(double time_s) {
  SwitchingSignal signal{};
  const double times_s[] = {time_s};
  EXPECT_EQ(signal.set(times_s, kDuration_s), Status::kOk);
  return signal;
}

double first_switch_s(const BranchPool& pool, std::size_t branch) {
  SwitchingSignal signal{};
  std::array<double, kMaxSwitches> scratch = {};
  pool.load(branch, kDuration_s, scratch, signal);
  return signal.count() == 0 ? 0.0 : signal.times_s()[0];
}

TEST(BranchPool, KeepsSwitchesAsPartsOfT) {
  BranchPool pool{};
  SwitchingSignal signal{};
  // The last two are closer to one another than a part of T, 30.5 ns.
  const double times_s[] = {0.1e-3, 1.0474909e-3, 1.5e-3, 1.500001e-3};
  ASSERT_EQ(signal.set(times_s, kDuration_s), Status::kOk);
  pool.add(0, signal);
  SwitchingSignal kept{};
  std::array<double, kMaxSwitches> scratch = {};
  pool.load(0, kDuration_s, scratch, kept);
  ASSERT_EQ(kept.count(), 2u);
  EXPECT_EQ(pool.switches(0), 2u);
  EXPECT_EQ(kept.duration_s(), kDuration_s);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(kept.times_s()[i], times_s[i], 0.5 * kDuration_s / 65536.0 * (1.0 + 1e-9));
  }
}

TEST(BranchPool, ASignalOfTheSameEnergyIsTheSame) {
  BranchPool pool{};
  pool.offer(0, signal_at(1e-3), 5.0);
  pool.offer(0, signal_at(1.1e-3), 5.0 * (1.0 + 1e-10));
  EXPECT_EQ(pool.count(), 1u);
  pool.offer(0, signal_at(1.2e-3), 5.0 * (1.0 - 1e-8));
  EXPECT_EQ(pool.count(), 2u);
  // At another place the first one is not known yet.
  pool.offer(1, signal_at(1e-3), 5.0);
  EXPECT_EQ(pool.count(), 3u);
  EXPECT_EQ(pool.home(1), 0u);
  EXPECT_EQ(pool.home(2), 1u);
}

TEST(BranchPool, TakesNothingThatIsMoreThanOnePercentLow) {
  BranchPool pool{};
  pool.offer(0, signal_at(1e-3), 5.0);
  pool.offer(0, signal_at(1.1e-3), 4.949);
  EXPECT_EQ(pool.count(), 1u);
  pool.offer(0, signal_at(1.2e-3), 4.951);
  EXPECT_EQ(pool.count(), 2u);
  // Energies below zero, as those of a difference may be.
  pool.clear();
  pool.offer(0, signal_at(1e-3), -5.0);
  pool.offer(0, signal_at(1.1e-3), -5.06);
  pool.offer(0, signal_at(1.2e-3), -5.04);
  EXPECT_EQ(pool.count(), 2u);
}

TEST(BranchPool, WithoutRoomTheFarthestFromTheBestGoes) {
  BranchPool pool{};
  for (std::size_t i = 0; i < BranchPool::kCapacity; ++i) {
    pool.offer(0, signal_at(1e-4 * static_cast<double>(i + 1)),
               5.0 - 0.001 * static_cast<double>(i));
  }
  ASSERT_EQ(pool.count(), BranchPool::kCapacity);
  // Lower than all: not taken. Higher than the lowest: takes its place, at the end.
  pool.offer(0, signal_at(1.9e-3), 4.96);
  EXPECT_NEAR(first_switch_s(pool, BranchPool::kCapacity - 1), 0.8e-3, 1e-7);
  pool.offer(0, signal_at(1.8e-3), 4.9995);
  EXPECT_EQ(pool.count(), BranchPool::kCapacity);
  EXPECT_NEAR(first_switch_s(pool, BranchPool::kCapacity - 1), 1.8e-3, 1e-7);
  pool.drop_low();
  // With one place nothing is known of how distances change: 7e-3 is then surely too low.
  EXPECT_FALSE(pool.is_crowded());
}

TEST(BranchPool, DropsWhatStaysLowAndKeepsWhatMayBeBest) {
  BranchPool pool{};
  pool.offer(0, signal_at(1e-3), 100.0);
  pool.offer(0, signal_at(1.1e-3), 99.9);
  pool.offer(0, signal_at(1.2e-3), 99.8);
  // The first gains 2 and the second keeps its distance. The third comes nearer, and may go on to
  // do so between the places and beyond.
  pool.know(0, 1, 102.0);
  pool.know(1, 1, 101.9);
  pool.know(2, 1, 101.95);
  EXPECT_NEAR(pool.variation(), 2.0 / 102.0, 1e-12);
  pool.drop_low();
  ASSERT_EQ(pool.count(), 2u);
  EXPECT_NEAR(first_switch_s(pool, 0), 1e-3, 1e-7);
  EXPECT_NEAR(first_switch_s(pool, 1), 1.2e-3, 1e-7);
}

TEST(BranchPool, SaysThatItIsCrowded) {
  BranchPool pool{};
  for (std::size_t i = 0; i <= BranchPool::kCapacity; ++i) {
    const double below = 0.001 * static_cast<double>(i);
    pool.offer(0, signal_at(1e-4 * static_cast<double>(i + 1)), 5.0 - below);
  }
  // The order turns round from place to place: what had no room may be the best at the other.
  for (std::size_t b = 0; b < pool.count(); ++b) {
    pool.know(b, 1, 5.2 + 0.01 * static_cast<double>(b));
  }
  pool.drop_low();
  EXPECT_TRUE(pool.is_crowded());
}

}  // namespace
}  // namespace emax
