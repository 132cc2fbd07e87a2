// Weighted least squares for sensitivity, natural frequency and damping from measured points, with
// covariances.
#include "emax/identify/wlsp.hpp"

#include "emax/base/distributions.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/identify/fit_judgement.hpp"
#include "emax/identify/magnitude_fit.hpp"

namespace emax {
namespace {

constexpr std::size_t kMinPoints = 3;

// A column whose part across the others is smaller than this share of it is dependent: rounding in
// the rotations leaves about 1e-15.
constexpr double kDependent = 1e-12;

double square(double x) noexcept { return x * x; }

bool all_finite(const double (&values)[3]) noexcept {
  return is_finite(values[0]) && is_finite(values[1]) && is_finite(values[2]);
}

bool factor(const ComplexCovariance& c, ComplexCholesky& l) noexcept {
  l.re_re = sqrt(c.re_re);
  l.im_re = c.re_im / l.re_re;
  l.im_im = sqrt(c.im_im - l.im_re * l.im_re);
  return l.re_re > 0.0 && l.im_im > 0.0 && is_finite(l.re_re) && is_finite(l.im_im);
}

// Rotates one row with its right-hand side into the triangle of `size` rows; the row ends as zeros.
void rotate_into(double* r, double* rhs, double* row, std::size_t size, double value) noexcept {
  for (std::size_t k = 0; k < size; ++k) {
    double* upper_row = r + k * size;
    if (row[k] == 0.0) {
      continue;
    }
    const double length = sqrt(upper_row[k] * upper_row[k] + row[k] * row[k]);
    const double c = upper_row[k] / length;
    const double s = row[k] / length;
    for (std::size_t i = k; i < size; ++i) {
      const double upper = upper_row[i];
      upper_row[i] = c * upper + s * row[i];
      row[i] = c * row[i] - s * upper;
    }
    const double upper = rhs[k];
    rhs[k] = c * upper + s * value;
    value = c * value - s * upper;
  }
}

template <std::size_t kSize>
void rotate_in(double (&r)[kSize][kSize], double (&rhs)[kSize], double (&row)[kSize],
               double value) noexcept {
  rotate_into(&r[0][0], rhs, row, kSize, value);
}

template <std::size_t kSize>
void solve_upper(const double (&r)[kSize][kSize], double (&x)[kSize]) noexcept {
  for (std::size_t i = kSize; i-- > 0;) {
    for (std::size_t j = i + 1; j < kSize; ++j) {
      x[i] -= r[i][j] * x[j];
    }
    x[i] = x[i] / r[i][i];
  }
}

void solve_transposed(const double (&r)[3][3], double (&x)[3]) noexcept {
  x[0] = x[0] / r[0][0];
  x[1] = (x[1] - r[0][1] * x[0]) / r[1][1];
  x[2] = (x[2] - r[0][2] * x[0] - r[1][2] * x[1]) / r[2][2];
}

bool independent(const double (&r)[3][3]) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    double squares = 0.0;
    for (std::size_t i = 0; i <= k; ++i) {
      squares += r[i][k] * r[i][k];
    }
    if (!is_finite(squares) || !(abs(r[k][k]) > kDependent * sqrt(squares))) {
      return false;
    }
  }
  return true;
}

}  // namespace

Status Wlsp::fit(const FrequencyResponse& response) noexcept {
  const Status status = load(response);
  if (status != Status::kOk) {
    return status;
  }
  const bool knows_all = response_.known_phases() == response_.size();
  const Status solved = !knows_all                       ? solve_without_phases()
                        : factor_points() == Status::kOk ? solve()
                                                         : reject(Status::kNotIdentifiable);
  return may_hold_given() ? hold_given() : solved;
}

// The damping given is among those that the points leave open, whose end is printed in three
// digits.
bool Wlsp::may_hold_given() const noexcept {
  if (!(given_damping_ >= kMinDamping) || held_damping_ > 0.0) {
    return false;
  }
  const FitJudgement judgement = judge(fit_);
  constexpr double kRoundedUp = 1.005;
  return judgement.determined == Determined::kAllButDamping && given_damping_ < 1.0 &&
         given_damping_ <= kRoundedUp * judgement.damping_high;
}

Status Wlsp::hold_given() noexcept {
  held_damping_ = given_damping_;
  is_damping_given_ = true;
  double scaled[3] = {scaled_[0], held_damping_ * sqrt(scaled_[0] * scaled_[2]), scaled_[2]};
  if (iterate_phases(scaled) == Status::kOk) {
    finish_without_phases();
  }
  return fit_.status;
}

