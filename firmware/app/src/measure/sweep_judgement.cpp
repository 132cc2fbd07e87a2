// What a sweep makes of its repeats: the level, the faults, the points.
#include <algorithm>
#include <limits>

#include "emax/app/measure/sweep.hpp"
#include "emax/app/measure/sweep_workspace.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::app {
namespace {

constexpr double kWeakSigmas = 8.0;
constexpr double kMostLeak = 0.015;  // Of percent with k = 2: three standard uncertainties.
constexpr double kLevelTolerance = 0.05;
constexpr double kRaise = 8.0;
constexpr double kSurelySeen = 1.5;       // Times where a device is seen.
constexpr double kBlindShare = 0.1;       // Of the drive limit, while nothing was seen at all,
constexpr double kBlindGain = 40.0;       // and to the limit with a shaker of so many (m/s^2)/V.
constexpr double kContradiction = 0.67;   // Of what the device saw per drive before.
constexpr double kConfirmedWithin = 0.1;  // Two looks that agree.
constexpr double kConfirmingShare = 0.5;  // Of the drive, for the second of them.
constexpr std::uint32_t kMaxTries = 12;
constexpr double kLooseShare = 0.01;     // Repeats that differ by more are taken again.
constexpr double kDistortedShare = 0.1;  // An error above,
constexpr double kFlaggedShare = 0.03;   // flagged above;
constexpr double kMixedShare = 0.06;     // more is what an exchange in the midst of a look leaves.
constexpr double kFewSteps = 0.0025;     // Of full scale: five steps of 12 bits, 8 %.
// Times that, at the check, for what the limit permits: the first look at a frequency takes a
// quarter, and the shaker may be livelier there.
constexpr double kCautiousSteps = 2.5;
constexpr double kSixOfFive = 1.2;
constexpr double kManySteps = 4.0;
constexpr double kHalfStep = 0.1;
constexpr std::uint64_t kStuckWords = 128;
constexpr double kOffsetShare = 0.02;  // Of full scale, against the silence.
constexpr double kTurnedRound = 0.9;   // Cosine of the angle to half a turn,
constexpr double kFlatWithin = 1.2;    // and the largest factor to the check's ratio.
constexpr double kLargestJump2 =
    64.0;  // Of the square of the ratio, from one frequency to the next.
constexpr std::uint32_t kMostLooksAgain = 2;  // After the first.
constexpr double kRingingScale = 8.0;         // Of the settling time, for each of them,
constexpr double kLookShare = 0.25;           // and of the drive, for the last.
constexpr double kMostHum = 0.1;              // Of the ratio, at a point,
constexpr double kMostHumOfCheck = 0.02;      // and at the check, which others are judged by.
constexpr double kHumPeak = 1.5;              // Of its rms part; more than a sine's.
constexpr double kSwappedShare = 0.16;        // Of the squares of the distances to both.
constexpr double kAlike2 = 4e-4;              // Square of a distance that says nothing: 2 %.
constexpr double kForeseen = 0.09;            // Square of a share of the 1/K that is expected,
constexpr double kShortestBase = 0.1;         // Of the square of the frequency, for a slope.
constexpr double kForeseenFlat = 1e-4;        // and of that at the check frequency.

constexpr double kRingingTimes = 12.0;  // Time constants of the device: 6e-6 is left.
constexpr double kLongestRinging_s = 3.0;
constexpr double kLeastLag = 2e-4;  // Of 1/K: less may be noise.

// A device of second order never leads. Sensors with a high pass do, by less than a degree where
// it matters; a skew that was set wrong by 1 us adds to it.
constexpr double kLead_rad = 0.0175;
constexpr double kLeadPerHz_rad = 6.3e-6;

// Out of line, for their size.
[[gnu::noinline]] double square_of(const Complex& z) noexcept { return norm(z); }
[[gnu::noinline]] double magnitude(const Complex& z) noexcept { return sqrt(square_of(z)); }

[[gnu::noinline]] double distance2(const Complex& a, const Complex& b) noexcept {
  return square_of(a - b);
}
[[gnu::noinline]] Complex inverse_of(const Complex& z) noexcept { return reciprocal(z); }

[[gnu::noinline]] bool is_beyond(double ratio, double factor) noexcept {
  return !(ratio < factor) || !(ratio * factor > 1.0);
}

/// What the ratio says of the cables.
///
/// @param ratio    Measured.
/// @param expected From the frequency before, or from the data sheet.
/// @param swapped  What exchanged channels would give.
Status cables_of(const Complex& ratio, const Complex& expected, const Complex& swapped) noexcept {
  const double to_inverted2 = distance2(ratio, -expected) * square_of(swapped);
  const double to_swapped2 = distance2(ratio, swapped) * square_of(expected);
  return to_inverted2 < to_swapped2 ? Status::kInvertedPolarity : Status::kSwappedChannels;
}

}  // namespace

