// The sequencer: what one block does, and what comes after what.
#include "emax/app/sweep.hpp"

#include "emax/elementary.hpp"

namespace emax::app {
namespace {

constexpr double kWordScale = 2147483648.0;
constexpr double kSettlePeriods = 3.0;
constexpr double kLeastScale = 1.0 / 16.0;
constexpr double kFirstDriveShare = 0.01;  // Of the limit, until the shaker is known.
constexpr double kLimitShare = 0.94;     // The level may be off by 5 %, and stays below the limit.
constexpr double kCautiousShare = 0.25;  // Of the limit, before this frequency was seen.
constexpr std::uint64_t kMinEqualWords = 256;

std::uint32_t frames_of(double frames) noexcept {
  return static_cast<std::uint32_t>(floor(frames + 0.5));
}

}  // namespace

Status Sweep::start(const SweepSettings& settings, hal::AnalogStream& stream) noexcept {
  if (!done()) {
    return Status::kAlreadyRunning;
  }
  refused_ = check(settings, stream.format());
  if (refused_.setting != nullptr) {
    return Status::kInvalidArgument;
  }
  const Status status = stream.start(drive_limits(settings, stream.format()));
  if (status != Status::kOk) {
    return status;
  }
  settings_ = settings;
  format_ = stream.format();
  reset();
  inputs_.sample_rate_hz = format_.sample_rate_hz;
  drive_.configure(format_, settings.drive_limit_v, settings.slew_v_per_s);
  silence_.start(format_.sample_rate_hz);
  left_ = silence_.frames();
  activity_ = Activity::kSilence;
  stage_ = SweepStage::kSilence;
  return Status::kOk;
}

// One by one: a whole new object would pass over the stack.
void Sweep::reset() noexcept {
  reference_monitor_ = ChannelMonitor();
  device_monitor_ = ChannelMonitor();
  target_ = Target();
  repeats_.count = 0;
  inputs_ = BudgetInputs();
  common_ = CommonBudget();
  noise_ = ChannelNoise();
  last_ratio_ = Complex();
  check_before_ = Complex();
  check_after_ = Complex();
  failed_frequency_hz_ = 0.0;
  drive_per_acceleration_ = 0.0;
  level_scale_ = 1.0;
  blocks_ = 0;
  point_count_ = 0;
  status_ = Status::kOk;
  is_lowering_ = false;
}

void Sweep::stop(hal::AnalogStream& stream) noexcept {
  if (!done()) {
    fail(Status::kStopped, stream);
  }
}

void Sweep::fail(Status status, hal::AnalogStream& stream) noexcept {
  (void)stream.stop();
  status_ = status;
  failed_frequency_hz_ = stage_ == SweepStage::kSilence ? 0.0 : target_.frequency_hz;
  stage_ = SweepStage::kFailed;
  finish();
}

double Sweep::progress() const noexcept {
  if (stage_ == SweepStage::kDone) {
    return 1.0;
  }
  const double all = static_cast<double>(settings_.frequency_count) + 2.0;
  const double checks = check_before_.re == 0.0 && check_before_.im == 0.0 ? 0.0 : 1.0;
  return (static_cast<double>(point_count_) + checks) / all;
}

void Sweep::step(hal::AnalogStream& stream) noexcept {
  if (done()) {
    return;
  }
  const Span<hal::Word> words = Span<hal::Word>(words_).first(format_.block_frames);
  drive_.fill(words);
  const hal::Exchange exchange =
      stream.exchange(words, Span<hal::Frame>(frames_).first(format_.block_frames));
  if (exchange.status != Status::kOk) {
    fail(exchange.status, stream);
    return;
  }
  ++blocks_;
  take_frames(stream);
}

void Sweep::take_frames(hal::AnalogStream& stream) noexcept {
  const double volts = format_.input_full_scale_v / kWordScale;
  for (std::size_t i = 0; i < format_.block_frames; ++i) {
    reference_monitor_.add(frames_[i].reference);
    device_monitor_.add(frames_[i].device);
    reference_v_[i] = volts * static_cast<double>(frames_[i].reference);
    device_v_[i] = volts * static_cast<double>(frames_[i].device);
  }
  block_is_spent_ = false;
  watch(stream);
  std::size_t from = 0;
  while (!done() && !block_is_spent_ && from < format_.block_frames) {
    std::size_t count = format_.block_frames - from;
    count = left_ < count ? left_ : count;
    consume(from, count);
    from += count;
    left_ -= static_cast<std::uint32_t>(count);
    if (left_ == 0) {
      end_activity(stream);
    }
  }
}

// What must be answered at once, whatever is going on.
void Sweep::watch(hal::AnalogStream& stream) noexcept {
  const bool full_scale =
      reference_monitor_.full_scale_words() > 0 || device_monitor_.full_scale_words() > 0;
  reference_monitor_.clear_full_scale();
  device_monitor_.clear_full_scale();
  if (activity_ == Activity::kSilence) {
    if (full_scale) {
      fail(Status::kSaturated, stream);
    }
    return;
  }
  if (activity_ == Activity::kRampingDown) {
    return;
  }
  const std::uint64_t period = frames_of(format_.sample_rate_hz / target_.frequency_hz);
  const std::uint64_t most = period > kMinEqualWords ? period : kMinEqualWords;
  if (reference_monitor_.equal_words() > most || device_monitor_.equal_words() > most) {
    fail(Status::kStuckChannel, stream);
    return;
  }
  is_lowering_ = is_lowering_ && activity_ == Activity::kSettling && left_ > settle_left_;
  if (is_lowering_) {
    return;
  }
  double peak_v = 0.0;
  for (std::size_t i = 0; i < format_.block_frames; ++i) {
    const double v = abs(reference_v_[i] - inputs_.silent_reference.offset_v);
    peak_v = v > peak_v ? v : peak_v;
  }
  peak_v -= kNoisePeak * inputs_.silent_reference.noise_v;
  if (full_scale || acceleration_of(peak_v) > settings_.limit_mps2) {
    lower_level(stream);
  }
}

void Sweep::lower_level(hal::AnalogStream& stream) noexcept {
  target_.was_overrange = true;
  level_scale_ *= 0.5;
  if (level_scale_ < kLeastScale) {
    fail(Status::kSaturated, stream);
    return;
  }
  is_lowering_ = true;
  drive_to(0.5 * drive_.amplitude_v());
}

void Sweep::consume(std::size_t from, std::size_t count) noexcept {
  const Span<const double> reference = Span<const double>(reference_v_).from(from).first(count);
  const Span<const double> device = Span<const double>(device_v_).from(from).first(count);
  if (activity_ == Activity::kSilence) {
    silence_.add(reference, device);
  } else if (activity_ == Activity::kMeasuring) {
    reference_fit_.add(reference);
    device_fit_.add(device);
  }
}

void Sweep::end_activity(hal::AnalogStream& stream) noexcept {
  switch (activity_) {
    case Activity::kSilence:
      end_silence(stream);
      return;
    case Activity::kSettling:
      repeats_.count = 0;
      reference_rest2_ = 0.0;
      device_rest2_ = 0.0;
      activity_ = Activity::kMeasuring;
      begin_repeat();
      return;
    case Activity::kMeasuring:
      end_repeat(stream);
      return;
    case Activity::kRampingDown:
      (void)stream.stop();
      stage_ = SweepStage::kDone;
      finish();
      return;
  }
}

void Sweep::end_silence(hal::AnalogStream& stream) noexcept {
  inputs_.silent_reference = silence_.reference();
  inputs_.silent_device = silence_.device();
  const double most_v = kWanderShare * format_.input_full_scale_v;
  if (abs(inputs_.silent_reference.drift_v) > most_v ||
      abs(inputs_.silent_device.drift_v) > most_v) {
    fail(Status::kDcDrift, stream);
    return;
  }
  stage_ = SweepStage::kCheckBefore;
  begin_target(settings_.check_hz);
}

double Sweep::aim_mps2() const noexcept {
  const double wanted = level_scale_ * settings_.level_mps2;
  const double most = (target_.is_close ? kLimitShare : kCautiousShare) * settings_.limit_mps2;
  return wanted < most ? wanted : most;
}

void Sweep::begin_target(double frequency_hz) noexcept {
  target_ = Target();
  target_.frequency_hz = frequency_hz;
  level_scale_ = level_scale_ < 0.5 ? 2.0 * level_scale_ : 1.0;
  // Whole periods, to the nearest frame.
  const double period = format_.sample_rate_hz / frequency_hz;
  const double by_duration = floor(settings_.repeat_s * frequency_hz + 0.999999);
  const double by_cycles = static_cast<double>(settings_.cycles);
  target_.repeat_frames = frames_of(period * (by_duration > by_cycles ? by_duration : by_cycles));
  // A fit needs a full period and four samples.
  while (static_cast<double>(target_.repeat_frames) < period || target_.repeat_frames < 4) {
    ++target_.repeat_frames;
  }
  const double most_v = drive_.max_amplitude_v(frequency_hz);
  double amplitude_v = drive_per_acceleration_ > 0.0 ? aim_mps2() * drive_per_acceleration_
                                                     : kFirstDriveShare * settings_.drive_limit_v;
  amplitude_v = amplitude_v < most_v ? amplitude_v : most_v;
  drive_to(amplitude_v);
}

void Sweep::drive_to(double amplitude_v) noexcept {
  const double periods = kSettlePeriods / target_.frequency_hz;
  const double settle_s = settings_.settle_s > periods ? settings_.settle_s : periods;
  settle_left_ = frames_of(settle_s * format_.sample_rate_hz);
  left_ =
      drive_.go_to(target_.frequency_hz, amplitude_v) + format_.latency_frames + settle_left_ + 1u;
  activity_ = Activity::kSettling;
  block_is_spent_ = true;
  reference_monitor_.clear_equal_words();
  device_monitor_.clear_equal_words();
}

void Sweep::begin_repeat() noexcept {
  // The rates were checked by `start()`.
  (void)reference_fit_.start(target_.frequency_hz, format_.sample_rate_hz);
  (void)device_fit_.start(target_.frequency_hz, format_.sample_rate_hz);
  left_ = target_.repeat_frames;
}

void Sweep::begin_next() noexcept {
  if (stage_ == SweepStage::kCheckAfter) {
    left_ = drive_.go_to(target_.frequency_hz, 0.0) + format_.latency_frames + 1u;
    activity_ = Activity::kRampingDown;
    block_is_spent_ = true;
    return;
  }
  if (point_count_ == settings_.frequency_count) {
    stage_ = SweepStage::kCheckAfter;
    begin_target(settings_.check_hz);
    return;
  }
  stage_ = SweepStage::kPoints;
  begin_target(settings_.frequency_hz[point_count_]);
}

void Sweep::finish() noexcept {
  const double volts = format_.input_full_scale_v;
  inputs_.reference_step_v = volts * reference_monitor_.step();
  inputs_.device_step_v = volts * device_monitor_.step();
  const bool has_checks = norm(check_before_) > 0.0 && norm(check_after_) > 0.0;
  common_ = common_budget(settings_,
                          has_checks ? sqrt(norm(check_after_) / norm(check_before_)) - 1.0 : 0.0);
  noise_ = pooled_noise(Span<const PointScatter>(scatter_).first(point_count_),
                        Span<const double>(settings_.frequency_hz).first(point_count_), inputs_);
  for (std::size_t i = 0; i < point_count_; ++i) {
    SweepPoint& point = points_[i];
    const PointVerdict verdict =
        point_verdict(scatter_[i], point.point.frequency_hz, noise_, inputs_);
    point.budget = verdict.budget;
    point.residual_percent = verdict.residual_percent;
    point.flagged = point.flagged || verdict.scatters;
    point.scatters = verdict.scatters;
    point.point.u_amplitude = verdict.relative_u * point.point.amplitude;
    point.point.u_phase_rad = verdict.budget.phase_rad;
  }
}

Status Sweep::copy_to(FrequencyResponse& response) const noexcept {
  response.clear();
  if (stage_ != SweepStage::kDone && stage_ != SweepStage::kFailed) {
    return Status::kNotRunning;
  }
  for (const SweepPoint& point : points()) {
    const Status status = response.add(point.point);
    if (status != Status::kOk) {
      response.clear();
      return status;
    }
  }
  return response.set_common(common_.total);
}

}  // namespace emax::app