Status Wlsp::factor_points() noexcept {
  for (std::size_t i = 0; i < response_.size(); ++i) {
    factors_[i] = inverse_cholesky(response_.points()[i]);
    if (!(factors_[i].re_re > 0.0) || !(factors_[i].im_im > 0.0)) {
      return Status::kNotIdentifiable;
    }
  }
  return Status::kOk;
}

Status Wlsp::fit(const FrequencyResponse& response,
                 Span<const ComplexCovariance> covariances) noexcept {
  const Status status = load(response);
  if (status != Status::kOk) {
    return status;
  }
  if (covariances.size() != response_.size()) {
    return reject(Status::kInvalidArgument);
  }
  for (std::size_t i = 0; i < response_.size(); ++i) {
    if (!factor(covariances[i], factors_[i])) {
      return reject(Status::kInvalidArgument);
    }
  }
  return solve();
}

Status Wlsp::load(const FrequencyResponse& response) noexcept {
  if (response.size() < kMinPoints) {
    return reject(Status::kTooFewPoints);
  }
  response_ = response;
  has_common_ = response.has_common();
  max_frequency_hz_ = response_.points()[response_.size() - 1].frequency_hz;
  largest_amplitude_ = 0.0;
  for (const ResponsePoint& point : response_.points()) {
    largest_amplitude_ =
        point.amplitude > largest_amplitude_ ? point.amplitude : largest_amplitude_;
  }
  held_damping_ = 0.0;
  fit_ = WlspFit();
  return Status::kOk;
}

Status Wlsp::reject(Status status) noexcept {
  if (status == Status::kTooFewPoints || status == Status::kInvalidArgument) {
    response_.clear();
  }
  fit_ = WlspFit();
  fit_.status = status;
  return status;
}

Status Wlsp::solve() noexcept {
  double scaled[3] = {};
  if (!triangularise(scaled) || !independent(r_)) {
    return reject(Status::kNotIdentifiable);
  }
  solve_upper(r_, scaled);
  if (!all_finite(scaled)) {
    return reject(Status::kNotIdentifiable);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    first_scaled_[k] = scaled[k];
  }
  if (has_common_) {
    if (!triangularise_with_common(scaled) || !independent(r_)) {
      return reject(Status::kNotIdentifiable);
    }
    solve_upper(r_, scaled);
    if (!all_finite(scaled)) {
      return reject(Status::kNotIdentifiable);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    scaled_[k] = scaled[k];
  }
  const double w_max = kTwoPi * max_frequency_hz_;
  fit_.mu[0] = scaled[0];
  fit_.mu[1] = scaled[1] / w_max;
  fit_.mu[2] = scaled[2] / w_max / w_max;
  set_mu_uncertainties();
  fit_.dof = static_cast<std::uint32_t>(2 * response_.size() - kWlspParameters);
  fit_.common_effect = common_effect_of(scaled_);
  explain_by_shared();
  fit_.chi2 = chi_square_of_scaled(scaled_, fit_.common_effect);
  fit_.birge_ratio = sqrt(fit_.chi2 / static_cast<double>(fit_.dof));
  if (!all_finite(fit_.mu) || !is_finite(fit_.chi2)) {
    return reject(Status::kNotIdentifiable);
  }
  if (!(scaled[0] * scaled[2] > 0.0)) {
    fit_.status = Status::kNotPhysical;
    return fit_.status;
  }
  if (!fill_estimates()) {
    return reject(Status::kNotIdentifiable);
  }
  fit_.status = Status::kOk;
  if (!(fit_.model.damping > 0.0)) {
    fit_.status = Status::kNotPhysical;
  } else if (scaled[0] < 0.0) {
    fit_.status = Status::kInvertedPolarity;
  } else if (fit_.model.damping >= 1.0) {
    fit_.status = Status::kOverdamped;
  }
  return fit_.status;
}

void Wlsp::set_mu_uncertainties() noexcept {
  const double w_max = kTwoPi * max_frequency_hz_;
  double scale = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    double row[3] = {};
    row[k] = 1.0;
    solve_transposed(r_, row);
    fit_.u_mu[k] = sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]) / scale;
    scale *= w_max;
  }
}

