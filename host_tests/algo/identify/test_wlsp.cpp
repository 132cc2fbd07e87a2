// The fit against synthetic devices, a second solution in 128-bit arithmetic, the paper's table,
// and chance.
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "emax/base/distributions.hpp"
#include "emax/identify/wlsp.hpp"

#include "support/table1.hpp"

namespace {

using emax::Accelerometer;
using emax::ComplexCovariance;
using emax::FrequencyResponse;
using emax::ResponsePoint;
using emax::Span;
using emax::Status;
using emax::WichmannHill;
using emax::Wlsp;
using emax::WlspDraws;
using emax::WlspDrawsResult;
using emax::WlspFit;
using emax::test::table1;

#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 Quad;
#else
using Quad = long double;
#endif

constexpr std::array<std::uint32_t, 4> kSeeds = {123456789, 345678901, 567890123, 789012345};
constexpr double kPi = 3.14159265358979323846;
constexpr Accelerometer kDevice = {1.037, 4073.0, 0.3182};

WichmannHill seeded() {
  WichmannHill generator;
  EXPECT_EQ(generator.seed(emax::Generator::k2006, kSeeds), Status::kOk);
  return generator;
}

// K from its definition, by complex arithmetic in long double.
ResponsePoint exact_point(const Accelerometer& device, double frequency_hz, double relative_u,
                          double u_phase_rad) {
  const auto ratio = static_cast<long double>(frequency_hz) /
                     static_cast<long double>(device.natural_frequency_hz);
  const std::complex<long double> k =
      static_cast<long double>(device.sensitivity) /
      std::complex<long double>(1.0L - ratio * ratio,
                                2.0L * static_cast<long double>(device.damping) * ratio);
  const auto amplitude = static_cast<double>(std::abs(k));
  return {frequency_hz, amplitude, static_cast<double>(std::arg(k)), relative_u * amplitude,
          u_phase_rad};
}

FrequencyResponse exact_response(const Accelerometer& device, std::size_t points,
                                 double first_hz = 100.0, double step_hz = 150.0) {
  FrequencyResponse response;
  for (std::size_t i = 0; i < points; ++i) {
    const double frequency_hz = first_hz + step_hz * static_cast<double>(i);
    EXPECT_EQ(response.add(
                  exact_point(device, frequency_hz, 0.005 + 1e-4 * static_cast<double>(i), 0.01)),
              Status::kOk);
  }
  return response;
}

FrequencyResponse transformed(const FrequencyResponse& response, double phase_sign,
                              double phase_shift_rad) {
  FrequencyResponse result;
  for (ResponsePoint p : response.points()) {
    p.phase_rad = phase_sign * p.phase_rad + phase_shift_rad;
    EXPECT_EQ(result.add(p), Status::kOk);
  }
  return result;
}

FrequencyResponse noisy(const FrequencyResponse& response, WichmannHill& generator) {
  FrequencyResponse result;
  for (ResponsePoint p : response.points()) {
    const double u1 = generator.next();
    const double u2 = generator.next();
    const emax::NormalPair z = emax::box_muller(u1, u2);
    p.amplitude += p.u_amplitude * z.first;
    p.phase_rad += p.u_phase_rad * z.second;
    EXPECT_EQ(result.add(p), Status::kOk);
  }
  return result;
}

// A second solution: unscaled normal equations in 113 bits, weights from the inverse of each C,
// Cramer's rule.
struct Reference {
  double parameters[3];
  double u[3];
  double chi2;
};

Reference normal_equations(const FrequencyResponse& response) {
  Quad n[3][3] = {};
  Quad g[3] = {};
  Quad yy = 0;
  for (const ResponsePoint& p : response.points()) {
    const Quad w = 2 * Quad(3.14159265358979323846264338327950288L) * Quad(p.frequency_hz);
    const Quad c = Quad(std::cos(static_cast<long double>(p.phase_rad)));
    const Quad s = Quad(std::sin(static_cast<long double>(p.phase_rad)));
    const Quad a = Quad(p.amplitude);
    const Quad y[2] = {c / a, -s / a};
    const Quad j[2][2] = {{-c / (a * a), -s / a}, {s / (a * a), -c / a}};
    const Quad v[2] = {Quad(p.u_amplitude) * Quad(p.u_amplitude),
                       Quad(p.u_phase_rad) * Quad(p.u_phase_rad)};
    Quad cov[2][2] = {};
    for (int i = 0; i < 2; ++i) {
      for (int k = 0; k < 2; ++k) {
        cov[i][k] = j[i][0] * v[0] * j[k][0] + j[i][1] * v[1] * j[k][1];
      }
    }
    const Quad det = cov[0][0] * cov[1][1] - cov[0][1] * cov[1][0];
    const Quad weight[2][2] = {{cov[1][1] / det, -cov[0][1] / det},
                               {-cov[1][0] / det, cov[0][0] / det}};
    const Quad row[2][3] = {{1, 0, -w * w}, {0, 2 * w, 0}};
    for (int q = 0; q < 2; ++q) {
      for (int r = 0; r < 2; ++r) {
        yy += y[q] * weight[q][r] * y[r];
        for (int i = 0; i < 3; ++i) {
          g[i] += row[q][i] * weight[q][r] * y[r];
          for (int k = 0; k < 3; ++k) {
            n[i][k] += row[q][i] * weight[q][r] * row[r][k];
          }
        }
      }
    }
  }
  Quad inverse[3][3] = {};
  Quad det = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const int i1 = (i + 1) % 3;
      const int i2 = (i + 2) % 3;
      const int k1 = (k + 1) % 3;
      const int k2 = (k + 2) % 3;
      inverse[k][i] = n[i1][k1] * n[i2][k2] - n[i1][k2] * n[i2][k1];
    }
    det += n[i][0] * inverse[0][i];
  }
  Quad mu[3] = {};
  Quad gm = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      inverse[i][k] /= det;
      mu[i] += inverse[i][k] * g[k];
    }
    gm += g[i] * mu[i];
  }
  const auto m1 = static_cast<double>(mu[0]);
  const auto m2 = static_cast<double>(mu[1]);
  const auto m3 = static_cast<double>(mu[2]);
  const double jacobian[3][3] = {
      {-1.0 / (m1 * m1), 0.0, 0.0},
      {1.0 / (4.0 * kPi * std::sqrt(m1 * m3)), 0.0, -std::sqrt(m1 / (m3 * m3 * m3)) / (4.0 * kPi)},
      {-m2 / (2.0 * std::pow(m1, 1.5) * std::sqrt(m3)), 1.0 / std::sqrt(m1 * m3),
       -m2 / (2.0 * std::sqrt(m1) * std::pow(m3, 1.5))}};
  Reference result = {{1.0 / m1, std::sqrt(m1 / m3) / (2.0 * kPi), m2 / std::sqrt(m1 * m3)},
                      {},
                      static_cast<double>(yy - gm)};
  for (int i = 0; i < 3; ++i) {
    Quad variance = 0;
    for (int k = 0; k < 3; ++k) {
      for (int l = 0; l < 3; ++l) {
        variance += Quad(jacobian[i][k]) * inverse[k][l] * Quad(jacobian[i][l]);
      }
    }
    result.u[i] = std::sqrt(static_cast<double>(variance));
  }
  return result;
}

