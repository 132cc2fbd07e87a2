// Draws of devices: their numbers, their order, and what happens outside what a device may be.
#include <cmath>
#include <gtest/gtest.h>

#include "emax/uncertainty/device_draws.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

using test::kPaperDevice;

constexpr std::uint32_t kSeed[] = {123456789, 345678901, 567890123, 789012345};

DrawSettings box(double u_sensitivity, double u_frequency_hz, double u_damping) {
  DrawSettings settings;
  settings.box = {u_sensitivity, u_frequency_hz, u_damping};
  EXPECT_EQ(settings.generator.seed(Generator::k2006, kSeed), Status::kOk);
  return settings;
}

DrawSettings normal(double u_sensitivity, double u_frequency_hz, double u_damping) {
  DrawSettings settings = box(0.0, 0.0, 0.0);
  settings.distribution = Distribution::kNormal;
  settings.covariance[0][0] = u_sensitivity * u_sensitivity;
  settings.covariance[1][1] = u_frequency_hz * u_frequency_hz;
  settings.covariance[2][2] = u_damping * u_damping;
  return settings;
}

/// The normal numbers that trial `trial` gets at redraw `redraw`, from the definition alone.
void numbers(std::uint32_t trial, int redraw, double (&z)[3]) {
  WichmannHill generator;
  ASSERT_EQ(generator.seed(Generator::k2006, kSeed), Status::kOk);
  for (int i = 0; i < 4 * redraw; ++i) {  // 2^64 is four times 2^62.
    generator.jump(std::uint64_t{1} << 62U);
  }
  for (std::uint32_t i = 0; i < 4 * trial; ++i) {
    (void)generator.next();
  }
  double u[4];
  for (double& number : u) {
    number = generator.next();
  }
  const double two_pi = 2.0 * std::acos(-1.0);
  z[0] = std::sqrt(-2.0 * std::log(u[0])) * std::cos(two_pi * u[1]);
  z[1] = std::sqrt(-2.0 * std::log(u[0])) * std::sin(two_pi * u[1]);
  z[2] = std::sqrt(-2.0 * std::log(u[2])) * std::cos(two_pi * u[3]);
}

TEST(DeviceDraws, SpreadIsTheHalfRangeOrTheStandardDeviation) {
  DeviceDraws draws{};
  ASSERT_EQ(draws.start(kPaperDevice, box(0.003, 6.0, 0.0004)), Status::kOk);
  EXPECT_EQ(draws.spread(1), 6.0);
  DrawSettings settings = normal(0.003, 6.0, 0.0004);
  settings.covariance[0][1] = settings.covariance[1][0] = 0.5 * 0.003 * 6.0;
  settings.covariance[1][2] = settings.covariance[2][1] = -0.3 * 6.0 * 0.0004;
  ASSERT_EQ(draws.start(kPaperDevice, settings), Status::kOk);
  // Whatever the correlations; to rounding of the root.
  EXPECT_NEAR(draws.spread(0), 0.003, 1e-15);
  EXPECT_NEAR(draws.spread(1), 6.0, 1e-12);
  EXPECT_NEAR(draws.spread(2), 0.0004, 1e-15);
}

TEST(DeviceDraws, PlacesAreWhereTheDevicesLie) {
  DeviceDraws draws{};
  ASSERT_EQ(draws.start(kPaperDevice, box(0.003, 6.0, 0.0004)), Status::kOk);
  for (std::uint32_t t = 0; t < 100; ++t) {
    ASSERT_TRUE(draws.draw(t));
    const Accelerometer device = draws.device();
    const DeviceDraws::Place place = draws.place_of(device);
    // The rounding of the largest parameter, 4073 Hz, in half ranges of 6 Hz.
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(draws.place()[i], place[i], 1e-12);
      EXPECT_LE(std::fabs(place[i]), 1.0 + 1e-12);
    }
    EXPECT_EQ(draws.sensitivity(), device.sensitivity);
    EXPECT_NEAR(draws.device_at(place).damping, device.damping, 1e-15);
  }
  EXPECT_EQ(draws.redraws(), 0u);
}