Status Wlsp::solve_without_phases() noexcept {
  double scaled[3] = {};
  Status status = begin_without_phases(scaled);
  if (status != Status::kOk) {
    return status;
  }
  status = iterate_phases(scaled);
  if (status == Status::kOk || status == Status::kNotPhysical || status == Status::kOverdamped) {
    finish_without_phases();
  }
  return fit_.status;
}

// A model to take the first phases from, and whether the damping is held.
Status Wlsp::begin_without_phases(double (&scaled)[3]) noexcept {
  const MagnitudeFit fit = fit_magnitudes(response_);
  const bool has_no_phase = response_.known_phases() == 0;
  const bool is_given = given_damping_ >= kMinDamping && given_damping_ < 1.0;
  if (has_no_phase && !fit.is_found) {
    return reject(Status::kNotIdentifiable);
  }
  const bool has_damping =
      fit.has_frequency() && fit.damping2 - 2.0 * fit.u_damping2 >= kMinDamping * kMinDamping;
  if (has_no_phase && !has_damping) {
    if (!fit.has_frequency() && !is_given) {
      return sensitivity_alone(fit.a[0], fit.u[0]);
    }
    const double fitted = sqrt(fit.damping2 > 0.0 ? fit.damping2 : 0.0);
    held_damping_ = is_given ? given_damping_ : fitted > kMinDamping ? fitted : kMinDamping;
    is_damping_given_ = is_given;
  }
  const bool has_start = fit.is_found && fit.a[0] > 0.0 && fit.has_frequency();
  const double a0 = fit.a[0] > 0.0 ? fit.a[0] : 1.0 / square(response_.points()[0].amplitude);
  // Without a start of its own the resonance is put at twice the highest frequency.
  const double a2 = has_start ? fit.a[2] : a0 / 16.0;
  const double least = has_no_phase ? kMinDamping : 0.01;
  const double free = sqrt(fit.damping2 > least * least ? fit.damping2 : least * least);
  scaled[0] = sqrt(a0);
  scaled[2] = sqrt(a2);
  scaled[1] = (held_damping_ > 0.0 ? held_damping_ : free) * sqrt(scaled[0] * scaled[2]);
  damping2_ = has_no_phase ? fit.damping2 : 0.0;
  u_damping2_ = has_no_phase ? fit.u_damping2 : 0.0;
  return Status::kOk;
}

Status Wlsp::iterate_phases(double (&scaled)[3]) noexcept {
  constexpr int kIterations = 60;
  constexpr double kAtRest = 1e-13;
  for (int i = 0; i < kIterations; ++i) {
    take_phases_from(scaled);
    aim_hold(scaled);
    if (factor_points() != Status::kOk) {
      return reject(Status::kNotIdentifiable);
    }
    const Status status = solve();
    if (status != Status::kOk && status != Status::kNotPhysical && status != Status::kOverdamped) {
      return status;
    }
    double change = 0.0;
    double size = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      change += abs(scaled_[k] - scaled[k]);
      size += abs(scaled_[k]);
      scaled[k] = scaled_[k];
    }
    if (change <= kAtRest * size) {
      return status;
    }
    if (held_damping_ > 0.0 && !(scaled[0] > 0.0 && scaled[2] > 0.0)) {
      return reject(Status::kNotIdentifiable);
    }
  }
  return reject(Status::kNotIdentifiable);
}

void Wlsp::take_phases_from(const double (&scaled)[3]) noexcept {
  for (std::size_t i = 0; i < response_.size(); ++i) {
    const ResponsePoint& point = response_.points()[i];
    if (!is_phase_known(point)) {
      const double w = point.frequency_hz / max_frequency_hz_;
      response_.set_unknown_phase(i, -atan2(2.0 * w * scaled[1], scaled[0] - w * w * scaled[2]));
    }
  }
}

// mu2 = beta sqrt(mu1 mu3) to first order about the last estimates; homogeneous, so without a
// constant.
void Wlsp::aim_hold(const double (&scaled)[3]) noexcept {
  if (!(held_damping_ > 0.0)) {
    return;
  }
  const double ratio = sqrt(scaled[2] / scaled[0]);
  hold_[0] = -0.5 * held_damping_ * ratio;
  hold_[1] = 1.0;
  hold_[2] = -0.5 * held_damping_ / ratio;
}

