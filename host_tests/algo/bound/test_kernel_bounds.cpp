// Bounds of the kernel against quadrature by hand, and energies of pulses.
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "emax/bound/kernel_bounds.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

using test::paper_model;

/// k(t) k(s), or for the energy difference that of the sensor less that of the filter.
double product(const ModalModel& model, double t_s, double s_s) {
  if (model.is_square()) {
    return model.impulse_response(t_s) * model.impulse_response(s_s);
  }
  return model.device_impulse_response(t_s) * model.device_impulse_response(s_s) -
         model.filter_impulse_response(t_s) * model.filter_impulse_response(s_s);
}

/// phi(t, s), the integral of k(u - t) k(u - s) over u up to T, by Simpson's rule.
double phi_of(const ModalModel& model, double t_s, double s_s, double duration_s) {
  const double start_s = std::fmax(t_s, s_s);
  constexpr int kIntervals = 400;
  const double h = (duration_s - start_s) / kIntervals;
  double sum = 0.0;
  for (int i = 0; i <= kIntervals; ++i) {
    const double u_s = start_s + i * h;
    const double weight = i == 0 || i == kIntervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    sum += weight * product(model, u_s - t_s, u_s - s_s);
  }
  return sum * h / 3.0;
}

/// The integral over s of |d phi / dt|, by the midpoint rule and central differences in t.
double by_hand(const ModalModel& model, double t_s, double duration_s) {
  constexpr int kPoints = 400;
  const double d = 2e-7;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double s_s = (i + 0.5) * duration_s / kPoints;
    sum += std::fabs(phi_of(model, t_s + d, s_s, duration_s) -
                     phi_of(model, t_s - d, s_s, duration_s)) /
           (2.0 * d);
  }
  return sum * duration_s / kPoints;
}

class Bounds {
 public:
  Bounds(const ModalModel& model, double duration_s)
      : numbers_(kernel_bounds_numbers(mesh_intervals(model, duration_s))) {
    EXPECT_EQ(bounds.start(model, duration_s, {numbers_.data(), numbers_.size()}), Status::kOk);
    while (!bounds.done()) {
      bounds.step();
    }
  }
  KernelBounds bounds{};

 private:
  std::vector<double> numbers_;
};

TEST(KernelBounds, AreJustAboveTheIntegrals) {
  for (const int order : {2, 5, 10}) {
    ModalModel model{};
    ASSERT_EQ(model.set(test::kPaperDevice, {order, 1000.0, 0.9}, Criterion::kIntegralSquareError),
              Status::kOk);
    const double duration_s = 0.7e-3;
    const Bounds found(model, duration_s);
    for (const double t_s : {0.03e-3, 0.2e-3, 0.41e-3, 0.6e-3}) {
      const double integral = by_hand(model, t_s, duration_s);
      const double bound = found.bounds.bound(t_s, t_s);
      // The midpoint rule is good to about 1e-4; the bound is the largest of the mesh points about.
      EXPECT_GT(bound, integral * 0.9995) << order << ' ' << t_s;
      EXPECT_LT(bound, integral * 1.05) << order << ' ' << t_s;
    }
  }
}

// An impulse response that does not start at zero, a delayed reference, a difference of energies.
TEST(KernelBounds, AreJustAboveTheIntegralsForEveryCriterion) {
  struct Case {
    int order;
    ErrorMeasure measure;
  };
  const ReferenceDelay own = {DelayMode::kOfSensor, 0.0};
  const Case cases[] = {{1, {Criterion::kIntegralSquareError, {}}},
                        {1, {Criterion::kEnergyDifference, {}}},
                        {1, {Criterion::kInBandError, {}}},
                        {3, {Criterion::kInBandError, own}}};
  for (const Case& own_case : cases) {
    ModalModel model{};
    const ReferenceFilter filter = butterworth({own_case.order, 1000.0, 0.9});
    ASSERT_EQ(model.set(test::kPaperDevice, filter, own_case.measure), Status::kOk);
    const double duration_s = 0.7e-3;
    const Bounds found(model, duration_s);
    for (const double t_s : {0.2e-3, 0.6e-3}) {
      const double integral = by_hand(model, t_s, duration_s);
      const double bound = found.bounds.bound(t_s, t_s);
      EXPECT_GT(bound, integral * 0.999) << own_case.order << ' ' << t_s;
      EXPECT_LT(bound, integral * 1.1) << own_case.order << ' ' << t_s;
    }
    EXPECT_EQ(found.bounds.filter_slope() > 0.0, !model.is_square());
  }
}

