// Exact sums of words over a table of 64 frames, turned into a 3x3 system of the whole record.
#include "emax/identify/frame_sine_fit.hpp"

#include "emax/base/units.hpp"

namespace emax {
namespace {

constexpr double kTableScale = 268435456.0;  // 2^28.
constexpr double kTableUnit = 1.0 / kTableScale;
constexpr std::uint64_t kMinFrames = 4;

// A pivot below this share of its diagonal element is nothing but rounding of the sums.
constexpr double kDependent = 1e-10;

std::int32_t table_word(double value) noexcept {
  return static_cast<std::int32_t>(floor(value * kTableScale + 0.5));
}

double of_table(std::int64_t sum) noexcept { return static_cast<double>(sum) * kTableUnit; }

}  // namespace

Status FrameSineFit::start(double frequency_hz, double sample_rate_hz,
                           double volts_per_word) noexcept {
  if (!(frequency_hz > 0.0) || !(frequency_hz < 0.5 * sample_rate_hz) ||
      !(frequency_hz / sample_rate_hz > 0.0) || !(volts_per_word > 0.0)) {
    return Status::kInvalidArgument;
  }
  frequency_hz_ = frequency_hz;
  sample_rate_hz_ = sample_rate_hz;
  unit_v_ = volts_per_word * kWordUnit;
  const SinCos step = phase_of_frame(1);
  SinCos now = {0.0, 1.0};
  for (std::size_t i = 0; i < kTableFrames; ++i) {
    cosine_[i] = table_word(now.cos);
    sine_[i] = table_word(now.sin);
    now = {now.sin * step.cos + now.cos * step.sin, now.cos * step.cos - now.sin * step.sin};
  }
  restart();
  return Status::kOk;
}

void FrameSineFit::restart() noexcept {
  reference_ = Channel();
  device_ = Channel();
  basis_ = BasisSums();
  frames_ = 0;
}

// The product is rounded once, not once per block, so the phase does not drift.
SinCos FrameSineFit::phase_of_frame(std::uint64_t frame) const noexcept {
  const double turns = static_cast<double>(frame) * frequency_hz_ / sample_rate_hz_;
  return sincos(kTwoPi * (turns - floor(turns)));
}

void FrameSineFit::end_table() noexcept {
  const SinCos start = phase_of_frame(frames_ - kTableFrames);
  basis_ = basis_with(kTableFrames, start);
  reference_.end_block(start);
  device_.end_block(start);
}

void FrameSineFit::Channel::end_block(const SinCos& start) noexcept {
  const double along = of_table(block.word_cosine);
  const double across = of_table(block.word_sine);
  word += static_cast<double>(block.word);
  word_cosine += start.cos * along - start.sin * across;
  word_sine += start.sin * along + start.cos * across;
  word2 += static_cast<double>(block.word2);
  block = BlockSums();
}

/// The sums with those of the table's first frames, which begin at this phase.
FrameSineFit::BasisSums FrameSineFit::basis_with(std::size_t frames,
                                                 const SinCos& start) const noexcept {
  std::int64_t cosine = 0;
  std::int64_t sine = 0;
  std::int64_t cosine2 = 0;
  std::int64_t cosine_sine = 0;
  std::int64_t sine2 = 0;
  for (std::size_t i = 0; i < frames; ++i) {
    cosine += cosine_[i];
    sine += sine_[i];
    cosine2 += std::int64_t{cosine_[i]} * cosine_[i];
    cosine_sine += std::int64_t{cosine_[i]} * sine_[i];
    sine2 += std::int64_t{sine_[i]} * sine_[i];
  }
  const double c = start.cos;
  const double s = start.sin;
  const double cc = kTableUnit * of_table(cosine2);
  const double cs = kTableUnit * of_table(cosine_sine);
  const double ss = kTableUnit * of_table(sine2);
  BasisSums sums = basis_;
  sums.cosine += c * of_table(cosine) - s * of_table(sine);
  sums.sine += s * of_table(cosine) + c * of_table(sine);
  sums.cosine2 += c * c * cc - 2.0 * (c * s) * cs + s * s * ss;
  sums.cosine_sine += c * s * (cc - ss) + (c * c - s * s) * cs;
  sums.sine2 += s * s * cc + 2.0 * (c * s) * cs + c * c * ss;
  return sums;
}

SineFitResult FrameSineFit::result(const Channel& channel) const noexcept {
  if (frames_ < kMinFrames || static_cast<double>(frames_) * frequency_hz_ < sample_rate_hz_) {
    return SineFitResult();
  }
  const std::size_t open = frames_ % kTableFrames;
  const SinCos start = phase_of_frame(frames_ - open);
  Channel whole = channel;
  whole.end_block(start);
  return solve(whole, basis_with(open, start));
}

// The normal equations by L D L^T. At the least squares the sum of squares has fallen by the
// coefficients times the right-hand side.
SineFitResult FrameSineFit::solve(const Channel& channel, const BasisSums& basis) const noexcept {
  SineFitResult result;
  result.status = Status::kNotIdentifiable;
  const double n = static_cast<double>(frames_);
  const double l10 = basis.cosine / n;
  const double l20 = basis.sine / n;
  const double d1 = basis.cosine2 - l10 * basis.cosine;
  const double cross = basis.cosine_sine - l10 * basis.sine;
  const double l21 = cross / d1;
  const double d2 = basis.sine2 - l20 * basis.sine - l21 * cross;
  if (!(d1 > kDependent * n) || !(d2 > kDependent * n)) {
    return result;
  }
  const double z1 = channel.word_cosine - l10 * channel.word;
  const double z2 = channel.word_sine - l20 * channel.word - l21 * z1;
  const double sine = z2 / d2;
  const double cosine = z1 / d1 - l21 * sine;
  const double offset = channel.word / n - l10 * cosine - l20 * sine;
  const double explained =
      cosine * channel.word_cosine + sine * channel.word_sine + offset * channel.word;
  const double left = channel.word2 > explained ? channel.word2 - explained : 0.0;
  result.status = Status::kOk;
  result.cosine_v = unit_v_ * cosine;
  result.sine_v = unit_v_ * sine;
  result.offset_v = unit_v_ * (static_cast<double>(channel.base) + offset);
  result.amplitude_v = unit_v_ * sqrt(cosine * cosine + sine * sine);
  result.phase_rad = atan2(cosine, sine);
  result.residual_std_v = unit_v_ * sqrt(left / (n - 3.0));
  result.samples = frames_;
  return result;
}

}  // namespace emax