void Wlsp::finish_without_phases() noexcept {
  const bool is_held = held_damping_ > 0.0;
  const std::size_t unknown = response_.size() - response_.known_phases();
  const std::size_t equations = 2 * response_.size() - unknown + (is_held ? 1U : 0U);
  fit_.dof =
      static_cast<std::uint32_t>(equations > kWlspParameters ? equations - kWlspParameters : 0U);
  fit_.birge_ratio = fit_.dof == 0 ? 0.0 : sqrt(fit_.chi2 / static_cast<double>(fit_.dof));
  fit_.unknown_phases = static_cast<std::uint32_t>(unknown);
  fit_.damping2 = damping2_;
  fit_.u_damping2 = u_damping2_;
  fit_.is_damping_held = is_held;
  fit_.is_damping_given = is_held && is_damping_given_;
  if (is_held && fit_.status == Status::kOk) {
    fit_.model.damping = held_damping_;
    fit_.u_damping = 0.0;
    for (std::size_t i = 0; i < kWlspParameters; ++i) {
      fit_.covariance[i][2] = 0.0;
      fit_.covariance[2][i] = 0.0;
    }
  }
}

// f0 may be anywhere above the points: `judge()` reads that from mu3 = 0 with an uncertainty.
Status Wlsp::sensitivity_alone(double a0, double u_a0) noexcept {
  if (!(a0 > 2.0 * u_a0)) {
    return reject(Status::kNotIdentifiable);
  }
  fit_ = WlspFit();
  fit_.status = Status::kNotPhysical;
  fit_.unknown_phases = static_cast<std::uint32_t>(response_.size());
  fit_.mu[0] = sqrt(a0);
  fit_.u_mu[0] = 0.5 * u_a0 / fit_.mu[0];
  fit_.u_mu[2] = fit_.mu[0] / square(kTwoPi * max_frequency_hz_);
  return fit_.status;
}

bool Wlsp::triangularise(double (&rhs)[3]) noexcept {
  for (auto& row : r_) {
    row[0] = row[1] = row[2] = 0.0;
  }
  for (std::size_t i = 0; i < response_.size(); ++i) {
    const Columns a = whitened_columns(i);
    const Complex b = whiten(i, inverse_response(response_.points()[i]));
    double real[3] = {a.column[0].re, a.column[1].re, a.column[2].re};
    double imaginary[3] = {a.column[0].im, a.column[1].im, a.column[2].im};
    if (!all_finite(real) || !all_finite(imaginary) || !is_finite(b.re) || !is_finite(b.im)) {
      return false;
    }
    rotate_in(r_, rhs, real, b.re);
    rotate_in(r_, rhs, imaginary, b.im);
  }
  if (held_damping_ > 0.0) {
    // Heavy enough to hold, light enough to leave digits to the rest.
    constexpr double kWeight = 1e4;
    const double weight = kWeight * abs(r_[0][0]);
    double row[3] = {weight * hold_[0], weight * hold_[1], weight * hold_[2]};
    rotate_in(r_, rhs, row, 0.0);
  }
  return all_finite(rhs);
}

bool Wlsp::triangularise_with_common(double (&rhs)[3]) noexcept {
  // The column of the common effect first, and its own observation as the first row.
  double r[4][4] = {{1.0, 0.0, 0.0, 0.0}};
  double full_rhs[4] = {};
  common_squares_ = 1.0;
  for (std::size_t i = 0; i < response_.size(); ++i) {
    const Columns a = whitened_columns(i);
    const Complex b = whiten(i, inverse_response(response_.points()[i]));
    const Complex c = whitened_common(i);
    double real[4] = {c.re, a.column[0].re, a.column[1].re, a.column[2].re};
    double imaginary[4] = {c.im, a.column[0].im, a.column[1].im, a.column[2].im};
    common_squares_ += norm(c);
    rotate_in(r, full_rhs, real, b.re);
    rotate_in(r, full_rhs, imaginary, b.im);
  }
  if (held_damping_ > 0.0) {
    constexpr double kWeight = 1e4;
    const double weight = kWeight * sqrt(r[0][1] * r[0][1] + r[1][1] * r[1][1]);
    double row[4] = {0.0, weight * hold_[0], weight * hold_[1], weight * hold_[2]};
    rotate_in(r, full_rhs, row, 0.0);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t j = 0; j < 3; ++j) {
      r_[k][j] = r[k + 1][j + 1];
    }
    rhs[k] = full_rhs[k + 1];
  }
  return all_finite(rhs) && is_finite(common_squares_);
}

