// The coordinates of polynomials where the damping varies by much of itself.
#include <cmath>
#include <gtest/gtest.h>

#include "emax/uncertainty/damping_scale.hpp"

namespace emax {
namespace {

DeviceDraws normal_draws(double damping, double u, double correlation = 0.0) {
  DrawSettings settings;
  settings.distribution = Distribution::kNormal;
  const double us[3] = {0.001, 5.0, u};
  for (int i = 0; i < 3; ++i) {
    settings.covariance[i][i] = us[i] * us[i];
  }
  settings.covariance[1][2] = correlation * us[1] * us[2];
  settings.covariance[2][1] = settings.covariance[1][2];
  DeviceDraws draws{};
  EXPECT_EQ(draws.start({1.0, 4000.0, damping}, settings), Status::kOk);
  return draws;
}

TEST(DampingScale, IsThePlaceItselfWhereTheDampingIsWellKnown) {
  DampingScale scale{};
  scale.start(normal_draws(0.3, 0.001), 2e-3, 4.0);
  EXPECT_FALSE(scale.is_logarithm());
  const DeviceDraws::Place place = {0.5, -1.0, 3.0};
  EXPECT_EQ(scale.to_coordinates(place), place);
  EXPECT_EQ(scale.to_place(place), place);
}

TEST(DampingScale, IsTheLogarithmOfDampingAndWhatLastsForT) {
  const double knee = 1.0 / (2.0 * 3.14159265358979323846 * 4000.0 * 2e-3);
  DampingScale scale{};
  scale.start(normal_draws(0.3, 0.05), 2e-3, 4.0);
  ASSERT_TRUE(scale.is_logarithm());
  EXPECT_NEAR(scale.low(), std::log(0.1 + knee), 1e-14);
  EXPECT_NEAR(scale.high(), std::log(0.5 + knee), 1e-14);
  EXPECT_NEAR(scale.to_coordinates({0.0, 0.0, 2.0})[2], std::log(0.4 + knee), 1e-14);
  EXPECT_NEAR(scale.deviation(), 0.05 / (0.3 + knee), 1e-14);
  EXPECT_NEAR(scale.distance(scale.high()), 4.0, 1e-12);
}

TEST(DampingScale, EndsWhereDevicesEnd) {
  DampingScale scale{};
  const DeviceDraws draws = normal_draws(0.3, 0.3);
  scale.start(draws, 2e-3, 4.0);
  ASSERT_TRUE(scale.is_logarithm());
  for (const double end : {scale.low(), scale.high()}) {
    // Also where the other units are far from the estimate.
    const Accelerometer device = draws.device_at(scale.to_place({4.0, -4.0, end}));
    EXPECT_EQ(validate(device), Status::kOk) << device.damping;
  }
}

TEST(DampingScale, ThereAndBackIsTheSamePlace) {
  DampingScale scale{};
  scale.start(normal_draws(0.3, 0.1, 0.6), 2e-3, 4.0);
  ASSERT_TRUE(scale.is_logarithm());
  const DeviceDraws::Place place = {1.0, -2.0, 0.7};
  const DeviceDraws::Place back = scale.to_place(scale.to_coordinates(place));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(back[i], place[i], 1e-12);
  }
}

TEST(DampingScale, IsNotUsedWhereOtherUnitsSayWhatTheDampingIs) {
  DampingScale scale{};
  scale.start(normal_draws(0.3, 0.1, 0.99), 2e-3, 4.0);
  EXPECT_FALSE(scale.is_logarithm());
}

TEST(DampingScale, WhatIsNoDampingIsBelowTheRange) {
  DampingScale scale{};
  scale.start(normal_draws(0.3, 0.1), 2e-3, 4.0);
  EXPECT_LT(scale.to_coordinates({0.0, 0.0, -5.0})[2], scale.low());
}

}  // namespace
}  // namespace emax
