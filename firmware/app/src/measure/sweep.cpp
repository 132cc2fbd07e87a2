// The sequencer: what one block does, and what comes after what.
#include "emax/app/measure/sweep.hpp"

#include <algorithm>

#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

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

// Whatever the memory held before. What is not here is written before it is read.
void SweepWorkspace::begin(const hal::StreamFormat& format) noexcept {
  format_ = format;
  reference_monitor_ = ChannelMonitor();
  device_monitor_ = ChannelMonitor();
  target_ = Target();
  last_ratio_ = Complex();
  drive_per_acceleration_ = 0.0;
  level_scale_ = 1.0;
  activity_ = Activity::kSilence;
  is_lowering_ = false;
}

Status Sweep::start(const SweepSettings& settings, hal::AnalogStream& stream,
                    SweepWorkspace& work) noexcept {
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
  reset();
  work.begin(stream.format());
  inputs_.sample_rate_hz = work.format_.sample_rate_hz;
  work.drive_.configure(work.format_, settings.drive_limit_v, settings.slew_v_per_s);
  work.silence_.start(work.format_);
  work.left_ = work.silence_.frames();
  stage_ = SweepStage::kSilence;
  return Status::kOk;
}

// One by one: a whole new object would pass over the stack.
void Sweep::reset() noexcept {
  inputs_ = BudgetInputs();
  common_ = CommonBudget();
  noise_ = ChannelNoise();
  check_before_ = Complex();
  check_after_ = Complex();
  failed_frequency_hz_ = 0.0;
  blocks_ = 0;
  point_count_ = 0;
  status_ = Status::kOk;
}

void Sweep::stop(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  if (!done()) {
    fail(Status::kStopped, stream, work);
  }
}

void Sweep::fail(Status status, hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  (void)stream.stop();
  status_ = status;
  failed_frequency_hz_ = stage_ == SweepStage::kSilence ? 0.0 : work.target_.frequency_hz;
  stage_ = SweepStage::kFailed;
  finish(work);
}

double Sweep::progress() const noexcept {
  if (stage_ == SweepStage::kDone) {
    return 1.0;
  }
  const double all = static_cast<double>(settings_.frequency_count) + 2.0;
  const double checks = check_before_.re == 0.0 && check_before_.im == 0.0 ? 0.0 : 1.0;
  return (static_cast<double>(point_count_) + checks) / all;
}

void Sweep::step(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  if (done()) {
    return;
  }
  const Span<hal::Word> words = Span<hal::Word>(work.words_).first(work.format_.block_frames);
  work.drive_.fill(words);
  const hal::Exchange exchange =
      stream.exchange(words, Span<hal::Frame>(work.frames_).first(work.format_.block_frames));
  if (exchange.status != Status::kOk) {
    fail(exchange.status, stream, work);
    return;
  }
  ++blocks_;
  take_frames(stream, work);
}

void Sweep::take_frames(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  for (std::size_t i = 0; i < work.format_.block_frames; ++i) {
    work.reference_monitor_.add(work.frames_[i].reference);
    work.device_monitor_.add(work.frames_[i].device);
  }
  work.block_is_spent_ = false;
  watch(stream, work);
  std::size_t from = 0;
  while (!done() && !work.block_is_spent_ && from < work.format_.block_frames) {
    std::size_t count = work.format_.block_frames - from;
    count = work.left_ < count ? work.left_ : count;
    consume(from, count, work);
    from += count;
    work.left_ -= static_cast<std::uint32_t>(count);
    if (work.left_ == 0) {
      end_activity(stream, work);
    }
  }
}

