// Curvature terms against differences of the impulse response, and energies inside a box.
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "emax/base/units.hpp"
#include "emax/bound/box_curvature.hpp"
#include "emax/energy/switching_signal.hpp"

#include "support/paper_device.hpp"

namespace emax {
namespace {

constexpr double kDuration_s = 2e-3;
constexpr DeviceRange kRange = {4067.0, 4079.0, 0.3178, 0.3186};

ModalModel model_of(double f0_hz, double damping) {
  ModalModel model{};
  EXPECT_EQ(
      model.set({1.037, f0_hz, damping}, {10, 1000.0, 1.037}, Criterion::kIntegralSquareError),
      Status::kOk);
  return model;
}

/// The root of the integral over t of (integral of |second difference of k| up to t)^2.
template <typename Models>
double size_by_hand(const Models& models, double step) {
  const ModalModel below = models(-step);
  const ModalModel middle = models(0.0);
  const ModalModel above = models(step);
  constexpr int kPoints = 20000;
  const double h = kDuration_s / kPoints;
  double integral = 0.0;
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double t_s = (i + 0.5) * h;
    integral += h *
                std::fabs(below.impulse_response(t_s) - 2.0 * middle.impulse_response(t_s) +
                          above.impulse_response(t_s)) /
                (step * step);
    sum += h * integral * integral;
  }
  return std::sqrt(sum);
}

// The envelope is up to pi/2 times the integral of a decaying sine; for beta twice that.
TEST(BoxCurvature, TermsAreAboveDifferencesOfTheResponse) {
  const CurvatureTerms terms = curvature_terms(kRange, 1.037, kDuration_s, 1.0);
  const double by_frequency =
      size_by_hand([](double step) { return model_of(4073.0 + step, 0.3182); }, 4.0);
  const double by_damping =
      size_by_hand([](double step) { return model_of(4073.0, 0.3182 + step); }, 1e-3);
  EXPECT_GT(terms.frequency, 0.25 * 12.0 * 12.0 * by_frequency);
  EXPECT_LT(terms.frequency, 0.25 * 12.0 * 12.0 * by_frequency * 1.65);
  EXPECT_GT(terms.damping, 0.25 * 8e-4 * 8e-4 * by_damping);
  EXPECT_LT(terms.damping, 0.25 * 8e-4 * 8e-4 * by_damping * 2.1);
}

TEST(BoxCurvature, TermsGrowWithTheSquareOfTheWidth) {
  const CurvatureTerms narrow = curvature_terms(kRange, 1.0, kDuration_s, 1.0);
  const CurvatureTerms wide =
      curvature_terms({4061.0, 4085.0, 0.3174, 0.3190}, 1.0, kDuration_s, 1.0);
  EXPECT_NEAR(wide.frequency / narrow.frequency, 4.0, 0.05);
  EXPECT_NEAR(wide.damping / narrow.damping, 4.0, 0.05);
  const CurvatureTerms twice = curvature_terms(kRange, 1.0, kDuration_s, 2.0);
  EXPECT_NEAR(twice.damping / narrow.damping, 2.0, 1e-12);
  EXPECT_EQ(curvature_terms({4073.0, 4073.0, 0.3, 0.3}, 1.0, kDuration_s, 1.0).frequency, 0.0);
}

// A wide box, where it matters: no signal has more inside than its terms allow.
TEST(BoxCurvature, CoversEnergiesBetweenTheCorners) {
  const DeviceRange range = {3000.0, 5500.0, 0.2, 0.5};
  const CurvatureTerms terms = curvature_terms(range, 1.037, kDuration_s, 1.0);
  double largest_rise = 0.0;
  for (int count = 1; count < 40; count += 3) {
    std::vector<double> times_s;
    for (int i = 1; i <= count; ++i) {
      times_s.push_back(kDuration_s * i / (count + 1));
    }
    const Span<const double> switches_s(times_s.data(), times_s.size());
    const auto energy_at = [&](double f0_hz, double damping) {
      return energy(model_of(f0_hz, damping), switches_s, kDuration_s);
    };
    double corners = 0.0;
    double inside = 0.0;
    for (int i = 0; i <= 10; ++i) {
      for (int j = 0; j <= 10; ++j) {
        const double found = energy_at(3000.0 + 250.0 * i, 0.2 + 0.03 * j);
        const bool is_corner = i % 10 == 0 && j % 10 == 0;
        corners = is_corner ? std::fmax(corners, found) : corners;
        inside = std::fmax(inside, found);
      }
    }
    largest_rise = std::fmax(largest_rise, inside / corners - 1.0);
    EXPECT_LE(inside, box_bound(corners, terms.frequency + terms.damping, 0.0));
  }
  EXPECT_GT(largest_rise, 0.05);  // So corners alone are not enough.
}

TEST(BoxCurvature, BoundSolvesItsEquation) {
  for (const double more : {0.0, 0.3}) {
    const double bound = box_bound(2.0, 0.1, more);
    EXPECT_NEAR(bound, 2.0 + 0.1 * std::sqrt(bound + more), 1e-14);
  }
  EXPECT_NEAR(box_bound(2.0, 0.0, 0.3), 2.0, 1e-15);
}

TEST(BoxCurvature, FilterIntegralIsAboveTheSum) {
  // Of order 1 h is w e^(-w t), and its integral 1 - e^(-w T).
  const double of_first = filter_integral(butterworth({1, 1000.0, 0.7}), 1e-3);
  const double exact = 1.0 - std::exp(-2.0 * kPi);
  EXPECT_GT(of_first, exact);
  EXPECT_LT(of_first, 1.02 * exact);
  // Of order 2 h is w sqrt(2) e^(-c t) sin(c t), c = w/sqrt(2): the sum over half-waves is
  // coth(pi/2).
  const double of_second = filter_integral(butterworth({2, 1000.0, 3.0}), 20e-3);
  EXPECT_GT(of_second, 1.0 / std::tanh(0.5 * kPi));
  EXPECT_LT(of_second, 1.02 / std::tanh(0.5 * kPi));
}

}  // namespace
}  // namespace emax
