// Impulse and step response, peak and settling time against published numbers and closed forms.
#include <cmath>
#include <gtest/gtest.h>

#include "emax/base/elementary.hpp"
#include "emax/model/modal_model.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

using test::kPaperDevice;
using test::kPaperFilter;
using test::paper_model;

constexpr Criterion kIse = Criterion::kIntegralSquareError;

TEST(ModalModel, ImpulseResponseMeetsTheKnownNumbers) {
  const ModalModel model = paper_model();
  // Nine digits are given; half a unit of the last one.
  EXPECT_NEAR(model.impulse_response(10e-6), 6199.1624, 0.5e-4);
  EXPECT_NEAR(model.impulse_response(50e-6), 17451.1509, 0.5e-4);
  EXPECT_NEAR(model.impulse_response(100e-6), 8133.60891, 0.5e-5);
  EXPECT_NEAR(model.impulse_response(500e-6), -259.559968, 0.5e-6);
  EXPECT_NEAR(model.impulse_response(1000e-6), -1744.33268, 0.5e-5);
  EXPECT_NEAR(model.impulse_response(2000e-6), 424.175752, 0.5e-6);
  EXPECT_EQ(model.impulse_response(-1e-9), 0.0);
  EXPECT_EQ(model.device_impulse_response(-1e-9), 0.0);
  EXPECT_EQ(model.filter_impulse_response(-1e-9), 0.0);
}

TEST(ModalModel, PeakAndSettlingTimeMeetTheKnownNumbers) {
  const ModalModel model = paper_model();
  const Peak peak = model.peak();
  EXPECT_NEAR(peak.value, 17462.4, 0.05);
  EXPECT_NEAR(peak.time_s, 51.4e-6, 0.05e-6);
  const SettlingTime settling = model.settling_time(0.05);
  EXPECT_TRUE(settling.found);
  EXPECT_NEAR(settling.time_s, 1.453582e-3, 0.5e-9);
}

TEST(ModalModel, PeakOfALoneSensorIsTheTextbookOne) {
  // Without a filter (gain 0) the peak is S w0 e^(-b/sqrt(1-b^2) acos b) at acos(b)/wd.
  for (const double damping : {0.001, 0.1, 0.5, 0.95}) {
    ModalModel model{};
    ASSERT_EQ(model.set({1.5, 2000.0, damping}, {4, 1000.0, 0.0}, kIse), Status::kOk);
    const double w0 = 2.0 * std::acos(-1.0) * 2000.0;
    const double root = std::sqrt(1.0 - damping * damping);
    const Peak peak = model.peak();
    EXPECT_NEAR(peak.time_s, std::acos(damping) / (w0 * root), 1e-6 * peak.time_s);
    EXPECT_NEAR(peak.value, 1.5 * w0 * std::exp(-damping / root * std::acos(damping)),
                1e-12 * peak.value);
  }
}

TEST(ModalModel, SettlingTimeOfALightlyDampedSensorIsThatOfItsEnvelope) {
  // The peaks of the lone sensor decay as e^(-b w0 t): 20 times less than the first after ln 20/(b
  // w0), to within half a period.
  ModalModel model{};
  ASSERT_EQ(model.set({1.0, 1000.0, 0.01}, {2, 500.0, 0.0}, kIse), Status::kOk);
  const double expected_s = std::log(20.0) / (0.01 * 2.0 * std::acos(-1.0) * 1000.0);
  const SettlingTime settling = model.settling_time(0.05);
  EXPECT_TRUE(settling.found);
  EXPECT_NEAR(settling.time_s, expected_s, 0.5e-3);
  EXPECT_NEAR(abs(model.impulse_response(settling.time_s)), 0.05 * model.peak().value,
              1e-9 * model.peak().value);
}

TEST(ModalModel, PeakMayBeNegativeAndAtTheStart) {
  // A first-order filter much faster than the sensor starts at -g wc.
  ModalModel model{};
  ASSERT_EQ(model.set({1.0, 10.0, 0.5}, {1, 1000.0, 1.0}, kIse), Status::kOk);
  EXPECT_EQ(model.peak().time_s, 0.0);
  EXPECT_NEAR(model.peak().value, -2.0 * std::acos(-1.0) * 1000.0, 1e-9);
}

