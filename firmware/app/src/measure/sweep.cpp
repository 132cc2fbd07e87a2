// What one block does, and what comes after what.
#include "emax/app/measure/sweep.hpp"

#include <algorithm>
#include <limits>

#include "emax/app/measure/sweep_workspace.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

// A shaker that a fault or a stop has left swinging comes to rest.
constexpr double kRest_s = 2.0;
constexpr double kMuchScatter = 1e-4;  // Relative, of the mean of a point's repeats.
constexpr double kHiddenShare = 0.5;
constexpr double kSettlePeriods = 3.0;
constexpr double kRingingPeriods = 2.0;  // Times what a resonance magnifies by: six time constants.
constexpr double kSharpest = 0.002;      // Of 1/K, over that at the check frequency.
constexpr double kLeastRoom = 1.0 / 24.0;  // Of the level: less is little for converters.
constexpr double kLeastScale = 1.0 / 16.0;
constexpr double kFirstDriveShare = 0.01;  // Of the limit, until the shaker is known;
constexpr double kLittle_mps2 = 1.0;       // a limit below is looked at with few steps.
constexpr double kLookShare = 0.25;        // Of the drive, where the first look is too much.
constexpr double kLivelyGain = 400.0;      // Of a shaker, in (m/s^2)/V; the limit over the first
constexpr double kSlowRise_s = 2.0;        // drive below it, and the first look is slow.
constexpr std::uint32_t kMostLooks = 6;
constexpr double kLimitShare = 0.94;      // The level may be off by 5 %, and stays below the limit.
constexpr double kRoundedSteps = 0.2;     // Of few steps: one.
constexpr double kRoomShare = 0.9;        // Above it the level is lowered at once,
constexpr double kLoweredShare = 0.5;     // to this share.
constexpr double kCautiousShare = 0.25;   // Of the limit, before this frequency was seen;
constexpr double kUnexpectedShare = 0.5;  // there more than this is too much,
constexpr double kNewsShare = 0.25;       // once the drive has risen so far;
constexpr double kCarefree = 20.0;        // and a limit of that many times the level is far.
constexpr double kTwice = 2.0;
constexpr double kRisePeriods = 16.0;  // Where it is near, for the shaker to be seen while it
constexpr double kLeastRise_s = 0.02;  // rises.
constexpr std::uint64_t kMinEqualWords = 256;

std::uint32_t frames_of(double frames) noexcept {
  return static_cast<std::uint32_t>(floor(frames + 0.5));
}

}  // namespace

// Whatever the memory held before. What is not here is written before it is read.
void SweepWorkspace::begin(const hal::StreamFormat& format, const FullScales& scales) noexcept {
  format_ = format;
  format_.drive_full_scale_v = scales.drive_v;
  scales_ = scales;
  reference_monitor_ = ChannelMonitor();
  device_monitor_ = ChannelMonitor();
  target_ = SweepWorkspace::Target();
  drive_per_acceleration_ = 0.0;
  least_level_mps2_ = 0.0;
  level_scale_ = 1.0;
  level_room_mps2_ = std::numeric_limits<double>::infinity();
  exchanged_share_ = 1.0;
  device_v_per_v_ = 0.0;
  activity_ = SweepWorkspace::Activity::kSilence;
  is_lowering_ = false;
}

Status Sweep::start(const SweepSettings& settings) noexcept {
  if (!done()) {
    return Status::kAlreadyRunning;
  }
  results_.refused = check(settings, stream_.format());
  if (results_.refused.setting != nullptr) {
    return Status::kInvalidArgument;
  }
  const Status status = stream_.start(drive_limits(settings, stream_.format()));
  if (status != Status::kOk) {
    return status;
  }
  results_.settings = settings;
  reset();
  work_.begin(stream_.format(), full_scales(settings, stream_.format()));
  results_.inputs.sample_rate_hz = work_.format_.sample_rate_hz;
  work_.drive_.configure(work_.format_, settings.drive_limit_v, settings.slew_v_per_s);
  work_.silence_.start(work_.format_, work_.scales_);
  work_.left_ = work_.silence_.frames();
  if (results_.may_swing) {
    work_.activity_ = SweepWorkspace::Activity::kRest;
    work_.left_ = frames_of(kRest_s * work_.format_.sample_rate_hz);
  }
  results_.stage = SweepStage::kSilence;
  return Status::kOk;
}