/// What one repeat's fit says of one channel.
struct Sweep::Reading {
  SineFitResult fit;
  double weak_v = 0.0;   // Below this it may be noise.
  double doubt_v = 0.0;  // What noise and hum make of its mean.
  double leak_v = 0.0;   // What the other channel may make of it by crosstalk.
  double distortion = 0.0;
  double least_v() const noexcept { return fit.amplitude_v - weak_v; }
  double most_v() const noexcept { return fit.amplitude_v + weak_v; }
  bool is_weak() const noexcept { return !(fit.amplitude_v > weak_v + leak_v); }
  bool is_strong() const noexcept { return fit.amplitude_v > 10.0 * weak_v; }
  // The phase is good to 0.15 degrees.
  bool is_clear() const noexcept { return fit.amplitude_v > 50.0 * weak_v; }
};

double Sweep::acceleration_of(double reference_v) const noexcept {
  return reference_v / results_.settings.reference_gain /
         sensitivity_at(results_.settings.reference, work_.target_.frequency_hz);
}

Sweep::Reading Sweep::reading_of(const SineFitResult& fit,
                                 const SilentChannel& silent) const noexcept {
  const double samples = static_cast<double>(work_.target_.repeat_frames);
  Reading reading;
  reading.fit = fit;
  double hum2 = 0.0;
  for (const double hum_v : silent.hum_v) {
    hum2 += hum_v * hum_v;
  }
  // Hum is no distortion.
  const double rest2 = fit.residual_std_v * fit.residual_std_v - 0.5 * hum2;
  reading.fit.residual_std_v = rest2 > 0.0 ? sqrt(rest2) : 0.0;
  reading.weak_v =
      kWeakSigmas * silent.noise_v * sqrt(2.0 / samples) +
      3.0 * silent.hum_in_fit_v(work_.target_.frequency_hz, samples / work_.format_.sample_rate_hz);
  reading.doubt_v = reading.weak_v + 2.0 * sqrt(hum2);
  reading.distortion =
      distortion_of(reading.fit.residual_std_v, silent.noise_v, reading.fit.amplitude_v, samples);
  return reading;
}

void Sweep::end_repeat() noexcept {
  Reading reference = reading_of(work_.fit_.reference(), results_.inputs.silent_reference);
  Reading device = reading_of(work_.device_fit(), results_.inputs.silent_device);
  const double leak = kMostLeak * results_.settings.crosstalk_expanded_percent;
  reference.leak_v = leak * device.fit.amplitude_v;
  device.leak_v = leak * reference.fit.amplitude_v;
  if (work_.repeats_.count == 0) {
    judge_first(reference, device);
    if (done() || work_.block_is_spent_) {
      return;
    }
    work_.first_reference_offset_v_ = reference.fit.offset_v;
    work_.first_device_offset_v_ = device.fit.offset_v;
  }
  const Status status = disturbance_of(reference, device);
  if (status != Status::kOk) {
    suspect(status);
    return;
  }
  work_.reference_rest2_ += reference.fit.residual_std_v * reference.fit.residual_std_v;
  work_.device_rest2_ += device.fit.residual_std_v * device.fit.residual_std_v;
  // Both to the time of the first repeat's first sample.
  const double turns = static_cast<double>(work_.repeats_.count) *
                       static_cast<double>(work_.target_.repeat_frames) *
                       work_.target_.frequency_hz / work_.format_.sample_rate_hz;
  const SinCos back = sincos(kTwoPi * (turns - floor(turns)));
  const Complex turn = {back.cos, -back.sin};
  work_.repeats_.reference[work_.repeats_.count] = turn * reference.fit.phasor();
  work_.repeats_.device[work_.repeats_.count] = turn * device.fit.phasor();
  ++work_.repeats_.count;
  if (work_.repeats_.count < results_.settings.repeats) {
    begin_repeat();
    return;
  }
  end_target();
}

