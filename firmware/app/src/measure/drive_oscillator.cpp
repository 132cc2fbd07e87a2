// The drive's phase, ramps and words.
#include "emax/app/measure/drive_oscillator.hpp"

#include <algorithm>

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::app {
namespace {

constexpr std::uint32_t kMinRampFrames = 256;
constexpr double kSineShare = 0.9;   // Of the slope.
constexpr double kRampShare = 0.09;  // The rest covers rounding to words.
constexpr double kSteepest = 1.5;    // Slope of a^2 (3 - 2a) in the middle.
constexpr double kAmplitudeShare = 0.999;
constexpr double kLowShare = 0.0625;  // From which a slow rise at another frequency begins.

}  // namespace

void DriveOscillator::configure(const hal::StreamFormat& format, double limit_v,
                                double slew_v_per_s) noexcept {
  *this = DriveOscillator();
  step_cosine_ = 1.0;
  sample_rate_hz_ = format.sample_rate_hz;
  full_scale_v_ = format.drive_full_scale_v;
  limit_v_ = limit_v;
  step_v_ = slew_v_per_s / format.sample_rate_hz;
}

double DriveOscillator::max_amplitude_v(double frequency_hz) const noexcept {
  const double by_limit = kAmplitudeShare * limit_v_;
  const double by_slope = kSineShare * step_v_ / (2.0 * sin(kPi * frequency_hz / sample_rate_hz_));
  return by_limit < by_slope ? by_limit : by_slope;
}

std::uint32_t DriveOscillator::ramp_frames(double change_v, double rise_s) const noexcept {
  if (change_v == 0.0) {
    return 0;
  }
  const double by_slope = kSteepest * abs(change_v) / (kRampShare * step_v_);
  const double by_period = frequency_hz_ > 0.0 ? sample_rate_hz_ / frequency_hz_ : 0.0;
  const double least = std::max(by_period, change_v > 0.0 ? rise_s * sample_rate_hz_ : 0.0);
  const double frames = by_slope > least ? by_slope : least;
  return frames > kMinRampFrames ? static_cast<std::uint32_t>(frames) + 1u : kMinRampFrames;
}

double DriveOscillator::present_v() const noexcept {
  if (down_.frames == 0 && up_.frames == 0) {
    return from_v_;
  }
  const Ramp& ramp = down_.frames > 0 ? down_ : up_;
  const double a = static_cast<double>(ramp_frame_) / static_cast<double>(ramp.frames);
  return from_v_ + (ramp.to_v - from_v_) * (a * a * (3.0 - 2.0 * a));
}

std::uint32_t DriveOscillator::go_to(double frequency_hz, double amplitude_v,
                                     double rise_s) noexcept {
  from_v_ = present_v();  // A ramp that still runs is left where it is now.
  down_ = Ramp();
  up_ = Ramp();
  ramp_frame_ = 0;
  target_v_ = amplitude_v;
  next_frequency_hz_ = frequency_hz;
  if (frequency_hz_ == frequency_hz) {
    up_ = {amplitude_v, ramp_frames(amplitude_v - from_v_, rise_s)};
    return up_.frames;
  }
  const double least_v = amplitude_v < from_v_ ? amplitude_v : from_v_;
  const double between_v = rise_s > 0.0 ? kLowShare * least_v : least_v;
  down_ = {between_v, ramp_frames(between_v - from_v_, 0.0)};
  if (down_.frames == 0) {
    set_frequency(frequency_hz);
  }
  up_ = {amplitude_v, ramp_frames(amplitude_v - between_v, rise_s)};
  return down_.frames + up_.frames;
}

void DriveOscillator::set_frequency(double frequency_hz) noexcept {
  const double turns =
      start_turns_ + static_cast<double>(frames_) * frequency_hz_ / sample_rate_hz_;
  start_turns_ = turns - floor(turns);
  frames_ = 0;
  frequency_hz_ = frequency_hz;
  const SinCos step = sincos(kTwoPi * (frequency_hz / sample_rate_hz_));
  step_cosine_ = step.cos;
  step_sine_ = step.sin;
}

void DriveOscillator::fill(Span<hal::Word> block) noexcept {
  while (!block.empty()) {
    std::size_t count = block.size();
    const Ramp& ramp = down_.frames > 0 ? down_ : up_;
    if (ramp.frames > 0 && ramp.frames - ramp_frame_ < count) {
      count = ramp.frames - ramp_frame_;
    }
    emit(block.first(count));
    if (ramp.frames > 0 && ramp_frame_ == ramp.frames) {
      end_ramp();
    }
    block = block.from(count);
  }
}

void DriveOscillator::end_ramp() noexcept {
  Ramp& ramp = down_.frames > 0 ? down_ : up_;
  from_v_ = ramp.to_v;
  ramp = Ramp();
  ramp_frame_ = 0;
  if (frequency_hz_ != next_frequency_hz_) {
    set_frequency(next_frequency_hz_);
  }
}

// At most as many frames as the ramp that runs has left. The phase is set anew for each call, and
// goes on by sin(x + h) = 2 cos(h) sin(x) - sin(x - h). The rounding of cos(h) costs the last of 64
// frames 64 * 1.1e-16/h of the amplitude: at 30 Hz and 100 kS/s 4e-12, a hundredth of a word.
void DriveOscillator::emit(Span<hal::Word> block) noexcept {
  const Ramp& ramp = down_.frames > 0 ? down_ : up_;
  const bool is_silent = from_v_ == 0.0 && ramp.frames == 0;
  if (is_silent) {
    std::fill(block.begin(), block.end(), 0);
    return;  // The phase stands still, which does not show.
  }
  const double turns =
      start_turns_ + static_cast<double>(frames_) * frequency_hz_ / sample_rate_hz_;
  const SinCos angle = sincos(kTwoPi * (turns - floor(turns)));
  double sine = angle.sin;
  double before = angle.sin * step_cosine_ - angle.cos * step_sine_;
  const double words_per_volt = hal::words_per_volt(full_scale_v_);
  const double twice_step_cosine = 2.0 * step_cosine_;
  const double per_frame = ramp.frames > 0 ? 1.0 / static_cast<double>(ramp.frames) : 0.0;
  const double from = from_v_ * words_per_volt;
  const double change = (ramp.to_v - from_v_) * words_per_volt;
  for (hal::Word& word : block) {
    double amplitude = from;
    if (ramp.frames > 0) {
      ++ramp_frame_;
      const double a = static_cast<double>(ramp_frame_) * per_frame;
      amplitude += change * (a * a * (3.0 - 2.0 * a));
    }
    word = hal::nearest_word(amplitude * sine);
    const double next = twice_step_cosine * sine - before;
    before = sine;
    sine = next;
  }
  frames_ += block.size();
}

}  // namespace emax::app