// What must be answered at once, whatever is going on.
void Sweep::watch(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  const bool full_scale =
      work.reference_monitor_.full_scale_words() > 0 || work.device_monitor_.full_scale_words() > 0;
  work.reference_monitor_.clear_full_scale();
  work.device_monitor_.clear_full_scale();
  if (work.activity_ == Activity::kSilence) {
    if (full_scale) {
      fail(Status::kSaturated, stream, work);
    }
    return;
  }
  if (work.activity_ == Activity::kRampingDown) {
    return;
  }
  const std::uint64_t period = frames_of(work.format_.sample_rate_hz / work.target_.frequency_hz);
  const std::uint64_t most = period > kMinEqualWords ? period : kMinEqualWords;
  if (work.reference_monitor_.equal_words() > most || work.device_monitor_.equal_words() > most) {
    fail(Status::kStuckChannel, stream, work);
    return;
  }
  work.is_lowering_ =
      work.is_lowering_ && work.activity_ == Activity::kSettling && work.left_ > work.settle_left_;
  if (work.is_lowering_) {
    return;
  }
  const double peak_v = reference_peak_v(work) - kNoisePeak * inputs_.silent_reference.noise_v;
  if (full_scale || acceleration_of(peak_v, work) > settings_.acceleration_limit_mps2) {
    lower_level(stream, work);
  }
}

/// The largest distance of the block from the offset, which is taken to a word.
double Sweep::reference_peak_v(const SweepWorkspace& work) const noexcept {
  const double volts = hal::volts_per_word(work.format_.input_full_scale_v);
  const auto offset = static_cast<std::int64_t>(inputs_.silent_reference.offset_v / volts);
  std::int64_t peak = 0;
  for (std::size_t i = 0; i < work.format_.block_frames; ++i) {
    const std::int64_t distance = work.frames_[i].reference - offset;
    peak = std::max(peak, distance < 0 ? -distance : distance);
  }
  return volts * static_cast<double>(peak);
}

void Sweep::lower_level(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  work.target_.was_overrange = true;
  work.level_scale_ *= 0.5;
  if (work.level_scale_ < kLeastScale) {
    fail(Status::kSaturated, stream, work);
    return;
  }
  work.is_lowering_ = true;
  drive_to(0.5 * work.drive_.amplitude_v(), work);
}

void Sweep::consume(std::size_t from, std::size_t count, SweepWorkspace& work) noexcept {
  const Span<const hal::Frame> frames =
      Span<const hal::Frame>(work.frames_).from(from).first(count);
  if (work.activity_ == Activity::kSilence) {
    work.silence_.add(frames);
  } else if (work.activity_ == Activity::kMeasuring) {
    work.fit_.add(frames);
  }
}

void Sweep::end_activity(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  switch (work.activity_) {
    case Activity::kSilence:
      end_silence(stream, work);
      return;
    case Activity::kSettling:
      work.repeats_.count = 0;
      work.reference_rest2_ = 0.0;
      work.device_rest2_ = 0.0;
      work.activity_ = Activity::kMeasuring;
      // The rates were checked by `start()`.
      (void)work.fit_.start(work.target_.frequency_hz, work.format_.sample_rate_hz,
                            hal::volts_per_word(work.format_.input_full_scale_v));
      begin_repeat(work);
      return;
    case Activity::kMeasuring:
      end_repeat(stream, work);
      return;
    case Activity::kRampingDown:
      (void)stream.stop();
      stage_ = SweepStage::kDone;
      finish(work);
      return;
  }
}

void Sweep::end_silence(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  inputs_.silent_reference = work.silence_.reference();
  inputs_.silent_device = work.silence_.device();
  const double most_v = kWanderShare * work.format_.input_full_scale_v;
  if (abs(inputs_.silent_reference.drift_v) > most_v ||
      abs(inputs_.silent_device.drift_v) > most_v) {
    fail(Status::kDcDrift, stream, work);
    return;
  }
  stage_ = SweepStage::kCheckBefore;
  begin_target(settings_.check_hz, work);
}

