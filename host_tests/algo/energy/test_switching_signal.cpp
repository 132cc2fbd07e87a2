// Exact energies against known numbers, quadrature of the output, and identities between criteria.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "emax/energy/switching_signal.hpp"

#include "support/paper_device.hpp"
#include "support/rounding.hpp"
#include "support/sign_pattern.hpp"

namespace emax {
namespace {

using test::kPaperA2;
using test::kPaperDevice;
using test::paper_model;

constexpr Criterion kIse = Criterion::kIntegralSquareError;
constexpr Criterion kDifference = Criterion::kEnergyDifference;

SwitchingSignal signal_of(const std::vector<double>& times_s, double duration_s) {
  SwitchingSignal signal{};
  EXPECT_EQ(signal.set(Span<const double>(times_s.data(), times_s.size()), duration_s),
            Status::kOk);
  return signal;
}

double paper_energy(const std::vector<double>& times_s, double duration_s) {
  return kPaperA2 * energy(paper_model(), signal_of(times_s, duration_s));
}

TEST(SwitchingSignalEnergy, MeetsTheKnownNumbers) {
  // Twelve to fifteen digits are given: half a unit of the last, and some units of rounding.
  EXPECT_NEAR(paper_energy({}, 2e-3), 0.00110693771864, 0.6e-14);
  EXPECT_NEAR(paper_energy({0.68e-3, 1.49e-3}, 2e-3), 0.00399063106536, 0.6e-14);
  EXPECT_NEAR(paper_energy({std::begin(test::kBestTimes2ms), std::end(test::kBestTimes2ms)}, 2e-3),
              test::kBestEnergy2ms, 1e-15);
  EXPECT_NEAR(
      paper_energy({std::begin(test::kBestTimes10ms), std::end(test::kBestTimes10ms)}, 10e-3),
      test::kBestEnergy10ms, 1e-14);
}

/// Integral of y^2 by Gauss-Legendre with 5 nodes on 400 pieces per stretch between switches.
double energy_by_quadrature(const ModalModel& model, const SwitchingSignal& signal) {
  constexpr double kNodes[] = {-0.9061798459386640, -0.5384693101056831, 0.0, 0.5384693101056831,
                               0.9061798459386640};
  constexpr double kWeights[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                 0.4786286704993665, 0.2369268850561891};
  constexpr int kPieces = 400;
  double sum = 0.0;
  double start_s = 0.0;
  for (std::size_t k = 0; k <= signal.count(); ++k) {
    const double end_s = k == signal.count() ? signal.duration_s() : signal.times_s()[k];
    const double half_s = 0.5 * (end_s - start_s) / kPieces;
    for (int piece = 0; piece < kPieces; ++piece) {
      for (int n = 0; n < 5; ++n) {
        const double y =
            error_output(model, signal, start_s + half_s * (2 * piece + 1 + kNodes[n]));
        sum += half_s * kWeights[n] * y * y;
      }
    }
    start_s = end_s;
  }
  return sum;
}

TEST(SwitchingSignalEnergy, IsTheIntegralOfTheSquaredOutput) {
  const std::vector<double> times_s = {0.1e-3, 0.15e-3, 0.9e-3, 1.3e-3, 2.9e-3};
  for (const int order : {1, 2, 3, 5, 10, 15}) {
    for (const double gain : {0.0, 0.7, 1.037}) {
      for (const double damping : {0.01, 0.3182, 0.9}) {
        ModalModel model{};
        ASSERT_EQ(model.set({1.037, 4073.0, damping}, {order, 1000.0, gain}, kIse), Status::kOk);
        const SwitchingSignal signal = signal_of(times_s, 3e-3);
        const double expected = energy_by_quadrature(model, signal);
        // The quadrature itself is exact to 1e-13 here.
        EXPECT_NEAR(energy(model, signal), expected, 1e-13 * expected + test::rounding_of(model))
            << order << ' ' << gain;
      }
    }
  }
}

TEST(SwitchingSignalEnergy, DifferenceFollowsFromSquareErrorsAtThreeGains) {
  // E(ya - g yf) = Ea - 2 g C + g^2 Ef, so Ef is a second difference over the gain; E(ya) - E(yf) =
  // Ea - Ef.
  const SwitchingSignal signal = signal_of({0.3e-3, 0.8e-3, 1.7e-3}, 2e-3);
  for (const int order : {1, 2, 7, 10, 15}) {
    double rounding = 0.0;
    const auto energy_at = [&](double gain, Criterion criterion) {
      ModalModel model{};
      EXPECT_EQ(model.set(kPaperDevice, {order, 1000.0, gain}, criterion), Status::kOk);
      rounding += test::rounding_of(model);
      return energy(model, signal);
    };
    const double device = energy_at(0.0, kIse);
    const double filter = 0.5 * (energy_at(2.0, kIse) - 2.0 * energy_at(1.0, kIse) + device);
    EXPECT_NEAR(energy_at(1.0, kDifference), device - filter, rounding);
    EXPECT_NEAR(energy_at(0.0, kDifference), device, rounding);
  }
}

TEST(SwitchingSignalEnergy, ASwitchThatChangesNothingChangesNothing) {
  const ModalModel model = paper_model();
  const double whole = energy(model, signal_of({1e-3}, 2e-3));
  const double split = energy(model, signal_of({1e-3, 1.5e-3, std::nextafter(1.5e-3, 1.0)}, 2e-3));
  EXPECT_NEAR(split, whole, 1e-14);
}

TEST(ErrorOutput, IsTheStepResponseUntilTheFirstSwitch) {
  const ModalModel model = paper_model();
  const SwitchingSignal signal = signal_of({1e-3}, 2e-3);
  EXPECT_EQ(error_output(model, signal, 0.7e-3), model.step_response(0.7e-3));
  EXPECT_EQ(error_output(model, signal, 1.5e-3),
            model.step_response(1.5e-3) - 2.0 * model.step_response(0.5e-3));
}

TEST(SwitchingSignal, ValueChangesAtEachSwitch) {
  const SwitchingSignal signal = signal_of({1e-3, 1.5e-3}, 2e-3);
  EXPECT_EQ(signal.value(-1e-9), 0.0);
  EXPECT_EQ(signal.value(0.0), 1.0);
  EXPECT_EQ(signal.value(0.999e-3), 1.0);
  EXPECT_EQ(signal.value(1e-3), -1.0);
  EXPECT_EQ(signal.value(1.5e-3), 1.0);
  EXPECT_EQ(signal.value(2e-3), 1.0);
  EXPECT_EQ(signal.value(2.1e-3), 0.0);
}

TEST(SwitchingSignal, ReadsAPatternOfSigns) {
  const test::SignPattern signs({-1, -1, 1, 1, 1, -1, 1, -1});
  SwitchingSignal signal{};
  ASSERT_EQ(signal.set_signs(signs.view(), 4e-3), Status::kOk);
  ASSERT_EQ(signal.count(), 4u);
  EXPECT_DOUBLE_EQ(signal.times_s()[0], 1e-3);
  EXPECT_DOUBLE_EQ(signal.times_s()[1], 2.5e-3);
  EXPECT_DOUBLE_EQ(signal.times_s()[2], 3e-3);
  EXPECT_DOUBLE_EQ(signal.times_s()[3], 3.5e-3);
  EXPECT_EQ(signal.value(0.0), 1.0);
}

TEST(SwitchingSignal, RefusesWhatItCannotHoldAndStaysAsItWas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SwitchingSignal signal = signal_of({1e-3}, 2e-3);
  const auto set = [&](std::vector<double> times_s, double duration_s) {
    return signal.set(Span<const double>(times_s.data(), times_s.size()), duration_s);
  };
  EXPECT_EQ(set({}, 0.0), Status::kInvalidArgument);
  EXPECT_EQ(set({}, nan), Status::kInvalidArgument);
  EXPECT_EQ(set({}, std::numeric_limits<double>::infinity()), Status::kInvalidArgument);
  EXPECT_EQ(set({0.0}, 1.0), Status::kInvalidArgument);
  EXPECT_EQ(set({1.0}, 1.0), Status::kInvalidArgument);
  EXPECT_EQ(set({nan}, 1.0), Status::kInvalidArgument);
  EXPECT_EQ(set({0.5, 0.5}, 1.0), Status::kNotAscending);
  EXPECT_EQ(set({0.5, 0.4}, 1.0), Status::kNotAscending);
  std::vector<double> many(kMaxSwitches + 1);
  for (std::size_t i = 0; i < many.size(); ++i) {
    many[i] = 1e-4 * static_cast<double>(i + 1);
  }
  EXPECT_EQ(set(many, 1.0), Status::kTooManySwitches);
  test::SignPattern signs(kMaxSwitches + 2);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    signs.view().set(i, i % 2 == 0);
  }
  EXPECT_EQ(signal.set_signs(signs.view(), 1.0), Status::kTooManySwitches);
  EXPECT_EQ(signal.count(), 1u);
  EXPECT_EQ(signal.times_s()[0], 1e-3);
  EXPECT_EQ(signal.duration_s(), 2e-3);
  many.pop_back();
  EXPECT_EQ(set(many, 1.0), Status::kOk);
}

}  // namespace
}  // namespace emax
