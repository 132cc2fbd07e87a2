// Which parameters of a device the points determine.
#include "emax/identify/fit_judgement.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr double kCoverage = 2.0;
// A damping below the least one by more than this is no scatter any more: one draw in 30 000.
constexpr double kImpossible = 4.0;
// An estimate far below zero leaves so much of u above it, near what Feldman and Cousins (Phys.
// Rev. D 57 (1998) 3873) give for 95 %.
constexpr double kLeastShare = 0.5;

bool is_sensitivity_alone(const WlspFit& fit) noexcept {
  return fit.u_mu[0] > 0.0 && fit.mu[0] > kCoverage * fit.u_mu[0] &&
         fit.mu[2] <= kCoverage * fit.u_mu[2] && fit.mu[2] >= -kImpossible * fit.u_mu[2];
}

FitJudgement sensitivity_alone(const WlspFit& fit) noexcept {
  FitJudgement judgement;
  judgement.determined = Determined::kSensitivity;
  judgement.device.sensitivity = 1.0 / fit.mu[0];
  judgement.u_sensitivity = fit.u_mu[0] / (fit.mu[0] * fit.mu[0]);
  if (fit.mu[2] != 0.0) {  // Magnitudes alone leave it at zero, as they do not tell it from beta.
    const double mu3 = fit.mu[2] > 0.0 ? fit.mu[2] : 0.0;
    judgement.frequency_low_hz = sqrt(fit.mu[0] / (mu3 + kCoverage * fit.u_mu[2])) / kTwoPi;
  }
  return judgement;
}

double permitted(double damping) noexcept {
  return damping < kMinDamping ? kMinDamping : damping > kMaxCutDamping ? kMaxCutDamping : damping;
}

FitJudgement whole(const WlspFit& fit) noexcept {
  return {Determined::kAll,
          fit.model,
          fit.u_sensitivity,
          fit.u_natural_frequency_hz,
          fit.u_damping,
          0.0,
          0.0,
          0.0,
          0.0,
          0.0};
}

// The fit has held the damping where magnitudes alone have left it open.
FitJudgement held(const WlspFit& fit) noexcept {
  FitJudgement judgement = whole(fit);
  if (fit.is_damping_given) {
    return judgement;
  }
  const double from = fit.damping2 > 0.0 ? fit.damping2 : 0.0;
  judgement.determined = Determined::kAllButDamping;
  judgement.damping_low = kMinDamping;
  judgement.damping_high = permitted(sqrt(from + kCoverage * fit.u_damping2));
  return judgement;
}

// Least squares under the condition that the damping is the nearest permitted one.
FitJudgement constrained(const WlspFit& fit) noexcept {
  FitJudgement judgement;
  const double variance = fit.covariance[2][2];
  const double damping = permitted(fit.model.damping);
  const double by_s = fit.covariance[0][2] / variance;
  const double by_f0 = fit.covariance[1][2] / variance;
  const double moved = damping - fit.model.damping;
  judgement.determined = Determined::kAllButDamping;
  judgement.device = {fit.model.sensitivity + by_s * moved,
                      fit.model.natural_frequency_hz + by_f0 * moved, damping};
  judgement.u_sensitivity = sqrt(fit.covariance[0][0] - by_s * fit.covariance[0][2]);
  judgement.u_natural_frequency_hz = sqrt(fit.covariance[1][1] - by_f0 * fit.covariance[1][2]);
  judgement.damping_low = kMinDamping;
  const double high = fit.model.damping + kCoverage * fit.u_damping;
  const double least = kMinDamping + kLeastShare * fit.u_damping;
  judgement.damping_high = permitted(high > least ? high : least);
  judgement.sensitivity_slope = by_s;
  judgement.frequency_slope_hz = by_f0;
  return judgement;
}

}  // namespace

FitJudgement judge(const WlspFit& fit) noexcept {
  // Where mu3 may be 0, f0 may be anything above, and so may a damping: it means nothing then.
  const bool is_overdamped = fit.status == Status::kOverdamped;
  if (fit.status != Status::kOk && fit.status != Status::kNotPhysical && !is_overdamped) {
    return {};
  }
  if (is_sensitivity_alone(fit)) {
    return sensitivity_alone(fit);
  }
  if (is_overdamped) {
    return {};
  }
  if (!(fit.mu[0] > 0.0) || !(fit.mu[2] > 0.0) || !(fit.u_sensitivity > 0.0)) {
    return {};
  }
  if (fit.is_damping_held) {
    return held(fit);
  }
  if (fit.model.damping - kCoverage * fit.u_damping >= kMinDamping) {
    return whole(fit);
  }
  return fit.model.damping + kImpossible * fit.u_damping >= kMinDamping ? constrained(fit)
                                                                        : FitJudgement{};
}

}  // namespace emax
