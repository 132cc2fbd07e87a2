// Measured points of a frequency response with their uncertainties, in a fixed table.
#include "emax/identify/frequency_response.hpp"

#include "emax/base/distributions.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

bool is_relative(double u) noexcept { return u >= 0.0 && u < 1.0; }

Complex inverse_of(double amplitude, double phase_rad) noexcept {
  const SinCos angle = sincos(phase_rad);
  return {angle.cos / amplitude, -angle.sin / amplitude};
}

// J diag(u_A, u_phase): the matrix whose product with its transpose is the covariance.
struct Propagation {
  double re_amplitude;
  double re_phase;
  double im_amplitude;
  double im_phase;
};

Propagation propagation(const ResponsePoint& point) noexcept {
  const SinCos angle = sincos(point.phase_rad);
  const double from_amplitude = point.u_amplitude / point.amplitude / point.amplitude;
  const double from_phase = point.u_phase_rad / point.amplitude;
  return {-angle.cos * from_amplitude, -angle.sin * from_phase, angle.sin * from_amplitude,
          -angle.cos * from_phase};
}

}  // namespace

Status validate(const ResponsePoint& point) noexcept {
  if (!is_finite(point.frequency_hz) || !is_finite(point.amplitude) ||
      !is_finite(point.phase_rad) || !is_finite(point.u_amplitude) ||
      !is_finite(point.u_phase_rad)) {
    return Status::kInvalidArgument;
  }
  if (point.frequency_hz <= 0.0 || point.amplitude <= 0.0) {
    return Status::kInvalidArgument;
  }
  if (point.u_amplitude <= 0.0 || point.u_phase_rad <= 0.0) {
    return Status::kUncertaintyNotPositive;
  }
  return Status::kOk;
}

Status FrequencyResponse::add(const ResponsePoint& point) noexcept {
  const Status status = validate(point);
  if (status != Status::kOk) {
    return status;
  }
  if (count_ == kMaxPoints) {
    return Status::kTooManyPoints;
  }
  if (count_ > 0 && point.frequency_hz <= points_[count_ - 1].frequency_hz) {
    return Status::kNotAscending;
  }
  points_[count_] = point;
  common_[count_] = 0.0;
  ++count_;
  return Status::kOk;
}

Status FrequencyResponse::set_common(double relative_u) noexcept {
  if (!is_relative(relative_u)) {
    return Status::kInvalidArgument;
  }
  for (std::size_t i = 0; i < count_; ++i) {
    common_[i] = relative_u;
  }
  return Status::kOk;
}

Status FrequencyResponse::set_common(Span<const double> relative_u) noexcept {
  if (relative_u.size() != count_) {
    return Status::kInvalidArgument;
  }
  for (const double u : relative_u) {
    if (!is_relative(u)) {
      return Status::kInvalidArgument;
    }
  }
  for (std::size_t i = 0; i < count_; ++i) {
    common_[i] = relative_u[i];
  }
  return Status::kOk;
}

Status FrequencyResponse::set_shared(const SharedEffects& shared) noexcept {
  const double all[] = {shared.skew_s, shared.clock,     shared.drift,     shared.images,
                        shared.leak,   shared.leak_back, shared.linearity, shared.corner_hz};
  for (const double u : all) {
    if (!(u >= 0.0) || !is_finite(u)) {
      return Status::kInvalidArgument;
    }
  }
  shared_ = shared;
  return Status::kOk;
}

Complex shared_at(const SharedEffects& shared, double frequency_hz, double place,
                  double of_highest) noexcept {
  const double drift = shared.drift * (place - 0.5);
  const double images = shared.images * of_highest * of_highest;
  return {sqrt(drift * drift + images * images), kTwoPi * frequency_hz * shared.skew_s};
}

bool FrequencyResponse::has_common() const noexcept {
  for (const double u : common()) {
    if (u > 0.0) {
      return true;
    }
  }
  return false;
}

std::size_t FrequencyResponse::known_phases() const noexcept {
  std::size_t known = 0;
  for (const ResponsePoint& point : points()) {
    known += is_phase_known(point) ? 1U : 0U;
  }
  return known;
}

Complex inverse_response(const ResponsePoint& point) noexcept {
  return inverse_of(point.amplitude, point.phase_rad);
}

ComplexCovariance inverse_covariance(const ResponsePoint& point) noexcept {
  const Propagation p = propagation(point);
  return {p.re_amplitude * p.re_amplitude + p.re_phase * p.re_phase,
          p.re_amplitude * p.im_amplitude + p.re_phase * p.im_phase,
          p.im_amplitude * p.im_amplitude + p.im_phase * p.im_phase};
}

ComplexCholesky inverse_cholesky(const ResponsePoint& point) noexcept {
  const Propagation p = propagation(point);
  const double re_re = sqrt(p.re_amplitude * p.re_amplitude + p.re_phase * p.re_phase);
  const double cross = p.re_amplitude * p.im_amplitude + p.re_phase * p.im_phase;
  // The determinant of the propagation, whose two products have the same sign: no cancellation.
  const double determinant = p.re_amplitude * p.im_phase - p.re_phase * p.im_amplitude;
  return {re_re, cross / re_re, abs(determinant) / re_re};
}

DrawnCovariance inverse_covariance_by_draws(const ResponsePoint& point, std::uint32_t draws,
                                            WichmannHill& generator) noexcept {
  DrawnCovariance result;
  if (draws < 3 || validate(point) != Status::kOk) {
    return result;
  }
  const Complex centre = inverse_response(point);
  Complex sum;
  ComplexCovariance products;
  for (std::uint32_t i = 0; i < draws; ++i) {
    const double u1 = generator.next();
    const double u2 = generator.next();
    const NormalPair normal = box_muller(u1, u2);
    const double amplitude = point.amplitude + point.u_amplitude * normal.first;
    if (!(amplitude > 0.0)) {
      result.status = Status::kNotPhysical;
      return result;
    }
    const Complex d =
        inverse_of(amplitude, point.phase_rad + point.u_phase_rad * normal.second) - centre;
    sum = sum + d;
    products.re_re += d.re * d.re;
    products.re_im += d.re * d.im;
    products.im_im += d.im * d.im;
  }
  const double n = static_cast<double>(draws);
  result.mean = centre + (1.0 / n) * sum;
  result.covariance = {(products.re_re - sum.re * sum.re / n) / (n - 1.0),
                       (products.re_im - sum.re * sum.im / n) / (n - 1.0),
                       (products.im_im - sum.im * sum.im / n) / (n - 1.0)};
  result.status = Status::kOk;
  return result;
}

}  // namespace emax
