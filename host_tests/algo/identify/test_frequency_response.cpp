// The table of points, and the covariance of 1/K by formula, by differences and by draws.
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>

#include "emax/identify/frequency_response.hpp"

namespace emax {
namespace {

constexpr std::array<std::uint32_t, 4> kSeeds = {123456789, 345678901, 567890123, 789012345};
constexpr ResponsePoint kPoint = {1000.0, 1.07, -0.4, 0.011, 0.0175};

std::complex<long double> inverse(long double amplitude, long double phase_rad) {
  return std::polar(1.0L / amplitude, -phase_rad);
}

// Central differences in long double stand in for the derivatives: an error of 1e-12 or so.
ComplexCovariance by_differences(const ResponsePoint& p) {
  const auto amplitude = static_cast<long double>(p.amplitude);
  const auto phase_rad = static_cast<long double>(p.phase_rad);
  const long double h = 1e-6L;
  const std::complex<long double> da =
      (inverse(amplitude * (1.0L + h), phase_rad) - inverse(amplitude * (1.0L - h), phase_rad)) /
      (2.0L * h * amplitude) * static_cast<long double>(p.u_amplitude);
  const std::complex<long double> dp =
      (inverse(amplitude, phase_rad + h) - inverse(amplitude, phase_rad - h)) / (2.0L * h) *
      static_cast<long double>(p.u_phase_rad);
  return {static_cast<double>(da.real() * da.real() + dp.real() * dp.real()),
          static_cast<double>(da.real() * da.imag() + dp.real() * dp.imag()),
          static_cast<double>(da.imag() * da.imag() + dp.imag() * dp.imag())};
}

TEST(FrequencyResponse, KeepsWhatItIsGiven) {
  FrequencyResponse response;
  EXPECT_EQ(response.size(), 0U);
  for (std::size_t i = 1; i <= emax::kMaxPoints; ++i) {
    ResponsePoint point = kPoint;
    point.frequency_hz = 10.0 * static_cast<double>(i);
    ASSERT_EQ(response.add(point), Status::kOk);
  }
  ASSERT_EQ(response.points().size(), emax::kMaxPoints);
  EXPECT_EQ(response.points()[41].frequency_hz, 420.0);
  EXPECT_EQ(response.points()[41].u_phase_rad, kPoint.u_phase_rad);
  ResponsePoint next = kPoint;
  next.frequency_hz = 1e5;
  EXPECT_EQ(response.add(next), Status::kTooManyPoints);
  EXPECT_EQ(response.size(), emax::kMaxPoints);
  response.clear();
  EXPECT_EQ(response.size(), 0U);
  EXPECT_EQ(response.add(kPoint), Status::kOk);
}

TEST(FrequencyResponse, RefusesBadPoints) {
  FrequencyResponse response;
  ASSERT_EQ(response.add(kPoint), Status::kOk);
  ResponsePoint later = kPoint;
  later.frequency_hz = 2000.0;

  EXPECT_EQ(response.add(kPoint), Status::kNotAscending);
  ResponsePoint earlier = kPoint;
  earlier.frequency_hz = 999.0;
  EXPECT_EQ(response.add(earlier), Status::kNotAscending);

  double ResponsePoint::*const fields[] = {&ResponsePoint::frequency_hz, &ResponsePoint::amplitude,
                                           &ResponsePoint::phase_rad, &ResponsePoint::u_amplitude,
                                           &ResponsePoint::u_phase_rad};
  for (double ResponsePoint::*const field : fields) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
          -std::numeric_limits<double>::infinity()}) {
      ResponsePoint point = later;
      point.*field = bad;
      EXPECT_EQ(response.add(point), Status::kInvalidArgument);
    }
  }
  for (const double bad : {0.0, -1.0}) {
    ResponsePoint point = later;
    point.frequency_hz = bad;
    EXPECT_EQ(response.add(point), Status::kInvalidArgument);
    point = later;
    point.amplitude = bad;
    EXPECT_EQ(response.add(point), Status::kInvalidArgument);
    point = later;
    point.u_amplitude = bad;
    EXPECT_EQ(response.add(point), Status::kUncertaintyNotPositive);
    point = later;
    point.u_phase_rad = bad;
    EXPECT_EQ(response.add(point), Status::kUncertaintyNotPositive);
  }
  EXPECT_EQ(response.size(), 1U);
  EXPECT_EQ(response.add(later), Status::kOk);
}