// One by one: a whole new object would pass over the stack.
void Sweep::reset() noexcept {
  results_.inputs = BudgetInputs();
  results_.common = CommonBudget();
  results_.noise = ChannelNoise();
  results_.shared = SharedEffects();
  results_.check_before = Complex();
  results_.check_after = Complex();
  results_.failed_frequency_hz = 0.0;
  results_.least_level_mps2 = 0.0;
  results_.blocks = 0;
  results_.point_count = 0;
  results_.status = Status::kOk;
}

void Sweep::stop() noexcept {
  if (!done()) {
    fail(Status::kStopped);
  }
}

void Sweep::fail(Status status) noexcept {
  results_.least_level_mps2 =
      has_few_steps() || status == Status::kFewSteps ? work_.least_level_mps2_ : 0.0;
  (void)stream_.stop();
  results_.may_swing = results_.may_swing || results_.blocks > 0;
  results_.status = status;
  results_.failed_frequency_hz =
      results_.stage == SweepStage::kSilence ? 0.0 : work_.target_.frequency_hz;
  results_.stage = SweepStage::kFailed;
  finish();
}

void Sweep::step() noexcept {
  if (done()) {
    return;
  }
  const Span<hal::Word> words = Span<hal::Word>(work_.words_).first(work_.format_.block_frames);
  work_.drive_.fill(words);
  const hal::Exchange exchange =
      stream_.exchange(words, Span<hal::Frame>(work_.frames_).first(work_.format_.block_frames));
  if (exchange.status != Status::kOk) {
    fail(exchange.status);
    return;
  }
  ++results_.blocks;
  take_frames();
}

void Sweep::take_frames() noexcept {
  for (std::size_t i = 0; i < work_.format_.block_frames; ++i) {
    work_.reference_monitor_.add(work_.frames_[i].reference);
    work_.device_monitor_.add(work_.frames_[i].device);
  }
  work_.block_is_spent_ = false;
  watch();
  std::size_t from = 0;
  while (!done() && !work_.block_is_spent_ && from < work_.format_.block_frames) {
    std::size_t count = work_.format_.block_frames - from;
    count = work_.left_ < count ? work_.left_ : count;
    consume(from, count);
    from += count;
    work_.left_ -= static_cast<std::uint32_t>(count);
    if (work_.left_ == 0) {
      end_activity();
    }
  }
}

// What must be answered at once, whatever is going on.
void Sweep::watch() noexcept {
  const bool full_scale = work_.reference_monitor_.full_scale_words() > 0 ||
                          work_.device_monitor_.full_scale_words() > 0;
  work_.reference_monitor_.clear_full_scale();
  work_.device_monitor_.clear_full_scale();
  if (work_.activity_ == SweepWorkspace::Activity::kSilence) {
    if (full_scale) {
      fail(Status::kSaturated);
    }
    return;
  }
  if (work_.activity_ == SweepWorkspace::Activity::kRampingDown ||
      work_.activity_ == SweepWorkspace::Activity::kRest) {
    return;
  }
  const std::uint64_t period = frames_of(work_.format_.sample_rate_hz / work_.target_.frequency_hz);
  const std::uint64_t most = period > kMinEqualWords ? period : kMinEqualWords;
  if (work_.reference_monitor_.equal_words() > most || work_.device_monitor_.equal_words() > most) {
    fail(Status::kStuckChannel);
    return;
  }
  work_.is_lowering_ = work_.is_lowering_ && work_.activity_ == SweepWorkspace::Activity::kSettling;
  if (work_.is_lowering_ && work_.left_ > work_.settle_left_) {
    return;
  }
  const double peak_v = reference_peak_v() - kNoisePeak * results_.inputs.silent_reference.noise_v;
  // What still swings of the frequency before is no news of this one.
  const bool is_cautious = !work_.target_.is_close && work_.drive_per_acceleration_ > 0.0 &&
                           work_.drive_.risen_share() > kNewsShare;
  const bool is_too_much = acceleration_of(peak_v) > (is_cautious ? kUnexpectedShare : 1.0) *
                                                         results_.settings.acceleration_limit_mps2;
  if (is_too_much && !full_scale && !(work_.drive_per_acceleration_ > 0.0) &&
      !(work_.drive_.amplitude_v() > few_steps_v())) {
    work_.target_.exceeds_by_few_steps = true;  // Unless it does so without them, too.
  }
  // The device may ring while it settles.
  if ((full_scale && !work_.is_lowering_) || is_too_much) {
    lower_level(full_scale);
  }
}

