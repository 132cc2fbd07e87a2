// Phi in single precision against the operator in double precision.
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "emax/energy/float_phi.hpp"

#include "support/paper_device.hpp"
#include "support/sign_pattern.hpp"

namespace emax {
namespace {

constexpr std::size_t kCells = 150;

struct Device {
  Accelerometer device;
  Butterworth filter;
  Criterion criterion;
  double tolerance;  ///< Of a product, as part of its largest element: 6e-8 times what cancels,
                     ///< or times the cells that a resonance adds up.
};

class FloatPhiOf : public testing::TestWithParam<Device> {
 protected:
  void SetUp() override {
    const Device& c = GetParam();
    ASSERT_EQ(model.set(c.device, c.filter, c.criterion), Status::kOk);
    ASSERT_EQ(exact.set(model, 3e-3, kCells), Status::kOk);
    phi.set(model, exact);
    for (const std::size_t end : {std::size_t{40}, std::size_t{41}, kCells}) {
      phi.fill_table(exact, filled, end, table);
      filled = end;
    }
  }

  void expect_product(Signs signs, Span<const float> of_signs) {
    std::vector<double> expected(kCells);
    exact.multiply(signs, Span<double>(expected.data(), kCells));
    double largest = 0.0;
    for (const double value : expected) {
      largest = std::fmax(largest, std::fabs(value) / phi.scale());
    }
    for (std::size_t i = 0; i < kCells; ++i) {
      EXPECT_NEAR(static_cast<double>(of_signs[i]), expected[i] / phi.scale(),
                  GetParam().tolerance * largest)
          << i;
    }
  }

  ModalModel model{};
  PhiOperator exact{};
  FloatPhi phi{};
  std::size_t filled = 0;
  float table[kCells] = {};
  float product[kCells] = {};
  std::mt19937_64 random{4};
};

TEST_P(FloatPhiOf, MultipliesAsTheOperator) {
  const test::SignPattern pattern = test::random_signs(kCells, random);
  phi.multiply(pattern.view(), product);
  expect_product(pattern.view(), product);
  float values[kCells];
  for (std::size_t i = 0; i < kCells; ++i) {
    values[i] = static_cast<float>(pattern.view()[i]);
  }
  float of_values[kCells];
  phi.multiply(Span<const float>(values), of_values);
  for (std::size_t i = 0; i < kCells; ++i) {
    EXPECT_EQ(of_values[i], product[i]);
  }
}

TEST_P(FloatPhiOf, FollowsStretchesThatTurn) {
  FloatPhi::End at_end;
  const test::SignPattern before = test::random_signs(kCells, random);
  const test::SignPattern after = test::random_signs(kCells, random);
  phi.multiply(before.view(), product);
  for (std::size_t cell = 0;
       (cell = after.view().first_difference(before.view(), cell)) != kCells;) {
    std::size_t end = cell;
    const bool positive = after.view().is_positive(cell);
    while (end < kCells && after.view().is_positive(end) == positive &&
           before.view().is_positive(end) != positive) {
      ++end;
    }
    phi.add_stretch(cell, end, positive ? 1.0F : -1.0F, table, product, at_end);
    cell = end;
  }
  phi.add_end(at_end, product);
  expect_product(after.view(), product);
}

TEST_P(FloatPhiOf, KnowsThePulses) {
  const auto most = static_cast<double>(phi.pulse_limit(FloatPhi::kMaxPulse));
  for (const std::size_t cell : {std::size_t{0}, std::size_t{100}, kCells - 9, kCells - 2}) {
    float energies[FloatPhi::kMaxPulse];
    phi.fill_pulses(cell, energies);
    for (std::size_t width = 1; width <= FloatPhi::kMaxPulse; ++width) {
      if (cell + width > kCells) {
        EXPECT_EQ(energies[width - 1], 0.0F);
        continue;
      }
      EXPECT_EQ(phi.pulse(cell, width), energies[width - 1]);
      EXPECT_LE(energies[width - 1], phi.pulse_limit(width));
      EXPECT_NEAR(static_cast<double>(energies[width - 1]), exact.pulse(cell, width) / phi.scale(),
                  3.0 * GetParam().tolerance * most)
          << cell << ' ' << width;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Devices, FloatPhiOf,
    testing::Values(
        Device{{1.037, 4073.0, 0.3182}, {10, 1000.0, 1.037}, Criterion::kIntegralSquareError, 1e-5},
        Device{{1.037, 4073.0, 0.3182}, {10, 1000.0, 1.037}, Criterion::kEnergyDifference, 1e-5},
        Device{{1e-7, 4073.0, 0.01}, {1, 1000.0, 1e-7}, Criterion::kIntegralSquareError, 1e-5},
        Device{{1.0, 900.0, 0.5}, {4, 1000.0, 1.0}, Criterion::kEnergyDifference, 1e-5},
        Device{{1.0, 4000.0, 0.5}, {15, 2000.0, 1.0}, Criterion::kIntegralSquareError, 1e-3}));

}  // namespace
}  // namespace emax
