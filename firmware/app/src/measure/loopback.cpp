// The stages of a loopback, and the straight line through its phases.
#include "emax/app/measure/loopback.hpp"

#include <algorithm>

#include "emax/app/measure/sweep_budget.hpp"
#include "emax/base/complex.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::app {
namespace {

constexpr double kLookShare = 0.01;       // Of the drive limit.
constexpr double kDriveShare = 0.5;       // Of what is permitted.
constexpr double kLongestPeriod = 512.0;  // In frames; each further frequency is twice the last.
constexpr std::uint32_t kMeasuredFrames = 16384;
constexpr std::uint32_t kSettlingFrames = 2048;
// A wire has a gain of 1 but for what front ends are off by.
constexpr double kLeastGain = 0.75;
constexpr double kGreatestGain = 1.0 / kLeastGain;
constexpr std::uint32_t kMostRestarts = 8;
constexpr double kMostFramesOff = 16.0;  // Of the latency.
constexpr double kStudent = 2.87;        // 95.45 %, four degrees of freedom.
constexpr double kPercent = 100.0;
constexpr double kMostPercent = 2.0;  // Expanded: more is no ratio that the channels have.
constexpr double kMostRest = 0.01;    // Of the squares of the phases beside a skew, in rad^2.

double angle_of(Complex number) noexcept { return atan2(number.im, number.re); }

/// From a sum of squares, which rounding may leave below zero.
double expanded(double squares) noexcept {
  return squares > 0.0 ? 0.5 * kStudent * sqrt(squares) : 0.0;
}

bool is_near_one(double gain) noexcept { return gain > kLeastGain && gain < kGreatestGain; }

}  // namespace

Status LoopbackRun::start(hal::AnalogStream& stream, const SweepSettings& settings) noexcept {
  scales_ = full_scales(settings, stream.format());
  format_ = stream.format();
  format_.drive_full_scale_v = scales_.drive_v;
  drive_limit_v_ = settings.drive_limit_v;
  slew_v_per_s_ = settings.slew_v_per_s;
  restarts_ = 0;
  results_.lost_blocks = 0;
  return begin(stream, drive_limits(settings, stream.format()));
}

Status LoopbackRun::begin(hal::AnalogStream& stream, const hal::DriveLimits& limits) noexcept {
  const Status status = stream.start(limits);
  if (status != Status::kOk) {
    return status;
  }
  drive_.configure(format_, drive_limit_v_, slew_v_per_s_);
  silence_.start(format_, scales_);
  amplitude_v_ = std::min(drive_limit_v_, std::min(scales_.reference_v, scales_.device_v));
  frequency_hz_ = format_.sample_rate_hz / kLongestPeriod;
  ratios_ = 0.0;
  ratios2_ = 0.0;
  phases2_ = 0.0;
  phases_by_frequency_ = 0.0;
  frames_ = 0;
  left_ = silence_.frames();
  target_ = 0;
  stage_ = Stage::kSilence;
  status_ = Status::kOk;
  return Status::kOk;
}

// The stream has stopped, with the drive at zero. Where it knows of a loss and not of how much, it
// tells the frame that was expected.
void LoopbackRun::count_lost(hal::AnalogStream& stream, std::uint64_t first_frame) noexcept {
  const std::uint64_t gap = first_frame > frames_ ? first_frame - frames_ : 1;
  results_.lost_blocks +=
      static_cast<std::uint32_t>((gap + format_.block_frames - 1) / format_.block_frames);
  ++restarts_;
  const Status status =
      restarts_ > kMostRestarts ? Status::kLostBlock : begin(stream, stream.limits());
  if (status != Status::kOk) {
    end(status);
  }
}

void LoopbackRun::step(hal::AnalogStream& stream) noexcept {
  if (done()) {
    return;
  }
  const std::size_t count = format_.block_frames;
  const Span<hal::Word> words = Span<hal::Word>(words_).first(count);
  const Span<hal::Frame> response = Span<hal::Frame>(response_).first(count);
  drive_.fill(words);
  const hal::Exchange exchange = stream.exchange(words, response);
  if (exchange.status == Status::kLostBlock) {
    count_lost(stream, exchange.first_frame);
    return;
  }
  if (exchange.status != Status::kOk) {
    end(exchange.status);
    return;
  }
  frames_ += count;
  for (std::size_t i = 0; i < count; ++i) {
    sent_[i] = {words[i], words[i]};
  }
  take(Span<const hal::Frame>(sent_).first(count), response);
  if (done()) {
    (void)stream.stop();
  }
}

void LoopbackRun::stop(hal::AnalogStream& stream) noexcept {
  (void)stream.stop();
  end(Status::kStopped);
}

double LoopbackRun::progress() const noexcept {
  return done() ? 1.0 : static_cast<double>(target_) / static_cast<double>(kFrequencies + 1);
}

// What is left of the block when a stage ends belongs to settling, or to nothing.
void LoopbackRun::take(Span<const hal::Frame> drive, Span<const hal::Frame> response) noexcept {
  const std::size_t count = std::min<std::size_t>(left_, response.size());
  if (stage_ == Stage::kSilence) {
    silence_.add(response.first(count));
  } else if (stage_ == Stage::kMeasuring) {
    drive_fit_.add(drive.first(count));
    response_fit_.add(response.first(count));
  }
  left_ -= static_cast<std::uint32_t>(count);
  if (left_ == 0) {
    end_stage();
  }
}