void expect_same(const WlspFit& fit, const Reference& expected, double relative) {
  EXPECT_NEAR(fit.model.sensitivity / expected.parameters[0], 1.0, relative);
  EXPECT_NEAR(fit.model.natural_frequency_hz / expected.parameters[1], 1.0, relative);
  EXPECT_NEAR(fit.model.damping / expected.parameters[2], 1.0, relative);
  EXPECT_NEAR(fit.u_sensitivity / expected.u[0], 1.0, relative);
  EXPECT_NEAR(fit.u_natural_frequency_hz / expected.u[1], 1.0, relative);
  EXPECT_NEAR(fit.u_damping / expected.u[2], 1.0, relative);
  EXPECT_NEAR(fit.chi2 / expected.chi2, 1.0, relative);
}

TEST(Wlsp, NoiseFreePointsComeBack) {
  const Accelerometer devices[] = {kDevice,
                                   {1.0079, 4057.25, 0.24618},
                                   {1e-3, 25000.0, 0.01},
                                   {250.0, 900.0, 0.9},
                                   {0.5, 60.0, 0.6}};
  for (const Accelerometer& device : devices) {
    for (const std::size_t points : {3U, 10U, 64U}) {
      const double first_hz = device.natural_frequency_hz / 40.0;
      const double step_hz = 1.5 * device.natural_frequency_hz / static_cast<double>(points);
      const FrequencyResponse response = exact_response(device, points, first_hz, step_hz);
      Wlsp wlsp;
      ASSERT_EQ(wlsp.fit(response), Status::kOk);
      const WlspFit& fit = wlsp.result();
      EXPECT_NEAR(fit.model.sensitivity / device.sensitivity, 1.0, 1e-10);
      EXPECT_NEAR(fit.model.natural_frequency_hz / device.natural_frequency_hz, 1.0, 1e-10);
      EXPECT_NEAR(fit.model.damping / device.damping, 1.0, 1e-10);
      EXPECT_LT(fit.chi2, 1e-18);
      EXPECT_EQ(fit.dof, 2 * points - 3);
      const double w0 = 2.0 * kPi * device.natural_frequency_hz;
      EXPECT_NEAR(fit.mu[0] * device.sensitivity, 1.0, 1e-10);
      EXPECT_NEAR(fit.mu[1] * device.sensitivity * w0 / device.damping, 1.0, 1e-10);
      EXPECT_NEAR(fit.mu[2] * device.sensitivity * w0 * w0, 1.0, 1e-10);
    }
  }
}

TEST(Wlsp, Table1) {
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(table1()), Status::kOk);
  const WlspFit& fit = wlsp.result();
  emax::test::expect_fit_of_table1(fit);
  EXPECT_NEAR(fit.birge_ratio, std::sqrt(8595.0 / 81.0), 1e-3);
  EXPECT_NEAR(wlsp.chi_square_of(kDevice), 14975.0, 0.5);
  EXPECT_NEAR(wlsp.chi_square_of(fit.model) / fit.chi2, 1.0, 1e-12);
}

TEST(Wlsp, SecondSolution) {
  // Sines in 64 bits and a Jacobian in 53 limit the reference to about 1e-15, the condition to a
  // few digits more.
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(table1()), Status::kOk);
  expect_same(wlsp.result(), normal_equations(table1()), 1e-11);
  WichmannHill generator = seeded();
  for (const std::size_t points : {3U, 12U, 64U}) {
    const FrequencyResponse response = noisy(exact_response(kDevice, points), generator);
    ASSERT_EQ(wlsp.fit(response), Status::kOk);
    expect_same(wlsp.result(), normal_equations(response), 1e-10);
  }
}

TEST(Wlsp, ChiSquareIsLeastAtTheFit) {
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(table1()), Status::kOk);
  const WlspFit& fit = wlsp.result();
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      // One standard uncertainty of one parameter, the others fixed, adds 1/(1 - R^2) to
      // chi-square: 1 or more.
      Accelerometer model = fit.model;
      model.sensitivity += i == 0 ? sign * fit.u_sensitivity : 0.0;
      model.natural_frequency_hz += i == 1 ? sign * fit.u_natural_frequency_hz : 0.0;
      model.damping += i == 2 ? sign * fit.u_damping : 0.0;
      EXPECT_GT(wlsp.chi_square_of(model), fit.chi2 + 0.99);
    }
  }
}

TEST(Wlsp, ResidualsAddUpToChiSquare) {
  Wlsp wlsp;
  const FrequencyResponse response = table1();
  ASSERT_EQ(wlsp.fit(response), Status::kOk);
  double sum = 0.0;
  for (std::size_t i = 0; i < wlsp.response().size(); ++i) {
    const emax::Complex residual = wlsp.normalised_residual(i);
    sum += residual.re * residual.re + residual.im * residual.im;
    // The length of the whitened residual does not depend on which root of C whitens: in polar form
    // it is the change of amplitude and phase over their uncertainties, to first order, so nearly
    // that of the exact solution of J.
    const ResponsePoint& p = response.points()[i];
    const Accelerometer& m = wlsp.result().model;
    const double ratio = p.frequency_hz / m.natural_frequency_hz;
    const std::complex<double> model =
        std::complex<double>(1.0 - ratio * ratio, 2.0 * m.damping * ratio) / m.sensitivity;
    const std::complex<double> difference = std::polar(1.0 / p.amplitude, -p.phase_rad) - model;
    const std::complex<double> turned = difference * std::polar(p.amplitude, p.phase_rad);
    const double expected = std::pow(turned.real() * p.amplitude / p.u_amplitude, 2) +
                            std::pow(turned.imag() / p.u_phase_rad, 2);
    EXPECT_NEAR((residual.re * residual.re + residual.im * residual.im) / expected, 1.0, 1e-9);
  }
  EXPECT_NEAR(sum / wlsp.result().chi2, 1.0, 1e-13);
}

