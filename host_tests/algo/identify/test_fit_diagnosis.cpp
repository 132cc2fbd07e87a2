// Faults of a measuring chain, put into points of a known device and found by name and size.
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <memory>
#include <random>

#include "emax/identify/fit_diagnosis.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"

namespace {

using emax::DiagnosisWorkspace;
using emax::FitCause;
using emax::FitDiagnosis;
using emax::FrequencyResponse;
using emax::ResponsePoint;
using emax::Status;
using emax::Wlsp;

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr std::complex<double> kJ(0.0, 1.0);

// 40 points of the paper's device with noise, each multiplied by what `fault` says.
template <typename Fault>
FitDiagnosis diagnosis_of(Fault fault) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  FrequencyResponse response;
  for (int i = 0; i < 40; ++i) {
    ResponsePoint p;
    p.frequency_hz = 20.0 * std::pow(300.0, i / 39.0);
    const std::complex<double> r = kJ * (p.frequency_hz / 4073.0);
    const std::complex<double> k = fault(p.frequency_hz, 1.037 / (r * r + 2.0 * 0.3182 * r + 1.0));
    p.u_amplitude = 0.005 * std::abs(k);
    p.u_phase_rad = 0.5 * kDegree;
    p.amplitude = std::abs(k) + p.u_amplitude * normal(random);
    p.phase_rad = std::arg(k) + p.u_phase_rad * normal(random);
    EXPECT_EQ(response.add(p), Status::kOk);
  }
  Wlsp fit;
  (void)fit.fit(response);
  const auto workspace = std::make_unique<DiagnosisWorkspace>();
  return diagnose(fit, *workspace);
}

// What noise of one degree at 40 points leaves of a size: a few parts in a thousand.
constexpr double kNoise = 0.02;

TEST(FitDiagnosis, GoodPointsHaveNoCause) {
  EXPECT_EQ(diagnosis_of([](double, std::complex<double> k) { return k; }).cause, FitCause::kNone);
}

TEST(FitDiagnosis, Delays) {
  for (const double delay_s : {0.53e-3, -0.1e-3, 1.2e-3}) {
    const FitDiagnosis found = diagnosis_of([delay_s](double f, std::complex<double> k) {
      return k * std::exp(-kJ * (2.0 * 180.0 * kDegree * f * delay_s));
    });
    EXPECT_EQ(found.cause, FitCause::kDelay);
    EXPECT_NEAR(found.delay_s, delay_s, kNoise * std::abs(delay_s));
    EXPECT_GT(found.reduced_before, 100.0);
    EXPECT_LT(found.reduced_after, 2.0);
  }
}

TEST(FitDiagnosis, Couplings) {
  for (const double corner_hz : {2.0, 5.0, 50.0}) {
    const FitDiagnosis found = diagnosis_of([corner_hz](double f, std::complex<double> k) {
      const std::complex<double> ratio = kJ * (f / corner_hz);
      return k * ratio / (1.0 + ratio);
    });
    EXPECT_EQ(found.cause, FitCause::kCoupling) << corner_hz;
    // 0.5 degrees at 20 Hz are 0.17 Hz, and some points share in it; at 50 Hz parts of the corner.
    EXPECT_NEAR(found.corner_hz, corner_hz, 0.4 + kNoise * corner_hz);
    EXPECT_LT(found.reduced_after, 2.0);
  }
}

TEST(FitDiagnosis, SignOfThePhase) {
  const FitDiagnosis found =
      diagnosis_of([](double, std::complex<double> k) { return std::conj(k); });
  EXPECT_EQ(found.cause, FitCause::kPhaseSign);
}