// The first repeat after each change of the drive: is there a signal, and is the level right?
void Sweep::judge_first(const Reading& reference, const Reading& device) noexcept {
  if (results_.stage == SweepStage::kCheckBefore && look_for_exchange(reference, device)) {
    suspect(Status::kSwappedChannels);
    return;
  }
  if (work_.target_.exceeds_by_few_steps) {
    fail(status_of_steps());
    return;
  }
  if (reference.is_weak()) {
    if (device.is_strong()) {
      suspect(Status::kNoReference);
    } else {
      raise_drive(reference, device);
    }
    return;
  }
  const double acceleration = acceleration_of(reference.fit.amplitude_v);
  const double drive_v = work_.drive_.amplitude_v();
  if (seen_v(reference, device) < drive_v) {
    suspect(Status::kNoDevice);
    return;
  }
  const double per_acceleration = drive_v / acceleration;
  const double few_steps_mps2 = few_steps_v() / per_acceleration;
  const double share = results_.stage == SweepStage::kCheckBefore ? kCautiousSteps : 1.0;
  if (few_steps() != Status::kWeakSignal && drive_v >= few_steps_v() &&
      most_mps2() < share * few_steps_mps2) {
    work_.least_level_mps2_ = few_steps_mps2;
    fail(few_steps());
    return;
  }
  work_.target_.is_close = true;
  const bool is_first_look = !(work_.drive_per_acceleration_ > 0.0);
  if (is_first_look) {
    work_.level_room_mps2_ = room_mps2(reference.fit.amplitude_v, device.fit.amplitude_v);
  }
  const Status status = status_at_first(reference, device);
  if (status != Status::kOk) {
    suspect(status);
    return;
  }
  if (is_first_look && has_left_silence(reference, device)) {
    suspect(Status::kDcDrift);  // Before more drive hides it behind full scale.
    return;
  }
  const double aim = aim_mps2();
  const double most_v = work_.drive_.max_amplitude_v(work_.target_.frequency_hz);
  const bool is_low = acceleration < aim * (1.0 - kLevelTolerance);
  if (device.is_weak() && (!is_low || drive_v >= most_v)) {
    // More drive would not be within the level.
    suspect(reference.is_strong() ? Status::kNoDevice : Status::kWeakSignal);
    return;
  }
  if (is_low && !may_rise(reference, device, aim * per_acceleration)) {
    return;
  }
  work_.target_.acceleration_mps2 = acceleration;
  work_.drive_per_acceleration_ = per_acceleration;
  if (drive_v >= few_steps_v() || !(work_.least_level_mps2_ > 0.0 || is_level_little())) {
    work_.least_level_mps2_ = few_steps_mps2;  // By a drive of fewer steps, roughly.
  }
  if (abs(acceleration / aim - 1.0) <= kLevelTolerance) {
    return;
  }
  const double needed_v = std::min(aim * per_acceleration, kSurelySeen * seen_v(reference, device));
  if (!(needed_v > kHalfStep * few_steps_v())) {
    fail(few_steps());  // Such a drive is none.
    results_.least_level_mps2 = work_.least_level_mps2_;
    return;
  }
  ++work_.target_.tries;
  if (needed_v > most_v * (1.0 + kLevelTolerance) || work_.target_.tries > kMaxTries) {
    fail_at_level();
    return;
  }
  if (needed_v > most_v && drive_v >= most_v) {
    return;  // Within the tolerance at the largest drive.
  }
  drive_to(needed_v < most_v ? needed_v : most_v);
}

// Of exchanged channels the device's input reads the acceleration, and the level must not exceed
// the limit by that unless the data sheet excludes it.
//
// @returns Whether the channels contradict the data sheet as only the drive's rise would answer:
// the device reads more than the reference lets it.
bool Sweep::look_for_exchange(const Reading& reference, const Reading& device) noexcept {
  const double sheet = sheet_v_per_v();
  const double most_v = kPlausibleFactor * sheet;
  const double least_v = sheet / kPlausibleFactor;
  const double reference_most_v = reference.most_v();
  const double device_most_v = device.most_v();
  const bool has_sheet = sheet > 0.0;
  const bool is_excluded = has_sheet && (reference.least_v() > most_v * device_most_v ||
                                         reference_most_v < least_v * device.least_v());
  work_.exchanged_share_ = is_excluded || reference.fit.amplitude_v > device_most_v
                               ? 1.0
                               : reference.fit.amplitude_v / device_most_v;
  return has_sheet && !is_excluded && device.least_v() > most_v * reference_most_v;
}

