// The way of a voltage through the bench, frame by frame.
#include "emax/sim/volt_bench.hpp"

#include <array>

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::sim {
namespace {

constexpr std::array<const char*, kFaultKinds> kFaultNames = {"none",
                                                              "lost-block",
                                                              "late-block",
                                                              "stuck-channel",
                                                              "saturation",
                                                              "unplugged-reference",
                                                              "unplugged-device",
                                                              "swapped-channels",
                                                              "inverted-polarity",
                                                              "dc-drift",
                                                              "gain-step"};

constexpr double kTwoTo64 = 18446744073709551616.0;
constexpr double kTwoToMinus53 = 1.1102230246251565e-16;
constexpr double kMaxPercent = 100.0;
constexpr double kMaxHarmonic = 0.1;
constexpr std::uint64_t kChannels = 0x14057B7EF767814FU;
constexpr double kMaxClockPpm = 1e4;
/// Half of an expanded uncertainty in percent, as a fraction.
constexpr double kStandardPerExpandedPercent = 0.005;
/// Every so many frames what moves slowly is computed anew, so that no error of rounding adds up.
constexpr std::uint64_t kRefreshFrames = 64;

[[gnu::noinline]] bool positive(double x) noexcept { return x > 0.0 && is_finite(x); }

[[gnu::noinline]] bool not_negative(double x) noexcept { return x >= 0.0 && is_finite(x); }

[[gnu::noinline]] bool percent(double x) noexcept { return x >= 0.0 && x <= kMaxPercent; }

bool uncertainties_ok(const BenchSettings& settings) noexcept {
  return not_negative(settings.skew_expanded_s) && percent(settings.crosstalk_expanded_percent) &&
         percent(settings.linearity_expanded_percent) && settings.clock_expanded_ppm >= 0.0 &&
         settings.clock_expanded_ppm <= kMaxClockPpm &&
         percent(settings.reference_expanded_percent) && percent(settings.drift_expanded_percent) &&
         percent(settings.gain_expanded_percent) && percent(settings.ratio_expanded_percent) &&
         percent(settings.mounting_expanded_percent);
}

bool electronics_ok(const BenchSettings& settings, double sample_rate_hz) noexcept {
  return positive(settings.reference_gain) && positive(settings.device_gain) &&
         positive(settings.ratio) && positive(settings.reference_sensitivity) &&
         positive(settings.drift_time_s) && not_negative(settings.noise_v) &&
         not_negative(settings.offset_v) && not_negative(settings.hum_v) &&
         settings.hum_hz >= 0.0 && settings.hum_hz <= 0.5 * sample_rate_hz &&
         settings.second_harmonic >= 0.0 && settings.second_harmonic <= kMaxHarmonic &&
         settings.third_harmonic >= 0.0 && settings.third_harmonic <= kMaxHarmonic;
}

/// What the plant is built with, drawn apart so that the other draws stay what they are.
struct Times {
  double clock_factor = 1.0;
  double skew_s = 0.0;
};

Times draw_times(const BenchSettings& settings) noexcept {
  constexpr double kStandardPerPpm = 0.5e-6;
  constexpr std::uint64_t kApart = 0x5851F42D4C957F2DU;
  Noise noise;
  noise.seed(settings.seed ^ kApart);
  const double clock = noise.normal();
  const double skew = noise.normal();
  return {1.0 + kStandardPerPpm * settings.clock_expanded_ppm * clock,
          settings.skew_s + 0.5 * settings.skew_expanded_s * skew};
}

/// The gain changes with the square of the voltage. A sine of amplitude A in x^3 has 3 A^3/4 at its
/// own frequency.
double bent_v(double volts, double bend) noexcept { return volts * (1.0 + bend * (volts * volts)); }

double bend_of(double linearity, double full_scale_v) noexcept {
  const double scale_v = full_scale_v > 0.0 ? full_scale_v : kLinearScale_v;
  return 4.0 / 3.0 / (scale_v * scale_v) * linearity;
}

bool equal(const char* a, const char* b) noexcept {
  while (*a != '\0' && *a == *b) {
    ++a;
    ++b;
  }
  return *a == *b;
}

}  // namespace

const char* name_of(FaultKind kind) noexcept {
  const auto index = static_cast<std::size_t>(kind);
  return index < kFaultKinds ? kFaultNames[index] : kFaultNames[0];
}

ParsedFault parse_fault(const char* name) noexcept {
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    if (equal(name, kFaultNames[i])) {
      return {true, static_cast<FaultKind>(i)};
    }
  }
  return {};
}