TEST(Wlsp, CovariancesFromDraws) {
  // Each drawn covariance is off by sqrt(2/n) = 0.7 % (one standard deviation) and by the
  // curvature. The estimate moves by less than a few per cent of its u, since the weights are off
  // that much point by point; u by less than 1 %.
  WichmannHill generator = seeded();
  const FrequencyResponse response = noisy(exact_response(kDevice, 42), generator);
  std::vector<ComplexCovariance> covariances;
  for (const ResponsePoint& point : response.points()) {
    const emax::DrawnCovariance drawn = emax::inverse_covariance_by_draws(point, 40000, generator);
    ASSERT_EQ(drawn.status, Status::kOk);
    covariances.push_back(drawn.covariance);
  }
  Wlsp by_formula;
  Wlsp by_draws;
  ASSERT_EQ(by_formula.fit(response), Status::kOk);
  ASSERT_EQ(by_draws.fit(response, {covariances.data(), covariances.size()}), Status::kOk);
  const WlspFit& a = by_formula.result();
  const WlspFit& b = by_draws.result();
  EXPECT_NEAR(a.model.sensitivity, b.model.sensitivity, 0.05 * a.u_sensitivity);
  EXPECT_NEAR(a.model.natural_frequency_hz, b.model.natural_frequency_hz,
              0.05 * a.u_natural_frequency_hz);
  EXPECT_NEAR(a.model.damping, b.model.damping, 0.05 * a.u_damping);
  EXPECT_NEAR(b.u_sensitivity / a.u_sensitivity, 1.0, 0.01);
  EXPECT_NEAR(b.u_natural_frequency_hz / a.u_natural_frequency_hz, 1.0, 0.01);
  EXPECT_NEAR(b.u_damping / a.u_damping, 1.0, 0.01);
  EXPECT_NE(a.chi2, b.chi2);
  // 84 squares, each off by some 1 %, add up to chi-square off by less than 1 %.
  EXPECT_NEAR(b.chi2 / a.chi2, 1.0, 0.01);
}

TEST(Wlsp, GivenCovariancesEqualToTheFormulaGiveTheSameFit) {
  const FrequencyResponse response = table1();
  std::vector<ComplexCovariance> covariances;
  for (const ResponsePoint& point : response.points()) {
    covariances.push_back(emax::inverse_covariance(point));
  }
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(response, {covariances.data(), covariances.size()}), Status::kOk);
  expect_same(wlsp.result(), normal_equations(response), 1e-10);
}

TEST(Wlsp, CoverageOnNoisySets) {
  constexpr int kSets = 500;
  const FrequencyResponse exact = exact_response(kDevice, 42);
  WichmannHill generator = seeded();
  int inside[3] = {};
  double chi2 = 0.0;
  Wlsp wlsp;
  for (int set = 0; set < kSets; ++set) {
    ASSERT_EQ(wlsp.fit(noisy(exact, generator)), Status::kOk);
    const WlspFit& fit = wlsp.result();
    inside[0] += std::fabs(fit.model.sensitivity - kDevice.sensitivity) < 1.96 * fit.u_sensitivity;
    inside[1] += std::fabs(fit.model.natural_frequency_hz - kDevice.natural_frequency_hz) <
                 1.96 * fit.u_natural_frequency_hz;
    inside[2] += std::fabs(fit.model.damping - kDevice.damping) < 1.96 * fit.u_damping;
    chi2 += fit.chi2;
  }
  // Binomial(500, 0.95): 475, standard deviation 4.9; four of them either way.
  for (const int count : inside) {
    EXPECT_GE(count, 455);
    EXPECT_LE(count, 495);
  }
  // Chi-square with 81 degrees of freedom has variance 162; four standard deviations of the mean of
  // 500, and 1 % for the curvature of 1/A.
  EXPECT_NEAR(chi2 / kSets, 81.0, 4.0 * std::sqrt(162.0 / kSets) + 0.81);
}

TEST(Wlsp, TooFewPoints) {
  Wlsp wlsp;
  EXPECT_EQ(wlsp.response().size(), 0U);
  ASSERT_EQ(wlsp.fit(exact_response(kDevice, 3)), Status::kOk);
  EXPECT_EQ(wlsp.fit(exact_response(kDevice, 2)), Status::kTooFewPoints);
  EXPECT_EQ(wlsp.result().status, Status::kTooFewPoints);
  EXPECT_EQ(wlsp.result().model.sensitivity, 0.0);
  EXPECT_EQ(wlsp.response().size(), 0U);
  EXPECT_EQ(wlsp.fit(FrequencyResponse(), {}), Status::kTooFewPoints);
}

TEST(Wlsp, NotIdentifiable) {
  // Three neighbours among the doubles: 1 and w^2 cannot be told apart.
  const double f1 = 1000.0;
  const double f2 = std::nextafter(f1, 2000.0);
  const double f3 = std::nextafter(f2, 2000.0);
  FrequencyResponse response;
  for (const double frequency_hz : {f1, f2, f3}) {
    ASSERT_EQ(response.add(exact_point(kDevice, frequency_hz, 0.01, 0.01)), Status::kOk);
  }
  Wlsp wlsp;
  EXPECT_EQ(wlsp.fit(response), Status::kNotIdentifiable);
  EXPECT_EQ(wlsp.result().model.sensitivity, 0.0);
  EXPECT_EQ(wlsp.result().chi2, 0.0);
}

TEST(Wlsp, NumbersOutOfTheRangeOfDouble) {
  for (const double scale : {1e-300, 1e-160, 1e160, 1e300}) {
    FrequencyResponse response;
    for (const double frequency_hz : {100.0, 2000.0, 4000.0, 6000.0}) {
      ResponsePoint point = exact_point(kDevice, frequency_hz, 0.01, 0.01);
      point.amplitude *= scale;
      point.u_amplitude *= scale;
      ASSERT_EQ(response.add(point), Status::kOk);
    }
    Wlsp wlsp;
    EXPECT_EQ(wlsp.fit(response), Status::kNotIdentifiable) << scale;
    EXPECT_EQ(wlsp.result().u_sensitivity, 0.0);
  }
}

TEST(Wlsp, InvertedPolarity) {
  // Half a turn: K becomes -K.
  const FrequencyResponse response = transformed(exact_response(kDevice, 20), 1.0, kPi);
  Wlsp wlsp;
  EXPECT_EQ(wlsp.fit(response), Status::kInvertedPolarity);
  EXPECT_EQ(wlsp.result().status, Status::kInvertedPolarity);
  EXPECT_NEAR(wlsp.result().model.sensitivity, -kDevice.sensitivity, 1e-10);
  EXPECT_NEAR(wlsp.result().model.natural_frequency_hz, kDevice.natural_frequency_hz, 1e-6);
  EXPECT_NEAR(wlsp.result().model.damping, kDevice.damping, 1e-10);
  EXPECT_GT(wlsp.result().u_damping, 0.0);
  Wlsp upright;
  ASSERT_EQ(upright.fit(exact_response(kDevice, 20)), Status::kOk);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      // Covariances with the sensitivity change sign with it.
      const double sign = (i == 0) != (j == 0) ? -1.0 : 1.0;
      const double expected = upright.result().covariance[i][j];
      EXPECT_NEAR(wlsp.result().covariance[i][j], sign * expected, 1e-9 * std::fabs(expected));
    }
  }
}