// 30 points of a device, their phases multiplied by `scale`, with errors of `scatter` times what is
// stated.
FitDiagnosis diagnosis_of_scaled(double f0_hz, double damping, double scale, double scatter) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, scatter);
  FrequencyResponse response;
  for (int i = 0; i < 30; ++i) {
    ResponsePoint p;
    p.frequency_hz = 20.0 * std::pow(300.0, i / 29.0);
    const std::complex<double> r = kJ * (p.frequency_hz / f0_hz);
    const std::complex<double> k = 1.037 / (r * r + 2.0 * damping * r + 1.0);
    p.u_amplitude = 0.005 * std::abs(k);
    p.u_phase_rad = 0.1 * kDegree * std::abs(scale);
    p.amplitude = std::abs(k) + p.u_amplitude * normal(random);
    p.phase_rad = std::arg(k) * scale + p.u_phase_rad * normal(random);
    EXPECT_EQ(response.add(p), Status::kOk);
  }
  Wlsp fit;
  (void)fit.fit(response);
  const auto workspace = std::make_unique<DiagnosisWorkspace>();
  return diagnose(fit, *workspace);
}

TEST(FitDiagnosis, RadiansTakenForDegrees) {
  const FitDiagnosis found = diagnosis_of_scaled(4073.0, 0.3182, kDegree, 1.0);
  EXPECT_EQ(found.cause, FitCause::kRadians);
  EXPECT_NEAR(found.damping, 0.3182, 0.003);
  EXPECT_LT(found.reduced_after, 1.5);
  // Far below the resonance both fit; then the damping alone tells.
  const FitDiagnosis far = diagnosis_of_scaled(40000.0, 0.03, kDegree, 1.0);
  EXPECT_EQ(far.cause, FitCause::kMayBeRadians);
  EXPECT_NEAR(far.damping, 0.03, 0.005);
  EXPECT_EQ(diagnosis_of_scaled(40000.0, 0.03, 1.0, 1.0).cause, FitCause::kNone);
}

// The scatter may be larger than stated; the sign is wrong all the same.
TEST(FitDiagnosis, SignOfThePhaseOfPointsThatScatter) {
  for (const double scatter : {1.0, 3.0, 6.0}) {
    EXPECT_EQ(diagnosis_of_scaled(4073.0, 0.3182, -1.0, scatter).cause, FitCause::kPhaseSign)
        << scatter;
    EXPECT_NE(diagnosis_of_scaled(4073.0, 0.3182, 1.0, scatter).cause, FitCause::kPhaseSign);
  }
}

TEST(FitDiagnosis, ASecondResonanceHasNoneOfTheseNames) {
  const FitDiagnosis found = diagnosis_of([](double f, std::complex<double> k) {
    const std::complex<double> r = kJ * (f / 900.0);
    return k * (1.0 + 0.3 * r / (r * r + 0.05 * r + 1.0));
  });
  EXPECT_EQ(found.cause, FitCause::kNone);
  EXPECT_GT(found.reduced_before, 3.0);
}

// Two points, one of unknown phase among others, and points that no fit explains.
TEST(FitDiagnosis, NothingIsSaidOfPointsThatDetermineNothing) {
  const auto workspace = std::make_unique<DiagnosisWorkspace>();
  const auto cause_of = [&](std::initializer_list<ResponsePoint> points) {
    FrequencyResponse response;
    for (const ResponsePoint& point : points) {
      EXPECT_EQ(response.add(point), Status::kOk);
    }
    Wlsp fit;
    (void)fit.fit(response);
    const FitDiagnosis diagnosis = diagnose(fit, *workspace);
    EXPECT_EQ(diagnosis.reduced_before, 0.0);
    return diagnosis.cause;
  };
  const auto point = [](double frequency_hz, double u_phase_rad) {
    ResponsePoint p;
    p.frequency_hz = frequency_hz;
    p.amplitude = 1.0 + 1e-3 * frequency_hz;  // Of no device.
    p.u_amplitude = 1e-5;
    p.u_phase_rad = u_phase_rad;
    return p;
  };
  EXPECT_EQ(cause_of({point(100.0, 1e-5), point(200.0, 1e-5)}), FitCause::kNone);
  EXPECT_EQ(cause_of({point(100.0, 1e-5), point(200.0, emax::kUnknownPhase_rad), point(300.0, 1e-5),
                      point(400.0, 1e-5)}),
            FitCause::kNone);
  EXPECT_EQ(cause_of({point(100.0, 1e-5), point(100.0 + 1e-12, 1e-5), point(100.0 + 2e-12, 1e-5)}),
            FitCause::kNone);
}

}  // namespace
