// Random devices, times and orders against a second implementation in 113-bit arithmetic.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <vector>

#include "emax/bound/energy_bound.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/energy/known_energy.hpp"
#include "emax/model/absolute_error.hpp"

#include "support/wide_response.hpp"

namespace emax {
namespace {

/// A search of more cells takes seconds; energies and rounding are looked at for all.
constexpr double kMostCells = 600.0;
/// What the second implementation loses: its partial fractions cancel, too, with 34 digits.
constexpr double kLeastWideEnergy = 1e-36;

struct Case {
  Accelerometer device;
  Butterworth filter;
  ErrorMeasure measure;
  double duration_s;
};

/// T fc from 0.001 to 40, f0/fc from 0.3 to 30, orders 1 to 15, all spread over their logarithms.
class RandomCases {
 public:
  Case next(const ErrorMeasure& measure) {
    const auto between = [this](double low, double high) {
      return low * std::pow(high / low, uniform());
    };
    Case result;
    result.measure = measure;
    const double cutoff_hz = 1000.0;
    const double sensitivity = between(0.01, 100.0);
    result.device = {sensitivity, cutoff_hz * between(0.3, 30.0), between(0.01, 0.95)};
    const double gain = uniform() < 0.7 ? sensitivity : sensitivity * between(0.9, 1.1);
    result.filter = {1 + static_cast<int>(15.0 * uniform()), cutoff_hz, gain};
    result.duration_s = between(0.001, 40.0) / cutoff_hz;
    return result;
  }
  double uniform() { return static_cast<double>(random_()) / 4294967296.0; }