void LoopbackRun::end_stage() noexcept {
  switch (stage_) {
    case Stage::kSilence:
      end_silence();
      return;
    case Stage::kSettling:
      stage_ = Stage::kMeasuring;
      left_ = kMeasuredFrames;
      // The rates were checked.
      (void)response_fit_.start(frequency_hz_, format_.sample_rate_hz,
                                hal::volts_per_word(scales_.reference_v));
      (void)drive_fit_.start(frequency_hz_, format_.sample_rate_hz,
                             hal::volts_per_word(scales_.drive_v));
      return;
    case Stage::kMeasuring:
      end_target();
      return;
    case Stage::kDone:
      return;
  }
}

void LoopbackRun::end_silence() noexcept {
  const SilentChannel reference = silence_.reference();
  const SilentChannel device = silence_.device();
  results_.reference_offset_v = reference.offset_v;
  results_.device_offset_v = device.offset_v;
  results_.reference_noise_v = reference.noise_v;
  results_.device_noise_v = device.noise_v;
  begin_target();
}

void LoopbackRun::begin_target() noexcept {
  const double wanted_v = target_ == 0 ? kLookShare * amplitude_v_ : kDriveShare * amplitude_v_;
  const double amplitude_v = std::min(wanted_v, drive_.max_amplitude_v(frequency_hz_));
  left_ = drive_.go_to(frequency_hz_, amplitude_v) + format_.latency_frames + kSettlingFrames;
  stage_ = Stage::kSettling;
}

void LoopbackRun::end_target() noexcept {
  const SineFitResult drive = drive_fit_.reference();
  const SineFitResult reference = response_fit_.reference();
  const SineFitResult device =
      in_volts(response_fit_.device(), scales_.device_v / scales_.reference_v);
  // The first two are of the same frequency.
  const Status wired = target_ < 2 ? check_wire(drive, reference, device) : Status::kOk;
  if (wired != Status::kOk) {
    end(wired);
    return;
  }
  if (target_ > 0) {
    const Complex ratio = device.phasor() / reference.phasor();
    const double off = sqrt(norm(ratio)) - 1.0;
    const double phase = angle_of(ratio);
    ratios_ += off;
    ratios2_ += off * off;
    phases2_ += phase * phase;
    phases_by_frequency_ += phase * static_cast<double>(1U << (target_ - 1));
    frequency_hz_ *= 2.0;
  }
  ++target_;
  if (target_ > kFrequencies) {
    end(evaluate());
    return;
  }
  begin_target();
}

Status LoopbackRun::check_wire(const SineFitResult& drive, const SineFitResult& reference,
                               const SineFitResult& device) noexcept {
  // Of all that look alike at this frequency, the one nearest to the stated latency.
  const double turns = angle_of(drive.phasor() / reference.phasor()) / kTwoPi;
  const auto stated = static_cast<double>(format_.latency_frames);
  const double turns_off = turns - stated / kLongestPeriod;
  const double off = kLongestPeriod * (turns_off - floor(turns_off + 0.5));
  results_.latency_frames = stated + off;
  results_.reference_gain = reference.amplitude_v / drive.amplitude_v;
  results_.device_gain = device.amplitude_v / drive.amplitude_v;
  results_.distortion_percent =
      kPercent * distortion_of(reference.residual_std_v, results_.reference_noise_v,
                               reference.amplitude_v, static_cast<double>(reference.samples));
  if (!is_near_one(results_.reference_gain) || !is_near_one(results_.device_gain)) {
    return Status::kNoReference;
  }
  if ((device.phasor() / reference.phasor()).re < 0.0) {
    return Status::kInvertedPolarity;
  }
  return abs(off) < kMostFramesOff ? Status::kOk : Status::kNoReference;
}

// Of phases that lie on a straight line through zero, up to what is left over.
Status LoopbackRun::evaluate() noexcept {
  constexpr auto kCount = static_cast<double>(kFrequencies);
  constexpr double kSquares = 341.0;  // Of the frequencies.
  const double omega = kTwoPi * format_.sample_rate_hz / kLongestPeriod;
  const double mean = ratios_ / kCount;
  const double slope = phases_by_frequency_ / kSquares;
  const double scatter = ratios2_ - kCount * mean * mean;
  const double rest = phases2_ - kSquares * slope * slope;
  results_.ratio = 1.0 + mean;
  results_.ratio_percent = kPercent * expanded(scatter);
  results_.skew_s = slope / omega;
  results_.skew_expanded_s = expanded(rest / kSquares) / omega;
  // Else a gain was switched on the way.
  const bool is_steady = results_.ratio_percent < kMostPercent && rest < kMostRest;
  return is_steady ? Status::kOk : Status::kDistorted;
}

void LoopbackRun::end(Status status) noexcept {
  status_ = status;
  stage_ = Stage::kDone;
}

}  // namespace emax::app