TEST(DeviceDraws, ANormalDrawThatIsNoDeviceIsDrawnAgain) {
  // Damping 0.01 +- 0.01: one draw in six is below 1e-4.
  const Accelerometer estimate = {1.0, 4000.0, 0.01};
  DeviceDraws draws{};
  ASSERT_EQ(draws.start(estimate, normal(0.001, 4.0, 0.01)), Status::kOk);
  std::uint32_t again = 0;
  for (std::uint32_t t = 0; t < 200; ++t) {
    double z[3];
    int redraw = 0;
    for (numbers(t, 0, z); !(0.01 + 0.01 * z[2] >= 1e-4); numbers(t, redraw, z)) {
      ++redraw;
    }
    again += static_cast<std::uint32_t>(redraw);
    ASSERT_TRUE(draws.draw(t));
    EXPECT_NEAR(draws.device().damping, 0.01 + 0.01 * z[2], 1e-15) << t;
    EXPECT_NEAR(draws.device().natural_frequency_hz, 4000.0 + 4.0 * z[1], 1e-11) << t;
  }
  EXPECT_GT(again, 20u);
  EXPECT_EQ(draws.redraws(), again);
}

TEST(DeviceDraws, RedrawsAreCountedOnceInWhateverOrderTrialsAreRepeated) {
  DeviceDraws draws{};
  ASSERT_EQ(draws.start({1.0, 4000.0, 0.01}, normal(0.001, 4.0, 0.01)), Status::kOk);
  for (std::uint32_t t = 0; t < 100; ++t) {
    ASSERT_TRUE(draws.draw(t));
  }
  const std::uint32_t redraws = draws.redraws();
  DeviceDraws forward = draws;
  for (std::uint32_t t = 100; t-- > 0;) {
    ASSERT_TRUE(draws.draw(t));
    const double damping = draws.device().damping;
    DeviceDraws alone{};
    ASSERT_EQ(alone.start({1.0, 4000.0, 0.01}, normal(0.001, 4.0, 0.01)), Status::kOk);
    ASSERT_TRUE(alone.draw(t));
    EXPECT_EQ(alone.device().damping, damping);
  }
  EXPECT_EQ(draws.redraws(), redraws);
  // A trial after a redraw takes its own numbers.
  ASSERT_TRUE(forward.draw(100));
  DeviceDraws alone{};
  ASSERT_EQ(alone.start({1.0, 4000.0, 0.01}, normal(0.001, 4.0, 0.01)), Status::kOk);
  ASSERT_TRUE(alone.draw(100));
  EXPECT_EQ(forward.device().damping, alone.device().damping);
}

TEST(DeviceDraws, GivesUpAfter64Redraws) {
  // Of damping 0.5 +- 1e6 one draw in about 2.5 million is a device.
  DeviceDraws draws{};
  ASSERT_EQ(draws.start({1.0, 4000.0, 0.5}, normal(0.001, 4.0, 1e6)), Status::kOk);
  EXPECT_FALSE(draws.draw(0));
  EXPECT_EQ(draws.redraws(), DeviceDraws::kMaxRedraws);
  EXPECT_EQ(draws.device().damping, 0.5);
}

TEST(DeviceDraws, ReachEndsWhereDevicesDo) {
  DeviceDraws draws{};
  ASSERT_EQ(draws.start(kPaperDevice, normal(0.003, 6.0, 0.0004)), Status::kOk);
  EXPECT_EQ(draws.reach(4.0), 4.0);
  // 0.0099 of room above the least damping, in steps of 0.004.
  ASSERT_EQ(draws.start({1.0, 4000.0, 0.01}, normal(0.001, 4.0, 0.004)), Status::kOk);
  EXPECT_NEAR(draws.reach(4.0), 2.475, 0.003);
  EXPECT_EQ(validate(draws.device_at({2.47, 2.47, -2.47})), Status::kOk);
  EXPECT_NE(validate(draws.device_at({0.0, 0.0, -2.48})), Status::kOk);
}