Status VoltBench::configure(const BenchSettings& settings, double sample_rate_hz) noexcept {
  if (!positive(sample_rate_hz) || !uncertainties_ok(settings) ||
      !electronics_ok(settings, sample_rate_hz) ||
      static_cast<std::size_t>(settings.fault.kind) >= kFaultKinds ||
      static_cast<std::size_t>(settings.second_fault.kind) >= kFaultKinds) {
    return Status::kInvalidArgument;
  }
  const Times times = draw_times(settings);
  const Status status = plant_.configure(settings.device, settings.shaker,
                                         1.0 / (sample_rate_hz * times.clock_factor), times.skew_s);
  if (status != Status::kOk) {
    return status;
  }
  settings_ = settings;
  sample_rate_hz_ = sample_rate_hz;
  reference_ = {};
  device_ = {};
  drift_factor_ = 1.0;
  peak_mps2_ = 0.0;
  offset_climb_v_ = 0.0;
  clock_ = 0;
  swapped_ = false;
  const double turns_per_frame = settings.hum_hz / sample_rate_hz;
  hum_step_ = static_cast<std::uint64_t>(turns_per_frame * kTwoTo64);
  hum_turn_ = sincos(kTwoPi * turns_per_frame);
  draw();
  return Status::kOk;
}

void VoltBench::draw() noexcept {
  noise_.seed(settings_.seed);
  // All draws are made whatever the settings are, so that one setting does not change the others.
  const double reference = noise_.normal();
  const double drift = noise_.normal();
  const double gain = noise_.normal();
  const double mounting = noise_.normal();
  const double reference_offset = noise_.normal();
  const double device_offset = noise_.normal();
  constexpr double kStandard = kStandardPerExpandedPercent;

  truth_.device = settings_.device;
  truth_.reference_sensitivity =
      settings_.reference_sensitivity *
      (1.0 + kStandard * settings_.reference_expanded_percent * reference);
  truth_.reference_drift = kStandard * settings_.drift_expanded_percent * drift;
  // The noise goes on from here whatever else is drawn, so that has a sequence of its own.
  Noise channels;
  channels.seed(settings_.seed ^ kChannels);
  truth_.into_reference = kStandard * settings_.crosstalk_expanded_percent * channels.normal();
  truth_.into_device = kStandard * settings_.crosstalk_expanded_percent * channels.normal();
  truth_.reference_linearity = kStandard * settings_.linearity_expanded_percent * channels.normal();
  truth_.device_linearity = kStandard * settings_.linearity_expanded_percent * channels.normal();
  truth_.channel_ratio =
      settings_.ratio * (1.0 + kStandard * settings_.ratio_expanded_percent * channels.normal());
  truth_.gain_factor =
      truth_.channel_ratio * (1.0 + kStandard * settings_.gain_expanded_percent * gain);
  truth_.mounting_factor = 1.0 + kStandard * settings_.mounting_expanded_percent * mounting;
  const Times times = draw_times(settings_);
  truth_.clock_factor = times.clock_factor;
  truth_.skew_s = times.skew_s;
  truth_.reference_offset_v = settings_.offset_v * reference_offset;
  truth_.device_offset_v = settings_.offset_v * device_offset;
  const double device_factor = truth_.gain_factor * truth_.mounting_factor;
  truth_.apparent_sensitivity = settings_.device.sensitivity * device_factor *
                                settings_.reference_sensitivity / truth_.reference_sensitivity;

  reference_.scale = truth_.reference_sensitivity * settings_.reference_gain;
  reference_.offset_v = truth_.reference_offset_v;
  reference_.hum_phase_rad = kTwoPi * kTwoToMinus53 * static_cast<double>(noise_.bits() >> 11U);
  device_.scale = settings_.device_gain * device_factor;
  device_.offset_v = truth_.device_offset_v;
  device_.hum_phase_rad = kTwoPi * kTwoToMinus53 * static_cast<double>(noise_.bits() >> 11U);
  reference_.bend = bend_of(truth_.reference_linearity, settings_.front_end.reference_v);
  device_.bend = bend_of(truth_.device_linearity, settings_.front_end.device_v);
}