TEST(Wlsp, NotPhysicalDamping) {
  // A phase that leads: the sign of the imaginary part, and so of mu2.
  Wlsp wlsp;
  EXPECT_EQ(wlsp.fit(transformed(exact_response(kDevice, 20), -1.0, 0.0)), Status::kNotPhysical);
  EXPECT_NEAR(wlsp.result().model.damping, -kDevice.damping, 1e-10);
  EXPECT_NEAR(wlsp.result().model.sensitivity, kDevice.sensitivity, 1e-10);
  EXPECT_EQ(wlsp.fit(transformed(exact_response(kDevice, 20), -1.0, kPi)), Status::kNotPhysical);
}

TEST(Wlsp, NotPhysicalMu) {
  // 1/K that grows with w^2 in phase: mu3 < 0.
  FrequencyResponse response;
  for (const double frequency_hz : {100.0, 200.0, 300.0, 400.0}) {
    const double amplitude = 1.0 / (1.0 + 1e-6 * frequency_hz * frequency_hz);
    ASSERT_EQ(response.add({frequency_hz, amplitude, 0.0, 1e-3, 1e-3}), Status::kOk);
  }
  Wlsp wlsp;
  EXPECT_EQ(wlsp.fit(response), Status::kNotPhysical);
  EXPECT_NEAR(wlsp.result().mu[0], 1.0, 1e-10);
  EXPECT_NEAR(wlsp.result().mu[2] * 4.0 * kPi * kPi, -1e-6, 1e-14);
  EXPECT_EQ(wlsp.result().model.sensitivity, 0.0);
  EXPECT_EQ(wlsp.result().dof, 5U);
}

TEST(Wlsp, Overdamped) {
  const Accelerometer device = {2.0, 500.0, 1.5};
  Wlsp wlsp;
  EXPECT_EQ(wlsp.fit(exact_response(device, 20)), Status::kOverdamped);
  EXPECT_NEAR(wlsp.result().model.damping, 1.5, 1e-9);
  EXPECT_NEAR(wlsp.result().model.natural_frequency_hz, 500.0, 1e-6);
  EXPECT_GT(wlsp.result().u_damping, 0.0);
}

TEST(Wlsp, BadCovariances) {
  const FrequencyResponse response = exact_response(kDevice, 3);
  const ComplexCovariance good = {1e-4, 0.0, 1e-4};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  Wlsp wlsp;
  const ComplexCovariance two[] = {good, good};
  EXPECT_EQ(wlsp.fit(response, two), Status::kInvalidArgument);
  const ComplexCovariance four[] = {good, good, good, good};
  EXPECT_EQ(wlsp.fit(response, four), Status::kInvalidArgument);
  for (const ComplexCovariance bad :
       {ComplexCovariance{0.0, 0.0, 1e-4}, ComplexCovariance{1e-4, 2e-4, 1e-4},
        ComplexCovariance{-1e-4, 0.0, 1e-4}, ComplexCovariance{1e-4, 0.0, nan},
        ComplexCovariance{infinity, 0.0, 1e-4}}) {
    const ComplexCovariance three[] = {good, bad, good};
    EXPECT_EQ(wlsp.fit(response, three), Status::kInvalidArgument);
    EXPECT_EQ(wlsp.result().status, Status::kInvalidArgument);
  }
  const ComplexCovariance three[] = {good, good, good};
  EXPECT_EQ(wlsp.fit(response, three), Status::kOk);
}

// A part that is common to all points, as one vector.

std::vector<double> rising_common(std::size_t points) {
  std::vector<double> u;
  for (std::size_t i = 0; i < points; ++i) {
    u.push_back(0.002 + 0.0002 * static_cast<double>(i % 40));
  }
  return u;
}

// The third solution: the full covariance matrix over all real and imaginary parts, its Cholesky
// factor, and generalised least squares with it, in long double.
Reference full_matrix(const FrequencyResponse& response, Span<const double> common) {
  using Real = long double;
  Wlsp first;
  FrequencyResponse without = response;
  EXPECT_EQ(without.set_common(0.0), Status::kOk);
  EXPECT_EQ(first.fit(without), Status::kOk);
  const double(&mu)[3] = first.result().mu;
  const std::size_t n = 2 * response.size();
  std::vector<std::vector<Real>> v(n, std::vector<Real>(n, 0.0L));
  std::vector<std::array<Real, 4>> rows(n);  // Columns of the model, scaled, and the values.
  std::vector<Real> c(n);
  const Real w_max = 2.0L * static_cast<Real>(kPi) *
                     static_cast<Real>(response.points()[response.size() - 1].frequency_hz);
  for (std::size_t i = 0; i < response.size(); ++i) {
    const ResponsePoint& p = response.points()[i];
    const Real w = 2.0L * static_cast<Real>(kPi) * static_cast<Real>(p.frequency_hz) / w_max;
    const Real a = p.amplitude;
    const Real cosine = std::cos(static_cast<Real>(p.phase_rad));
    const Real sine = std::sin(static_cast<Real>(p.phase_rad));
    const Real j[2][2] = {{-cosine / (a * a), -sine / a}, {sine / (a * a), -cosine / a}};
    const Real u[2] = {p.u_amplitude, p.u_phase_rad};
    for (std::size_t q = 0; q < 2; ++q) {
      for (std::size_t r = 0; r < 2; ++r) {
        for (std::size_t k = 0; k < 2; ++k) {
          v[2 * i + q][2 * i + r] += j[q][k] * u[k] * u[k] * j[r][k];
        }
      }
    }
    rows[2 * i] = {1.0L, 0.0L, -w * w, cosine / a};
    rows[2 * i + 1] = {0.0L, 2.0L * w, 0.0L, -sine / a};
    const Real scaled[3] = {mu[0], mu[1] * w_max, mu[2] * w_max * w_max};
    for (std::size_t q = 0; q < 2; ++q) {
      Real modelled = 0.0L;
      for (std::size_t k = 0; k < 3; ++k) {
        modelled += rows[2 * i + q][k] * scaled[k];
      }
      c[2 * i + q] = -static_cast<Real>(common[i]) * modelled;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      v[i][k] += c[i] * c[k];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {  // v becomes its factor; rows are whitened on the way.
    for (std::size_t k = 0; k <= i; ++k) {
      Real sum = v[i][k];
      for (std::size_t q = 0; q < k; ++q) {
        sum -= v[i][q] * v[k][q];
      }
      v[i][k] = i == k ? std::sqrt(sum) : sum / v[k][k];
    }
    for (std::size_t column = 0; column < 4; ++column) {
      for (std::size_t q = 0; q < i; ++q) {
        rows[i][column] -= v[i][q] * rows[q][column];
      }
      rows[i][column] /= v[i][i];
    }
  }
  Real normal[3][4] = {};
  Real yy = 0.0L;
  for (const auto& row : rows) {
    yy += row[3] * row[3];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        normal[i][k] += row[i] * row[k];
      }
    }
  }
  Real inverse[3][3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      inverse[k][i] = normal[(i + 1) % 3][(k + 1) % 3] * normal[(i + 2) % 3][(k + 2) % 3] -
                      normal[(i + 1) % 3][(k + 2) % 3] * normal[(i + 2) % 3][(k + 1) % 3];
    }
  }
  const Real determinant =
      normal[0][0] * inverse[0][0] + normal[0][1] * inverse[1][0] + normal[0][2] * inverse[2][0];
  Real x[3] = {};
  Real explained = 0.0L;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      inverse[i][k] /= determinant;
      x[i] += inverse[i][k] * normal[k][3];
    }
    explained += x[i] * normal[i][3];
  }
  const Real f = w_max / (2.0L * static_cast<Real>(kPi));
  const Real root = std::sqrt(x[0] * x[2]);
  const Real f0 = f * std::sqrt(x[0] / x[2]);
  const Real beta = x[1] / root;
  const Real jacobian[3][3] = {{-1.0L / (x[0] * x[0]), 0.0L, 0.0L},
                               {0.5L * f0 / x[0], 0.0L, -0.5L * f0 / x[2]},
                               {-0.5L * beta / x[0], 1.0L / root, -0.5L * beta / x[2]}};
  Reference result = {
      {static_cast<double>(1.0L / x[0]), static_cast<double>(f0), static_cast<double>(beta)},
      {},
      static_cast<double>(yy - explained)};
  for (std::size_t i = 0; i < 3; ++i) {
    Real variance = 0.0L;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t l = 0; l < 3; ++l) {
        variance += jacobian[i][k] * inverse[k][l] * jacobian[i][l];
      }
    }
    result.u[i] = static_cast<double>(std::sqrt(variance));
  }
  return result;
}