// A device without a signal at the check: what the reference's input reads may be the device, too.
// The drive rises to where the data sheet lets it be seen, first, and no further without it.
//
// @returns That drive; infinity where the device is seen, or nothing is known of it.
double Sweep::seen_v(const Reading& reference, const Reading& device) const noexcept {
  const double sheet = sheet_v_per_v();
  if (results_.stage != SweepStage::kCheckBefore || !device.is_weak() || !(sheet > 0.0)) {
    return std::numeric_limits<double>::infinity();
  }
  return kPlausibleFactor * device.most_v() / (sheet * reference.least_v()) *
         work_.drive_.amplitude_v();
}

// Before the level follows a reference that may be another sensor by now, upwards or downwards.
Status Sweep::status_at_first(const Reading& reference, const Reading& device) noexcept {
  if (!reference.is_clear() || !device.is_clear()) {
    return Status::kOk;
  }
  const bool is_lost = has_lost_gain(reference, device);
  // At the first look a device that is saturated at the level would look like another fault.
  const bool is_judged =
      results_.stage != SweepStage::kCheckBefore && device.distortion <= kFlaggedShare;
  const Status cables = is_judged
                            ? plausibility_of(ratio_of(reference.fit.phasor(), device.fit.phasor()),
                                              reference.weak_v / reference.fit.amplitude_v +
                                                  device.weak_v / device.fit.amplitude_v)
                            : Status::kOk;
  if (cables != Status::kOk || !is_lost) {
    return cables;
  }
  return reference.distortion > kFlaggedShare ? Status::kDistorted : Status::kNoReference;
}

// From one look to the next at the same frequency the reference reads less per drive, and the
// device does not: the shaker is the same, and to keep the level would need more than the level.
bool Sweep::has_lost_gain(const Reading& reference, const Reading& device) noexcept {
  if (work_.target_.was_overrange) {
    return false;
  }
  const double reference_v_per_v = reference.fit.amplitude_v / work_.drive_.amplitude_v();
  const double by_device = reference.fit.amplitude_v / device.fit.amplitude_v;
  SweepWorkspace::Target& target = work_.target_;
  constexpr double kLeast = 1.0 - kConfirmedWithin;
  if (!(target.by_device > 0.0)) {
    target.reference_v_per_v = reference_v_per_v;
    target.by_device = by_device;
  }
  return reference_v_per_v < kLeast * target.reference_v_per_v &&
         by_device < kLeast * target.by_device;
}

bool Sweep::is_level_little() const noexcept {
  return work_.level_room_mps2_ < results_.settings.level_mps2;
}

double Sweep::few_steps_v() const noexcept { return kFewSteps * work_.format_.drive_full_scale_v; }

// A drive of few steps of its converter is no sine, and cannot be set to a level; one below a step
// is nothing at all.
bool Sweep::has_few_steps() const noexcept {
  return work_.least_level_mps2_ > 0.0 && work_.drive_.amplitude_v() < few_steps_v();
}

// Few steps make more than the limit, or the reference's input reads another sensor.
Status Sweep::status_of_steps() const noexcept {
  const Reading reference = reading_of(work_.fit_.reference(), results_.inputs.silent_reference);
  const Reading device = reading_of(work_.device_fit(), results_.inputs.silent_device);
  const bool is_off_sheet =
      sheet_v_per_v() * reference.least_v() > kPlausibleFactor * device.most_v();
  return is_off_sheet ? Status::kSwappedChannels : Status::kFewSteps;
}

// A level near the limit cannot be raised, nor one to what is near the limit.
Status Sweep::few_steps() const noexcept {
  const double level = results_.settings.level_mps2;
  const double least = work_.least_level_mps2_;
  const double needed = has_few_steps() && least > level ? least : level;
  return 2.0 * needed > results_.settings.acceleration_limit_mps2 ? status_of_steps()
                                                                  : Status::kWeakSignal;
}

// A level that full scale has made little is not reached for the converters' steps, and a channel
// that was too large for its level may not follow the drive.
void Sweep::fail_at_level() noexcept {
  fail(is_level_little() || work_.target_.was_overrange ? Status::kSaturated
       : has_few_steps()                                ? few_steps()
                                                        : Status::kLevelNotReached);
}