bool Wlsp::fill_estimates() noexcept {
  const double root = (scaled_[0] < 0.0 ? -1.0 : 1.0) * sqrt(scaled_[0] * scaled_[2]);
  const double f0_hz = max_frequency_hz_ * sqrt(scaled_[0] / scaled_[2]);
  const double beta = scaled_[1] / root;
  fit_.model = {1.0 / scaled_[0], f0_hz, beta};

  const double jacobian[3][3] = {
      {-1.0 / (scaled_[0] * scaled_[0]), 0.0, 0.0},
      {0.5 * f0_hz / scaled_[0], 0.0, -0.5 * f0_hz / scaled_[2]},
      {-0.5 * beta / scaled_[0], 1.0 / root, -0.5 * beta / scaled_[2]},
  };
  // The covariance of the scaled mu is (R^T R)^-1, so that of the estimates is T T^T with T = J
  // R^-1.
  double t[3][3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    double row[3] = {jacobian[i][0], jacobian[i][1], jacobian[i][2]};
    solve_transposed(r_, row);
    for (std::size_t k = 0; k < 3; ++k) {
      t[i][k] = row[k];
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      fit_.covariance[i][j] = t[i][0] * t[j][0] + t[i][1] * t[j][1] + t[i][2] * t[j][2];
    }
  }
  add_shared(fit_.covariance);
  fit_.u_sensitivity = sqrt(fit_.covariance[0][0]);
  fit_.u_natural_frequency_hz = sqrt(fit_.covariance[1][1]);
  fit_.u_damping = sqrt(fit_.covariance[2][2]);
  const double uncertainties[3] = {fit_.u_sensitivity, fit_.u_natural_frequency_hz, fit_.u_damping};
  return is_finite(fit_.model.sensitivity) && is_finite(f0_hz) && is_finite(beta) &&
         all_finite(uncertainties);
}

// In the time of the sweep, from 0 to 1: the middle of a point.
double Wlsp::place_of(std::size_t index) const noexcept {
  const Span<const ResponsePoint> points = response_.points();
  double before = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double time = time_of(points[i].frequency_hz, response_.shared().corner_hz);
    before += i < index ? time : 0.0;
    before += i == index ? 0.5 * time : 0.0;
    all += time;
  }
  return before / all;
}

// Of 1/K of the fit at a point, by the effect in the size of its uncertainty. An error of the
// amplitude changes 1/K by as much of it, one of the phase turns it.
Complex Wlsp::change_of(Effect effect, std::size_t index) const noexcept {
  const SharedEffects& shared = response_.shared();
  const ResponsePoint& point = response_.points()[index];
  const double w = point.frequency_hz / max_frequency_hz_;
  const Complex y = inverse_at(index, scaled_);
  const double share = point.amplitude / largest_amplitude_;
  const double angle = kTwoPi * point.frequency_hz * shared.skew_s;
  switch (effect) {
    case Effect::kSkew:
      return {y.im * angle, -y.re * angle};
    case Effect::kDrift:
      return -shared.drift * (place_of(index) - 0.5) * y;
    case Effect::kImages:
      return -shared.images * w * w * y;
    case Effect::kLeak:
      return -shared.leak * (y * y);
    case Effect::kLeakBack:
      return {shared.leak_back, 0.0};
    case Effect::kLinearity:
      return -shared.linearity * share * share * y;
  }
  return {};
}

// Adds what a change of 1/K at a point is in the normal equations, whose right-hand side is A^T z
// for the whitened change z, without the common part's share of it.
void Wlsp::add_to(NormalStep& step, std::size_t index, const Complex& change) const noexcept {
  const Complex z = whiten(index, change);
  const Columns a = whitened_columns(index);
  for (std::size_t k = 0; k < 3; ++k) {
    step.x[k] += a.column[k].re * z.re + a.column[k].im * z.im;
  }
  if (has_common_) {
    const Complex c = whitened_common(index);
    step.common_z += c.re * z.re + c.im * z.im;
    for (std::size_t k = 0; k < 3; ++k) {
      step.columns_common[k] += a.column[k].re * c.re + a.column[k].im * c.im;
    }
  }
}

// x becomes the change of the scaled mu, common_z that of the common effect.
void Wlsp::solve_step(NormalStep& step) const noexcept {
  if (has_common_) {
    for (std::size_t k = 0; k < 3; ++k) {
      step.x[k] -= step.columns_common[k] * (step.common_z / common_squares_);
    }
  }
  solve_transposed(r_, step.x);
  solve_upper(r_, step.x);
  for (std::size_t k = 0; k < 3; ++k) {
    step.common_z -= step.columns_common[k] * step.x[k];
  }
  step.common_z = has_common_ ? step.common_z / common_squares_ : 0.0;
}