TEST(WlspCommon, OneValueForAllOnlyWidensTheSensitivity) {
  constexpr double kCommon = 0.0025;
  FrequencyResponse response = table1();
  Wlsp without;
  Wlsp with;
  ASSERT_EQ(without.fit(response), Status::kOk);
  ASSERT_EQ(response.set_common(kCommon), Status::kOk);
  ASSERT_EQ(with.fit(response), Status::kOk);
  const WlspFit& a = without.result();
  const WlspFit& b = with.result();
  // Rounding of two reductions whose condition is about 1e3.
  EXPECT_NEAR(b.model.sensitivity / a.model.sensitivity, 1.0, 1e-12);
  EXPECT_NEAR(b.model.natural_frequency_hz / a.model.natural_frequency_hz, 1.0, 1e-12);
  EXPECT_NEAR(b.model.damping / a.model.damping, 1.0, 1e-12);
  EXPECT_NEAR(b.chi2 / a.chi2, 1.0, 1e-12);
  EXPECT_NEAR(b.common_effect, 0.0, 1e-10);
  EXPECT_EQ(b.dof, a.dof);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double gained = i == 0 && j == 0 ? std::pow(kCommon * a.model.sensitivity, 2) : 0.0;
      const double scale = std::sqrt(b.covariance[i][i] * b.covariance[j][j]);
      EXPECT_NEAR(b.covariance[i][j], a.covariance[i][j] + gained, 1e-11 * scale) << i << j;
    }
  }
}

TEST(WlspCommon, SameAsTheFullMatrix) {
  WichmannHill generator = seeded();
  const FrequencyResponse sets[] = {table1(), noisy(exact_response(kDevice, 12), generator),
                                    noisy(exact_response(kDevice, 64), generator)};
  for (FrequencyResponse response : sets) {
    const std::vector<double> rising = rising_common(response.size());
    const std::vector<double> equal(response.size(), 0.003);
    std::vector<double> some = rising;
    some[1] = some[response.size() - 1] = 0.0;
    for (const std::vector<double>& common : {rising, equal, some}) {
      const Span<const double> view(common.data(), common.size());
      ASSERT_EQ(response.set_common(view), Status::kOk);
      Wlsp wlsp;
      ASSERT_EQ(wlsp.fit(response), Status::kOk);
      // The vector along the model comes from a fit in double: 1e-12 and its condition.
      expect_same(wlsp.result(), full_matrix(response, view), 1e-9);
    }
  }
}

TEST(WlspCommon, Table1WithTheReferenceTakenOut) {
  // U_ref = 0.5 % (k = 2), the table's columns being totals; numbers from outside this code, to
  // half a unit of their last digit.
  const FrequencyResponse table = table1();
  FrequencyResponse response;
  for (ResponsePoint p : table.points()) {
    p.u_amplitude = std::sqrt(std::pow(p.u_amplitude, 2) - std::pow(0.0025 * p.amplitude, 2));
    ASSERT_EQ(response.add(p), Status::kOk);
  }
  ASSERT_EQ(response.set_common(0.0025), Status::kOk);
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(response), Status::kOk);
  EXPECT_NEAR(wlsp.result().model.sensitivity, 1.00645, 0.5e-5);
  EXPECT_NEAR(wlsp.result().u_sensitivity, 0.00270, 0.5e-5);
  EXPECT_NEAR(wlsp.result().chi2, 8911.7, 0.05);
}

TEST(WlspCommon, ResidualsAndTheEffectAddUpToChiSquare) {
  FrequencyResponse response = table1();
  const std::vector<double> common = rising_common(response.size());
  ASSERT_EQ(response.set_common({common.data(), common.size()}), Status::kOk);
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(response), Status::kOk);
  const WlspFit& fit = wlsp.result();
  double sum = fit.common_effect * fit.common_effect;
  for (std::size_t i = 0; i < response.size(); ++i) {
    sum += norm(wlsp.normalised_residual(i));
  }
  EXPECT_NEAR(sum / fit.chi2, 1.0, 1e-13);
  EXPECT_GT(std::fabs(fit.common_effect), 0.01);
  EXPECT_NEAR(wlsp.chi_square_of(fit.model) / fit.chi2, 1.0, 1e-12);
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      // One standard uncertainty of one parameter, the others fixed, adds 1 or more, but for the
      // curvature of 1/S.
      Accelerometer model = fit.model;
      model.sensitivity += i == 0 ? sign * fit.u_sensitivity : 0.0;
      model.natural_frequency_hz += i == 1 ? sign * fit.u_natural_frequency_hz : 0.0;
      model.damping += i == 2 ? sign * fit.u_damping : 0.0;
      EXPECT_GT(wlsp.chi_square_of(model), fit.chi2 + 0.98);
    }
  }
}