// What takes one of the channels to full scale, as far as their gains can be believed: of a
// device far from its data sheet the gain is in doubt, and it is judged at the full level.
double Sweep::room_mps2(double reference_v, double device_v) const noexcept {
  const double of_reference = acceleration_of(work_.scales_.reference_v);
  const double sheet = results_.settings.expected_sensitivity;
  const double sensitivity = ratio_factor() * device_v / reference_v;
  const bool is_check = results_.stage == SweepStage::kCheckBefore;
  if (is_check && sheet > 0.0 && is_beyond(sensitivity / sheet, kPlausibleFactor)) {
    return of_reference;
  }
  const double of_device = work_.scales_.device_v * acceleration_of(reference_v) / device_v;
  return of_device < of_reference ? of_device : of_reference;
}

// Of the ratio: from the check, or from the frequency before, which knows of no resonance ahead.
double Sweep::least_expected() const noexcept {
  return results_.stage == SweepStage::kCheckAfter
             ? magnitude(results_.check_before)
             : std::min(magnitude(work_.last_ratio_), 1.0 / magnitude(inverse_expected()));
}

// More drive, because the reference reads less than the level. It may read less because it has just
// died, or because its gain has changed: the limit of acceleration depends on it.
bool Sweep::may_rise(const Reading& reference, const Reading& device, double needed_v) noexcept {
  const double drive_v = work_.drive_.amplitude_v();
  const bool is_look = !(work_.drive_per_acceleration_ > 0.0);
  SweepWorkspace::Target& target = work_.target_;
  const bool is_permitted = is_look || needed_v <= target.permitted_v;
  if (work_.device_v_per_v_ > 0.0 && device.is_weak() &&
      (!is_permitted || device.most_v() < 0.5 * reference.fit.amplitude_v / ratio_factor() /
                                              magnitude(inverse_expected()))) {
    // What the reference's input reads may be the device, and the reference dead.
    suspect(Status::kNoDevice);
    return false;
  }
  if (!is_permitted && results_.stage == SweepStage::kCheckBefore && drive_v >= few_steps_v()) {
    // At one frequency less per drive from one look to the next is no shaker's way.
    suspect(device.is_weak() ? Status::kNoDevice : Status::kNoReference);
    return false;
  }
  // Of few steps the drive is less of a sine.
  const double most = drive_v < kManySteps * few_steps_v() ? kDistortedShare : kMixedShare;
  if (is_permitted && reference.distortion <= most) {
    target.permitted_v = is_look ? SweepWorkspace::kPermittedStep * needed_v : target.permitted_v;
    return true;
  }
  if (!is_permitted && reference.distortion <= kDistortedShare && work_.device_v_per_v_ > 0.0 &&
      device.fit.amplitude_v > kContradiction * drive_v * work_.device_v_per_v_ &&
      kContradiction * ratio_factor() * device.fit.amplitude_v >
          least_expected() * reference.fit.amplitude_v) {
    // The device sees as much as before, and more than the reference lets it.
    suspect(Status::kNoReference);
    return false;
  }
  const double per_acceleration = drive_v / acceleration_of(reference.fit.amplitude_v);
  if (abs(target.unconfirmed_v - per_acceleration) <= kConfirmedWithin * per_acceleration) {
    const double permitted_v = SweepWorkspace::kPermittedStep * needed_v;
    target.permitted_v = is_permitted && !is_look ? target.permitted_v : permitted_v;
    return true;
  }
  if (++target.tries > kMaxTries) {
    fail_at_level();
    return false;
  }
  target.unconfirmed_v = per_acceleration;
  drive_to(is_permitted ? drive_v : kConfirmingShare * drive_v);
  return false;
}

// Neither channel has a signal. Once the shaker is known, more drive is no way to find out why.
void Sweep::raise_drive(const Reading& reference, const Reading& device) noexcept {
  if (work_.drive_per_acceleration_ > 0.0) {
    suspect(Status::kWeakSignal);
    return;
  }
  const double limit_v = std::min(kBlindShare * results_.settings.drive_limit_v,
                                  results_.settings.acceleration_limit_mps2 / kBlindGain);
  const double permitted_v = work_.drive_.max_amplitude_v(work_.target_.frequency_hz);
  const double most_v = limit_v < permitted_v ? limit_v : permitted_v;
  if (work_.drive_.amplitude_v() >= most_v) {
    fail(Status::kWeakSignal);
    return;
  }
  // What is not seen yet may be as large as the noise hides, or, of exchanged channels, as what the
  // other input reads.
  const double hidden_mps2 = acceleration_of(
      device.fit.amplitude_v > reference.weak_v ? device.most_v() : reference.weak_v);
  const double rise = aim_mps2() / hidden_mps2;
  if (rise < SweepWorkspace::kPermittedStep) {
    fail(Status::kWeakSignal);
    return;
  }
  const double raised_v = (rise < kRaise ? rise : kRaise) * work_.drive_.amplitude_v();
  drive_to(raised_v < most_v ? raised_v : most_v);
}

