// The end of a climb in single precision, looked at in double precision.
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "emax/energy/energy_search.hpp"
#include "emax/energy/grid_climb.hpp"

#include "support/paper_device.hpp"
#include "support/sign_pattern.hpp"

namespace emax {
namespace {

struct Climbed {
  std::vector<double> product;  ///< Of the end, in double precision.
  double energy = 0.0;
  GridClimb climb;
};

Climbed climb_from(const test::SignPattern& start, const ModalModel& model, double duration_s,
                   bool has_pulses) {
  const std::size_t cells = start.size();
  PhiOperator exact{};
  EXPECT_EQ(exact.set(model, duration_s, cells), Status::kOk);
  FloatPhi phi{};
  phi.set(model, exact);
  std::vector<float> table(cells);
  phi.fill_table(exact, 0, cells, Span<float>(table.data(), cells));
  std::vector<float> pulses(has_pulses ? FloatPhi::kMaxPulse * cells : 0);
  for (std::size_t i = 0; has_pulses && i < cells; ++i) {
    phi.fill_pulses(i, Span<float>(&pulses[FloatPhi::kMaxPulse * i], FloatPhi::kMaxPulse));
  }
  const test::SignPattern applied(cells);
  std::vector<float> product(cells);
  Climbed result;
  const double shift = ascent_shift(model, duration_s / static_cast<double>(cells));
  result.climb.start(static_cast<float>(shift / phi.scale()));
  const auto step = [&] {
    return result.climb.step(phi, Span<const float>(table.data(), cells),
                             Span<const float>(pulses.data(), pulses.size()), start.view(),
                             applied.view(), Span<float>(product.data(), cells));
  };
  while (!result.climb.done()) {
    (void)step();
  }
  EXPECT_EQ(step(), 0U) << "nothing is left to do";
  result.product.resize(cells);
  exact.multiply(start.view(), Span<double>(result.product.data(), cells));
  result.energy = dot(start.view(), Span<const double>(result.product.data(), cells));
  EXPECT_NEAR(phi.scale() * result.climb.energy(), result.energy,
              1e-5 * std::fabs(result.energy) + 1e-4 * phi.scale());
  return result;
}

class ClimbOf : public testing::TestWithParam<Criterion> {};

TEST_P(ClimbOf, EndsWhereNothingGainsMoreThanRounding) {
  const ModalModel model = test::paper_model(GetParam());
  constexpr std::size_t kCells = 203;
  constexpr double kDuration_s = 4e-3;
  PhiOperator exact{};
  ASSERT_EQ(exact.set(model, kDuration_s, kCells), Status::kOk);
  std::mt19937_64 random(3);
  for (int repeat = 0; repeat < 10; ++repeat) {
    const test::SignPattern pattern = test::random_signs(kCells, random);
    const test::SignPattern again = pattern;
    std::vector<double> before(kCells);
    exact.multiply(pattern.view(), Span<double>(before.data(), kCells));
    const double start = dot(pattern.view(), Span<const double>(before.data(), kCells));
    const Climbed end = climb_from(pattern, model, kDuration_s, true);
    EXPECT_GT(end.energy, start);
    // What is not turned gains less than 1e-7 of the energy, or the rounding of single precision.
    const double tolerance = 1e-7 * end.energy + 2e-5 * exact.diagonal_limit();
    const Signs signs = pattern.view();
    for (std::size_t i = 0; i < kCells; ++i) {
      double held = 0.0;
      for (std::size_t k = 0; k < PhiOperator::kMaxPulse && i + k < signs.run_end(i); ++k) {
        held += signs[i] * end.product[i + k];
        EXPECT_LE(exact.pulse(i, k + 1) - held, tolerance) << i << ' ' << k;
      }
    }
    // The table of pulses is a matter of time only.
    const Climbed same = climb_from(again, model, kDuration_s, false);
    EXPECT_EQ(same.climb.energy(), end.climb.energy());
    EXPECT_EQ(again.view().first_difference(signs, 0), kCells);
  }
}

INSTANTIATE_TEST_SUITE_P(Criteria, ClimbOf,
                         testing::Values(Criterion::kIntegralSquareError,
                                         Criterion::kEnergyDifference));

}  // namespace
}  // namespace emax