TEST(InverseCovariance, AgainstDifferences) {
  for (const double phase_rad : {0.0, -0.1, -0.4, -1.5707963, -2.5, -3.1, 1.0}) {
    ResponsePoint point = kPoint;
    point.phase_rad = phase_rad;
    const ComplexCovariance expected = by_differences(point);
    const ComplexCovariance c = inverse_covariance(point);
    const double size = expected.re_re + expected.im_im;
    EXPECT_NEAR(c.re_re, expected.re_re, 1e-10 * size);
    EXPECT_NEAR(c.re_im, expected.re_im, 1e-10 * size);
    EXPECT_NEAR(c.im_im, expected.im_im, 1e-10 * size);
    const Complex y = inverse_response(point);
    const std::complex<long double> exact =
        inverse(static_cast<long double>(point.amplitude), static_cast<long double>(phase_rad));
    EXPECT_NEAR(y.re, static_cast<double>(exact.real()), 1e-15);
    EXPECT_NEAR(y.im, static_cast<double>(exact.imag()), 1e-15);
  }
}

TEST(InverseCovariance, FactorTimesItsTranspose) {
  for (const double phase_rad : {0.0, -0.4, -1.5707963, -3.1, 1.0}) {
    ResponsePoint point = kPoint;
    point.phase_rad = phase_rad;
    const ComplexCovariance c = inverse_covariance(point);
    const ComplexCholesky l = inverse_cholesky(point);
    const double size = c.re_re + c.im_im;
    EXPECT_NEAR(l.re_re * l.re_re, c.re_re, 1e-14 * size);
    EXPECT_NEAR(l.re_re * l.im_re, c.re_im, 1e-14 * size);
    EXPECT_NEAR(l.im_re * l.im_re + l.im_im * l.im_im, c.im_im, 1e-14 * size);
  }
}

TEST(InverseCovariance, FactorKeepsAVerySmallUncertainty) {
  // det C = (u_A u_phase/A^3)^2, of which C itself keeps nothing here.
  const ResponsePoint point = {1000.0, 2.0, -0.7, 0.1, 1e-12};
  const ComplexCholesky l = inverse_cholesky(point);
  EXPECT_NEAR(l.re_re * l.im_im / (0.1 * 1e-12 / 8.0), 1.0, 1e-14);
}

TEST(InverseCovariance, DrawsAgreeWithTheFormula) {
  WichmannHill generator;
  ASSERT_EQ(generator.seed(Generator::k2006, kSeeds), Status::kOk);
  constexpr std::uint32_t kDraws = 100000;
  const ComplexCovariance c = inverse_covariance(kPoint);
  const DrawnCovariance drawn = inverse_covariance_by_draws(kPoint, kDraws, generator);
  ASSERT_EQ(drawn.status, Status::kOk);
  // A drawn variance has relative standard deviation sqrt(2/n), a covariance sqrt((c11 c22 +
  // c12^2)/n): four of them, and the curvature of 1/A, some (u_A/A)^2 = 1e-4 of the variance.
  const double n = kDraws;
  const double cross = std::sqrt((c.re_re * c.im_im + c.re_im * c.re_im) / n);
  EXPECT_NEAR(drawn.covariance.re_re / c.re_re, 1.0, 4.0 * std::sqrt(2.0 / n) + 1e-3);
  EXPECT_NEAR(drawn.covariance.im_im / c.im_im, 1.0, 4.0 * std::sqrt(2.0 / n) + 1e-3);
  EXPECT_NEAR(drawn.covariance.re_im, c.re_im, 4.0 * cross + 1e-3 * c.re_re);
  // E(1/A) = (1/A)(1 + (u_A/A)^2), E e^(j phase) shrinks by u_phase^2/2; then scatter.
  const Complex y = inverse_response(kPoint);
  const double bias = 0.011 * 0.011 / (1.07 * 1.07) - 0.5 * 0.0175 * 0.0175;
  EXPECT_NEAR(drawn.mean.re, y.re * (1.0 + bias), 4.0 * std::sqrt(c.re_re / n));
  EXPECT_NEAR(drawn.mean.im, y.im * (1.0 + bias), 4.0 * std::sqrt(c.im_im / n));
}

