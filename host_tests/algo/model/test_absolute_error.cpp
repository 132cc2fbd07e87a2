// The largest absolute error against quadrature, a closed form and the output of its signal.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "emax/energy/switching_signal.hpp"
#include "emax/model/absolute_error.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

using test::kPaperDevice;
using test::paper_model;

constexpr Criterion kIse = Criterion::kIntegralSquareError;

/// The value with the signal that reaches it.
struct LargestError {
  Status status = Status::kOk;
  double value = 0.0;
  std::size_t zeros = 0;
  SwitchingSignal signal = {};
};

LargestError largest_absolute_error(const ModalModel& model, double duration_s) {
  AbsoluteError error{};
  double zeros_s[kMaxSwitches];
  LargestError result;
  result.status = error.start(model, duration_s);
  while (!error.done()) {
    error.step(model, zeros_s);
  }
  result.value = error.value();
  result.zeros = error.zeros();
  if (result.status != Status::kOk || result.zeros > kMaxSwitches) {
    return result;
  }
  std::vector<double> times_s;
  for (std::size_t i = result.zeros; i-- > 0;) {
    times_s.push_back(duration_s - zeros_s[i]);
  }
  EXPECT_EQ(result.signal.set(Span<const double>(times_s.data(), times_s.size()), duration_s),
            Status::kOk);
  return result;
}

TEST(AbsoluteError, MeetsTheKnownValue) {
  // Five digits are known.
  EXPECT_NEAR(1.037 * largest_absolute_error(paper_model(), 2e-3).value, 3.7149, 0.5e-4);
}

TEST(AbsoluteError, IsWhatItsSignalReachesAtTheEnd) {
  for (const int order : {1, 2, 5, 10, 15}) {
    for (const double damping : {0.01, 0.3182, 0.9}) {
      ModalModel model{};
      ASSERT_EQ(model.set({1.037, 4073.0, damping}, {order, 1000.0, 0.9}, kIse), Status::kOk);
      for (const double duration_s : {0.1e-3, 2e-3, 10e-3}) {
        const LargestError error = largest_absolute_error(model, duration_s);
        ASSERT_EQ(error.status, Status::kOk);
        // Residues of order 15 are dozens of times the gain: two digits of 16 go.
        EXPECT_NEAR(std::fabs(error_output(model, error.signal, duration_s)), error.value,
                    1e-12 * error.value)
            << order << ' ' << damping;
        // Nothing before the end is larger, beyond rounding.
        for (double part = 0.05; part < 1.0; part += 0.05) {
          EXPECT_LE(std::fabs(error_output(model, error.signal, part * duration_s)),
                    error.value * (1.0 + 1e-12));
        }
      }
    }
  }
}

TEST(AbsoluteError, IsTheIntegralOfTheMagnitude) {
  const ModalModel model = paper_model();
  for (const double duration_s : {0.3e-3, 2e-3}) {
    // Midpoints: h^2/24 of the change of the slope, and h^2 of the slope at each of a few zeros;
    // with slopes up to 1e9 and h = 1 ns far below 1e-9.
    const int points = static_cast<int>(std::lround(duration_s / 1e-8));
    double sum = 0.0;
    for (int i = 0; i < points; ++i) {
      sum += std::fabs(model.impulse_response((i + 0.5) * 1e-8)) * 1e-8;
    }
    EXPECT_NEAR(largest_absolute_error(model, duration_s).value, sum, 1e-6 * sum);
  }
}

TEST(AbsoluteError, OfALoneSensorIsTheSumOfItsOvershoots) {
  // Without a filter the step response goes through extrema at n pi/wd, whose distances from S fall
  // by q = e^(-b pi/sqrt(1 - b^2)): in infinite time the sum is S (1 + q)/(1 - q).
  const double damping = 0.2;
  ModalModel model{};
  ASSERT_EQ(model.set({1.5, 2000.0, damping}, {2, 1000.0, 0.0}, kIse), Status::kOk);
  const double q = std::exp(-damping * std::acos(-1.0) / std::sqrt(1.0 - damping * damping));
  const double expected = 1.5 * (1.0 + q) / (1.0 - q);
  // After 25 ms the envelope is below 1e-27.
  EXPECT_NEAR(largest_absolute_error(model, 25e-3).value, expected, 1e-13 * expected);
}

