// Energies by differential equations against closed forms, and where these lose their digits.
#include <cmath>
#include <gtest/gtest.h>

#include "emax/energy/known_energy.hpp"
#include "emax/energy/refinement.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/model/cascade_response.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

using test::kPaperDevice;

ModalModel model_of(const Accelerometer& device, const Butterworth& filter, Criterion criterion,
                    DelayMode delay = DelayMode::kNone) {
  ModalModel model{};
  EXPECT_EQ(model.set(device, butterworth(filter), ErrorMeasure{criterion, {delay, 0.0}}),
            Status::kOk);
  return model;
}

KnownEnergy by_cascade(const ModalModel& model, Span<const double> times_s, double duration_s) {
  CascadeResponse response{};
  EXPECT_TRUE(response.start(model, duration_s));
  double last_s = 0.0;
  double sign = 1.0;
  for (const double time_s : times_s) {
    response.advance(time_s - last_s, sign);
    last_s = time_s;
    sign = -sign;
  }
  response.advance(duration_s - last_s, sign);
  return response.energy();
}

TEST(CascadeResponse, HasTheEnergiesOfTheClosedForm) {
  const double times_s[] = {0.2e-3, 0.65e-3, 1.3e-3};
  for (const int order : {1, 2, 3, 6, 10}) {
    for (const Criterion criterion :
         {Criterion::kIntegralSquareError, Criterion::kEnergyDifference, Criterion::kInBandError}) {
      const ModalModel model = model_of(kPaperDevice, {order, 1000.0, 0.9}, criterion);
      const double expected = energy(model, times_s, 2e-3);
      const KnownEnergy found = by_cascade(model, times_s, 2e-3);
      // The closed form of order 10 is good to 1e-14 of the outputs' energies of some 1e-3.
      EXPECT_NEAR(found.energy, expected, 1e-12 * std::fabs(expected) + 1e-16) << order;
      EXPECT_LT(found.rounding, 1e-10 * std::fabs(expected));
      EXPECT_LE(std::fabs(found.energy - expected),
                found.rounding + energy_rounding(model, 2e-3, 3, expected));
    }
  }
}

TEST(CascadeResponse, HasThemWithADelay) {
  const double times_s[] = {0.365e-3, 0.946e-3};
  for (const int order : {4, 7, 10}) {
    const ModalModel model = model_of(kPaperDevice, {order, 1000.0, 1.037}, Criterion::kInBandError,
                                      DelayMode::kOfSensor);
    const double expected = energy(model, times_s, 2e-3);
    EXPECT_NEAR(by_cascade(model, times_s, 2e-3).energy, expected, 1e-11 * expected);
  }
}

TEST(CascadeResponse, KeepsAllDigitsOfAPowerOfTime) {
  // As T goes to 0 y = -G (wc t)^L/L! in band, so E = G^2 wc^2L T^(2L + 1)/((2L + 1) L!^2), less
  // something like wc T of it.
  const double wc = 2.0 * std::acos(-1.0) * 1000.0;
  const double duration_s = 1e-9 / wc;
  for (const int order : {1, 2, 5, 9, 12}) {
    double factor = 1.0;
    for (int n = 1; n <= order; ++n) {
      factor *= 1e-9 / n;
    }
    const ModalModel model = model_of(kPaperDevice, {order, 1000.0, 1.0}, Criterion::kInBandError);
    const KnownEnergy found = by_cascade(model, Span<const double>(), duration_s);
    const double expected = factor * factor * duration_s / (2 * order + 1);
    EXPECT_NEAR(found.energy / expected, 1.0, 1e-7) << order;
  }
}

TEST(CascadeResponse, OfAShortTimeIsTheSensorAlone) {
  // y = S w0^2 t^2/2 (1 - 2 b w0 t/3 ...): E = S^2 w0^4 T^5/20 less about b w0 T of it.
  const double w0_t = 2.0 * std::acos(-1.0) * 4073.0 * 1e-9;
  const ModalModel model =
      model_of(kPaperDevice, {15, 1000.0, 1.037}, Criterion::kIntegralSquareError);
  SwitchingSignal signal{};
  ASSERT_EQ(signal.set(Span<const double>(), 1e-9), Status::kOk);
  const EnergyAnswer answer = known_energy(model, signal);
  EXPECT_EQ(answer.status, Status::kOk);
  EXPECT_NEAR(answer.known.energy, 1.037 * 1.037 * std::pow(w0_t, 4) * 1e-9 / 20.0,
              1e-4 * answer.known.energy);
}

TEST(Refinement, EndsOnAnEnergyThatKeepsItsDigits) {
  // As above: a closed form of order 15 has none left.
  const double w0_t = 2.0 * std::acos(-1.0) * 4073.0 * 1e-9;
  const ModalModel model =
      model_of(kPaperDevice, {15, 1000.0, 1.037}, Criterion::kIntegralSquareError);
  SwitchingSignal signal{};
  ASSERT_EQ(signal.set(Span<const double>(), 1e-9), Status::kOk);
  static double scratch[kRefinementScratch];
  const Refinement found = refine(model, signal, Span<double>(scratch));
  EXPECT_NEAR(found.energy, 1.037 * 1.037 * std::pow(w0_t, 4) * 1e-9 / 20.0, 1e-4 * found.energy);
}

TEST(OneSidedResponse, HoldsUntilTheResponseTurns) {
  // The first zero of k of Table 2's device is near 130 us.
  const ModalModel model = test::paper_model();
  for (const double duration_s : {1e-9, 1e-5, 1e-4, 1.2e-4}) {
    const OneSidedResponse found = one_sided_response(model, duration_s);
    EXPECT_TRUE(found.holds) << duration_s;
    EXPECT_NEAR(found.output, std::fabs(model.step_response(duration_s)), 1e-12);
  }
  EXPECT_GT(model.impulse_response(1.2e-4) * model.impulse_response(1e-4), 0.0);
  EXPECT_LT(model.impulse_response(1.7e-4) * model.impulse_response(1e-4), 0.0);
  EXPECT_FALSE(one_sided_response(model, 1.7e-4).holds);
  EXPECT_FALSE(one_sided_response(test::paper_model(Criterion::kEnergyDifference), 1e-5).holds);
}

TEST(OneSidedResponse, DoesNotHoldWhereTheInputPassesAtOnce) {
  ModalModel model{};
  ASSERT_EQ(model.set_ideal(1.0, butterworth({4, 1000.0, 1.0}), Criterion::kIntegralSquareError),
            Status::kOk);
  EXPECT_FALSE(one_sided_response(model, 1e-5).holds);
}

TEST(CascadeResponse, SaysWhatTakesTooManySteps) {
  CascadeResponse response{};
  const ModalModel model = test::paper_model();
  EXPECT_FALSE(response.start(model, 0.0));
  EXPECT_FALSE(response.start(model, 1.0));
  EXPECT_TRUE(response.start(model, 0.1));
}

}  // namespace
}  // namespace emax