TEST(KernelBounds, OfAnIntervalAreTheLargestInside) {
  const ModalModel model = paper_model();
  const Bounds found(model, 1e-3);
  double largest = 0.0;
  for (double t_s = 0.2e-3; t_s <= 0.3e-3; t_s += 1e-6) {
    largest = std::fmax(largest, found.bounds.bound(t_s, t_s));
  }
  EXPECT_LE(largest, found.bounds.bound(0.2e-3, 0.3e-3) * (1.0 + 1e-12));
  // The largest of a few mesh points more at both ends.
  EXPECT_NEAR(largest / found.bounds.bound(0.2e-3, 0.3e-3), 1.0, 0.01);
}

TEST(KernelBounds, RefuseWhatTheyDoNotHoldFor) {
  std::vector<double> numbers(kernel_bounds_numbers(4096));
  const Span<double> memory(numbers.data(), numbers.size());
  KernelBounds bounds{};
  ModalModel ideal{};
  ASSERT_EQ(ideal.set_ideal(1.0, butterworth({4, 1000.0, 1.0}), Criterion::kIntegralSquareError),
            Status::kOk);
  EXPECT_EQ(bounds.start(ideal, 1e-3, memory), Status::kInvalidArgument);
  ModalModel nothing{};
  const Accelerometer filter_as_sensor = {0.1, 1000.0, 0.7071067811865476};
  ASSERT_EQ(nothing.set(filter_as_sensor, {2, 1000.0, 0.1}, Criterion::kIntegralSquareError),
            Status::kOk);
  ASSERT_TRUE(nothing.is_nothing());
  EXPECT_EQ(bounds.start(nothing, 1e-3, memory), Status::kInvalidArgument);
  ModalModel moved{};
  ASSERT_EQ(moved.set(filter_as_sensor, {2, 1000.0, 0.1}, Criterion::kInBandError), Status::kOk);
  ASSERT_GT(moved.moved_by(), 0.0);
  EXPECT_EQ(bounds.start(moved, 1e-3, memory), Status::kInvalidArgument);
  EXPECT_EQ(bounds.start(paper_model(), std::nan(""), memory), Status::kInvalidArgument);
  EXPECT_EQ(bounds.start(paper_model(), 0.0, memory), Status::kInvalidArgument);
  EXPECT_EQ(bounds.start(paper_model(), 10.0, memory), Status::kTooManyCells);
  EXPECT_EQ(bounds.start(paper_model(), 1e-3, memory.first(100)), Status::kBufferTooSmall);
}

TEST(PulseEnergy, IsTheDifferenceOfTwoIntegrals) {
  const ModalModel difference = paper_model(Criterion::kEnergyDifference);
  const double width_s = 90e-6;
  const double left_s = 1.5e-3;
  constexpr int kIntervals = 2000;
  const double h = left_s / kIntervals;
  const auto pulse = [&](double u_s, bool of_sensor) {  // By Simpson's rule over the pulse.
    constexpr int kInner = 40;
    const double w = std::fmin(width_s, u_s) / kInner;
    double sum = 0.0;
    for (int j = 0; j <= kInner; ++j) {
      const double t_s = std::fmax(u_s - j * w, 0.0);
      const double k = of_sensor ? difference.device_impulse_response(t_s)
                                 : difference.filter_impulse_response(t_s);
      sum += (j == 0 || j == kInner ? 1.0 : (j % 2 == 1 ? 4.0 : 2.0)) * k;
    }
    return sum * w / 3.0;
  };
  double sum = 0.0;
  for (int i = 0; i <= kIntervals; ++i) {
    const double sensor = pulse(i * h, true);
    const double filter = pulse(i * h, false);
    sum += (i == 0 || i == kIntervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0)) *
           (sensor * sensor - filter * filter);
  }
  EXPECT_NEAR(pulse_energy(difference, left_s, width_s) / (sum * h / 3.0), 1.0, 1e-5);
}

TEST(PulseEnergy, IsTheIntegralOfTheSquaredResponse) {
  const ModalModel model = paper_model();
  for (const double width_s : {2e-6, 30e-6, 90e-6, 400e-6}) {
    for (const double left_s : {400e-6, 1.5e-3}) {
      constexpr int kIntervals = 4000;  // Simpson's error: (width / 30)^4 of the whole, 1e-6.
      const double h = left_s / kIntervals;
      double sum = 0.0;
      for (int i = 0; i <= kIntervals; ++i) {
        const double u_s = i * h;
        const double before = u_s > width_s ? model.step_response(u_s - width_s) : 0.0;
        const double y = model.step_response(u_s) - before;
        sum += (i == 0 || i == kIntervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0)) * y * y;
      }
      const double found = pulse_energy(model, left_s, width_s);
      EXPECT_NEAR(found / (sum * h / 3.0), 1.0, 1e-5) << width_s << ' ' << left_s;
    }
  }
}

}  // namespace
}  // namespace emax