TEST(DeviceDraws, KnowsWhichUnitsMoveTheDevice) {
  DeviceDraws draws{};
  ASSERT_EQ(draws.start(kPaperDevice, box(0.003, 0.0, 0.0004)), Status::kOk);
  EXPECT_TRUE(draws.moves(0, false));
  EXPECT_FALSE(draws.moves(0, true));
  EXPECT_FALSE(draws.moves(1, false));
  EXPECT_TRUE(draws.moves(2, true));
  DrawSettings correlated = normal(0.003, 6.0, 0.0004);
  correlated.covariance[0][1] = correlated.covariance[1][0] = 0.5 * 0.003 * 6.0;
  ASSERT_EQ(draws.start(kPaperDevice, correlated), Status::kOk);
  EXPECT_TRUE(draws.moves(0, true));  // By f0, which goes with S.
}

// S and f0 with a correlation of 1, and both the same with the damping.
TEST(DeviceDraws, ParametersThatGoTogetherAreDrawnTogether) {
  DrawSettings settings = normal(0.003, 6.0, 0.0004);
  settings.covariance[0][1] = settings.covariance[1][0] = 0.003 * 6.0;
  settings.covariance[0][2] = settings.covariance[2][0] = 0.5 * 0.003 * 0.0004;
  settings.covariance[1][2] = settings.covariance[2][1] = 0.5 * 6.0 * 0.0004;
  DeviceDraws draws{};
  ASSERT_EQ(draws.start(kPaperDevice, settings), Status::kOk);
  for (std::uint32_t t = 0; t < 50; ++t) {
    ASSERT_TRUE(draws.draw(t));
    const Accelerometer device = draws.device();
    const double s = (device.sensitivity - kPaperDevice.sensitivity) / 0.003;
    const double f0 = (device.natural_frequency_hz - kPaperDevice.natural_frequency_hz) / 6.0;
    EXPECT_NEAR(f0, s, 1e-9) << t;  // Rounding of S and f0 in their standard deviations.
    EXPECT_NEAR(draws.device_at(draws.place_of(device)).natural_frequency_hz,
                device.natural_frequency_hz, 1e-9);
  }
  settings.covariance[1][2] = settings.covariance[2][1] = 0.4 * 6.0 * 0.0004;
  EXPECT_EQ(draws.start(kPaperDevice, settings), Status::kInvalidArgument) << "cannot be";
}

TEST(DeviceDraws, RefusalLeavesTheDrawsAsTheyWere) {
  DeviceDraws draws{};
  ASSERT_EQ(draws.start(kPaperDevice, box(0.003, 6.0, 0.0004)), Status::kOk);
  ASSERT_TRUE(draws.draw(3));
  const double before = draws.sensitivity();
  EXPECT_EQ(draws.start(kPaperDevice, box(1.037, 6.0, 0.0004)), Status::kInvalidArgument);
  EXPECT_EQ(draws.start(kPaperDevice, box(0.003, 6.0, 0.7)), Status::kInvalidArgument);
  EXPECT_EQ(draws.start({1.0, 4000.0, 0.9}, box(0.003, 6.0, 0.2)), Status::kOverdamped);
  EXPECT_EQ(draws.start(kPaperDevice, normal(0.003, 6.0, std::nan(""))), Status::kInvalidArgument);
  EXPECT_EQ(draws.start({0.0, 4000.0, 0.3}, box(0.0, 6.0, 0.0004)), Status::kInvalidArgument);
  for (const double bad : {-6.0, std::nan(""), HUGE_VAL}) {
    EXPECT_EQ(draws.start(kPaperDevice, box(0.003, bad, 0.0004)), Status::kInvalidArgument) << bad;
  }
  DrawSettings settings = normal(0.003, 6.0, 0.0004);
  settings.covariance[0][1] = 0.5 * 0.003 * 6.0;
  EXPECT_EQ(draws.start(kPaperDevice, settings), Status::kInvalidArgument) << "not symmetrical";
  settings.covariance[0][1] = settings.covariance[1][0] = 1.5 * 0.003 * 6.0;
  EXPECT_EQ(draws.start(kPaperDevice, settings), Status::kInvalidArgument) << "correlation of 1.5";
  settings = normal(0.0, 6.0, 0.0004);
  settings.covariance[0][1] = settings.covariance[1][0] = 0.001;
  EXPECT_EQ(draws.start(kPaperDevice, settings), Status::kInvalidArgument) << "of a constant";
  ASSERT_TRUE(draws.draw(3));
  EXPECT_EQ(draws.sensitivity(), before);
}

}  // namespace
}  // namespace emax