// By how much the offsets have moved apart. A slow swing of the shaker moves both, in the ratio of
// low frequencies.
double Sweep::offset_change_v(double reference_v, double device_v) const noexcept {
  const double ratio = square_of(results_.check_before) > 0.0
                           ? magnitude(results_.check_before) / ratio_factor()
                           : work_.device_fit().amplitude_v / work_.fit_.reference().amplitude_v;
  return abs(device_v - ratio * reference_v) / (ratio > 1.0 ? ratio : 1.0);
}

// Offsets that are no longer those of the silence.
bool Sweep::has_left_silence(const Reading& reference, const Reading& device) const noexcept {
  const double moved_v =
      offset_change_v(reference.fit.offset_v - results_.inputs.silent_reference.offset_v,
                      device.fit.offset_v - results_.inputs.silent_device.offset_v);
  return moved_v > kOffsetShare * work_.scales_.device_v + reference.doubt_v + device.doubt_v;
}

Status Sweep::disturbance_of(const Reading& reference, const Reading& device) const noexcept {
  if (reference.is_weak()) {
    return device.is_weak() ? Status::kWeakSignal : Status::kNoReference;
  }
  if (device.is_weak()) {
    return Status::kNoDevice;
  }
  const double full_scale_v = work_.scales_.device_v;
  const double within_v = offset_change_v(reference.fit.offset_v - work_.first_reference_offset_v_,
                                          device.fit.offset_v - work_.first_device_offset_v_);
  // After overrange the ratio is in doubt; it is judged before anything else.
  const double doubt_v = reference.doubt_v + device.doubt_v;
  if (!work_.target_.was_overrange &&
      (within_v > kWanderShare * full_scale_v + doubt_v || has_left_silence(reference, device))) {
    // The mean of words that have just got stuck is another one, too.
    return work_.device_monitor_.equal_words() > kStuckWords ? Status::kStuckChannel
                                                             : Status::kDcDrift;
  }
  const double samples = static_cast<double>(work_.target_.repeat_frames);
  // Above a sharp resonance there is little beside what rings on: it is judged by what the device
  // sees at the check frequency.
  const double flat_v =
      reference.fit.amplitude_v * magnitude(results_.check_before) / ratio_factor();
  const double device_v = device.fit.amplitude_v > flat_v ? device.fit.amplitude_v : flat_v;
  const double of_device = distortion_of(device.fit.residual_std_v,
                                         results_.inputs.silent_device.noise_v, device_v, samples);
  // A drive of few steps is no good sine, as rounding has harmonics; its point is flagged.
  const bool is_of_steps = work_.drive_.amplitude_v() < kManySteps * few_steps_v();
  const double most = is_level_little() || is_of_steps ? 2.0 * kDistortedShare : kDistortedShare;
  if (reference.distortion > most || of_device > most) {
    return Status::kDistorted;
  }
  return Status::kOk;
}

// A fault that begins within a repeat looks like another one: the second look decides. What is not
// a sine may be a sharp resonance that rings: it gets more time, and then a lower level, because
// its share of the drive's harmonics falls with it.
void Sweep::suspect(Status status) noexcept {
  SweepWorkspace::Target& target = work_.target_;
  const bool may_ring = status == Status::kDistorted;
  // A second fault within the second look moves the mean, too.
  const bool is_patient = may_ring || status == Status::kDcDrift;
  double drive_v = work_.drive_.amplitude_v();
  if (target.looks >= (is_patient ? kMostLooksAgain : 1)) {
    fail(status == Status::kDistorted ? distortion() : status);
    return;
  }
  ++target.looks;
  if (may_ring) {
    target.settle_scale *= kRingingScale;
    // A level that full scale has made little needs its steps.
    if (target.looks == kMostLooksAgain && !is_level_little() &&
        results_.stage != SweepStage::kCheckBefore) {
      work_.level_scale_ *= kLookShare;
      drive_v *= kLookShare;
    }
  }
  drive_to(drive_v);
}

// Less of a drive of few steps, as for other distortion, would not help.
Status Sweep::distortion() const noexcept {
  if (is_level_little()) {
    return Status::kSaturated;
  }
  // With one step more, too, a look may be distorted.
  const bool is_of_steps = work_.drive_per_acceleration_ > 0.0 &&
                           work_.drive_.amplitude_v() < kSixOfFive * few_steps_v();
  return is_of_steps ? few_steps() : Status::kDistorted;
}