TEST(InverseCovariance, DrawsTakeTwoNumbersEach) {
  WichmannHill drawn;
  WichmannHill jumped;
  ASSERT_EQ(drawn.seed(Generator::k2006, kSeeds), Status::kOk);
  ASSERT_EQ(jumped.seed(Generator::k2006, kSeeds), Status::kOk);
  ASSERT_EQ(inverse_covariance_by_draws(kPoint, 50, drawn).status, Status::kOk);
  jumped.jump(100);
  EXPECT_EQ(drawn.state(), jumped.state());
}

TEST(InverseCovariance, DrawsRefuseBadInput) {
  WichmannHill generator;
  ASSERT_EQ(generator.seed(Generator::k2006, kSeeds), Status::kOk);
  EXPECT_EQ(inverse_covariance_by_draws(kPoint, 2, generator).status, Status::kInvalidArgument);
  EXPECT_EQ(inverse_covariance_by_draws(ResponsePoint(), 100, generator).status,
            Status::kInvalidArgument);
  ResponsePoint loose = kPoint;
  loose.u_amplitude = 1.0;
  const DrawnCovariance result = inverse_covariance_by_draws(loose, 1000, generator);
  EXPECT_EQ(result.status, Status::kNotPhysical);
  EXPECT_EQ(result.covariance.re_re, 0.0);
}

TEST(FrequencyResponse, CommonPart) {
  FrequencyResponse response;
  EXPECT_FALSE(response.has_common());
  ASSERT_EQ(response.add({100.0, 1.0, 0.0, 0.01, 0.01}), Status::kOk);
  ASSERT_EQ(response.add({200.0, 1.0, 0.0, 0.01, 0.01}), Status::kOk);
  ASSERT_EQ(response.common().size(), 2U);
  EXPECT_EQ(response.common()[0], 0.0);
  EXPECT_FALSE(response.has_common());
  ASSERT_EQ(response.set_common(0.0025), Status::kOk);
  EXPECT_TRUE(response.has_common());
  EXPECT_EQ(response.common()[1], 0.0025);
  const double two[] = {0.001, 0.0};
  ASSERT_EQ(response.set_common(two), Status::kOk);
  EXPECT_EQ(response.common()[0], 0.001);
  EXPECT_EQ(response.common()[1], 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-0.001, 1.0, nan}) {
    EXPECT_EQ(response.set_common(bad), Status::kInvalidArgument) << bad;
    const double second_bad[] = {0.002, bad};
    EXPECT_EQ(response.set_common(second_bad), Status::kInvalidArgument) << bad;
  }
  const double three[] = {0.0, 0.0, 0.0};
  EXPECT_EQ(response.set_common(three), Status::kInvalidArgument);
  EXPECT_EQ(response.common()[0], 0.001);
  // A point that comes later, and a table begun anew, have none.
  ASSERT_EQ(response.add({300.0, 1.0, 0.0, 0.01, 0.01}), Status::kOk);
  EXPECT_EQ(response.common()[2], 0.0);
  response.clear();
  ASSERT_EQ(response.add({100.0, 1.0, 0.0, 0.01, 0.01}), Status::kOk);
  EXPECT_FALSE(response.has_common());
}

}  // namespace
}  // namespace emax