TEST(WlspCommon, ManyPointsDoNotAverageItAway) {
  // All amplitudes move together in each set: the interval of S must know.
  constexpr int kSets = 500;
  constexpr double kCommon = 0.01;
  const FrequencyResponse exact = exact_response(kDevice, 42);
  WichmannHill generator = seeded();
  int inside = 0;
  int inside_without = 0;
  Wlsp wlsp;
  for (int set = 0; set < kSets; ++set) {
    const double u1 = generator.next();
    const double u2 = generator.next();
    const double factor = 1.0 + kCommon * emax::box_muller(u1, u2).first;
    const FrequencyResponse scattered = noisy(exact, generator);
    FrequencyResponse response;
    for (ResponsePoint p : scattered.points()) {
      p.amplitude *= factor;
      ASSERT_EQ(response.add(p), Status::kOk);
    }
    ASSERT_EQ(wlsp.fit(response), Status::kOk);
    inside_without += std::fabs(wlsp.result().model.sensitivity - kDevice.sensitivity) <
                      1.96 * wlsp.result().u_sensitivity;
    ASSERT_EQ(response.set_common(kCommon), Status::kOk);
    ASSERT_EQ(wlsp.fit(response), Status::kOk);
    inside += std::fabs(wlsp.result().model.sensitivity - kDevice.sensitivity) <
              1.96 * wlsp.result().u_sensitivity;
  }
  // Binomial(500, 0.95): 475, standard deviation 4.9; four of them either way.
  EXPECT_GE(inside, 455);
  EXPECT_LE(inside, 495);
  EXPECT_LT(inside_without, 300);
}

TEST(WlspCommon, DrawsMoveTogether) {
  constexpr std::uint32_t kDraws = 20000;
  FrequencyResponse response = exact_response(kDevice, 20);
  const std::vector<double> common = rising_common(response.size());
  ASSERT_EQ(response.set_common({common.data(), common.size()}), Status::kOk);
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(response), Status::kOk);
  WlspDraws draws;
  ASSERT_EQ(draws.start(wlsp, kDraws, seeded()), Status::kOk);
  draws.step(wlsp, kDraws);
  const WlspDrawsResult result = draws.result();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double scale =
          std::sqrt(wlsp.result().covariance[i][i] * wlsp.result().covariance[j][j]);
      // Four standard deviations of a covariance from so many draws, and the curvature.
      EXPECT_NEAR(result.covariance[i][j], wlsp.result().covariance[i][j],
                  (4.0 * std::sqrt(2.0 / kDraws) + 0.01) * scale)
          << i << j;
    }
  }
}

void run(WlspDraws& draws, const Wlsp& wlsp, std::uint32_t slice) {
  while (!draws.done()) {
    draws.step(wlsp, slice);
  }
}

TEST(WlspDraws, EachDrawIsARefitWithTheWeightsKept) {
  constexpr std::uint32_t kDraws = 200;
  const FrequencyResponse response = table1();
  std::vector<ComplexCovariance> covariances;
  for (const ResponsePoint& point : response.points()) {
    covariances.push_back(emax::inverse_covariance(point));
  }
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(response), Status::kOk);
  WlspDraws draws;
  ASSERT_EQ(draws.start(wlsp, kDraws, seeded()), Status::kOk);
  run(draws, wlsp, 7);

  WichmannHill generator = seeded();
  std::vector<std::array<double, 3>> fits;
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    Wlsp refit;
    ASSERT_EQ(refit.fit(noisy(response, generator), {covariances.data(), covariances.size()}),
              Status::kOk);
    const Accelerometer& m = refit.result().model;
    fits.push_back({m.sensitivity, m.natural_frequency_hz, m.damping});
  }
  const WlspDrawsResult result = draws.result();
  EXPECT_EQ(result.draws, kDraws);
  EXPECT_EQ(result.discarded, 0U);
  double mean[3] = {};
  for (const auto& fit : fits) {
    for (std::size_t i = 0; i < 3; ++i) {
      mean[i] += fit[i] / kDraws;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(result.mean[i] / mean[i], 1.0, 1e-11);
    for (std::size_t j = 0; j < 3; ++j) {
      double covariance = 0.0;
      for (const auto& fit : fits) {
        covariance += (fit[i] - mean[i]) * (fit[j] - mean[j]) / (kDraws - 1);
      }
      const double size = std::sqrt(result.covariance[i][i] * result.covariance[j][j]);
      EXPECT_NEAR(result.covariance[i][j], covariance, 1e-8 * size);
    }
  }
}

TEST(WlspDraws, AgreeWithTheFormula) {
  constexpr std::uint32_t kDraws = 40000;
  WichmannHill generator = seeded();
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(noisy(exact_response(kDevice, 42), generator)), Status::kOk);
  const WlspFit before = wlsp.result();
  WichmannHill far = seeded();
  far.jump(std::uint64_t{1} << 60U);
  WlspDraws draws;
  ASSERT_EQ(draws.start(wlsp, kDraws, far), Status::kOk);
  run(draws, wlsp, 1000);
  const WlspDrawsResult result = draws.result();
  ASSERT_EQ(result.draws, kDraws);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      // A drawn covariance scatters by sqrt((c11 c22 + c12^2)/n), at most sqrt(2/n) of the size;
      // four of them, and 0.5 % for the curvature.
      const double size = std::sqrt(before.covariance[i][i] * before.covariance[j][j]);
      EXPECT_NEAR(result.covariance[i][j], before.covariance[i][j],
                  (4.0 * std::sqrt(2.0 / kDraws) + 0.005) * size);
    }
  }
  // The draws' mean is shown; the estimates are untouched by it.
  EXPECT_NE(result.mean[0], before.model.sensitivity);
  EXPECT_NEAR(result.mean[0], before.model.sensitivity, 0.2 * before.u_sensitivity);
  EXPECT_EQ(wlsp.result().model.sensitivity, before.model.sensitivity);
  EXPECT_EQ(wlsp.result().model.natural_frequency_hz, before.model.natural_frequency_hz);
  EXPECT_EQ(wlsp.result().model.damping, before.model.damping);
}

TEST(WlspDraws, SlicesDoNotMatter) {
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(table1()), Status::kOk);
  WlspDraws whole;
  WlspDraws sliced;
  ASSERT_EQ(whole.start(wlsp, 100, seeded()), Status::kOk);
  ASSERT_EQ(sliced.start(wlsp, 100, seeded()), Status::kOk);
  whole.step(wlsp, 0xffffffffU);
  EXPECT_TRUE(whole.done());
  sliced.step(wlsp, 0);
  EXPECT_EQ(sliced.made(), 0U);
  EXPECT_EQ(sliced.result().draws, 0U);
  sliced.step(wlsp, 1);
  EXPECT_EQ(sliced.made(), 1U);
  EXPECT_EQ(sliced.result().covariance[0][0], 0.0);
  run(sliced, wlsp, 33);
  sliced.step(wlsp, 5);
  EXPECT_EQ(sliced.made(), 100U);
  EXPECT_EQ(whole.result().covariance[1][2], sliced.result().covariance[1][2]);
  EXPECT_EQ(whole.result().mean[1], sliced.result().mean[1]);
}