TEST(ModalModel, StepResponseIsTheTextbookOne) {
  // Sensor: S (1 - e^(-b w0 t) (cos wd t + b/sqrt(1-b^2) sin wd t)); first-order filter: g (1 -
  // e^(-wc t)).
  ModalModel model{};
  const Accelerometer device = {1.2, 3000.0, 0.4};
  ASSERT_EQ(model.set(device, {1, 700.0, 0.9}, kIse), Status::kOk);
  const double w0 = 2.0 * std::acos(-1.0) * 3000.0;
  const double wc = 2.0 * std::acos(-1.0) * 700.0;
  const double root = std::sqrt(1.0 - 0.16);
  for (double t_s = 0.0; t_s < 3e-3; t_s += 7e-5) {
    const double wd_t = w0 * root * t_s;
    const double sensor =
        1.2 * (1.0 - std::exp(-0.4 * w0 * t_s) * (std::cos(wd_t) + 0.4 / root * std::sin(wd_t)));
    EXPECT_NEAR(model.step_response(t_s), sensor - 0.9 * (1.0 - std::exp(-wc * t_s)), 1e-14);
  }
}

TEST(ModalModel, PartsAddUp) {
  const ModalModel model = paper_model();
  for (double t_s = 0.0; t_s < 2e-3; t_s += 1e-4) {
    EXPECT_NEAR(model.device_impulse_response(t_s) - model.filter_impulse_response(t_s),
                model.impulse_response(t_s), 1e-10);
  }
}

TEST(ModalModel, AnExchangedSensorIsTheSameAsAFreshModel) {
  for (const Criterion criterion : {kIse, Criterion::kEnergyDifference}) {
    ModalModel model = paper_model(criterion);
    const Accelerometer other = {1.1, 3900.0, 0.25};
    ASSERT_EQ(model.set_device(other), Status::kOk);
    ASSERT_EQ(model.set_gain(1.1), Status::kOk);
    ModalModel fresh{};
    ASSERT_EQ(fresh.set(other, {10, 1000.0, 1.1}, criterion), Status::kOk);
    EXPECT_EQ(model.static_power(), fresh.static_power());
    for (std::size_t i = 0; i < fresh.modes().size(); ++i) {
      // The filter's residues are multiplied by the ratio of the gains: two roundings, which a
      // weight makes larger, as its terms are up to 100 times its size.
      EXPECT_DOUBLE_EQ(model.modes()[i].residue.re, fresh.modes()[i].residue.re);
      EXPECT_EQ(model.modes()[i].pole.im, fresh.modes()[i].pole.im);
      EXPECT_NEAR(model.switch_weight(i).re, fresh.switch_weight(i).re,
                  1e-12 * std::fabs(fresh.switch_weight(i).re));
      for (std::size_t j = 0; j < fresh.modes().size(); ++j) {
        EXPECT_EQ(model.gramian(i, j).re, fresh.gramian(i, j).re);
        EXPECT_EQ(model.conjugate_gramian(i, j).im, fresh.conjugate_gramian(i, j).im);
      }
    }
  }
}

TEST(ModalModel, AReferenceFilterByItsModesIsTheSame) {
  ModalModel model{};
  ASSERT_EQ(model.set(kPaperDevice, butterworth(kPaperFilter), ErrorMeasure{kIse}), Status::kOk);
  const ModalModel expected = paper_model();
  ASSERT_EQ(model.modes().size(), expected.modes().size());
  for (std::size_t i = 0; i < model.modes().size(); ++i) {
    EXPECT_EQ(model.modes()[i].residue.re, expected.modes()[i].residue.re);
    EXPECT_EQ(model.switch_weight(i).im, expected.switch_weight(i).im);
  }
  EXPECT_EQ(model.filter().relative_degree, 10);
  EXPECT_EQ(model.filter().band_hz, 1000.0);
}

TEST(ModalModel, AFilterWithoutGainKeepsIt) {
  ModalModel model{};
  ASSERT_EQ(model.set(kPaperDevice, {4, 1000.0, 0.0}, kIse), Status::kOk);
  EXPECT_EQ(model.set_gain(0.0), Status::kOk);
  EXPECT_EQ(model.set_gain(1.0), Status::kInvalidArgument);
}

TEST(ModalModel, ARefusedArgumentChangesNothing) {
  ModalModel model = paper_model();
  const double before = model.impulse_response(1e-4);
  EXPECT_EQ(model.set({1.0, 1000.0, 1.0}, kPaperFilter, kIse), Status::kOverdamped);
  EXPECT_EQ(model.set(kPaperDevice, {16, 1000.0, 1.0}, kIse), Status::kInvalidOrder);
  EXPECT_EQ(model.set_device({-1.0, 1000.0, 0.5}), Status::kInvalidArgument);
  EXPECT_EQ(model.set_gain(-1.0), Status::kInvalidArgument);
  EXPECT_EQ(model.set_gain(HUGE_VAL), Status::kInvalidArgument);
  EXPECT_EQ(model.impulse_response(1e-4), before);
  EXPECT_EQ(model.filter().relative_degree, 10);
}

}  // namespace
}  // namespace emax
