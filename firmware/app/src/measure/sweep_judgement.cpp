// What a sweep makes of its repeats: the level, the faults, the points.
#include "emax/app/measure/sweep.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::app {
namespace {

constexpr double kWeakSigmas = 8.0;
constexpr double kLevelTolerance = 0.05;
constexpr double kRaise = 8.0;
constexpr std::uint32_t kMaxTries = 12;
constexpr double kLooseShare = 0.01;     // Repeats that differ by more are taken again.
constexpr double kDistortedShare = 0.1;  // An error above,
constexpr double kFlaggedShare = 0.03;   // flagged above.
constexpr double kOffsetShare = 0.02;    // Of full scale, against the silence.
constexpr double kLargestJump = 8.0;     // Of the ratio, from one frequency to the next.

// A device of second order never leads. Sensors with a high pass do, by less than a degree where
// it matters; a skew that was set wrong by 1 us adds to it.
constexpr double kLead_rad = 0.0175;
constexpr double kLeadPerHz_rad = 6.3e-6;

double magnitude(Complex z) noexcept { return sqrt(norm(z)); }

bool is_beyond(double ratio, double factor) noexcept {
  return !(ratio < factor) || !(ratio * factor > 1.0);
}

/// What the ratio says of the cables.
///
/// @param ratio    Measured.
/// @param expected From the frequency before, or from the data sheet.
/// @param swapped  What exchanged channels would give.
Status cables_of(Complex ratio, Complex expected, Complex swapped) noexcept {
  const double to_inverted = magnitude(ratio + expected) / magnitude(expected);
  const double to_swapped = magnitude(ratio - swapped) / magnitude(swapped);
  return to_inverted < to_swapped ? Status::kInvertedPolarity : Status::kSwappedChannels;
}

}  // namespace

double Sweep::acceleration_of(double reference_v, const SweepWorkspace& work) const noexcept {
  return reference_v / settings_.reference_gain /
         sensitivity_at(settings_.reference, work.target_.frequency_hz);
}

Sweep::Reading Sweep::reading_of(const SineFitResult& fit, const SilentChannel& silent,
                                 const SweepWorkspace& work) noexcept {
  const double samples = static_cast<double>(work.target_.repeat_frames);
  Reading reading;
  reading.fit = fit;
  reading.weak_v =
      kWeakSigmas * silent.noise_v * sqrt(2.0 / samples) +
      3.0 * silent.hum_in_fit_v(work.target_.frequency_hz, samples / work.format_.sample_rate_hz);
  return reading;
}

void Sweep::end_repeat(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  const Reading reference = reading_of(work.fit_.reference(), inputs_.silent_reference, work);
  const Reading device = reading_of(work.fit_.device(), inputs_.silent_device, work);
  if (work.repeats_.count == 0) {
    judge_first(reference, device, stream, work);
    if (done() || work.block_is_spent_) {
      return;
    }
    work.first_reference_offset_v_ = reference.fit.offset_v;
    work.first_device_offset_v_ = device.fit.offset_v;
  }
  const Status status = disturbance_of(reference, device, work);
  if (status != Status::kOk) {
    suspect(status, stream, work);
    return;
  }
  work.reference_rest2_ += reference.fit.residual_std_v * reference.fit.residual_std_v;
  work.device_rest2_ += device.fit.residual_std_v * device.fit.residual_std_v;
  // Both to the time of the first repeat's first sample.
  const double turns = static_cast<double>(work.repeats_.count) *
                       static_cast<double>(work.target_.repeat_frames) * work.target_.frequency_hz /
                       work.format_.sample_rate_hz;
  const SinCos back = sincos(kTwoPi * (turns - floor(turns)));
  const Complex turn = {back.cos, -back.sin};
  work.repeats_.reference[work.repeats_.count] = turn * reference.fit.phasor();
  work.repeats_.device[work.repeats_.count] = turn * device.fit.phasor();
  ++work.repeats_.count;
  if (work.repeats_.count < settings_.repeats) {
    begin_repeat(work);
    return;
  }
  end_target(stream, work);
}