// What the effect makes of the scaled mu and of the common effect, with the weights of the fit: one
// step of its normal equations.
Wlsp::NormalStep Wlsp::step_of(Effect effect) const noexcept {
  NormalStep step;
  for (std::size_t i = 0; i < response_.size(); ++i) {
    add_to(step, i, change_of(effect, i));
  }
  solve_step(step);
  return step;
}

void Wlsp::add_effect(Effect effect, double (&covariance)[3][3]) const noexcept {
  const NormalStep step = step_of(effect);
  const double* x = step.x;
  const double d0 = x[0] / scaled_[0];
  const double d2 = x[2] / scaled_[2];
  const double d[3] = {-d0 / scaled_[0],
                       0.5 * max_frequency_hz_ * sqrt(scaled_[0] / scaled_[2]) * (d0 - d2),
                       (x[1] - 0.5 * scaled_[1] * (d0 + d2)) / sqrt(scaled_[0] * scaled_[2])};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      covariance[i][j] += d[i] * d[j];
    }
  }
}

// The points' own uncertainties know of drift, images and skew, not of leak and linearity. What no
// change of the parameters takes up of those stays in the residuals, and that of a skew is at all
// points of one size, as no scatter is. Each is one number of a
// standard normal distribution, the same at all points: chi-square is judged at those numbers that
// make it least, which is chi-square with the whole covariance. The parameters move along: it is
// that of the fit with that covariance, and not that of the estimates, which do not move.
void Wlsp::explain_by_shared() noexcept {
  is_explained_ = false;
  explained_ = {};
  const SharedEffects& shared = response_.shared();
  if (!shared.is_explained()) {
    return;
  }
  Explained parts[kExplained] = {};
  double r[kExplained][kExplained] = {};
  double rhs[kExplained] = {};
  double rows[2][kExplained] = {};
  for (std::size_t k = 0; k < kExplained; ++k) {
    const NormalStep step = step_of(explained_by(k));
    parts[k] = {{}, {step.x[0], step.x[1], step.x[2]}, step.common_z};
    parts[k].size[k] = 1.0;
    r[k][k] = 1.0;
    rows[0][k] = parts[k].common;
  }
  rotate_in(r, rhs, rows[0], fit_.common_effect);
  for (std::size_t i = 0; i < response_.size(); ++i) {
    for (std::size_t k = 0; k < kExplained; ++k) {
      const Complex left = left_over(parts[k], i);
      rows[0][k] = left.re;
      rows[1][k] = left.im;
    }
    const Complex residual = normalised_residual(i);
    rotate_in(r, rhs, rows[0], residual.re);
    rotate_in(r, rhs, rows[1], residual.im);
  }
  solve_upper(r, rhs);
  for (std::size_t k = 0; k < kExplained; ++k) {
    explained_.size[k] = rhs[k];
    explained_.common += rhs[k] * parts[k].common;
    for (std::size_t j = 0; j < 3; ++j) {
      explained_.x[j] += rhs[k] * parts[k].x[j];
    }
  }
  is_explained_ = true;
}

// Whitened: what parameters and common part do not take up of leak and linearity of these sizes.
Complex Wlsp::left_over(const Explained& explained, std::size_t index) const noexcept {
  Complex change;
  for (std::size_t k = 0; k < kExplained; ++k) {
    change = change + explained.size[k] * change_of(explained_by(k), index);
  }
  change = whiten(index, change - inverse_at(index, explained.x));
  return without_common(index, change, explained.common);
}

void Wlsp::add_shared(double (&covariance)[3][3]) const noexcept {
  const SharedEffects& shared = response_.shared();
  const double sizes[] = {shared.skew_s, shared.drift,     shared.images,
                          shared.leak,   shared.leak_back, shared.linearity};
  for (std::size_t k = 0; k < 6; ++k) {
    if (sizes[k] > 0.0) {
      add_effect(static_cast<Effect>(k), covariance);
    }
  }
  const double f0_u = max_frequency_hz_ * sqrt(abs(scaled_[0] / scaled_[2])) * shared.clock;
  covariance[1][1] += f0_u * f0_u;
}