/// The largest distance of the block from the offset, which is taken to a word.
double Sweep::reference_peak_v() const noexcept {
  const double volts = hal::volts_per_word(work_.scales_.reference_v);
  const auto offset = static_cast<std::int64_t>(results_.inputs.silent_reference.offset_v / volts);
  std::int64_t peak = 0;
  for (std::size_t i = 0; i < work_.format_.block_frames; ++i) {
    const std::int64_t distance = work_.frames_[i].reference - offset;
    peak = std::max(peak, distance < 0 ? -distance : distance);
  }
  return volts * static_cast<double>(peak);
}

void Sweep::lower_level(bool full_scale) noexcept {
  const bool is_look =
      !work_.target_.is_close && !(full_scale && work_.drive_per_acceleration_ > 0.0);
  work_.target_.was_overrange = work_.target_.was_overrange || full_scale || !is_look;
  if (is_look) {
    // Nothing is known of this frequency yet: it is the drive that was too much, not the level.
    ++work_.target_.tries;
    if (work_.target_.tries > kMostLooks) {
      // With next to no drive left, a channel has got there by itself.
      fail(Status::kDcDrift);
      return;
    }
    work_.is_lowering_ = true;
    const double share = work_.drive_per_acceleration_ > 0.0 ? 0.5 : kLookShare;
    drive_to(share * std::min(work_.drive_.present_v(), work_.drive_.amplitude_v()));
    return;
  }
  work_.level_scale_ *= 0.5;
  if (work_.level_scale_ < kLeastScale) {
    const bool is_offset =
        work_.reference_monitor_.is_at_one_rail() || work_.device_monitor_.is_at_one_rail();
    fail(is_offset ? Status::kDcDrift : Status::kSaturated);
    return;
  }
  work_.is_lowering_ = true;
  drive_to(0.5 * work_.drive_.amplitude_v());
}

void Sweep::consume(std::size_t from, std::size_t count) noexcept {
  const Span<const hal::Frame> frames =
      Span<const hal::Frame>(work_.frames_).from(from).first(count);
  if (work_.activity_ == SweepWorkspace::Activity::kSilence) {
    work_.silence_.add(frames);
  } else if (work_.activity_ == SweepWorkspace::Activity::kMeasuring) {
    work_.fit_.add(frames);
  }
}