// Device's volts over the reference's, by the data sheet; 0 without one.
double Sweep::sheet_v_per_v() const noexcept {
  return results_.settings.expected_sensitivity / ratio_factor();
}

// K over the ratio of the volts.
double Sweep::ratio_factor() const noexcept {
  return sensitivity_at(results_.settings.reference, work_.target_.frequency_hz) *
         results_.settings.reference_gain /
         (results_.settings.device_gain * results_.settings.ratio_correction);
}

Complex Sweep::ratio_of(const Complex& reference, const Complex& device) const noexcept {
  // Sampled later, the device's channel is ahead by w skew.
  const SinCos skew = sincos(kTwoPi * work_.target_.frequency_hz * results_.settings.skew_s);
  return ratio_factor() * ((device / reference) * Complex{skew.cos, -skew.sin});
}

void Sweep::end_target() noexcept {
  PointScatter scatter = scatter_of(work_.repeats_);
  scatter.repeat_samples = static_cast<double>(work_.target_.repeat_frames);
  const double frequency_hz = work_.target_.frequency_hz;
  const double by_noise = kNoisePeak * expected_scatter(scatter, frequency_hz, results_.inputs);
  if (scatter.largest > by_noise + (work_.target_.looks > 1 ? kDistortedShare : kLooseShare)) {
    suspect(Status::kDistorted);
    return;
  }
  const double repeats = static_cast<double>(work_.repeats_.count);
  const double hum =
      relative_hum(scatter, frequency_hz, repeats * scatter.repeat_samples, results_.inputs);
  if (hum > (results_.stage == SweepStage::kPoints ? kMostHum : kMostHumOfCheck)) {
    fail(Status::kHum);
    return;
  }
  scatter.reference_rest_v = sqrt(work_.reference_rest2_ / repeats);
  scatter.device_rest_v = sqrt(work_.device_rest2_ / repeats);
  const Complex ratio = ratio_of(scatter.reference, scatter.device);
  work_.device_v_per_v_ = magnitude(scatter.device) / work_.drive_.amplitude_v();
  const bool is_judged = hum <= kMostHumOfCheck;
  const Status status = is_judged ? plausibility_of(ratio, by_noise, kHumPeak * hum) : Status::kOk;
  if (status != Status::kOk) {
    suspect(status);
    return;
  }
  work_.level_room_mps2_ = room_mps2(magnitude(scatter.reference), magnitude(scatter.device));
  if (results_.stage == SweepStage::kPoints) {
    store_point(scatter, ratio);
  } else if (results_.stage == SweepStage::kCheckBefore) {
    results_.check_before = ratio;
  } else {
    results_.check_after = ratio;
    work_.check_scatter_ = scatter;
  }
  if (is_judged) {
    work_.last_ratio_ = ratio;
    work_.last_hz_ = frequency_hz;
  }
  begin_next();
}

// The check frequency is far below the resonance, and so is what lies below it.
bool Sweep::is_neighbour() const noexcept {
  return work_.target_.frequency_hz < kPlausibleFactor * work_.last_hz_;
}

// Half a turn between neighbours, both as large as at the check frequency: a resonance between them
// would have made one of them larger, unless they are far apart.
bool Sweep::has_turned_round(const Complex& ratio, const Complex& before) const noexcept {
  const double flat = magnitude(results_.check_before);
  const double size = magnitude(ratio);
  const double size_before = magnitude(before);
  return ratio.re * before.re + ratio.im * before.im < -kTurnedRound * size * size_before &&
         !is_beyond(size / flat, kFlatWithin) && !is_beyond(size_before / flat, kFlatWithin) &&
         is_neighbour();
}

// What check and last frequency let expect of a device of second order: of its 1/K the real part is
// linear in the square of the frequency, and the imaginary part in the frequency.
Complex Sweep::inverse_expected() const noexcept {
  const Complex before = inverse_of(work_.last_ratio_);
  const double step = work_.target_.frequency_hz / work_.last_hz_;
  return {before.re + inverse_slope() * (step * step - 1.0), step * before.im};
}

// Of the real part, over the square of the frequency in units of the last one.
double Sweep::inverse_slope() const noexcept {
  const double check = results_.settings.check_hz / work_.last_hz_;
  const double base = 1.0 - check * check;
  // Too near one another, they tell no slope.
  return abs(base) > kShortestBase
             ? (inverse_of(work_.last_ratio_).re - inverse_of(results_.check_before).re) / base
             : 0.0;
}