// Relative changes of 1/K: their real part is one of the amplitude, their imaginary part a turn.
Complex Wlsp::shared_beside(std::size_t index) const noexcept {
  const Complex y = inverse_at(index, scaled_);
  const double clock = response_.shared().clock;
  Complex change = {2.0 * clock * (y.re - scaled_[0]), clock * y.im};  // By f d(1/K)/df.
  Complex squares;
  for (std::size_t k = 0;; ++k) {
    const Complex relative = change / y;
    squares = squares + Complex{square(relative.re), square(relative.im)};
    if (k == kBeside) {
      return {sqrt(squares.re), sqrt(squares.im)};
    }
    change = change_of(explained_by(k), index);
  }
}

Complex Wlsp::whiten(std::size_t index, const Complex& value) const noexcept {
  const ComplexCholesky& l = factors_[index];
  const double re = value.re / l.re_re;
  return {re, (value.im - l.im_re * re) / l.im_im};
}

Wlsp::Columns Wlsp::whitened_columns(std::size_t index) const noexcept {
  const double w = response_.points()[index].frequency_hz / max_frequency_hz_;
  return {{whiten(index, {1.0, 0.0}), whiten(index, {0.0, 2.0 * w}), whiten(index, {-w * w, 0.0})}};
}

Complex Wlsp::whitened_common(std::size_t index) const noexcept {
  return whiten(index, -response_.common()[index] * inverse_at(index, first_scaled_));
}

// Out of line, for their size, as the next one.
[[gnu::noinline]] Complex Wlsp::without_common(std::size_t index, const Complex& value,
                                               double effect) const noexcept {
  return has_common_ ? value - effect * whitened_common(index) : value;
}

[[gnu::noinline]] Complex Wlsp::inverse_at(std::size_t index,
                                           const double (&scaled)[3]) const noexcept {
  const double w = response_.points()[index].frequency_hz / max_frequency_hz_;
  return {scaled[0] - w * w * scaled[2], 2.0 * w * scaled[1]};
}

double Wlsp::common_effect_of(const double (&scaled)[3]) const noexcept {
  if (!has_common_) {
    return 0.0;
  }
  // The z that makes |residual - c z|^2 + z^2 least.
  double product = 0.0;
  for (std::size_t i = 0; i < response_.size(); ++i) {
    const Complex c = whitened_common(i);
    const Complex residual = whitened_residual(i, scaled);
    product += c.re * residual.re + c.im * residual.im;
  }
  return product / common_squares_;
}

Complex Wlsp::whitened_residual(std::size_t index, const double (&scaled)[3]) const noexcept {
  return whiten(index, inverse_response(response_.points()[index]) - inverse_at(index, scaled));
}

double Wlsp::chi_square_of_scaled(const double (&scaled)[3], double common_effect) const noexcept {
  const double common = common_effect - explained_.common;
  double sum = common * common;
  for (const double size : explained_.size) {
    sum += size * size;
  }
  for (std::size_t i = 0; i < response_.size(); ++i) {
    sum += norm(explained_residual(i, scaled, common_effect));
  }
  return sum;
}

Complex Wlsp::explained_residual(std::size_t index, const double (&scaled)[3],
                                 double common_effect) const noexcept {
  const Complex residual = without_common(index, whitened_residual(index, scaled), common_effect);
  return is_explained_ ? residual - left_over(explained_, index) : residual;
}

Complex Wlsp::normalised_residual(std::size_t index) const noexcept {
  return explained_residual(index, scaled_, fit_.common_effect);
}

double Wlsp::chi_square_of(const Accelerometer& model) const noexcept {
  const double ratio = max_frequency_hz_ / model.natural_frequency_hz;
  const double scaled[3] = {1.0 / model.sensitivity, model.damping * ratio / model.sensitivity,
                            ratio * ratio / model.sensitivity};
  return chi_square_of_scaled(scaled, common_effect_of(scaled));
}

Status WlspDraws::start(const Wlsp& fit, std::uint32_t draws,
                        const WichmannHill& generator) noexcept {
  const bool has_device = fit.result().mu[0] > 0.0 && fit.result().u_sensitivity > 0.0;
  const bool lacks_damping = fit.result().status == Status::kNotPhysical && has_device;
  if (fit.result().status != Status::kOk && !lacks_damping) {
    return fit.result().status;
  }
  if (fit.response().size() == 0) {
    return Status::kTooFewPoints;
  }
  if (draws < 2) {
    return Status::kInvalidArgument;
  }
  *this = WlspDraws();
  fit.add_shared(shared_);
  generator_ = generator;
  wanted_ = draws;
  const Accelerometer& model = fit.result().model;
  estimate_[0] = model.sensitivity;
  estimate_[1] = model.natural_frequency_hz;
  estimate_[2] = model.damping;
  return Status::kOk;
}