TEST(WlspDraws, ImpossibleDrawsAreCounted) {
  FrequencyResponse response;
  const FrequencyResponse exact = exact_response(kDevice, 20);
  for (ResponsePoint point : exact.points()) {
    point.u_amplitude = 0.5 * point.amplitude;  // 1 draw in 44 of a point is below zero.
    ASSERT_EQ(response.add(point), Status::kOk);
  }
  Wlsp wlsp;
  ASSERT_EQ(wlsp.fit(response), Status::kOk);
  WlspDraws draws;
  ASSERT_EQ(draws.start(wlsp, 1000, seeded()), Status::kOk);
  run(draws, wlsp, 1000);
  EXPECT_EQ(draws.made(), 1000U);
  EXPECT_EQ(draws.result().draws + draws.result().discarded, 1000U);
  // (1 - 0.02275)^20 = 0.63 of the draws have all amplitudes above zero.
  EXPECT_GT(draws.result().discarded, 300U);
  EXPECT_GT(draws.result().draws, 100U);
}

TEST(WlspDraws, StartRefuses) {
  Wlsp wlsp;
  WlspDraws draws;
  EXPECT_TRUE(draws.done());
  EXPECT_EQ(draws.start(wlsp, 100, seeded()), Status::kTooFewPoints);
  EXPECT_EQ(wlsp.fit(exact_response({2.0, 500.0, 1.5}, 20)), Status::kOverdamped);
  EXPECT_EQ(draws.start(wlsp, 100, seeded()), Status::kOverdamped);
  ASSERT_EQ(wlsp.fit(table1()), Status::kOk);
  EXPECT_EQ(draws.start(wlsp, 1, seeded()), Status::kInvalidArgument);
  EXPECT_EQ(draws.result().draws, 0U);
  EXPECT_TRUE(draws.done());
}

// What one shared effect does to exact points: K times `factor`, or its inverse plus `inverse`.
struct SharedCase {
  const char* name;
  emax::SharedEffects shared;
  std::complex<double> (*changed)(std::complex<double> k, double frequency_hz, double place);
};

constexpr double kEffect = 1e-5;

// The changes of the estimates by a second fit of changed points, not by the formula.
TEST(Wlsp, SharedEffectsAreCarriedToTheParameters) {
  using Value = std::complex<double>;
  const SharedCase cases[] = {
      {"skew",
       {kEffect * 1e-3, 0, 0, 0, 0, 0, 0, 0},
       [](Value k, double f, double) {
         return k * std::polar(1.0, 2.0 * kPi * f * kEffect * 1e-3);
       }},
      {"drift",
       {0, 0, kEffect, 0, 0, 0, 0, 0},
       [](Value k, double, double place) { return k * (1.0 + kEffect * (place - 0.5)); }},
      {"images",
       {0, 0, 0, 0, kEffect, 0, 0, 0},
       [](Value k, double f, double) { return k * (1.0 + kEffect * f * f / 36e6); }},
      {"leak", {0, 0, 0, 0, 0, kEffect, 0, 0}, [](Value k, double, double) { return k + kEffect; }},
      {"leak back",
       {0, 0, 0, 0, 0, 0, kEffect, 0},
       [](Value k, double, double) { return 1.0 / (1.0 / k + kEffect); }},
  };
  for (const SharedCase& one : cases) {
    SCOPED_TRACE(one.name);
    FrequencyResponse plain;
    FrequencyResponse changed;
    constexpr int kPoints = 30;
    for (int i = 0; i < kPoints; ++i) {
      const double frequency_hz = 200.0 * (i + 1);
      ResponsePoint point = exact_point(kDevice, frequency_hz, 1e-4, 1e-4);
      ASSERT_EQ(plain.add(point), Status::kOk);
      const Value k = one.changed(std::polar(point.amplitude, point.phase_rad), frequency_hz,
                                  (i + 0.5) / kPoints);
      point.amplitude = std::abs(k);
      point.phase_rad = std::arg(k);
      ASSERT_EQ(changed.add(point), Status::kOk);
    }
    static Wlsp fit;
    ASSERT_EQ(fit.fit(plain), Status::kOk);
    const WlspFit before = fit.result();
    ASSERT_EQ(fit.fit(changed), Status::kOk);
    const Accelerometer& model = fit.result().model;
    const double d[3] = {model.sensitivity - before.model.sensitivity,
                         model.natural_frequency_hz - before.model.natural_frequency_hz,
                         model.damping - before.model.damping};
    const double parameters[3] = {1.037, 4073.0, 0.3182};
    ASSERT_EQ(plain.set_shared(one.shared), Status::kOk);
    ASSERT_EQ(fit.fit(plain), Status::kOk);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const double added = fit.result().covariance[i][j] - before.covariance[i][j];
        // Second order in the effect: 1e-6 of the parameter.
        const double second =
            1e-6 * (parameters[i] * std::fabs(d[j]) + parameters[j] * std::fabs(d[i]));
        EXPECT_NEAR(added, d[i] * d[j], 2e-3 * std::fabs(d[i] * d[j]) + second) << i << " " << j;
      }
    }
    EXPECT_EQ(fit.result().model.damping, before.model.damping) << "they weigh nothing";
  }
}