// A device of little damping rings at its own frequency after each change of the drive, wherever
// that is. Its time constant is mu3/mu2, both from what check and last frequency say of 1/K.
void Sweep::foresee_ringing() noexcept {
  const Complex inverse = inverse_of(work_.last_ratio_);
  const double lag = abs(inverse.im) + kLeastLag * abs(inverse.re);
  const double times_s = -2.0 * kRingingTimes * inverse_slope() / (kTwoPi * work_.last_hz_ * lag);
  work_.target_.ringing_s = times_s < kLongestRinging_s ? times_s : kLongestRinging_s;
}

// Where device and reference give the same volts, exchanged channels have the same ratio, but for
// the phase: there it is noise that chooses between the two, and a resonance shows them apart.
Status Sweep::plausibility_of(const Complex& ratio, double noise, double turn_rad) const noexcept {
  const bool is_check = results_.stage != SweepStage::kPoints;
  const double factor = ratio_factor();
  const double sheet = results_.settings.expected_sensitivity;
  Complex expected = {sheet > 0.0 ? sheet : magnitude(ratio), 0.0};
  if (results_.stage == SweepStage::kCheckAfter) {
    expected = results_.check_before;
  } else if (!is_check) {
    const Complex inverse = inverse_expected();
    const bool is_foreseen =
        distance2(inverse_of(ratio), inverse) <
        kForeseen * square_of(inverse) + kForeseenFlat / square_of(results_.check_before);
    expected = is_foreseen ? inverse_of(inverse) : work_.last_ratio_;
  }
  // Exchanged channels turn V_a/V_r, which is ratio/factor, into its inverse; with one of them
  // turned round, into minus that.
  const Complex swapped = factor * factor * inverse_of(expected);
  const double expected2 = square_of(expected);
  const double jump2 = square_of(ratio) / expected2;
  constexpr double kPlausible2 = kPlausibleFactor * kPlausibleFactor;
  if (work_.target_.was_overrange && is_beyond(jump2, is_check ? kPlausible2 : kLargestJump2)) {
    return Status::kSaturated;
  }
  if (is_check && is_beyond(jump2, kPlausible2)) {
    return Status::kSwappedChannels;
  }
  const double to_expected2 = distance2(ratio, expected);
  const double phase = atan2(ratio.im, ratio.re);
  bool is_wrong = false;
  if (is_check) {
    // The check frequency is far below the resonance, where the lag is small.
    is_wrong = phase < -0.5 * kPi;
  } else if (to_expected2 > (noise * noise + kAlike2) * expected2) {
    // Distances relative to both, so that beside a resonance a small ratio is not near its inverse.
    const double near2 = kSwappedShare * to_expected2 * factor * factor;
    is_wrong = distance2(ratio, swapped) * expected2 < near2 ||
               (distance2(ratio, -swapped) * expected2 < near2 && is_neighbour()) ||
               has_turned_round(ratio, expected);
  }
  // Past half a turn of lag the phase begins again at the top.
  const bool went_on = !is_check && expected.re < 0.0 && to_expected2 < 0.25 * expected2;
  is_wrong =
      is_wrong ||
      (phase > kLead_rad + kLeadPerHz_rad * work_.target_.frequency_hz + turn_rad && !went_on);
  return is_wrong ? cables_of(ratio, expected, swapped) : Status::kOk;
}

void Sweep::store_point(const PointScatter& scatter, const Complex& ratio) noexcept {
  SweepPoint& point = results_.table[results_.point_count];
  work_.scatter_[results_.point_count] = scatter;
  point = SweepPoint();
  point.point.frequency_hz = work_.target_.frequency_hz;
  point.point.amplitude = magnitude(ratio);
  point.point.phase_rad = atan2(ratio.im, ratio.re);
  point.acceleration_mps2 = acceleration_of(magnitude(scatter.reference));
  point.drive_v = work_.drive_.amplitude_v();
  const double samples = scatter.repeat_samples * static_cast<double>(scatter.repeats);
  point.flagged = distortion_of(scatter.reference_rest_v, results_.inputs.silent_reference.noise_v,
                                magnitude(scatter.reference), samples) > kFlaggedShare ||
                  distortion_of(scatter.device_rest_v, results_.inputs.silent_device.noise_v,
                                magnitude(scatter.device), samples) > kFlaggedShare;
  ++results_.point_count;
}

}  // namespace emax::app
