// What points determine: with and without phases, near the resonance and far below it.
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <random>
#include <utility>

#include "emax/identify/fit_judgement.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/identify/magnitude_fit.hpp"
#include "emax/identify/wlsp.hpp"

namespace {

using emax::Accelerometer;
using emax::Determined;
using emax::FitJudgement;
using emax::FrequencyResponse;
using emax::ResponsePoint;
using emax::Status;
using emax::Wlsp;
using emax::WlspFit;

constexpr double kDegree = 3.14159265358979323846 / 180.0;

struct Points {
  Accelerometer device = {1.037, 4073.0, 0.3182};
  int count = 40;
  double lowest_hz = 20.0;
  double highest_hz = 6000.0;
  double relative_u = 0.005;  // Standard.
  double u_phase_rad = 0.5 * kDegree;
  double scatter = 0.0;
  bool has_phase = true;
};

FrequencyResponse response_of(const Points& given, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  FrequencyResponse response;
  for (int i = 0; i < given.count; ++i) {
    ResponsePoint p;
    p.frequency_hz =
        given.lowest_hz * std::pow(given.highest_hz / given.lowest_hz, i / (given.count - 1.0));
    const std::complex<double> r(0.0, p.frequency_hz / given.device.natural_frequency_hz);
    const auto k = given.device.sensitivity / (r * r + 2.0 * given.device.damping * r + 1.0);
    p.u_amplitude = given.relative_u * std::abs(k);
    p.u_phase_rad = given.has_phase ? given.u_phase_rad : emax::kUnknownPhase_rad;
    p.amplitude = std::abs(k) + given.scatter * p.u_amplitude * normal(random);
    p.phase_rad =
        given.has_phase ? std::arg(k) + given.scatter * p.u_phase_rad * normal(random) : 0.0;
    EXPECT_EQ(response.add(p), Status::kOk);
  }
  return response;
}

Points piezo() {
  Points points;
  points.device = {0.0102, 55000.0, 0.005};
  points.count = 20;
  points.highest_hz = 10000.0;
  return points;
}

TEST(Magnitudes, PolynomialOfADevice) {
  Points given;
  given.has_phase = false;
  const emax::MagnitudeFit fit = fit_magnitudes(response_of(given));
  ASSERT_TRUE(fit.is_found && fit.has_frequency());
  // Noise-free: normal equations of condition 1e4 leave about 1e-11.
  EXPECT_NEAR(fit.a[0], 1.0 / (1.037 * 1.037), 1e-10);
  EXPECT_NEAR(std::pow(fit.a[2] / fit.a[0], 0.25), 6000.0 / 4073.0, 1e-9);
  EXPECT_NEAR(fit.damping2, 0.3182 * 0.3182, 1e-9);
}

TEST(Magnitudes, FitWithoutPhasesFindsTheDevice) {
  Points given;
  given.has_phase = false;
  Wlsp fit;
  ASSERT_EQ(fit.fit(response_of(given)), Status::kOk);
  const WlspFit& result = fit.result();
  EXPECT_NEAR(result.model.sensitivity, 1.037, 1e-9);
  EXPECT_NEAR(result.model.natural_frequency_hz, 4073.0, 1e-5);
  EXPECT_NEAR(result.model.damping, 0.3182, 1e-9);
  EXPECT_EQ(result.dof, 37U);
  EXPECT_EQ(result.unknown_phases, 40U);
  // Both are least squares of the same magnitudes; with 0.5 % their linear laws agree to that.
  EXPECT_NEAR(result.u_damping2 / (2.0 * 0.3182 * result.u_damping), 1.0, 0.005);
  EXPECT_EQ(judge(result).determined, Determined::kAll);
}

// The covariance is that of many fits; a standard deviation of 400 scatters by 3.5 %, four times
// that.
TEST(Magnitudes, UncertaintiesAreThoseOfRepeatedFits) {
  Points given;
  given.has_phase = false;
  given.scatter = 1.0;
  constexpr int kFits = 400;
  double sums[3] = {};
  double squares[3] = {};
  double chi2 = 0.0;
  WlspFit first;
  for (unsigned seed = 1; seed <= kFits; ++seed) {
    Wlsp fit;
    ASSERT_EQ(fit.fit(response_of(given, seed)), Status::kOk);
    const Accelerometer& m = fit.result().model;
    const double off[3] = {m.sensitivity - 1.037, m.natural_frequency_hz - 4073.0,
                           m.damping - 0.3182};
    for (int i = 0; i < 3; ++i) {
      sums[i] += off[i];
      squares[i] += off[i] * off[i];
    }
    chi2 += fit.result().chi2;
    first = fit.result();
  }
  const double u[3] = {first.u_sensitivity, first.u_natural_frequency_hz, first.u_damping};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::sqrt(squares[i] / kFits) / u[i], 1.0, 0.14) << i;
    EXPECT_LT(std::abs(sums[i]) / kFits, 4.0 * u[i] / std::sqrt(kFits)) << i;
  }
  // The mean of 400 chi-squares of 37 degrees has a standard deviation of sqrt(74/400).
  EXPECT_NEAR(chi2 / kFits, 37.0, 4.0 * std::sqrt(74.0 / kFits));
}