 private:
  std::mt19937 random_{7};
};

test::WideResponse wide_of(const Case& c, const ModalModel& model) {
  const bool in_band = c.measure.criterion == Criterion::kInBandError;
  return test::WideResponse(c.device.sensitivity, c.device.natural_frequency_hz, c.device.damping,
                            c.filter.order, c.filter.cutoff_hz, c.filter.gain,
                            in_band ? test::WideError::kInBand : test::WideError::kSquare,
                            model.delay_s());
}

std::string words_of(const Case& c) {
  return "order " + std::to_string(c.filter.order) + " T fc " +
         std::to_string(c.duration_s * c.filter.cutoff_hz) + " f0/fc " +
         std::to_string(c.device.natural_frequency_hz / c.filter.cutoff_hz) + " damping " +
         std::to_string(c.device.damping) + " criterion " +
         std::to_string(static_cast<int>(c.measure.criterion)) + " delay " +
         std::to_string(static_cast<int>(c.measure.delay.mode));
}

class RandomDevices : public testing::TestWithParam<int> {
 protected:
  static ErrorMeasure measure() {
    if (GetParam() == 0) {
      return {Criterion::kIntegralSquareError, {}};
    }
    return {Criterion::kInBandError,
            {GetParam() == 1 ? DelayMode::kNone : DelayMode::kOfSensor, 0.0}};
  }
};

TEST_P(RandomDevices, MaximumEnergyBoundAndAbsoluteErrorAreKnownOrRefused) {
  RandomCases cases;
  const auto search = std::make_unique<EnergySearch>();
  const auto bound = std::make_unique<EnergyBound>();
  const auto workspace = std::make_unique<GridWorkspace>();
  int answered = 0;
  const int devices = GetParam() == 2 ? 20 : 40;
  for (int i = 0; i < devices; ++i) {
    Case c = cases.next(measure());
    while (12.0 * c.duration_s * c.device.natural_frequency_hz > kMostCells) {
      c = cases.next(measure());
    }
    SCOPED_TRACE(words_of(c));
    ModalModel model{};
    Status status = model.set(c.device, butterworth(c.filter), c.measure);
    if (status != Status::kOk) {
      EXPECT_EQ(status, Status::kDelayTooLong);
      continue;
    }
    SearchSettings settings;
    settings.duration_s = c.duration_s;
    status = search->start(model, settings);
    while (status == Status::kOk && !search->done()) {
      status = search->step(model, *workspace);
    }
    if (status != Status::kOk) {
      EXPECT_TRUE(status == Status::kLostDigits || status == Status::kDelayNotResolved ||
                  status == Status::kTooManyCells || status == Status::kTooManySwitches);
      EXPECT_GT(std::char_traits<char>::length(explain(status)), 40u);
      continue;
    }
    ++answered;
    const MaximumEnergy& found = search->result();
    const Span<const double> times_s = found.signal.times_s();
    const test::WideResponse wide = wide_of(c, model);
    const double expected =
        wide.energy(std::vector<double>(times_s.begin(), times_s.end()), c.duration_s);
    const double s2 = c.device.sensitivity * c.device.sensitivity;
    EXPECT_GE(found.energy, 0.0);
    EXPECT_LE(found.rounding, 1e-9 * found.energy);
    if (expected > kLeastWideEnergy * s2) {
      EXPECT_NEAR(found.energy, expected, 1e-9 * expected);
      EXPECT_LE(std::fabs(found.energy - expected), found.rounding + 1e-15 * expected);
    }
    status = bound->start(model, c.duration_s, *workspace);
    while (status == Status::kOk && !bound->done()) {
      status = bound->step(model, *workspace);
    }
    EXPECT_TRUE(status == Status::kOk || status == Status::kNotProven);
    EXPECT_GE(bound->bound(), found.energy);  // Infinity without a proof.

    AbsoluteError error{};
    ASSERT_EQ(error.start(model, c.duration_s), Status::kOk);
    std::vector<double> zeros_s(4096);
    while (!error.done()) {
      error.step(model, Span<double>(zeros_s.data(), zeros_s.size()));
    }
    if (error.status() != Status::kOk) {
      continue;
    }
    ASSERT_LE(error.zeros(), zeros_s.size());
    zeros_s.resize(error.zeros());
    zeros_s.push_back(c.duration_s);
    test::Wide value = 0;
    test::Wide last = wide.step_response(0);
    for (const double zero_s : zeros_s) {
      const test::Wide step = wide.step_response(zero_s);
      value += fabsq(step - last);
      last = step;
    }
    const double y = static_cast<double>(value);
    if (y * y > kLeastWideEnergy * s2) {
      EXPECT_NEAR(error.value(), y, 1e-9 * y);
    }
  }
  EXPECT_GE(answered, GetParam() == 2 ? 6 : 38);
}

TEST_P(RandomDevices, EveryEnergyKnowsItsRounding) {
  RandomCases cases;
  int refused = 0;
  for (int i = 0; i < 120; ++i) {
    const Case c = cases.next(measure());
    std::vector<double> times_s;
    for (int n = static_cast<int>(4.0 * cases.uniform()); n > 0; --n) {
      times_s.push_back(c.duration_s * cases.uniform());
    }
    std::sort(times_s.begin(), times_s.end());
    ModalModel model{};
    SwitchingSignal signal{};
    if (model.set(c.device, butterworth(c.filter), c.measure) != Status::kOk ||
        signal.set(Span<const double>(times_s.data(), times_s.size()), c.duration_s) !=
            Status::kOk) {
      continue;
    }
    SCOPED_TRACE(words_of(c));
    const double expected = wide_of(c, model).energy(times_s, c.duration_s);
    const double s2 = c.device.sensitivity * c.device.sensitivity;
    if (!(expected > kLeastWideEnergy * s2)) {
      continue;
    }
    const double closed = energy(model, signal);
    EXPECT_LE(std::fabs(closed - expected),
              energy_rounding(model, c.duration_s, times_s.size(), closed));
    const EnergyAnswer answer = known_energy(model, signal);
    EXPECT_LE(std::fabs(answer.known.energy - expected), answer.known.rounding);
    refused += answer.status == Status::kOk ? 0 : 1;
  }
  EXPECT_LE(refused, 2);
}

INSTANTIATE_TEST_SUITE_P(Error, RandomDevices, testing::Values(0, 1, 2));

}  // namespace
}  // namespace emax