// The first repeat after each change of the drive: is there a signal, and is the level right?
void Sweep::judge_first(const Reading& reference, const Reading& device, hal::AnalogStream& stream,
                        SweepWorkspace& work) noexcept {
  if (reference.is_weak() || device.is_weak()) {
    if (reference.is_weak() && device.is_strong()) {
      suspect(Status::kNoReference, stream, work);
    } else if (device.is_weak() && reference.is_strong()) {
      suspect(Status::kNoDevice, stream, work);
    } else {
      raise_drive(stream, work);
    }
    return;
  }
  const double acceleration = acceleration_of(reference.fit.amplitude_v, work);
  const double drive_v = work.drive_.amplitude_v();
  work.target_.acceleration_mps2 = acceleration;
  work.target_.is_close = true;
  work.drive_per_acceleration_ = drive_v / acceleration;
  const double aim = aim_mps2(work);
  if (abs(acceleration / aim - 1.0) <= kLevelTolerance) {
    return;
  }
  const double most_v = work.drive_.max_amplitude_v(work.target_.frequency_hz);
  const double needed_v = aim * work.drive_per_acceleration_;
  ++work.target_.tries;
  if (needed_v > most_v * (1.0 + kLevelTolerance) || work.target_.tries > kMaxTries) {
    fail(Status::kLevelNotReached, stream, work);
    return;
  }
  if (needed_v > most_v && drive_v >= most_v) {
    return;  // Within the tolerance at the largest drive.
  }
  drive_to(needed_v < most_v ? needed_v : most_v, work);
}

void Sweep::raise_drive(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  const double most_v = work.drive_.max_amplitude_v(work.target_.frequency_hz);
  if (work.drive_.amplitude_v() >= most_v) {
    fail(Status::kWeakSignal, stream, work);
    return;
  }
  const double raised_v = kRaise * work.drive_.amplitude_v();
  drive_to(raised_v < most_v ? raised_v : most_v, work);
}

// By how much the offsets have moved apart. A slow swing of the shaker moves both, in the ratio of
// low frequencies.
double Sweep::offset_change_v(double reference_v, double device_v,
                              const SweepWorkspace& work) const noexcept {
  const double ratio = norm(check_before_) > 0.0
                           ? magnitude(check_before_) / ratio_factor(work)
                           : work.fit_.device().amplitude_v / work.fit_.reference().amplitude_v;
  return abs(device_v - ratio * reference_v) / (ratio > 1.0 ? ratio : 1.0);
}

Status Sweep::disturbance_of(const Reading& reference, const Reading& device,
                             const SweepWorkspace& work) const noexcept {
  if (reference.is_weak()) {
    return device.is_weak() ? Status::kWeakSignal : Status::kNoReference;
  }
  if (device.is_weak()) {
    return Status::kNoDevice;
  }
  const double full_scale_v = work.format_.input_full_scale_v;
  const double within_v = offset_change_v(reference.fit.offset_v - work.first_reference_offset_v_,
                                          device.fit.offset_v - work.first_device_offset_v_, work);
  const double since_silence_v =
      offset_change_v(reference.fit.offset_v - inputs_.silent_reference.offset_v,
                      device.fit.offset_v - inputs_.silent_device.offset_v, work);
  // After overrange the ratio is in doubt; it is judged before anything else.
  if (!work.target_.was_overrange &&
      (within_v > kWanderShare * full_scale_v || since_silence_v > kOffsetShare * full_scale_v)) {
    return Status::kDcDrift;
  }
  const double samples = static_cast<double>(work.target_.repeat_frames);
  const double distortion[] = {
      distortion_of(reference.fit.residual_std_v, inputs_.silent_reference.noise_v,
                    reference.fit.amplitude_v, samples),
      distortion_of(device.fit.residual_std_v, inputs_.silent_device.noise_v,
                    device.fit.amplitude_v, samples)};
  if (distortion[0] > kDistortedShare || distortion[1] > kDistortedShare) {
    return Status::kDistorted;
  }
  return Status::kOk;
}

// A fault that begins within a repeat looks like another one: the second look decides.
void Sweep::suspect(Status status, hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  if (work.target_.was_suspect) {
    fail(status, stream, work);
    return;
  }
  work.target_.was_suspect = true;
  drive_to(work.drive_.amplitude_v(), work);
}

// K over the ratio of the volts.
double Sweep::ratio_factor(const SweepWorkspace& work) const noexcept {
  return sensitivity_at(settings_.reference, work.target_.frequency_hz) * settings_.reference_gain /
         settings_.device_gain;
}