BenchVolts VoltBench::step(double drive_v) noexcept {
  if (!(sample_rate_hz_ > 0.0)) {
    return {};
  }
  begin_step();
  const PlantOutput sensed = plant_.step(distorted_v(drive_v));
  const double size = abs(sensed.acceleration_mps2);
  peak_mps2_ = size > peak_mps2_ ? size : peak_mps2_;
  return end_step(sensed.acceleration_mps2 * drift_factor_, sensed.device_v);
}

BenchVolts VoltBench::step_wired(double reference_v, double device_v) noexcept {
  if (!(sample_rate_hz_ > 0.0)) {
    return {};
  }
  begin_step();
  // Without sensor and conditioner: of their factors only the ratio of the channels stays.
  return end_step(reference_v / (truth_.reference_sensitivity * settings_.reference_gain),
                  device_v * truth_.channel_ratio /
                      (settings_.device_gain * truth_.gain_factor * truth_.mounting_factor));
}

void VoltBench::begin_step() noexcept {
  if (clock_ % kRefreshFrames == 0) {
    refresh();
  }
  if (clock_ == settings_.fault.at_frame) {
    break_down(settings_.fault.kind);
  }
  if (clock_ == settings_.second_fault.at_frame) {
    break_down(settings_.second_fault.kind);
  }
  device_.offset_v += offset_climb_v_;
}

/// From what the sensors hand over to the converters.
BenchVolts VoltBench::end_step(double reference, double device) noexcept {
  const NoisePair noise = noise_.pair();
  const BenchVolts clean = {conditioned_v(reference_, reference, noise.first),
                            conditioned_v(device_, device, noise.second)};
  const BenchVolts volts = {
      bent_v(clean.reference_v, reference_.bend) + truth_.into_reference * clean.device_v,
      bent_v(clean.device_v, device_.bend) + truth_.into_device * clean.reference_v};
  ++clock_;
  return swapped_ ? BenchVolts{volts.device_v, volts.reference_v} : volts;
}

void VoltBench::refresh() noexcept {
  const double turns = kTwoToMinus53 * static_cast<double>((clock_ * hum_step_) >> 11U);
  reference_.hum = sincos(kTwoPi * turns + reference_.hum_phase_rad);
  device_.hum = sincos(kTwoPi * turns + device_.hum_phase_rad);
  const double now_s = static_cast<double>(clock_) / sample_rate_hz_;
  const double progress = now_s / settings_.drift_time_s;
  drift_factor_ = 1.0 + truth_.reference_drift * (progress < 1.0 ? progress : 1.0);
  plant_.flush();
}

void VoltBench::break_down(FaultKind kind) noexcept {
  switch (kind) {
    case FaultKind::kNone:
    case FaultKind::kLostBlock:
    case FaultKind::kLateBlock:
    case FaultKind::kStuckChannel:
      return;
    case FaultKind::kSaturation:
      device_.scale *= kSaturationFactor;
      return;
    case FaultKind::kUnpluggedReference:
      reference_.scale = 0.0;
      return;
    case FaultKind::kUnpluggedDevice:
      device_.scale = 0.0;
      return;
    case FaultKind::kSwappedChannels:
      swapped_ = true;
      return;
    case FaultKind::kInvertedPolarity:
      device_.scale = -device_.scale;
      return;
    case FaultKind::kDcDrift:
      offset_climb_v_ = kOffsetClimbPerSecond_v / sample_rate_hz_;
      return;
    case FaultKind::kGainStep:
      device_.scale *= kGainStepFactor;
      return;
  }
}

/// What the amplifier makes of the drive.
double VoltBench::distorted_v(double drive_v) const noexcept {
  // A sine of amplitude A in x^2 has a second harmonic of A^2/2, in x^3 a third one of A^3/4. The
  // cubic term compresses, as an amplifier near its limit does.
  return drive_v * (1.0 + drive_v * (2.0 * settings_.second_harmonic -
                                     drive_v * (4.0 * settings_.third_harmonic)));
}

/// The voltage behind the conditioner. Moves the channel's hum on by one frame.
double VoltBench::conditioned_v(Channel& channel, double sensor, double noise) const noexcept {
  const SinCos angle = channel.hum;
  channel.hum = {angle.sin * hum_turn_.cos + angle.cos * hum_turn_.sin,
                 angle.cos * hum_turn_.cos - angle.sin * hum_turn_.sin};
  // sin(x) + sin(3x)/3
  const double hum = angle.sin * (2.0 - (4.0 / 3.0) * angle.sin * angle.sin);
  return sensor * channel.scale + channel.offset_v + settings_.hum_v * hum +
         settings_.noise_v * noise;
}

}  // namespace emax::sim
