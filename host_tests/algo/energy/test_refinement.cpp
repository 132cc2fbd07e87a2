// Gradient against differences of energies, and the maxima that Newton's method ends on.
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "emax/energy/refinement.hpp"

#include "support/paper_device.hpp"
#include "support/rounding.hpp"

namespace emax {
namespace {

using test::kPaperA2;
using test::kPaperDevice;
using test::paper_model;

constexpr Criterion kIse = Criterion::kIntegralSquareError;
constexpr Criterion kDifference = Criterion::kEnergyDifference;

double memory[kRefinementScratch];
const Span<double> scratch(memory);

SwitchingSignal signal_of(const std::vector<double>& times_s, double duration_s) {
  SwitchingSignal signal{};
  EXPECT_EQ(signal.set(Span<const double>(times_s.data(), times_s.size()), duration_s),
            Status::kOk);
  return signal;
}

std::vector<double> gradient_of(const ModalModel& model, const SwitchingSignal& signal) {
  std::vector<double> gradient(signal.count());
  const double found =
      energy_gradient(model, signal, Span<double>(gradient.data(), gradient.size()), scratch);
  // Two sums over the switches, of at most 20 terms in another order: each rounds by an ulp or two.
  EXPECT_NEAR(found, energy(model, signal), test::rounding_of(model) + 2e-15 * std::fabs(found));
  return gradient;
}

std::vector<double> random_times(std::mt19937_64& random, std::size_t count, double duration_s) {
  std::vector<double> times_s(count);
  double sum = 0.0;
  for (double& time_s : times_s) {
    sum += 0.1 + static_cast<double>(random() % 1000) / 1000.0;
    time_s = sum;
  }
  for (double& time_s : times_s) {
    time_s *= duration_s / (sum + 0.5);
  }
  return times_s;
}

TEST(EnergyGradient, IsTheSlopeOfTheEnergy) {
  std::mt19937_64 random(7);
  for (const Criterion criterion : {kIse, kDifference}) {
    for (const int order : {1, 2, 5, 10, 15}) {
      ModalModel model{};
      ASSERT_EQ(model.set(kPaperDevice, {order, 1000.0, 0.9}, criterion), Status::kOk);
      const std::vector<double> times_s = random_times(random, 6, 3e-3);
      const std::vector<double> gradient = gradient_of(model, signal_of(times_s, 3e-3));
      for (std::size_t j = 0; j < times_s.size(); ++j) {
        // Central differences of fourth order: the error falls as h^4, rounding rises as 1/h.
        const double h = 2e-7;
        const auto energy_at = [&](double shift_s) {
          std::vector<double> moved = times_s;
          moved[j] += shift_s;
          return energy(model, signal_of(moved, 3e-3));
        };
        const double slope =
            (8.0 * (energy_at(h) - energy_at(-h)) - (energy_at(2.0 * h) - energy_at(-2.0 * h))) /
            (12.0 * h);
        const double tolerance = 3.0 * test::rounding_of(model) / h + 1e-7;
        EXPECT_NEAR(gradient[j], slope, tolerance) << order << ' ' << j;
      }
    }
  }
}

TEST(Refine, EndsOnTheBestKnownFromTheGrid) {
  SwitchingSignal two = signal_of({1.04e-3}, 2e-3);
  EXPECT_NEAR(kPaperA2 * refine(paper_model(), two, scratch).energy, test::kBestEnergy2ms, 1e-15);
  EXPECT_NEAR(two.times_s()[0], test::kBestTimes2ms[0], 1e-13);
  std::vector<double> rounded;
  for (const double time_s : test::kBestTimes10ms) {
    rounded.push_back(2e-5 * std::round(time_s / 2e-5));
  }
  SwitchingSignal ten = signal_of(rounded, 10e-3);
  EXPECT_NEAR(kPaperA2 * refine(paper_model(), ten, scratch).energy, test::kBestEnergy10ms, 1e-14);
}

TEST(Refine, NeverLosesEnergyAndEndsWithAGradientOfRounding) {
  std::mt19937_64 random(8);
  for (const Criterion criterion : {kIse, kDifference}) {
    for (const int order : {1, 4, 10, 15}) {
      for (const double damping : {0.01, 0.3182, 0.9}) {
        ModalModel model{};
        ASSERT_EQ(model.set({1.037, 4073.0, damping}, {order, 1000.0, 1.037}, criterion),
                  Status::kOk);
        for (int run = 0; run < 20; ++run) {
          const auto switches = static_cast<std::size_t>(1 + random() % 20);
          SwitchingSignal signal = signal_of(random_times(random, switches, 4e-3), 4e-3);
          const double before = energy(model, signal);
          const std::size_t count = signal.count();
          const Refinement result = refine(model, signal, scratch);
          EXPECT_GE(result.energy, before - 1e-14 * std::fabs(before));
          EXPECT_EQ(result.energy, energy(model, signal));
          EXPECT_EQ(result.dropped, count - signal.count());
          // For the energy difference there are flat ridges on which 200 steps may not be enough.
          const std::vector<double> gradient = gradient_of(model, signal);
          for (std::size_t j = 0; criterion == kIse && j < gradient.size(); ++j) {
            // At rest a switch moved by T/1000 changes the energy by less than 1e-9 of it.
            EXPECT_LT(std::fabs(gradient[j]) * 4e-6, 1e-9 * result.energy);
          }
        }
      }
    }
  }
}

TEST(Refine, DropsSwitchesThatMeet) {
  // Two needless switches close together at 0.3 ms: the best signal has one, at 1.0475 ms.
  SwitchingSignal signal = signal_of({0.300e-3, 0.301e-3, 1.04e-3}, 2e-3);
  const Refinement result = refine(paper_model(), signal, scratch);
  EXPECT_EQ(result.dropped, 2u);
  EXPECT_NEAR(kPaperA2 * result.energy, test::kBestEnergy2ms, 1e-15);
}

TEST(Refine, DropsASwitchThatLeaves) {
  SwitchingSignal signal = signal_of({1.04e-3, 1.98e-3}, 2e-3);
  const Refinement result = refine(paper_model(), signal, scratch);
  EXPECT_EQ(result.dropped, 1u);
  EXPECT_NEAR(kPaperA2 * result.energy, test::kBestEnergy2ms, 1e-15);
}

TEST(Refine, LeavesASignalWithoutSwitchesAlone) {
  SwitchingSignal signal = signal_of({}, 2e-3);
  const Refinement result = refine(paper_model(), signal, scratch);
  EXPECT_EQ(result.steps, 0u);
  EXPECT_NEAR(result.energy, energy(paper_model(), signal), test::rounding_of(paper_model()));
}

TEST(Refine, TakesAFullTableOfSwitches) {
  std::mt19937_64 random(9);
  SwitchingSignal signal = signal_of(random_times(random, kMaxSwitches, 40e-3), 40e-3);
  ModalModel model{};
  ASSERT_EQ(model.set(kPaperDevice, {15, 1000.0, 1.037}, kIse), Status::kOk);
  const double before = energy(model, signal);
  EXPECT_GT(refine(model, signal, scratch).energy, before);
}

}  // namespace
}  // namespace emax