void Sweep::end_activity() noexcept {
  switch (work_.activity_) {
    case SweepWorkspace::Activity::kRest:
      results_.may_swing = false;
      work_.activity_ = SweepWorkspace::Activity::kSilence;
      work_.left_ = work_.silence_.frames();
      return;
    case SweepWorkspace::Activity::kSilence:
      end_silence();
      return;
    case SweepWorkspace::Activity::kSettling:
      work_.repeats_.count = 0;
      work_.reference_rest2_ = 0.0;
      work_.device_rest2_ = 0.0;
      work_.activity_ = SweepWorkspace::Activity::kMeasuring;
      // The rates were checked by `start()`.
      (void)work_.fit_.start(work_.target_.frequency_hz, work_.format_.sample_rate_hz,
                             hal::volts_per_word(work_.scales_.reference_v));
      begin_repeat();
      return;
    case SweepWorkspace::Activity::kMeasuring:
      end_repeat();
      return;
    case SweepWorkspace::Activity::kRampingDown:
      (void)stream_.stop();
      results_.stage = SweepStage::kDone;
      finish();
      return;
  }
}

void Sweep::end_silence() noexcept {
  results_.inputs.silent_reference = work_.silence_.reference();
  results_.inputs.silent_device = work_.silence_.device();
  if (abs(results_.inputs.silent_reference.drift_v) > kWanderShare * work_.scales_.reference_v ||
      abs(results_.inputs.silent_device.drift_v) > kWanderShare * work_.scales_.device_v) {
    fail(Status::kDcDrift);
    return;
  }
  results_.stage = SweepStage::kCheckBefore;
  begin_target(results_.settings.check_hz);
}

double Sweep::aim_mps2() const noexcept {
  const double room = work_.level_room_mps2_;
  const double level = results_.settings.level_mps2;
  const double wanted =
      work_.level_scale_ * (level < kRoomShare * room ? level : kLoweredShare * room);
  const double most = work_.target_.is_close ? most_mps2()
                                             : kCautiousShare * work_.exchanged_share_ *
                                                   results_.settings.acceleration_limit_mps2;
  return wanted < most ? wanted : std::max(most, 0.0);
}

// The converter rounds by half a step, which a resonance of the shaker magnifies.
double Sweep::most_mps2() const noexcept {
  const double steps_mps2 = work_.drive_per_acceleration_ > 0.0
                                ? kRoundedSteps * few_steps_v() / work_.drive_per_acceleration_
                                : 0.0;
  return work_.exchanged_share_ *
         (kLimitShare * results_.settings.acceleration_limit_mps2 - steps_mps2);
}

// A sharp resonance ahead takes the device's channel to full scale, and it needs periods to ring
// up.
void Sweep::foresee_resonance() noexcept {
  const double flat2 = norm(results_.check_before);
  const double share = sqrt(std::max(norm(inverse_expected()) * flat2, kSharpest * kSharpest));
  work_.target_.periods = std::max(kSettlePeriods, kRingingPeriods / share);
  const double device_v = work_.scales_.device_v * ratio_factor() * share / sqrt(flat2);
  work_.level_room_mps2_ = std::max(acceleration_of(std::min(work_.scales_.reference_v, device_v)),
                                    kLeastRoom * results_.settings.level_mps2);
}

double Sweep::first_drive_v() const noexcept {
  const double share_v = kFirstDriveShare * results_.settings.drive_limit_v;
  const bool is_little = results_.settings.acceleration_limit_mps2 < kLittle_mps2;
  return is_little && few_steps_v() < share_v ? few_steps_v() : share_v;
}

