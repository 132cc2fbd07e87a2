// The in-band error against convolutions, closed forms and its own scaling; the ideal sensor.
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "emax/energy/fixed_point.hpp"
#include "emax/energy/known_energy.hpp"
#include "emax/energy/phi_operator.hpp"
#include "emax/model/in_band.hpp"
#include "emax/model/modal_model.hpp"

#include "support/paper_device.hpp"
#include "support/sign_pattern.hpp"

namespace emax {
namespace {

using test::kPaperDevice;
using test::kPaperFilter;

constexpr ErrorMeasure kPlain = {Criterion::kInBandError, {DelayMode::kNone, 0.0}};
constexpr ErrorMeasure kMatched = {Criterion::kInBandError, {DelayMode::kOfSensor, 0.0}};

ModalModel model_of(const Accelerometer& device, const Butterworth& filter,
                    const ErrorMeasure& measure) {
  ModalModel model{};
  EXPECT_EQ(model.set(device, butterworth(filter), measure), Status::kOk);
  return model;
}

/// The integral over [0, t] of h(t - v) ka(v), h of gain 1, by 10 nodes of Gauss and Legendre on
/// pieces of 10 us: exact to rounding.
double filtered_sensor(const ModalModel& model, double time_s) {
  constexpr double kNodes[] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                               0.8650633666889845, 0.9739065285171717};
  constexpr double kWeights[] = {0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                 0.1494513491505806, 0.0666713443086881};
  const int pieces = static_cast<int>(time_s / 10e-6) + 1;
  const double half_s = 0.5 * time_s / pieces;
  double sum = 0.0;
  for (int piece = 0; piece < pieces; ++piece) {
    for (int n = 0; n < 5; ++n) {
      for (const double side : {-1.0, 1.0}) {
        const double v_s = half_s * (2 * piece + 1 + side * kNodes[n]);
        sum += half_s * kWeights[n] * model.filter_impulse_response(time_s - v_s) *
               model.device_impulse_response(v_s);
      }
    }
  }
  return sum / model.filter().gain;
}

TEST(InBandError, IsTheFilteredDifferenceOfSensorAndGain) {
  for (const int order : {1, 2, 3, 4, 7, 10, 15}) {
    for (const double gain : {1.037, 0.9}) {
      const ModalModel model = model_of(kPaperDevice, {order, 1000.0, gain}, kPlain);
      EXPECT_DOUBLE_EQ(model.static_gain(), 1.037 - gain);
      for (const double t_s : {20e-6, 0.3e-3, 1.1e-3}) {
        const double expected = filtered_sensor(model, t_s) - model.filter_impulse_response(t_s);
        // Both are sums of a dozen terms, at order 15 of up to 60 times 6000, a few roundings each.
        EXPECT_NEAR(model.impulse_response(t_s), expected, order == 15 ? 1e-8 : 1e-9)
            << order << ' ' << t_s;
      }
    }
  }
}

TEST(InBandError, WithADelayComparesWithTheFilterOfBefore) {
  for (const int order : {4, 6, 10}) {
    const ModalModel model = model_of(kPaperDevice, {order, 1000.0, 1.037}, kMatched);
    EXPECT_DOUBLE_EQ(model.delay_s(), 2.0 * 0.3182 / (2.0 * std::acos(-1.0) * 4073.0));
    for (const double t_s : {0.1e-3, 0.3e-3, 1.1e-3}) {
      const double expected =
          filtered_sensor(model, t_s) - model.filter_impulse_response(t_s - model.delay_s());
      EXPECT_NEAR(model.impulse_response(t_s), expected, 1e-9) << order << ' ' << t_s;
    }
    // K(0) of the modes, whose terms are some thousand times the difference.
    double at_zero = 0.0;
    for (std::size_t i = 0; i < model.modes().size(); ++i) {
      at_zero -= real_of_product(model.modes()[i].residue, model.inverse_pole(i));
    }
    EXPECT_NEAR(model.static_gain(), at_zero, 1e-14);
  }
}

TEST(InBandError, KeepsItsDigitsWhereTheSensorIsNearlyIdeal) {
  // To first order in the inverse of f0, K = -2 b s/w0 S Kf/G, and with the delay out -(1 - 2 b^2)
  // (s/w0)^2: what is left over is of the next order, f/f0 = 1e-6 relative.
  const double w0 = 2.0 * std::acos(-1.0) * 1e9;
  for (const ErrorMeasure& measure : {kPlain, kMatched}) {
    const ModalModel model = model_of({1.0, 1e9, 0.3}, {4, 1000.0, 1.0}, measure);
    for (std::size_t i = 1; i < model.modes().size(); ++i) {
      const Mode filter = model.filter().modes[i - 1];
      const Complex q = (1.0 / w0) * filter.pole;
      const Complex part =
          measure.delay.mode == DelayMode::kNone ? -0.6 * q : (-1.0 + 0.5 * 0.36) * (q * q);
      const Complex expected = filter.residue * part;
      EXPECT_LT(std::sqrt(norm(model.modes()[i].residue - expected)),
                5e-6 * std::sqrt(norm(expected)));
    }
  }
}

TEST(InBandError, DoesNotDependOnTheSensitivity) {
  const ModalModel one = model_of(kPaperDevice, kPaperFilter, kMatched);
  const ModalModel ten = model_of({10.37, 4073.0, 0.3182}, {10, 1000.0, 10.37}, kMatched);
  const double energies[] = {energy(one, Span<const double>(), 2e-3),
                             energy(ten, Span<const double>(), 2e-3)};
  EXPECT_NEAR(energies[1], 100.0 * energies[0], 1e-10 * energies[1]);
}

TEST(InBandError, AnExchangedSensorIsAFreshModelWithTheFirstDelay) {
  ModalModel model = model_of(kPaperDevice, kPaperFilter, kMatched);
  const double delay_s = model.delay_s();
  const Accelerometer other = {1.1, 3900.0, 0.25};
  ASSERT_EQ(model.set_device(other), Status::kOk);
  EXPECT_EQ(model.delay_s(), delay_s);
  const ErrorMeasure given = {Criterion::kInBandError, {DelayMode::kGiven, delay_s}};
  const ModalModel fresh = model_of(other, kPaperFilter, given);
  for (std::size_t i = 0; i < fresh.modes().size(); ++i) {
    EXPECT_EQ(model.modes()[i].residue.re, fresh.modes()[i].residue.re);
    EXPECT_EQ(model.switch_weight(i).im, fresh.switch_weight(i).im);
    EXPECT_EQ(model.correlation(i).re, fresh.correlation(i).re);
  }
  EXPECT_EQ(model.static_power(), fresh.static_power());
}

TEST(InBandError, ADelayLeavesOpenWhatTheContinuedFilterHasBeforeItsStart) {
  // Order 1: h(-s) = wc e^(wc s). Order 2: sqrt(2) wc e^(u) sin(u), u = wc s/sqrt(2), with the
  // integral e^u (sin u - cos u)/sqrt(2) + 1/sqrt(2), times sqrt(2).
  const double wc = 2.0 * std::acos(-1.0) * 1000.0;
  for (const double part : {0.01, 0.3, 1.0}) {
    const double delay_s = part / wc;
    EXPECT_NEAR(reach_before_start(butterworth({1, 1000.0, 1.037}), delay_s), std::expm1(part),
                1e-15);
    const double u = part / std::sqrt(2.0);
    EXPECT_NEAR(reach_before_start(butterworth({2, 1000.0, 0.7}), delay_s),
                -(std::exp(u) * (std::sin(u) - std::cos(u)) + 1.0), 1e-15);
  }
  // The leading term (wc tau)^10/10!, which is too low by less than the next ones add.
  const double tau_wc = 0.01;
  const double leading = std::pow(tau_wc, 10) / 3628800.0;
  const double found = reach_before_start(butterworth({10, 1000.0, 1.0}), tau_wc / wc);
  EXPECT_NEAR(std::fabs(found) / leading, 1.0, 0.01);
}

// The band ends at 1000 Hz. At order 10 nothing passes at 20 kHz; at order 1 a twentieth does, of a
// resonance of 50.
TEST(InBandError, AGridResolvesTheBandAndAResonanceThatShows) {
  const struct {
    double natural_frequency_hz;
    double damping;
    int order;
    double expected_hz;
  } grids[] = {{500.0, 0.3, 10, 1000.0}, {3000.0, 0.3, 10, 3000.0}, {20e3, 0.5, 10, 4000.0},
               {100e3, 0.5, 10, 6250.0}, {20e3, 0.01, 10, 4000.0},  {20e3, 0.01, 1, 20e3}};
  for (const auto& grid : grids) {
    const ModalModel model =
        model_of({1.0, grid.natural_frequency_hz, grid.damping}, {grid.order, 1000.0, 1.0}, kPlain);
    EXPECT_DOUBLE_EQ(model.grid_hz(), grid.expected_hz) << grid.natural_frequency_hz;
  }
}

TEST(InBandError, SaysWhatItDoesNotTakeAndStaysAsItWas) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ModalModel model = model_of(kPaperDevice, kPaperFilter, kPlain);
  const double before = model.impulse_response(1e-4);
  const ReferenceFilter filter = butterworth(kPaperFilter);
  const auto with_delay = [](double delay_s) {
    return ErrorMeasure{Criterion::kInBandError, {DelayMode::kGiven, delay_s}};
  };
  for (const double bad : {-1e-9, 1.6e-4, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(model.set(kPaperDevice, filter, with_delay(bad)), Status::kDelayTooLong) << bad;
  }
  // 2 b/w0 above 1/wc.
  EXPECT_EQ(model.set({1.0, 1000.0, 0.6}, filter, kMatched), Status::kDelayTooLong);
  EXPECT_EQ(model.set(kPaperDevice, butterworth({10, 1000.0, 0.0}), kPlain),
            Status::kInvalidArgument);
  EXPECT_EQ(model.set({1.0, 1000.0, 1.0}, filter, kPlain), Status::kOverdamped);
  EXPECT_EQ(model.set_ideal(0.0, filter, Criterion::kIntegralSquareError),
            Status::kInvalidArgument);
  EXPECT_EQ(model.set_ideal(nan, filter, Criterion::kInBandError), Status::kInvalidArgument);
  EXPECT_EQ(model.set_ideal(HUGE_VAL, filter, Criterion::kInBandError), Status::kInvalidArgument);
  EXPECT_EQ(model.set_ideal(1.0, butterworth({10, 1000.0, 0.0}), Criterion::kInBandError),
            Status::kInvalidArgument);
  EXPECT_EQ(model.impulse_response(1e-4), before);
  EXPECT_EQ(model.set(kPaperDevice, filter, with_delay(1.59e-4)), Status::kOk);
}

TEST(InBandError, PolesOfTheFilterAreMovedApart) {
  // Sections of order 2 and 4 have dampings of 1/sqrt(2) and sin(pi/8).
  for (const double damping : {0.7071067811865476, 0.7071068}) {
    const ModalModel model = model_of({0.1, 1000.0, damping}, {2, 1000.0, 0.1}, kPlain);
    EXPECT_GT(model.moved_by(), 0.0);
    EXPECT_EQ(model.device().natural_frequency_hz, 1000.0);
    // No farther than said: y of the modes against that of the sensor itself.
    CascadeResponse response{};
    ASSERT_TRUE(response.start(model, 2e-3));
    double t_s = 0.0;
    for (int i = 0; i < 40; ++i) {
      response.advance(5e-5, 1.0);
      t_s += 5e-5;
      EXPECT_LT(std::fabs(response.output() - model.step_response(t_s)), model.moved_by());
    }
  }
  EXPECT_EQ(model_of({0.1, 1001.0, 0.7071068}, {2, 1000.0, 0.1}, kPlain).moved_by(), 0.0);
}

TEST(IdealSensor, PassesItsInputAtOnce) {
  ModalModel model{};
  ASSERT_EQ(model.set_ideal(1.2, butterworth({1, 700.0, 0.9}), Criterion::kIntegralSquareError),
            Status::kOk);
  EXPECT_EQ(model.feedthrough(), 1.2);
  const double wc = 2.0 * std::acos(-1.0) * 700.0;
  for (const double t_s : {1e-6, 1e-4, 2e-3}) {
    EXPECT_NEAR(model.step_response(t_s), 1.2 - 0.9 * -std::expm1(-wc * t_s), 1e-14);
  }
  // (1.2 - 0.9 (1 - e^-u))^2 over T, u = wc t.
  const double u = wc * 2e-3;
  const double expected =
      (0.09 * u + 2.0 * 0.3 * 0.9 * -std::expm1(-u) + 0.405 * -std::expm1(-2.0 * u)) / wc;
  EXPECT_NEAR(energy(model, Span<const double>(), 2e-3), expected, 1e-15);
  EXPECT_DOUBLE_EQ(fast_switching_limit(model, 2e-3), 1.44 * 2e-3);
}

TEST(IdealSensor, KeepsThatOnTheGrid) {
  for (const Criterion criterion :
       {Criterion::kIntegralSquareError, Criterion::kEnergyDifference}) {
    ModalModel model{};
    ASSERT_EQ(model.set_ideal(1.2, butterworth({3, 700.0, 0.9}), criterion), Status::kOk);
    test::SignPattern signs({1, 1, -1, -1, -1, 1, -1, 1, 1, 1, -1, 1});
    SwitchingSignal signal{};
    ASSERT_EQ(signal.set_signs(signs.view(), 3e-3), Status::kOk);
    PhiOperator phi{};
    ASSERT_EQ(phi.set(model, 3e-3, 12), Status::kOk);
    double product[12];
    phi.multiply(signs.view(), Span<double>(product));
    const double expected = energy(model, signal);
    EXPECT_NEAR(dot(signs.view(), Span<const double>(product)), expected, 1e-13);
    // Turning one cell changes the energy by 4 (Phi_ii - x_i (Phi x)_i).
    test::SignPattern turned({1, 1, -1, -1, 1, 1, -1, 1, 1, 1, -1, 1});
    ASSERT_EQ(signal.set_signs(turned.view(), 3e-3), Status::kOk);
    EXPECT_NEAR(energy(model, signal) - expected, 4.0 * (phi.diagonal(4) + product[4]), 1e-13);
    EXPECT_LE(phi.diagonal(4), phi.diagonal_limit());
  }
}

TEST(InBandError, WhatIsLeftOpenRaisesABound) {
  const ModalModel model = model_of(kPaperDevice, {4, 1000.0, 1.037}, kMatched);
  // epsilon is 2.7e-5.
  EXPECT_NEAR(delay_tolerance(model), 2.693e-5 * 1.037, 1e-8);
  const double root = 2e-3 + delay_tolerance(model) * std::sqrt(2e-3);
  EXPECT_DOUBLE_EQ(true_bound(model, 4e-6, 2e-3), root * root);
  EXPECT_EQ(true_bound(model_of(kPaperDevice, kPaperFilter, kPlain), 4e-6, 2e-3), 4e-6);
  const ModalModel moved = model_of({0.1, 1000.0, 0.7071068}, {2, 1000.0, 0.1}, kPlain);
  EXPECT_GT(true_bound(moved, 4e-6, 2e-3), 4e-6);
  EXPECT_EQ(check_delay(model, 2e-3 * std::pow(101.0 * delay_tolerance(model), 2), 2e-3),
            Status::kOk);
  EXPECT_EQ(check_delay(model, 2e-3 * std::pow(99.0 * delay_tolerance(model), 2), 2e-3),
            Status::kDelayNotResolved);
}

TEST(IdealSensor, HasNoInBandError) {
  ModalModel model{};
  ASSERT_EQ(model.set_ideal(1.2, butterworth({10, 700.0, 1.2}), Criterion::kInBandError),
            Status::kOk);
  EXPECT_TRUE(model.is_nothing());
  EXPECT_EQ(energy(model, Span<const double>(), 2e-3), 0.0);
  // Of another sensitivity, S - G through the filter.
  ASSERT_EQ(model.set_ideal(1.2, butterworth({1, 700.0, 1.0}), Criterion::kInBandError),
            Status::kOk);
  const double wc = 2.0 * std::acos(-1.0) * 700.0;
  EXPECT_NEAR(model.step_response(1e-4), 0.2 * -std::expm1(-wc * 1e-4), 1e-15);
  EXPECT_EQ(fast_switching_limit(model, 2e-3), 0.0);
}

TEST(IdealSensor, AGivenDelayIsItsError) {
  // From the delay on it is S h(t) - G h(t - tau), h the filter of gain 1.
  const double delay_s = 1e-4;
  for (const int order : {2, 4, 10}) {
    for (const double gain : {1.2, 1.0}) {
      ModalModel model{};
      const Butterworth filter = {order, 700.0, gain};
      ASSERT_EQ(model.set_ideal(1.2, butterworth(filter), Criterion::kInBandError, delay_s),
                Status::kOk);
      EXPECT_FALSE(model.is_nothing());
      EXPECT_EQ(model.delay_s(), delay_s);
      const double peak = std::abs(model.peak().value);
      for (const double time_s : {1.5e-4, 3e-4, 8e-4, 2e-3}) {
        const double expected = 1.2 / gain * model.filter_impulse_response(time_s) -
                                model.filter_impulse_response(time_s - delay_s);
        // Rounding of poles of up to ten modes, whose residues cancel by some thousands.
        EXPECT_NEAR(model.impulse_response(time_s), expected, 1e-10 * peak) << order;
      }
      // Settled, what an input of 1 leaves is S - G, but for what the continued filter starts with.
      EXPECT_NEAR(model.static_gain(), 1.2 - gain, gain * 1.001 * model.delay_error() + 1e-15);
    }
  }
}

TEST(IdealSensor, ASensorInItsPlaceIsAFreshModel) {
  ModalModel model{};
  ASSERT_EQ(model.set_ideal(1.037, butterworth(kPaperFilter), Criterion::kIntegralSquareError),
            Status::kOk);
  ASSERT_EQ(model.set_device(kPaperDevice), Status::kOk);
  const ModalModel fresh = test::paper_model();
  EXPECT_EQ(energy(model, Span<const double>(), 2e-3), energy(fresh, Span<const double>(), 2e-3));
}

TEST(ModalModel, ASensorThatIsTheFilterLeavesNothing) {
  for (const Criterion criterion :
       {Criterion::kIntegralSquareError, Criterion::kEnergyDifference}) {
    ModalModel model{};
    ASSERT_EQ(model.set({0.1, 1000.0, 0.7071067811865476}, {2, 1000.0, 0.1}, criterion),
              Status::kOk);
    EXPECT_TRUE(model.is_nothing());
    EXPECT_EQ(energy(model, Span<const double>(), 2e-3), 0.0);
    EXPECT_EQ(model.settling_time(0.05).time_s, 0.0);
    EXPECT_TRUE(model.settling_time(0.05).found);
    // And another one brings the filter back.
    ASSERT_EQ(model.set_device({0.1, 1100.0, 0.7}), Status::kOk);
    ModalModel fresh{};
    ASSERT_EQ(fresh.set({0.1, 1100.0, 0.7}, {2, 1000.0, 0.1}, criterion), Status::kOk);
    EXPECT_FALSE(model.is_nothing());
    EXPECT_EQ(energy(model, Span<const double>(), 2e-3), energy(fresh, Span<const double>(), 2e-3));
  }
}

}  // namespace
}  // namespace emax