double Sweep::aim_mps2(const SweepWorkspace& work) const noexcept {
  const double wanted = work.level_scale_ * settings_.level_mps2;
  const double most =
      (work.target_.is_close ? kLimitShare : kCautiousShare) * settings_.acceleration_limit_mps2;
  return wanted < most ? wanted : most;
}

void Sweep::begin_target(double frequency_hz, SweepWorkspace& work) noexcept {
  work.target_ = Target();
  work.target_.frequency_hz = frequency_hz;
  work.level_scale_ = work.level_scale_ < 0.5 ? 2.0 * work.level_scale_ : 1.0;
  // Whole periods, to the nearest frame.
  const double period = work.format_.sample_rate_hz / frequency_hz;
  const double by_duration = floor(settings_.repeat_s * frequency_hz + 0.999999);
  const double by_cycles = static_cast<double>(settings_.cycles);
  work.target_.repeat_frames =
      frames_of(period * (by_duration > by_cycles ? by_duration : by_cycles));
  // A fit needs a full period and four samples.
  while (static_cast<double>(work.target_.repeat_frames) < period ||
         work.target_.repeat_frames < 4) {
    ++work.target_.repeat_frames;
  }
  const double most_v = work.drive_.max_amplitude_v(frequency_hz);
  double amplitude_v = work.drive_per_acceleration_ > 0.0
                           ? aim_mps2(work) * work.drive_per_acceleration_
                           : kFirstDriveShare * settings_.drive_limit_v;
  amplitude_v = amplitude_v < most_v ? amplitude_v : most_v;
  drive_to(amplitude_v, work);
}

void Sweep::drive_to(double amplitude_v, SweepWorkspace& work) noexcept {
  const double periods = kSettlePeriods / work.target_.frequency_hz;
  const double settle_s = settings_.settle_s > periods ? settings_.settle_s : periods;
  work.settle_left_ = frames_of(settle_s * work.format_.sample_rate_hz);
  work.left_ = work.drive_.go_to(work.target_.frequency_hz, amplitude_v) +
               work.format_.latency_frames + work.settle_left_ + 1u;
  work.activity_ = Activity::kSettling;
  work.block_is_spent_ = true;
  work.reference_monitor_.clear_equal_words();
  work.device_monitor_.clear_equal_words();
}

void Sweep::begin_repeat(SweepWorkspace& work) noexcept {
  work.fit_.restart();
  work.left_ = work.target_.repeat_frames;
}

void Sweep::begin_next(SweepWorkspace& work) noexcept {
  if (stage_ == SweepStage::kCheckAfter) {
    work.left_ =
        work.drive_.go_to(work.target_.frequency_hz, 0.0) + work.format_.latency_frames + 1u;
    work.activity_ = Activity::kRampingDown;
    work.block_is_spent_ = true;
    return;
  }
  if (point_count_ == settings_.frequency_count) {
    stage_ = SweepStage::kCheckAfter;
    begin_target(settings_.check_hz, work);
    return;
  }
  stage_ = SweepStage::kPoints;
  begin_target(settings_.frequency_hz[point_count_], work);
}

void Sweep::finish(SweepWorkspace& work) noexcept {
  const double volts = work.format_.input_full_scale_v;
  inputs_.reference_step_v = volts * work.reference_monitor_.step();
  inputs_.device_step_v = volts * work.device_monitor_.step();
  const bool has_checks = norm(check_before_) > 0.0 && norm(check_after_) > 0.0;
  common_ = common_budget(settings_,
                          has_checks ? sqrt(norm(check_after_) / norm(check_before_)) - 1.0 : 0.0);
  noise_ = pooled_noise(Span<const PointScatter>(work.scatter_).first(point_count_),
                        Span<const double>(settings_.frequency_hz).first(point_count_), inputs_);
  for (std::size_t i = 0; i < point_count_; ++i) {
    SweepPoint& point = points_[i];
    const PointVerdict verdict =
        point_verdict(work.scatter_[i], point.point.frequency_hz, noise_, inputs_);
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