void Sweep::begin_target(double frequency_hz) noexcept {
  SweepWorkspace& work = work_;
  const SweepSettings& settings = results_.settings;
  SweepWorkspace::Target& target = work.target_;
  target = SweepWorkspace::Target();
  target.frequency_hz = frequency_hz;
  target.periods = kSettlePeriods;
  // What the last frequency has left room for holds what the level was lowered by there.
  const bool is_by_room = !(settings.level_mps2 < kRoomShare * work.level_room_mps2_);
  work.level_scale_ = !is_by_room && work.level_scale_ < 0.5 ? 2.0 * work.level_scale_ : 1.0;
  if (results_.stage == SweepStage::kPoints) {
    foresee_resonance();
  }
  if (results_.stage != SweepStage::kCheckBefore) {
    foresee_ringing();
  }
  // Whole periods, to the nearest frame.
  const double period = work.format_.sample_rate_hz / frequency_hz;
  const double by_duration = floor(settings.repeat_s * frequency_hz + 0.999999);
  const double by_cycles = static_cast<double>(settings.cycles);
  target.repeat_frames = frames_of(period * (by_duration > by_cycles ? by_duration : by_cycles));
  // A fit needs a full period and four samples.
  while (static_cast<double>(target.repeat_frames) < period || target.repeat_frames < 4) {
    ++target.repeat_frames;
  }
  const double most_v = work.drive_.max_amplitude_v(frequency_hz);
  double amplitude_v = work.drive_per_acceleration_ > 0.0
                           ? aim_mps2() * work.drive_per_acceleration_
                           : first_drive_v();
  amplitude_v = amplitude_v < most_v ? amplitude_v : most_v;
  target.is_close = true;
  target.permitted_v = SweepWorkspace::kPermittedStep * aim_mps2() * work.drive_per_acceleration_;
  target.is_close = false;
  drive_to(amplitude_v);
}

// While it is not known what the shaker makes of the drive, at all or at this frequency, the limit
// is to be seen before the rise has gone far beyond it.
double Sweep::rise_s() const noexcept {
  const double limit = results_.settings.acceleration_limit_mps2;
  if (work_.drive_per_acceleration_ > 0.0) {
    // A resonance that a fast rise excites adds as much again.
    const double far = work_.target_.is_close ? kTwice : kCarefree;
    return limit < far * aim_mps2() ? kLeastRise_s + kRisePeriods / work_.target_.frequency_hz
                                    : 0.0;
  }
  return limit < kLivelyGain * kFirstDriveShare * results_.settings.drive_limit_v ? kSlowRise_s
                                                                                  : 0.0;
}

void Sweep::drive_to(double amplitude_v) noexcept {
  const double periods_s = work_.target_.periods / work_.target_.frequency_hz;
  const double settle_s =
      std::max(work_.target_.settle_scale * std::max(results_.settings.settle_s, periods_s),
               work_.target_.ringing_s);
  work_.settle_left_ = frames_of(settle_s * work_.format_.sample_rate_hz);
  work_.left_ = work_.drive_.go_to(work_.target_.frequency_hz, amplitude_v, rise_s()) +
                work_.format_.latency_frames + work_.settle_left_ + 1u;
  work_.activity_ = SweepWorkspace::Activity::kSettling;
  work_.block_is_spent_ = true;
  work_.reference_monitor_.clear_equal_words();
  work_.device_monitor_.clear_equal_words();
  work_.reference_monitor_.clear_rails();
  work_.device_monitor_.clear_rails();
}

void Sweep::begin_repeat() noexcept {
  work_.fit_.restart();
  work_.left_ = work_.target_.repeat_frames;
}

void Sweep::begin_next() noexcept {
  if (results_.stage == SweepStage::kCheckAfter) {
    work_.left_ =
        work_.drive_.go_to(work_.target_.frequency_hz, 0.0) + work_.format_.latency_frames + 1u;
    work_.activity_ = SweepWorkspace::Activity::kRampingDown;
    work_.block_is_spent_ = true;
    return;
  }
  if (results_.point_count == results_.settings.frequency_count) {
    results_.stage = SweepStage::kCheckAfter;
    begin_target(results_.settings.check_hz);
    return;
  }
  results_.stage = SweepStage::kPoints;
  begin_target(results_.settings.frequency_hz[results_.point_count]);
}