Complex Sweep::ratio_of(const PointScatter& scatter, const SweepWorkspace& work) const noexcept {
  // Sampled later, the device's channel is ahead by w skew.
  const SinCos skew = sincos(kTwoPi * work.target_.frequency_hz * settings_.skew_s);
  return ratio_factor(work) * ((scatter.device / scatter.reference) * Complex{skew.cos, -skew.sin});
}

void Sweep::end_target(hal::AnalogStream& stream, SweepWorkspace& work) noexcept {
  PointScatter scatter = scatter_of(work.repeats_);
  scatter.repeat_samples = static_cast<double>(work.target_.repeat_frames);
  const double by_noise = kNoisePeak * expected_scatter(scatter, inputs_);
  if (scatter.largest > by_noise + (work.target_.was_suspect ? kDistortedShare : kLooseShare)) {
    suspect(Status::kDistorted, stream, work);
    return;
  }
  const double repeats = static_cast<double>(work.repeats_.count);
  scatter.reference_rest_v = sqrt(work.reference_rest2_ / repeats);
  scatter.device_rest_v = sqrt(work.device_rest2_ / repeats);
  const Complex ratio = ratio_of(scatter, work);
  const Status status = plausibility_of(ratio, work);
  if (status != Status::kOk) {
    suspect(status, stream, work);
    return;
  }
  if (stage_ == SweepStage::kPoints) {
    store_point(scatter, ratio, work);
    work.last_ratio_ = ratio;
  } else if (stage_ == SweepStage::kCheckBefore) {
    check_before_ = ratio;
  } else {
    check_after_ = ratio;
  }
  begin_next(work);
}

Status Sweep::plausibility_of(Complex ratio, const SweepWorkspace& work) const noexcept {
  const bool is_check = stage_ != SweepStage::kPoints;
  const double factor = ratio_factor(work);
  const double sheet = settings_.expected_sensitivity;
  Complex expected = {sheet > 0.0 ? sheet : magnitude(ratio), 0.0};
  if (stage_ == SweepStage::kCheckAfter) {
    expected = check_before_;
  } else if (!is_check) {
    expected = norm(work.last_ratio_) > 0.0 ? work.last_ratio_ : check_before_;
  }
  // Exchanged channels turn V_a/V_r, which is ratio/factor, into its inverse.
  const Complex swapped = Complex{factor * factor, 0.0} / expected;
  const double jump = magnitude(ratio) / magnitude(expected);
  if (work.target_.was_overrange && is_beyond(jump, is_check ? kPlausibleFactor : kLargestJump)) {
    return Status::kSaturated;
  }
  if (is_check && is_beyond(jump, kPlausibleFactor)) {
    return Status::kSwappedChannels;
  }
  const double to_expected = magnitude(ratio - expected);
  if (!is_check && magnitude(ratio - swapped) < 0.4 * to_expected) {
    return cables_of(ratio, expected, swapped);
  }
  const double phase = atan2(ratio.im, ratio.re);
  // Past half a turn of lag the phase begins again at the top.
  const bool went_on = !is_check && expected.re < 0.0 && to_expected < 0.5 * magnitude(expected);
  if (phase > kLead_rad + kLeadPerHz_rad * work.target_.frequency_hz && !went_on) {
    return cables_of(ratio, expected, swapped);
  }
  // The check frequency is far below the resonance, where the lag is small.
  if (is_check && phase < -0.5 * kPi) {
    return cables_of(ratio, expected, swapped);
  }
  return Status::kOk;
}

void Sweep::store_point(const PointScatter& scatter, Complex ratio, SweepWorkspace& work) noexcept {
  SweepPoint& point = points_[point_count_];
  work.scatter_[point_count_] = scatter;
  point = SweepPoint();
  point.point.frequency_hz = work.target_.frequency_hz;
  point.point.amplitude = magnitude(ratio);
  point.point.phase_rad = atan2(ratio.im, ratio.re);
  point.acceleration_mps2 = acceleration_of(magnitude(scatter.reference), work);
  point.drive_v = work.drive_.amplitude_v();
  const double samples = scatter.repeat_samples * static_cast<double>(scatter.repeats);
  point.flagged = distortion_of(scatter.reference_rest_v, inputs_.silent_reference.noise_v,
                                magnitude(scatter.reference), samples) > kFlaggedShare ||
                  distortion_of(scatter.device_rest_v, inputs_.silent_device.noise_v,
                                magnitude(scatter.device), samples) > kFlaggedShare;
  ++point_count_;
}

}  // namespace emax::app