// What each effect, made as large as its uncertainty, does to amplitude and phase of a point.
TEST(Wlsp, SharedBesideIsWhatTheEffectsChange) {
  static constexpr double kU = 1e-6;  // So small that the second order is 1e-6 of it, too.
  using Value = std::complex<double>;
  const SharedCase cases[] = {
      {"clock",
       {0, kU, 0, 0, 0, 0, 0, 0},
       [](Value, double f, double) {
         const ResponsePoint faster = exact_point(kDevice, f * (1.0 + kU), 1e-4, 1e-4);
         return std::polar(faster.amplitude, faster.phase_rad);
       }},
      {"leak", {0, 0, 0, 0, 0, kU, 0, 0}, [](Value k, double, double) { return k + kU; }},
      {"leak back",
       {0, 0, 0, 0, 0, 0, kU, 0},
       [](Value k, double, double) { return 1.0 / (1.0 / k + kU); }},
  };
  FrequencyResponse response;
  for (int i = 0; i < 30; ++i) {
    ASSERT_EQ(response.add(exact_point(kDevice, 200.0 * (i + 1), 1e-4, 1e-4)), Status::kOk);
  }
  static Wlsp fit;
  double squares[30] = {};
  for (const SharedCase& one : cases) {
    SCOPED_TRACE(one.name);
    ASSERT_EQ(response.set_shared(one.shared), Status::kOk);
    ASSERT_EQ(fit.fit(response), Status::kOk);
    for (std::size_t i = 0; i < 30; ++i) {
      const ResponsePoint& point = response.points()[i];
      const Value k = std::polar(point.amplitude, point.phase_rad);
      const Value changed = one.changed(k, point.frequency_hz, 0.0) / k;
      const emax::Complex beside = fit.shared_beside(i);
      EXPECT_NEAR(beside.re, std::fabs(std::abs(changed) - 1.0), 1e-5 * kU);
      EXPECT_NEAR(beside.im, std::fabs(std::arg(changed)), 1e-5 * kU);
      squares[i] += beside.re * beside.re;
    }
  }
  // All at once, with the linearity: (A/A_max)^2 of it.
  ASSERT_EQ(response.set_shared({0, kU, 0, 0, 0, kU, kU, kU}), Status::kOk);
  ASSERT_EQ(fit.fit(response), Status::kOk);
  double largest = 0.0;
  for (const ResponsePoint& point : response.points()) {
    largest = std::max(largest, point.amplitude);
  }
  for (std::size_t i = 0; i < 30; ++i) {
    const double share = response.points()[i].amplitude / largest;
    EXPECT_NEAR(fit.shared_beside(i).re, std::sqrt(squares[i] + kU * kU * std::pow(share, 4)),
                1e-9 * kU);
  }
  // Drift, images and skew are in the points' own uncertainties.
  ASSERT_EQ(response.set_shared({kU, 0, kU, 10.0, kU, 0, 0, 0}), Status::kOk);
  ASSERT_EQ(fit.fit(response), Status::kOk);
  EXPECT_EQ(fit.shared_beside(29).re, 0.0);
  EXPECT_EQ(fit.shared_beside(29).im, 0.0);
}

// 30 points of the device, K changed by the function; with a common part of 0.25 % on request.
FrequencyResponse changed_points(std::complex<double> (*changed)(std::complex<double>, double),
                                 bool has_common) {
  FrequencyResponse response;
  for (int i = 0; i < 30; ++i) {
    ResponsePoint point = exact_point(kDevice, 200.0 * (i + 1), 1e-6, 1e-6);
    const std::complex<double> k =
        changed(std::polar(point.amplitude, point.phase_rad), point.frequency_hz);
    point.amplitude = std::abs(k);
    point.phase_rad = std::arg(k);
    EXPECT_EQ(response.add(point), Status::kOk);
  }
  if (has_common) {
    EXPECT_EQ(response.set_common(0.0025), Status::kOk);
  }
  return response;
}

// One error of 1.5 standard uncertainties at all points together: chi-square is 1.5^2 at most.
TEST(Wlsp, ChiSquareKnowsWhatSharedEffectsExplain) {
  using Value = std::complex<double>;
  constexpr double kSize = 1.5;
  constexpr double kU = 1e-4;
  struct Case {
    const char* name;
    emax::SharedEffects shared;
    Value (*changed)(Value k, double frequency_hz);
  };
  // The first two are large where the inverse of the response is.
  const Case cases[] = {
      {"leak", {0, 0, 0, 0, 0, kU, 0, 0}, [](Value k, double) { return k + kSize * kU; }},
      {"leak back",
       {0, 0, 0, 0, 0, 0, kU, 0},
       [](Value k, double) { return 1.0 / (1.0 / k + kSize * kU); }},
      {"linearity", {0, 0, 0, 0, 0, 0, 0, kU}, [](Value k, double) {
         constexpr double kLargest = 1.717;  // S/(2 beta sqrt(1 - beta^2)), to 1 %.
         return k * (1.0 + kSize * kU * std::norm(k) / (kLargest * kLargest));
       }}};
  for (const Case& one : cases) {
    for (const bool has_common : {false, true}) {
      SCOPED_TRACE(one.name);
      FrequencyResponse response = changed_points(one.changed, has_common);
      static Wlsp fit;
      ASSERT_EQ(fit.fit(response), Status::kOk);
      const WlspFit unexplained = fit.result();
      ASSERT_EQ(response.set_shared(one.shared), Status::kOk);
      ASSERT_EQ(fit.fit(response), Status::kOk);
      // The linearity's largest amplitude is that of a point: 2 % of the size, twice.
      EXPECT_LT(fit.result().chi2, 1.05 * kSize * kSize);
      EXPECT_EQ(fit.result().model.damping, unexplained.model.damping);
      double squares = 0.0;
      for (std::size_t i = 0; i < response.size(); ++i) {
        const emax::Complex residual = fit.normalised_residual(i);
        squares += residual.re * residual.re + residual.im * residual.im;
      }
      EXPECT_LE(squares, fit.result().chi2);
      if (one.shared.leak_back == 0.0) {  // That is a change of mu1, which the fit takes up.
        EXPECT_GT(unexplained.chi2, 20.0 * fit.result().chi2);
      }
      // What is no effect of that kind stays seen.
      FrequencyResponse bumpy =
          changed_points([](Value k, double f) { return f == 3000.0 ? 1.001 * k : k; }, has_common);
      ASSERT_EQ(bumpy.set_shared(one.shared), Status::kOk);
      ASSERT_EQ(fit.fit(bumpy), Status::kOk);
      EXPECT_GT(fit.result().chi2, 1e5);
    }
  }
}

TEST(Wlsp, TheClockIsAnErrorOfTheFrequencyAlone) {
  FrequencyResponse response;
  for (int i = 0; i < 30; ++i) {
    ASSERT_EQ(response.add(exact_point(kDevice, 200.0 * (i + 1), 1e-4, 1e-4)), Status::kOk);
  }
  static Wlsp fit;
  ASSERT_EQ(fit.fit(response), Status::kOk);
  const WlspFit before = fit.result();
  emax::SharedEffects shared;
  shared.clock = 25e-6;
  ASSERT_EQ(response.set_shared(shared), Status::kOk);
  ASSERT_EQ(fit.fit(response), Status::kOk);
  EXPECT_EQ(fit.result().u_sensitivity, before.u_sensitivity);
  EXPECT_EQ(fit.result().u_damping, before.u_damping);
  EXPECT_NEAR(fit.result().u_natural_frequency_hz,
              std::hypot(before.u_natural_frequency_hz, 4073.0 * 25e-6), 1e-9);
  for (const double bad : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    shared.clock = bad;
    EXPECT_EQ(response.set_shared(shared), Status::kInvalidArgument) << bad;
  }
  EXPECT_EQ(response.shared().clock, 25e-6);
}

}  // namespace
