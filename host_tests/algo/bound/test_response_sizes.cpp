// Sizes of responses against sums over fine samples, and bounds that are energies.
#include <cmath>
#include <gtest/gtest.h>

#include "emax/bound/energy_bound.hpp"
#include "emax/bound/kernel_bounds.hpp"
#include "emax/bound/response_sizes.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

GridWorkspace workspace;
EnergyBound bound;
EnergySearch search;

ModalModel model_of(int order, DelayMode delay) {
  ModalModel model{};
  EXPECT_EQ(model.set(test::kPaperDevice, butterworth({order, 1000.0, 1.037}),
                      ErrorMeasure{Criterion::kInBandError, {delay, 0.0}}),
            Status::kOk);
  return model;
}

TEST(ResponseSizes, AreNotBelowTheTrueOnes) {
  for (const int order : {1, 2, 3, 4, 10}) {
    for (const DelayMode delay : {DelayMode::kNone, DelayMode::kOfSensor}) {
      const ModalModel model = model_of(order, delay);
      const ResponseSizes sizes = response_sizes(model, 2e-3);
      // Second differences of k at 1 us, and their sum.
      const double h = 1e-6;
      double curvature = 0.0;
      double terms = 0.0;
      for (int i = 1; i < 2000; ++i) {
        const double t_s = i * h;
        curvature += std::fabs(model.impulse_response(t_s + h) - 2.0 * model.impulse_response(t_s) +
                               model.impulse_response(t_s - h)) /
                     h;
        terms += std::fabs(model.impulse_response(t_s)) * h;
      }
      EXPECT_GE(sizes.curvature, 0.98 * curvature) << order;
      EXPECT_LE(sizes.curvature, 4.0 * curvature) << order;  // By Cauchy and Schwarz.
      EXPECT_GE(sizes.terms, terms);
      const double start = model.impulse_response(0.0);
      const double slope = (model.impulse_response(1e-9) - start) / 1e-9;
      EXPECT_GE(sizes.start, model.starts_at_zero() ? 0.0 : std::fabs(start));
      // The difference of two values of 1e4 is good to 1e-12, over 1e-9.
      if (order <= 2 || delay != DelayMode::kNone) {
        EXPECT_GE(sizes.slope, 0.999 * std::fabs(slope) - 0.01);
      }
    }
  }
}

TEST(ResponseSizes, OfTheSensorItselfStartWithItsSlope) {
  // k'(0) = S w0^2 of the sensor, whatever the order of the filter: its own is 0 from order 3 on.
  const double w0 = 2.0 * std::acos(-1.0) * 4073.0;
  for (const int order : {3, 10}) {
    ModalModel model{};
    ASSERT_EQ(
        model.set(test::kPaperDevice, {order, 1000.0, 1.037}, Criterion::kIntegralSquareError),
        Status::kOk);
    const ResponseSizes sizes = response_sizes(model, 2e-3);
    EXPECT_EQ(sizes.start, 0.0);
    EXPECT_GE(sizes.slope, (1.0 - 1e-12) * 1.037 * w0 * w0);
    EXPECT_LE(sizes.slope, (1.0 + 1e-9) * 1.037 * w0 * w0);
  }
}

TEST(EnergyBound, OfAShortTimeIsTheEnergyOfTheConstantSignal) {
  for (const double duration_s : {1e-9, 1e-7, 1e-4}) {
    const ModalModel model = test::paper_model();
    SearchSettings settings;
    settings.duration_s = duration_s;
    ASSERT_EQ(search.start(model, settings), Status::kOk);
    EXPECT_TRUE(search.done());
    EXPECT_EQ(search.result().signal.count(), 0u);
    EXPECT_EQ(search.result().signal.duration_s(), duration_s);
    ASSERT_EQ(bound.start(model, duration_s, workspace), Status::kOk);
    EXPECT_TRUE(bound.done());
    EXPECT_GE(bound.bound(), search.result().energy);
    EXPECT_LE(bound.bound(), search.result().energy * (1.0 + 1e-9));
  }
}

TEST(EnergyBound, OfNothingIsZero) {
  ModalModel model{};
  ASSERT_EQ(model.set({0.1, 1000.0, 0.7071067811865476}, {2, 1000.0, 0.1},
                      Criterion::kIntegralSquareError),
            Status::kOk);
  SearchSettings settings;
  settings.duration_s = 2e-3;
  ASSERT_EQ(search.start(model, settings), Status::kOk);
  EXPECT_TRUE(search.done());
  EXPECT_EQ(search.result().energy, 0.0);
  ASSERT_EQ(bound.start(model, 2e-3, workspace), Status::kOk);
  EXPECT_EQ(bound.bound(), 0.0);
}

TEST(KernelBounds, RefuseWhatHasNoProof) {
  KernelBounds kernel{};
  ModalModel ideal{};
  ASSERT_EQ(ideal.set_ideal(1.0, butterworth({4, 1000.0, 1.0}), Criterion::kIntegralSquareError),
            Status::kOk);
  EXPECT_EQ(kernel.start(ideal, 2e-3, Span<double>()), Status::kInvalidArgument);
  EXPECT_EQ(bound.start(ideal, 2e-3, workspace), Status::kInvalidArgument);
}

}  // namespace
}  // namespace emax