TEST(AbsoluteError, SeesAZeroBeforeItsFirstSample) {
  // k(0) = -g wc for order 1; found outside this code by a dense scan.
  ModalModel model{};
  ASSERT_EQ(model.set({1.0, 10858.8, 0.364}, {1, 1000.0, 0.9}, kIse), Status::kOk);
  const LargestError error = largest_absolute_error(model, 3.524e-3);
  EXPECT_NEAR(error.value, 2.0535961, 0.5e-7);
}

TEST(AbsoluteError, OfAShortTimeKeepsItsDigits) {
  // y(T) = S (w0 T)^2/2 less about b w0 T of it.
  const double w0_t = 2.0 * std::acos(-1.0) * 4073.0 * 1e-9;
  ModalModel model{};
  ASSERT_EQ(model.set(kPaperDevice, {15, 1000.0, 1.037}, kIse), Status::kOk);
  AbsoluteError error{};
  ASSERT_EQ(error.start(model, 1e-9), Status::kOk);
  ASSERT_TRUE(error.done());
  EXPECT_EQ(error.status(), Status::kOk);
  EXPECT_EQ(error.zeros(), 0u);
  EXPECT_NEAR(error.value(), 1.037 * 0.5 * w0_t * w0_t, 1e-4 * error.value());
}

TEST(AbsoluteError, KnowsItsRounding) {
  const ModalModel model = paper_model();
  AbsoluteError error{};
  ASSERT_EQ(error.start(model, 2e-3), Status::kOk);
  while (!error.done()) {
    error.step(model);
  }
  EXPECT_GT(error.rounding(), 0.0);
  EXPECT_LT(error.rounding(), 1e-12);
  EXPECT_EQ(error.status(), Status::kOk);
  // A sensor next to the filter.
  ModalModel alike{};
  ASSERT_EQ(alike.set({0.1, 1000.0, 0.70710678}, {2, 1000.0, 0.1}, kIse), Status::kOk);
  ASSERT_EQ(error.start(alike, 2e-3), Status::kOk);
  while (!error.done()) {
    error.step(alike);
  }
  EXPECT_EQ(error.status(), Status::kLostDigits);
}

TEST(AbsoluteError, OfAnIdealSensorCountsWhatPassesAtOnce) {
  // Order 1: |y| <= S + g (1 - e^(-wc T)).
  ModalModel model{};
  ASSERT_EQ(model.set_ideal(1.2, butterworth({1, 700.0, 0.9}), kIse), Status::kOk);
  AbsoluteError error{};
  ASSERT_EQ(error.start(model, 1e-3), Status::kOk);
  while (!error.done()) {
    error.step(model);
  }
  EXPECT_NEAR(error.value(), 1.2 - 0.9 * std::expm1(-2.0 * std::acos(-1.0) * 0.7), 1e-14);
}

TEST(AbsoluteError, SaysWhatItCannotDo) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity(), 1e6}) {
    EXPECT_EQ(largest_absolute_error(paper_model(), bad).status, Status::kInvalidArgument) << bad;
  }
  ModalModel model{};
  ASSERT_EQ(model.set({1.0, 4073.0, 0.001}, {2, 1000.0, 0.0}, kIse), Status::kOk);
  // More zeros than there is room for are counted, and the value is right: two for each period.
  const LargestError many =
      largest_absolute_error(model, 1.1 * static_cast<double>(kMaxSwitches) / (2.0 * 4073.0));
  EXPECT_EQ(many.status, Status::kOk);
  EXPECT_GT(many.zeros, kMaxSwitches);
  EXPECT_GT(many.value, largest_absolute_error(model, 30e-3).value);
}

}  // namespace
}  // namespace emax