void WlspDraws::step(const Wlsp& fit, std::uint32_t count) noexcept {
  const std::uint32_t left = wanted_ - made_;
  const std::uint32_t end = made_ + (count < left ? count : left);
  while (made_ < end) {
    add(draw(fit, generator_));
  }
}

void WlspDraws::add(const WlspDeviation& deviation) noexcept {
  ++made_;
  if (!deviation.is_device) {
    ++discarded_;
    return;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    sum_[i] += deviation.parameters[i];
    for (std::size_t j = 0; j < 3; ++j) {
      products_[i][j] += deviation.parameters[i] * deviation.parameters[j];
    }
  }
}

void WlspDraws::look_ahead(const Wlsp& fit, std::uint32_t skipped,
                           Span<WlspDeviation> deviations) const noexcept {
  WichmannHill generator = generator_;
  generator.jump(numbers_per_draw(fit) * skipped);
  for (WlspDeviation& deviation : deviations) {
    deviation = draw(fit, generator);
  }
}

void WlspDraws::take(const Wlsp& fit, Span<const WlspDeviation> deviations) noexcept {
  generator_.jump(numbers_per_draw(fit) * deviations.size());
  for (const WlspDeviation& deviation : deviations) {
    add(deviation);
  }
}

std::uint64_t WlspDraws::numbers_per_draw(const Wlsp& fit) noexcept {
  return 2 * (std::uint64_t{fit.response_.size()} + (fit.has_common_ ? 1U : 0U));
}

WlspDeviation WlspDraws::draw(const Wlsp& fit, WichmannHill& generator) const noexcept {
  // For the difference from the measured values: small numbers, so that solving with R^T R loses
  // nothing that matters.
  Wlsp::NormalStep step;
  bool possible = true;
  double together = 0.0;
  if (fit.has_common_) {
    const double u1 = generator.next();
    const double u2 = generator.next();
    together = box_muller(u1, u2).first;
  }
  for (std::size_t i = 0; i < fit.response_.size(); ++i) {
    const ResponsePoint& measured = fit.response_.points()[i];
    const double u1 = generator.next();
    const double u2 = generator.next();
    const NormalPair normal = box_muller(u1, u2);
    ResponsePoint drawn = measured;
    drawn.amplitude += drawn.u_amplitude * normal.first;
    drawn.amplitude *= 1.0 + fit.response_.common()[i] * together;
    // A phase that is the model's own is no observation, so it does not scatter.
    drawn.phase_rad += is_phase_known(drawn) ? drawn.u_phase_rad * normal.second : 0.0;
    if (!(drawn.amplitude > 0.0)) {
      possible = false;  // The other points still take their numbers: each draw keeps its place in
                         // the sequence.
      continue;
    }
    fit.add_to(step, i, inverse_response(drawn) - inverse_response(measured));
  }
  fit.solve_step(step);
  const double* x = step.x;
  const double scaled[3] = {fit.scaled_[0] + x[0], fit.scaled_[1] + x[1], fit.scaled_[2] + x[2]};
  if (!possible || !(scaled[0] > 0.0) || !(scaled[2] > 0.0) || !all_finite(scaled)) {
    return {};
  }
  return {{1.0 / scaled[0] - estimate_[0],
           fit.max_frequency_hz_ * sqrt(scaled[0] / scaled[2]) - estimate_[1],
           scaled[1] / sqrt(scaled[0] * scaled[2]) - estimate_[2]},
          true};
}

WlspDrawsResult WlspDraws::result() const noexcept {
  WlspDrawsResult result;
  result.draws = made_ - discarded_;
  result.discarded = discarded_;
  if (result.draws == 0) {
    return result;
  }
  const double n = static_cast<double>(result.draws);
  for (std::size_t i = 0; i < 3; ++i) {
    result.mean[i] = estimate_[i] + sum_[i] / n;
    if (result.draws < 2) {
      continue;
    }
    for (std::size_t j = 0; j < 3; ++j) {
      result.covariance[i][j] =
          (products_[i][j] - sum_[i] * sum_[j] / n) / (n - 1.0) + shared_[i][j];
    }
  }
  return result;
}

}  // namespace emax