TEST(Magnitudes, SomePhasesAreEnoughForMore) {
  const FrequencyResponse all = response_of(Points());
  FrequencyResponse some;
  for (std::size_t i = 0; i < all.size(); ++i) {
    ResponsePoint point = all.points()[i];
    if (i % 2 == 0) {
      point.phase_rad = 0.0;
      point.u_phase_rad = emax::kUnknownPhase_rad;
    }
    ASSERT_EQ(some.add(point), Status::kOk);
  }
  Wlsp fit;
  ASSERT_EQ(fit.fit(some), Status::kOk);
  EXPECT_NEAR(fit.result().model.damping, 0.3182, 1e-9);
  EXPECT_EQ(fit.result().dof, 57U);
}

TEST(Magnitudes, GivenDampingIsHeldWhereItIsNotDetermined) {
  Points given = piezo();
  given.has_phase = false;
  Wlsp fit;
  EXPECT_EQ(fit.fit(response_of(given)), Status::kNotPhysical);
  EXPECT_EQ(judge(fit.result()).determined, Determined::kSensitivity);
  fit.give_damping(0.005);
  ASSERT_EQ(fit.fit(response_of(given)), Status::kOk);
  EXPECT_EQ(fit.result().model.damping, 0.005);
  // The weight that holds it leaves 1e-8 of an uncertainty of 4 kHz.
  EXPECT_NEAR(fit.result().model.natural_frequency_hz, 55000.0, 1e-2);
  EXPECT_TRUE(fit.result().is_damping_given);
  EXPECT_EQ(fit.result().dof, 18U);
  const FitJudgement judgement = judge(fit.result());
  EXPECT_EQ(judgement.determined, Determined::kAll);
  EXPECT_EQ(judgement.u_damping, 0.0);
  // Where the magnitudes determine it, what was given is not looked at.
  Points paper;
  paper.has_phase = false;
  ASSERT_EQ(fit.fit(response_of(paper)), Status::kOk);
  EXPECT_NEAR(fit.result().model.damping, 0.3182, 1e-9);
}

// With phases, too: least squares under a condition.
TEST(Judgement, GivenDampingIsHeldWhereThePointsLeaveItOpen) {
  Points given = piezo();
  given.scatter = 1.0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const FrequencyResponse response = response_of(given, seed);
    Wlsp fit;
    (void)fit.fit(response);
    const WlspFit free = fit.result();
    ASSERT_EQ(judge(free).determined, Determined::kAllButDamping) << seed;
    fit.give_damping(0.01);
    ASSERT_EQ(fit.fit(response), Status::kOk);
    const WlspFit held = fit.result();
    EXPECT_TRUE(held.is_damping_given);
    EXPECT_EQ(held.model.damping, 0.01);
    EXPECT_EQ(held.u_damping, 0.0);
    EXPECT_EQ(held.dof, free.dof + 1);
    // Chi-square grows by the square of what was moved, to first order.
    const double moved = (0.01 - free.model.damping) / free.u_damping;
    EXPECT_NEAR(held.chi2 - free.chi2, moved * moved, 0.05);
    // No device of that damping nearby fits better.
    for (const double s : {-1.0, 0.0, 1.0}) {
      for (const double f : {-1.0, 0.0, 1.0}) {
        const Accelerometer other = {
            held.model.sensitivity + 0.1 * s * held.u_sensitivity,
            held.model.natural_frequency_hz + 0.1 * f * held.u_natural_frequency_hz, 0.01};
        EXPECT_GE(fit.chi_square_of(other), held.chi2 - 1e-6);
      }
    }
    EXPECT_EQ(judge(held).determined, Determined::kAll);
    // Far beyond what the points leave open nothing is held.
    fit.give_damping(0.5);
    (void)fit.fit(response);
    EXPECT_FALSE(fit.result().is_damping_held);
    EXPECT_EQ(fit.result().chi2, free.chi2);
  }
}

