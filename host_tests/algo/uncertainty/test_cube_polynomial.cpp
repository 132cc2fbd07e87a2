// Polynomials of three variables through Chebyshev nodes: exact where the function is one.
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "emax/uncertainty/cube_polynomial.hpp"

namespace emax {
namespace {

template <typename Function>
std::vector<double> fitted(std::size_t degree, const std::array<bool, 3>& axes,
                           const Function& function) {
  const CubeNodes nodes(degree, axes);
  std::vector<double> coefficients(cube_terms(degree));
  const Span<double> span(coefficients.data(), coefficients.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes.add(i, function(nodes.point(i)), span);
  }
  to_powers(degree, span);
  return coefficients;
}

double value(std::size_t degree, const std::vector<double>& coefficients, const CubePoint& point) {
  return cube_value(degree, Span<const double>(coefficients.data(), coefficients.size()), point);
}

const CubePoint kPoints[] = {{0.0, 0.0, 0.0},  {1.0, 1.0, 1.0},   {-1.0, 1.0, -1.0},
                             {0.3, -0.7, 0.9}, {-0.9, 0.2, -0.4}, {0.5, 0.5, -1.0}};

TEST(CubePolynomial, HasTheTermsUpToItsDegree) {
  EXPECT_EQ(cube_terms(0), 1u);
  EXPECT_EQ(cube_terms(4), 35u);
  EXPECT_EQ(cube_terms(5), 56u);
  EXPECT_EQ(cube_terms(6), 84u);
}

TEST(CubePolynomial, IsAPolynomialOfItsDegreeItself) {
  for (std::size_t degree = 1; degree <= kMaxCubeDegree; ++degree) {
    const auto n = static_cast<double>(degree);
    // Terms of the highest degree on each axis and on all together, and lower ones.
    const auto function = [n](const CubePoint& p) {
      return 2.0 - p[1] + 3.0 * std::pow(p[0], n) - std::pow(p[1], n) + 0.5 * std::pow(p[2], n) +
             std::pow(p[0], n - 1.0) * p[2] - 2.0 * p[1] * std::pow(p[2], n - 1.0);
    };
    const std::vector<double> fit = fitted(degree, {true, true, true}, function);
    for (const CubePoint& point : kPoints) {
      // Rounding: coefficients of T_6 up to 48, a few hundred nodes.
      EXPECT_NEAR(value(degree, fit, point), function(point), 1e-13) << degree;
    }
  }
}

TEST(CubePolynomial, ErrorOfAnExponentialIsThatOfItsSeries) {
  const auto function = [](const CubePoint& p) { return std::exp(0.1 * (p[0] + p[1] - p[2])); };
  double last = 1.0;
  for (const std::size_t degree : {2u, 3u, 4u, 5u, 6u}) {
    const std::vector<double> fit = fitted(degree, {true, true, true}, function);
    double worst = 0.0;
    for (const CubePoint& point : kPoints) {
      worst = std::fmax(worst, std::fabs(value(degree, fit, point) - function(point)));
    }
    // The first term left out of the Taylor series at a corner, 0.3^(d+1)/(d+1)!, is an upper
    // bound up to the terms after it.
    const auto n = static_cast<double>(degree);
    EXPECT_LT(worst, 1.1 * std::pow(0.3, n + 1.0) / std::tgamma(n + 2.0)) << degree;
    EXPECT_LT(worst, 0.2 * last) << degree;
    last = worst;
  }
}

TEST(CubePolynomial, LeavesOutAnAxisThatChangesNothing) {
  const CubeNodes nodes(4, {false, true, true});
  EXPECT_EQ(nodes.size(), 25u);
  const auto function = [](const CubePoint& p) { return 1.0 + p[1] * p[2] * p[2]; };
  const std::vector<double> fit = fitted(4, {false, true, true}, function);
  EXPECT_NEAR(value(4, fit, {0.7, 0.5, -0.5}), 1.125, 1e-14);
}

TEST(CubePolynomial, SlopesAreThoseAtTheMiddle) {
  const auto function = [](const CubePoint& p) {
    return 5.0 + 2.0 * p[0] - 3.0 * p[1] + 0.25 * p[2] + p[0] * p[1] + p[2] * p[2] * p[2];
  };
  const std::vector<double> fit = fitted(4, {true, true, true}, function);
  const CubePoint slopes = cube_slopes(4, Span<const double>(fit.data(), fit.size()));
  EXPECT_NEAR(slopes[0], 2.0, 1e-13);
  EXPECT_NEAR(slopes[1], -3.0, 1e-13);
  EXPECT_NEAR(slopes[2], 0.25, 1e-13);
}

}  // namespace
}  // namespace emax
