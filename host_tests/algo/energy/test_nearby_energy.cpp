// Energies of signals near a given one, against the closed form that computes each exponential.
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "emax/energy/nearby_energy.hpp"

#include "support/paper_device.hpp"
#include "support/rounding.hpp"

namespace emax {
namespace {

using test::kPaperFilter;
using test::paper_model;

SwitchingSignal signal_of(const std::vector<double>& times_s, double duration_s) {
  SwitchingSignal signal{};
  EXPECT_EQ(signal.set(Span<const double>(times_s.data(), times_s.size()), duration_s),
            Status::kOk);
  return signal;
}

/// Switches at unequal distances, about a millisecond each.
SwitchingSignal given_signal(std::size_t switches) {
  std::vector<double> times_s;
  for (std::size_t k = 1; k <= switches; ++k) {
    const double step = static_cast<double>(k);
    times_s.push_back(1e-3 * step + 1e-4 * std::sin(3.0 * step));
  }
  return signal_of(times_s, 1e-3 * static_cast<double>(switches + 1));
}

/// The given signal with every other switch moved forward and the others back.
SwitchingSignal moved_signal(const SwitchingSignal& given, double move_s) {
  std::vector<double> times_s;
  for (std::size_t k = 0; k < given.count(); ++k) {
    times_s.push_back(given.times_s()[k] + (k % 2 == 0 ? move_s : -move_s));
  }
  return signal_of(times_s, given.duration_s());
}

constexpr double kCutoff_hz = 1000.0;
/// The distance of all Butterworth poles from 0.
const double kPole = 2.0 * std::acos(-1.0) * kCutoff_hz;

TEST(NearbyEnergy, IsTheEnergyForEverySensorFilterAndMove) {
  NearbyEnergy nearby;
  for (const Criterion criterion :
       {Criterion::kIntegralSquareError, Criterion::kEnergyDifference}) {
    for (int order = 1; order <= 15; ++order) {
      for (const double damping : {1e-4, 0.02, 0.3182, 0.95}) {
        ModalModel model{};
        ASSERT_EQ(model.set({1.037, 4073.0, damping}, {order, kCutoff_hz, 1.037}, criterion),
                  Status::kOk);
        for (const std::size_t switches : {0u, 1u, 4u, 7u}) {
          const SwitchingSignal given = given_signal(switches);
          nearby.prepare(model, given);
          // Two moves add up in one interval, so the last two are beyond the polynomial's reach.
          for (const double part : {0.0, 1e-6, 0.01, 0.1, 0.49, -0.49, 0.51, -3.0, 10.0}) {
            ModalModel other = model;
            ASSERT_EQ(other.set_device({1.039, 4076.0, 1.01 * damping}), Status::kOk);
            const SwitchingSignal moved = moved_signal(given, part / 70.0 / kPole);
            EXPECT_NEAR(nearby.energy(other, moved, given), energy(other, moved),
                        test::rounding_of(other))
                << order << ' ' << damping << ' ' << switches << ' ' << part;
          }
        }
      }
    }
  }
}

TEST(NearbyEnergy, LosesNothingButRoundingUpToTheEndOfItsReach) {
  // The energy of a first-order filter alone is well-conditioned: a few roundings of itself.
  ModalModel model{};
  ASSERT_EQ(
      model.set({1e-9, 4073.0, 0.3182}, {1, kCutoff_hz, 1.0}, Criterion::kIntegralSquareError),
      Status::kOk);
  NearbyEnergy nearby;
  const SwitchingSignal given = signal_of({2e-4}, 3e-4);
  nearby.prepare(model, given);
  double worst = 0.0;
  for (int i = -99; i <= 99; ++i) {
    const SwitchingSignal moved = signal_of({2e-4 + i / 100.0 / 70.0 / kPole}, 3e-4);
    const double expected = energy(model, moved);
    worst = std::fmax(worst, std::fabs(nearby.energy(model, moved, given) - expected) / expected);
  }
  // Without the sixth power it is 4e-14.
  EXPECT_LT(worst, 2e-15);
}

TEST(NearbyEnergy, FollowsAChangeOfTheGain) {
  ModalModel model = paper_model();
  NearbyEnergy nearby;
  const SwitchingSignal given = given_signal(3);
  nearby.prepare(model, given);
  ASSERT_EQ(model.set_gain(0.7), Status::kOk);
  const SwitchingSignal moved = moved_signal(given, 1e-7);
  EXPECT_NEAR(nearby.energy(model, moved, given), energy(model, moved), test::rounding_of(model));
}

/// Whether each exponential is computed: the energies of signals around the given one then have the
/// bits of `energy()`. A polynomial's rounding shows in some of a hundred.
bool computes_each(const NearbyEnergy& nearby, const ModalModel& model,
                   const SwitchingSignal& given) {
  for (int i = 1; i <= 100; ++i) {
    const SwitchingSignal moved = moved_signal(given, 1e-9 * i);
    if (nearby.energy(model, moved, given) != energy(model, moved)) {
      return false;
    }
  }
  return true;
}

TEST(NearbyEnergy, ComputesEachExponentialUntilItIsPreparedAndWhereThereIsNoRoom) {
  struct Case {
    int order;
    std::size_t most_switches;
  };
  for (const Case c : {Case{10, 11}, Case{15, 7}, Case{2, NearbyEnergy::kMaxIntervals - 1}}) {
    ModalModel model{};
    ASSERT_EQ(model.set(test::kPaperDevice, {c.order, kCutoff_hz, 1.037},
                        Criterion::kIntegralSquareError),
              Status::kOk);
    NearbyEnergy nearby;
    const SwitchingSignal most = given_signal(c.most_switches);
    const SwitchingSignal more = given_signal(c.most_switches + 1);
    EXPECT_TRUE(computes_each(nearby, model, most));
    nearby.prepare(model, most);
    EXPECT_FALSE(computes_each(nearby, model, most));
    nearby.prepare(model, more);
    EXPECT_TRUE(computes_each(nearby, model, more));
    EXPECT_TRUE(computes_each(nearby, model, most));
  }
}

TEST(NearbyEnergy, ComputesEachExponentialOfSignalsThatAreNotNear) {
  const ModalModel model = paper_model();
  NearbyEnergy nearby;
  const SwitchingSignal given = given_signal(1);
  nearby.prepare(model, given);
  // One switch more, but the first intervals are those of the given signal.
  const SwitchingSignal longer = signal_of({given.times_s()[0], 2e-3}, 3e-3);
  EXPECT_EQ(nearby.energy(model, longer, given), energy(model, longer));
  for (int i = 1; i <= 100; ++i) {
    const SwitchingSignal moved = moved_signal(given, (1.0 + 1e-3 * i) / 70.0 / kPole);
    EXPECT_EQ(nearby.energy(model, moved, given), energy(model, moved));
  }
}

}  // namespace
}  // namespace emax