TEST(Judgement, PointsToAFifthOfTheResonanceLeaveTheDampingOpen) {
  const FrequencyResponse response = response_of(piezo());
  Wlsp fit;
  ASSERT_EQ(fit.fit(response), Status::kOk);
  const FitJudgement judgement = judge(fit.result());
  EXPECT_EQ(judgement.determined, Determined::kAllButDamping);
  EXPECT_EQ(judgement.device.damping, fit.result().model.damping);
  EXPECT_EQ(judgement.damping_low, emax::kMinDamping);
  EXPECT_NEAR(judgement.damping_high, 0.005 + 2.0 * fit.result().u_damping, 1e-10);
}

// The constrained estimate has the least chi-square of all devices with that damping, to half an
// uncertainty: the equations are linear in mu, so not quite in S, f0 and beta.
TEST(Judgement, NearestDampingIsAConstrainedFit) {
  Points given = piezo();
  given.scatter = 1.0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Wlsp fit;
    const FrequencyResponse response = response_of(given, seed);
    (void)fit.fit(response);
    if (fit.result().model.damping >= emax::kMinDamping) {
      continue;
    }
    const FitJudgement judgement = judge(fit.result());
    if (judgement.determined != Determined::kAllButDamping) {
      continue;
    }
    EXPECT_EQ(judgement.device.damping, emax::kMinDamping);
    const double least = fit.chi_square_of(judgement.device);
    for (const double by : {-1.0, 1.0}) {
      Accelerometer moved = judgement.device;
      moved.sensitivity += by * judgement.u_sensitivity;
      EXPECT_GT(fit.chi_square_of(moved), least);
      moved = judgement.device;
      moved.natural_frequency_hz += by * judgement.u_natural_frequency_hz;
      EXPECT_GT(fit.chi_square_of(moved), least);
    }
  }
}

// By hand: S moves by its covariance with the damping over the damping's variance, as f0 does.
TEST(Judgement, ParametersFollowTheDampingByTheirCovariance) {
  WlspFit fit;
  fit.status = Status::kNotPhysical;
  fit.mu[0] = fit.mu[2] = 1.0;
  fit.u_mu[0] = fit.u_mu[2] = 0.01;
  fit.model = {1.0, 1e4, -0.0099};
  fit.u_sensitivity = 0.01;
  fit.u_natural_frequency_hz = 100.0;
  fit.u_damping = 0.01;
  fit.covariance[0][0] = 1e-4;
  fit.covariance[1][1] = 1e4;
  fit.covariance[2][2] = 1e-4;
  fit.covariance[0][2] = fit.covariance[2][0] = 0.6e-4;
  fit.covariance[1][2] = fit.covariance[2][1] = -0.8;
  const FitJudgement judgement = judge(fit);
  ASSERT_EQ(judgement.determined, Determined::kAllButDamping);
  EXPECT_NEAR(judgement.device.sensitivity, 1.0 + 0.6 * 0.01, 1e-15);
  EXPECT_NEAR(judgement.device.natural_frequency_hz, 1e4 - 80.0, 1e-10);
  EXPECT_NEAR(judgement.u_sensitivity, 0.008, 1e-15);
  EXPECT_NEAR(judgement.u_natural_frequency_hz, 60.0, 1e-10);
}