void Sweep::finish() noexcept {
  SweepResults& results = results_;
  SweepWorkspace& work = work_;
  BudgetInputs& inputs = results.inputs;
  inputs.reference_step_v = work.scales_.reference_v * work.reference_monitor_.step();
  inputs.device_step_v = work.scales_.device_v * work.device_monitor_.step();
  const double before = norm(results.check_before);
  const double after = norm(results.check_after);
  const bool has_checks = before > 0.0 && after > 0.0;
  results.common = common_budget(results.settings, has_checks ? sqrt(after / before) - 1.0 : 0.0);
  const std::size_t count = results.point_count;
  results.noise =
      pooled_noise(Span<const PointScatter>(work.scatter_).first(count),
                   Span<const double>(results.settings.frequency_hz).first(count), inputs);
  for (std::size_t i = 0; i < count; ++i) {
    SweepPoint& point = results.table[i];
    const PointVerdict verdict =
        point_verdict(work.scatter_[i], point.point.frequency_hz, results.noise, inputs);
    point.budget = verdict.budget;
    point.residual_percent = static_cast<float>(verdict.residual_percent);
    // What the shaker still swings by is beyond chance where there is no noise; the point's
    // uncertainty has it, and little of it is not worth a look.
    point.scatters = verdict.scatters && verdict.budget.noise > kMuchScatter;
    point.flagged = point.flagged || point.scatters || verdict.budget.hum > kMuchHum;
    point.point.u_amplitude = verdict.relative_u * point.point.amplitude;
    point.point.u_phase_rad = verdict.relative_u;
  }
  if (count > 0) {
    share_effects(has_checks ? sqrt(after / before) - 1.0 : 0.0);
  }
}

// What no scatter shows, in the parameters and, so that chi-square can be judged, in the points.
void Sweep::share_effects(double check_change) noexcept {
  SweepResults& results = results_;
  const std::size_t count = results.point_count;
  SweepLevels levels;
  levels.device_scale2 = work_.scales_.device_v * work_.scales_.device_v;
  levels.reference_scale2 = work_.scales_.reference_v * work_.scales_.reference_v;
  double time = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const PointScatter& scatter = work_.scatter_[i];
    levels.largest_device2 = std::max(levels.largest_device2, norm(scatter.device));
    levels.largest_amplitude = std::max(levels.largest_amplitude, results.table[i].point.amplitude);
    levels.mean_reference2 += norm(scatter.reference) / static_cast<double>(count);
  }
  const double check_u =
      point_verdict(work_.check_scatter_, results.settings.check_hz, results.noise, results.inputs)
          .relative_u;
  const double squares = check_change * check_change - check_u * check_u;
  const double highest_hz = results.table[count - 1].point.frequency_hz;
  results.shared = shared_effects(results.settings, work_.format_.sample_rate_hz,
                                  squares > 0.0 ? sqrt(squares) : 0.0, ratio_factor(), highest_hz,
                                  sqrt(levels.largest_device2) / work_.scales_.device_v);
  // The points keep what was seen, by which chi-square is judged; the parameters also what the
  // noise of two checks may have hidden.
  const double drift = norm(results.check_after) > 0.0
                           ? sqrt(std::max(squares, kHiddenShare * check_u * check_u))
                           : 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    time += time_of(results.table[i].point.frequency_hz, results.shared.corner_hz);
  }
  double passed = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    ResponsePoint& point = results.table[i].point;
    const double own = time_of(point.frequency_hz, results.shared.corner_hz);
    const Complex at = shared_at(results.shared, point.frequency_hz, (passed + 0.5 * own) / time,
                                 point.frequency_hz / highest_hz);
    passed += own;
    const double bent = unfitted_crosstalk(results.shared, results.settings.skew_s, point);
    const double off_level = unfitted_linearity(results.settings, levels, work_.scatter_[i], point);
    const double u = point.u_amplitude / point.amplitude;
    const double turned = unfitted_turn(at.im);
    const double shared2 = at.re * at.re + bent * bent + off_level * off_level + turned * turned;
    results.table[i].budget.shared = sqrt(shared2);
    point.u_amplitude = sqrt(u * u + shared2) * point.amplitude;
    point.u_phase_rad = sqrt(u * u + (at.im * at.im + bent * bent));
  }
  results.shared.drift = drift;
}

}  // namespace emax::app
