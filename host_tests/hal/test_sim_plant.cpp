// The continuous part of the bench against its transfer function.
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "emax/sim/plant.hpp"

#include "hal/bench_response.hpp"

namespace emax::test {
namespace {

using sim::Device;
using sim::Plant;
using sim::PlantOutput;
using sim::Shaker;

constexpr double kInterval_s = 1e-5;
constexpr int kWindow = 10000;  // Whole periods of any multiple of 10 Hz.

struct Seen {
  Complex acceleration;
  Complex device;
};

// Drives a cosine until the transient is gone, then takes one window apart.
Seen measured(Plant& plant, int frequency_hz, int settling_windows) {
  Seen seen;
  const int cycles = frequency_hz / 10;
  for (int n = 0; n < (settling_windows + 1) * kWindow; ++n) {
    const double turns =
        static_cast<double>((static_cast<long long>(n) * cycles) % kWindow) / kWindow;
    const Complex phasor = std::polar(1.0, kTurn * turns);
    const PlantOutput output = plant.step(phasor.real());
    if (n >= settling_windows * kWindow) {
      seen.acceleration += output.acceleration_mps2 * std::conj(phasor) * (2.0 / kWindow);
      seen.device += output.device_v * std::conj(phasor) * (2.0 / kWindow);
    }
  }
  return seen;
}

void expect_response(const Device& device, const Shaker& shaker, double skew_s,
                     int settling_windows, const std::vector<int>& frequencies_hz) {
  for (const int frequency_hz : frequencies_hz) {
    Plant plant;
    ASSERT_EQ(plant.configure(device, shaker, kInterval_s, skew_s), Status::kOk);
    const Seen seen = measured(plant, frequency_hz, settling_windows);
    const Complex acceleration = acceleration_seen(shaker, frequency_hz, kInterval_s);
    const Complex voltage = device_seen(device, shaker, frequency_hz, kInterval_s, skew_s);
    // Rounding of the recursion, and what is left of the transient: e^-28 of it.
    EXPECT_LT(std::abs(seen.acceleration - acceleration), 2e-11 * (1.0 + std::abs(acceleration)))
        << frequency_hz;
    EXPECT_LT(std::abs(seen.device - voltage), 2e-11 * (1.0 + std::abs(voltage))) << frequency_hz;
  }
}

TEST(SimPlant, RespondsAsItsTransferFunction) {
  expect_response({}, {}, 1.25e-6, 10,
                  {10, 20, 100, 1000, 3200, 4070, 6000, 10000, 14000, 20000, 30000, 45000});
}

TEST(SimPlant, AtEveryFrequencyOfTheDefaultSweep) {
  std::vector<int> frequencies_hz;
  for (int f = 30; f <= 100; f += 10) {
    frequencies_hz.push_back(f);
  }
  for (int f = 200; f <= 1000; f += 100) {
    frequencies_hz.push_back(f);
  }
  for (int f = 1200; f <= 6000; f += 200) {
    frequencies_hz.push_back(f);
  }
  ASSERT_EQ(frequencies_hz.size(), 42U);
  expect_response({}, {}, 1.25e-6, 10, frequencies_hz);
}

// Each parameter away from its default, so that each block shows.
TEST(SimPlant, WithOtherParts) {
  Shaker shaker;
  shaker.gain = -3.0;
  shaker.reconstruction_hz = 8000.0;
  shaker.armature_hz = 3000.0;
  shaker.armature_damping = 0.2;
  shaker.suspension_hz = 200.0;
  shaker.suspension_damping = 1.5;
  const Device device{-0.4, 9000.0, 0.05};
  const std::vector<int> frequencies_hz = {10, 200, 2900, 3000, 8000, 9000, 20000};
  for (const double skew_s : {-5e-6, 0.0, 5e-6}) {
    expect_response(device, shaker, skew_s, 10, frequencies_hz);
  }
}

TEST(SimPlant, NothingStaysOfAConstantVoltage) {
  Plant plant;
  ASSERT_EQ(plant.configure({}, {}, kInterval_s, 0.0), Status::kOk);
  PlantOutput output;
  for (int n = 0; n < 200000; ++n) {
    output = plant.step(1.0);
  }
  EXPECT_NEAR(output.acceleration_mps2, 0.0, 1e-12);
  EXPECT_NEAR(output.device_v, 0.0, 1e-12);
}

// A first-order check of the start: the sixth-order low-pass has not moved after half an interval
// by more than its leading term, gain * w_r^4 w_a^2 t^6/6!.
TEST(SimPlant, StartsAsAChainOfIntegrators) {
  constexpr double kShort_s = 1e-7;
  Plant plant;
  ASSERT_EQ(plant.configure({}, {}, kShort_s, 0.0), Status::kOk);
  const double acceleration = plant.step(1.0).acceleration_mps2;
  const double leading = 2.0 * std::pow(kTurn * 25000.0, 4) * std::pow(kTurn * 14000.0, 2) *
                         std::pow(0.5 * kShort_s, 6) / 720.0;
  // The next term: the sum of the dampings times t/7, and what rounding leaves of numbers near 1.
  EXPECT_NEAR(acceleration, leading, 0.01 * leading);
}

TEST(SimPlant, FlushEndsTheDecay) {
  Plant plant;
  ASSERT_EQ(plant.configure({}, {}, kInterval_s, 0.0), Status::kOk);
  plant.step(1.0);
  for (int n = 0; n < 100; ++n) {
    plant.step(0.0);
  }
  plant.flush();
  EXPECT_NE(plant.step(0.0).acceleration_mps2, 0.0);
  for (int n = 0; n < 2000000; ++n) {
    if (n % 64 == 0) {
      plant.flush();
    }
    plant.step(0.0);
  }
  const PlantOutput output = plant.step(0.0);
  EXPECT_EQ(output.acceleration_mps2, 0.0);
  EXPECT_EQ(output.device_v, 0.0);
}

TEST(SimPlant, ConfiguredAnewItIsAtRest) {
  Plant plant;
  ASSERT_EQ(plant.configure({}, {}, kInterval_s, 0.0), Status::kOk);
  for (int n = 0; n < 10; ++n) {
    plant.step(1.0);
  }
  ASSERT_EQ(plant.configure({}, {}, kInterval_s, 0.0), Status::kOk);
  EXPECT_EQ(plant.step(0.0).acceleration_mps2, 0.0);
}

TEST(SimPlant, RefusesAndKeepsWhatItHad) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  Plant plant;
  Plant untouched;
  ASSERT_EQ(plant.configure({}, {}, kInterval_s, 0.0), Status::kOk);
  ASSERT_EQ(untouched.configure({}, {}, kInterval_s, 0.0), Status::kOk);
  const auto refused = [&plant](const Device& device, const Shaker& shaker, double interval_s,
                                double skew_s) {
    return plant.configure(device, shaker, interval_s, skew_s) == Status::kInvalidArgument;
  };
  for (const double bad : {0.0, -1.0, nan, infinity, 2.1e6}) {
    EXPECT_TRUE(refused({1.0, bad, 0.3}, {}, kInterval_s, 0.0)) << bad;
    EXPECT_TRUE(refused({}, {2.0, bad, 14e3, 0.05, 15.0, 0.3}, kInterval_s, 0.0)) << bad;
    EXPECT_TRUE(refused({}, {2.0, 25e3, bad, 0.05, 15.0, 0.3}, kInterval_s, 0.0)) << bad;
    EXPECT_TRUE(refused({}, {2.0, 25e3, 14e3, 0.05, bad, 0.3}, kInterval_s, 0.0)) << bad;
  }
  for (const double bad : {0.0, -0.1, 11.0, nan, infinity}) {
    EXPECT_TRUE(refused({1.0, 4073.0, bad}, {}, kInterval_s, 0.0)) << bad;
    EXPECT_TRUE(refused({}, {2.0, 25e3, 14e3, bad, 15.0, 0.3}, kInterval_s, 0.0)) << bad;
    EXPECT_TRUE(refused({}, {2.0, 25e3, 14e3, 0.05, 15.0, bad}, kInterval_s, 0.0)) << bad;
  }
  for (const double bad : {nan, infinity, -infinity}) {
    EXPECT_TRUE(refused({bad, 4073.0, 0.3}, {}, kInterval_s, 0.0)) << bad;
    EXPECT_TRUE(refused({}, {bad, 25e3, 14e3, 0.05, 15.0, 0.3}, kInterval_s, 0.0)) << bad;
    EXPECT_TRUE(refused({}, {}, bad, 0.0)) << bad;
    EXPECT_TRUE(refused({}, {}, kInterval_s, bad)) << bad;
  }
  EXPECT_TRUE(refused({}, {}, 0.0, 0.0));
  EXPECT_TRUE(refused({}, {}, kInterval_s, 5.1e-6));
  EXPECT_TRUE(refused({}, {}, kInterval_s, -5.1e-6));
  for (int n = 0; n < 100; ++n) {
    EXPECT_EQ(plant.step(1.0).device_v, untouched.step(1.0).device_v);
  }
}

}  // namespace
}  // namespace emax::test