// The permitted range is never empty while scatter may explain the estimate, up to 4 u below.
TEST(Judgement, RangeOfDampingsByTheEstimate) {
  WlspFit fit;
  fit.mu[0] = fit.mu[2] = 1.0;
  fit.u_mu[0] = fit.u_mu[2] = 0.01;
  fit.u_sensitivity = 0.01;
  fit.u_damping = 0.01;
  fit.covariance[2][2] = 1e-4;
  const struct {
    double damping;
    Determined determined;
    double high;
  } cases[] = {{0.0202, Determined::kAll, 0.0},
               {0.0200, Determined::kAllButDamping, 0.04},
               {-0.01, Determined::kAllButDamping, 0.01},
               {-0.03, Determined::kAllButDamping, 0.0051},
               {-0.0398, Determined::kAllButDamping, 0.0051},
               {-0.0400, Determined::kNothing, 0.0}};
  for (const auto& expected : cases) {
    fit.model = {1.0, 1e4, expected.damping};
    fit.status = expected.damping > 0.0 ? Status::kOk : Status::kNotPhysical;
    const FitJudgement judgement = judge(fit);
    EXPECT_EQ(judgement.determined, expected.determined) << expected.damping;
    EXPECT_NEAR(judgement.damping_high, expected.high, 1e-12) << expected.damping;
  }
}

TEST(Judgement, PointsFarBelowTheResonanceLeaveTheSensitivityAlone) {
  Points given = piezo();
  given.count = 5;
  given.lowest_hz = 10.0;
  given.highest_hz = 160.0;
  Wlsp fit;
  (void)fit.fit(response_of(given));
  const FitJudgement judgement = judge(fit.result());
  EXPECT_EQ(judgement.determined, Determined::kSensitivity);
  EXPECT_NEAR(judgement.device.sensitivity, 0.0102, 1e-7);
  EXPECT_GT(judgement.u_sensitivity, 0.0);
}

// 1/(S w0^2) in units of its u; all else is the fit of a sensor with f0 = 30 kHz to 3 kHz.
WlspFit fit_by_mu3(double mu3_in_u, Status status) {
  WlspFit fit;
  fit.status = status;
  fit.mu[0] = 98.0;
  fit.mu[1] = 1.5e-4;
  fit.mu[2] = mu3_in_u * 1.2e-9;
  fit.u_mu[0] = 0.12;
  fit.u_mu[1] = 1.4e-5;
  fit.u_mu[2] = 1.2e-9;
  return fit;
}

TEST(Judgement, WhereF0IsOpenNoDampingIsReadFromIt) {
  constexpr double kTwoPi = 6.283185307179586;
  const struct {
    double mu3_in_u;
    Status status;
    double most_in_u;  // Of 1/(S w0^2), by 2 u.
  } cases[] = {
      {0.1, Status::kOverdamped, 2.1},   {1.9, Status::kOverdamped, 3.9},
      {-1.9, Status::kNotPhysical, 2.0}, {-2.5, Status::kNotPhysical, 2.0},
      {-3.9, Status::kNotPhysical, 2.0}, {1.0, Status::kOk, 3.0},
  };
  for (const auto& each : cases) {
    const FitJudgement judgement = judge(fit_by_mu3(each.mu3_in_u, each.status));
    EXPECT_EQ(judgement.determined, Determined::kSensitivity) << each.mu3_in_u;
    EXPECT_DOUBLE_EQ(judgement.device.sensitivity, 1.0 / 98.0);
    EXPECT_NEAR(judgement.frequency_low_hz, std::sqrt(98.0 / (each.most_in_u * 1.2e-9)) / kTwoPi,
                1e-6);
  }
  // No scatter: a mu3 as far below 0 is that of other phases or units.
  for (const auto& [mu3_in_u, status] :
       {std::pair(-4.1, Status::kNotPhysical), std::pair(2.1, Status::kOverdamped)}) {
    EXPECT_EQ(judge(fit_by_mu3(mu3_in_u, status)).determined, Determined::kNothing) << mu3_in_u;
  }
}

