// Three-parameter sine approximation: rotation, sums, and a 3x3 system at the end.
#include "emax/identify/sine_fit.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr std::uint64_t kAnchorSamples = 64;
constexpr std::uint64_t kMinSamples = 4;

// A pivot below this share of its diagonal element is nothing but rounding of the sums.
constexpr double kDependent = 1e-10;

SinCos sincos_of_turns(double turns) noexcept { return sincos(kTwoPi * (turns - floor(turns))); }

}  // namespace

Status SineFit::start(double frequency_hz, double sample_rate_hz) noexcept {
  if (!(frequency_hz > 0.0) || !(frequency_hz < 0.5 * sample_rate_hz) ||
      !is_finite(sample_rate_hz) || !(frequency_hz / sample_rate_hz > 0.0)) {
    return Status::kInvalidArgument;
  }
  *this = SineFit();
  frequency_hz_ = frequency_hz;
  sample_rate_hz_ = sample_rate_hz;
  const SinCos step = sincos(kTwoPi * (frequency_hz / sample_rate_hz));
  step_cosine_ = step.cos;
  step_sine_ = step.sin;
  return Status::kOk;
}

void SineFit::add(Span<const double> samples_v) noexcept {
  if (!(sample_rate_hz_ > 0.0)) {
    return;
  }
  for (const double sample_v : samples_v) {
    add_sample(sample_v);
  }
}

void SineFit::add_sample(double sample_v) noexcept {
  if (samples_ % kAnchorSamples == 0) {
    anchor();
  }
  if (samples_ == 0) {
    base_.offset = sample_v;
  }
  const double rest = sample_v - (base_.offset + (base_.cosine * cosine_ + base_.sine * sine_));
  sum_cosine_ += cosine_;
  sum_sine_ += sine_;
  sum_cosine2_ += cosine_ * cosine_;
  sum_cosine_sine_ += cosine_ * sine_;
  sum_rest_ += rest;
  sum_rest_cosine_ += rest * cosine_;
  sum_rest_sine_ += rest * sine_;
  sum_rest2_ += rest * rest;
  const double cosine = cosine_;
  cosine_ = cosine * step_cosine_ - sine_ * step_sine_;
  sine_ = cosine * step_sine_ + sine_ * step_cosine_;
  ++samples_;
}

void SineFit::anchor() noexcept {
  // The product is rounded once, not once per block, so the phase does not drift.
  const SinCos angle =
      sincos_of_turns(static_cast<double>(samples_) * frequency_hz_ / sample_rate_hz_);
  cosine_ = angle.cos;
  sine_ = angle.sin;
  if (!is_rebased_ && samples_ > 0 && is_period_complete()) {
    rebase();
  }
}

bool SineFit::is_period_complete() const noexcept {
  return samples_ >= kMinSamples &&
         static_cast<double>(samples_) * frequency_hz_ >= sample_rate_hz_;
}

// Solves the normal equations for what is left over, by L D L^T.
bool SineFit::solve(Coefficients& change) const noexcept {
  const double n = static_cast<double>(samples_);
  const double sine2 = n - sum_cosine2_;  // cos^2 + sin^2 = 1 at each sample.
  const double l10 = sum_cosine_ / n;
  const double l20 = sum_sine_ / n;
  const double d1 = sum_cosine2_ - l10 * sum_cosine_;
  const double cross = sum_cosine_sine_ - l10 * sum_sine_;
  const double l21 = cross / d1;
  const double d2 = sine2 - l20 * sum_sine_ - l21 * cross;
  if (!(d1 > kDependent * n) || !(d2 > kDependent * n)) {
    return false;
  }
  const double z1 = sum_rest_cosine_ - l10 * sum_rest_;
  const double z2 = sum_rest_sine_ - l20 * sum_rest_ - l21 * z1;
  change.sine = z2 / d2;
  change.cosine = z1 / d1 - l21 * change.sine;
  change.offset = sum_rest_ / n - l10 * change.cosine - l20 * change.sine;
  return true;
}

// Moves the sums so that they are those of the rest after a better fit: small numbers from here on.
void SineFit::rebase() noexcept {
  is_rebased_ = true;
  Coefficients d;
  if (!solve(d)) {
    return;
  }
  const double n = static_cast<double>(samples_);
  const double sine2 = n - sum_cosine2_;
  // At the least squares the sum of squares falls by the change times the right-hand side.
  const double explained =
      d.cosine * sum_rest_cosine_ + d.sine * sum_rest_sine_ + d.offset * sum_rest_;
  sum_rest2_ = sum_rest2_ > explained ? sum_rest2_ - explained : 0.0;
  sum_rest_ -= d.cosine * sum_cosine_ + d.sine * sum_sine_ + d.offset * n;
  sum_rest_cosine_ -= d.cosine * sum_cosine2_ + d.sine * sum_cosine_sine_ + d.offset * sum_cosine_;
  sum_rest_sine_ -= d.cosine * sum_cosine_sine_ + d.sine * sine2 + d.offset * sum_sine_;
  base_.cosine += d.cosine;
  base_.sine += d.sine;
  base_.offset += d.offset;
}

SineFitResult SineFit::result() const noexcept {
  SineFitResult result;
  if (!is_period_complete()) {
    return result;
  }
  result.status = Status::kNotIdentifiable;
  Coefficients d;
  if (!solve(d)) {
    return result;
  }
  const double cosine = base_.cosine + d.cosine;
  const double sine = base_.sine + d.sine;
  const double offset = base_.offset + d.offset;
  const double explained =
      d.cosine * sum_rest_cosine_ + d.sine * sum_rest_sine_ + d.offset * sum_rest_;
  const double left = sum_rest2_ > explained ? sum_rest2_ - explained : 0.0;
  const double amplitude = sqrt(cosine * cosine + sine * sine);
  if (!is_finite(amplitude) || !is_finite(offset) || !is_finite(sum_rest2_)) {
    return result;
  }
  result.status = Status::kOk;
  result.cosine_v = cosine;
  result.sine_v = sine;
  result.offset_v = offset;
  result.amplitude_v = amplitude;
  result.phase_rad = atan2(cosine, sine);
  result.residual_std_v = sqrt(left / static_cast<double>(samples_ - 3));
  result.samples = samples_;
  return result;
}

}  // namespace emax