TEST(Judgement, EveryDrawFarBelowTheResonanceSaysSomething) {
  Points far;
  far.count = 20;
  far.scatter = 1.0;
  for (const double damping : {0.01, 0.3, 0.6}) {
    for (const double part : {0.05, 0.1}) {
      far.device = {0.0102, 30000.0, damping};
      far.lowest_hz = part * 300.0;
      far.highest_hz = part * 30000.0;
      for (unsigned seed = 1; seed <= 300; ++seed) {
        Wlsp fit;
        (void)fit.fit(response_of(far, seed));
        EXPECT_NE(judge(fit.result()).determined, Determined::kNothing)
            << damping << " " << part << " " << seed;
      }
    }
  }
}

TEST(Judgement, ADampingThatIsNegativeIsNoDevice) {
  FrequencyResponse turned;
  const FrequencyResponse good = response_of(Points());
  for (ResponsePoint point : good.points()) {
    point.phase_rad = -point.phase_rad;
    ASSERT_EQ(turned.add(point), Status::kOk);
  }
  Wlsp fit;
  EXPECT_EQ(fit.fit(turned), Status::kNotPhysical);
  EXPECT_EQ(judge(fit.result()).determined, Determined::kNothing);
}

// What a fit may answer besides, by hand.
TEST(Judgement, WithoutPositiveEstimatesThereIsNoDevice) {
  WlspFit good;
  good.model = {0.5, 1000.0, 0.3};
  good.u_sensitivity = 0.01;
  good.u_damping = 0.01;
  good.mu[0] = 2.0;
  good.mu[2] = 3.0;
  ASSERT_EQ(judge(good).determined, Determined::kAll) << "exact numbers are as good";
  good.u_mu[0] = good.u_mu[2] = 0.01;
  ASSERT_EQ(judge(good).determined, Determined::kAll);
  const auto determined = [&good](auto change) {
    WlspFit fit = good;
    change(fit);
    return judge(fit).determined;
  };
  for (const Status status :
       {Status::kNotIdentifiable, Status::kTooFewPoints, Status::kOverdamped}) {
    EXPECT_EQ(determined([&](WlspFit& fit) { fit.status = status; }), Determined::kNothing);
  }
  for (const double bad : {0.0, -2.0, std::nan("")}) {
    EXPECT_EQ(determined([&](WlspFit& fit) { fit.mu[0] = bad; }), Determined::kNothing) << bad;
    EXPECT_EQ(determined([&](WlspFit& fit) { fit.u_sensitivity = bad; }), Determined::kNothing);
  }
  for (const double bad : {-3.0, std::nan("")}) {
    EXPECT_EQ(determined([&](WlspFit& fit) { fit.mu[2] = bad; }), Determined::kNothing) << bad;
  }
  EXPECT_EQ(determined([](WlspFit& fit) { fit.mu[2] = -0.01; }), Determined::kSensitivity);
}

// beta^2 + 2 u ends the range, cut at what is below 1; a negative beta^2 counts as none.
TEST(Judgement, RangeOfDampingsByMagnitudes) {
  WlspFit fit;
  fit.model = {0.5, 1000.0, 0.01};
  fit.u_sensitivity = 0.01;
  fit.mu[0] = 2.0;
  fit.mu[2] = 3.0;
  fit.is_damping_held = true;
  const struct {
    double damping2;
    double u_damping2;
    double high;
  } ranges[] = {{0.01, 0.04, 0.3}, {-0.5, 0.02, 0.2}, {0.9, 0.5, 0.999}};
  for (const auto& range : ranges) {
    fit.damping2 = range.damping2;
    fit.u_damping2 = range.u_damping2;
    EXPECT_EQ(judge(fit).determined, Determined::kAllButDamping);
    EXPECT_NEAR(judge(fit).damping_high, range.high, 1e-15) << range.damping2;
  }
}

TEST(Magnitudes, TwoAreTooFew) {
  Points given;
  given.count = 2;
  EXPECT_FALSE(fit_magnitudes(response_of(given)).is_found);
  given.count = 3;
  EXPECT_TRUE(fit_magnitudes(response_of(given)).is_found);
}

}  // namespace
