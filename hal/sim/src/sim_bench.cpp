// The way of a drive word through the bench, frame by frame.
#include "emax/sim/sim_bench.hpp"

#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

namespace emax::sim {
namespace {

using hal::Frame;
using hal::StreamFormat;
using hal::Word;

constexpr std::array<const char*, kFaultKinds> kFaultNames = {"none",
                                                              "lost-block",
                                                              "late-block",
                                                              "stuck-channel",
                                                              "saturation",
                                                              "unplugged-reference",
                                                              "unplugged-device",
                                                              "swapped-channels",
                                                              "inverted-polarity",
                                                              "dc-drift"};

constexpr double kTwoTo64 = 18446744073709551616.0;
constexpr double kTwoToMinus53 = 1.1102230246251565e-16;
constexpr double kMaxPercent = 100.0;
constexpr double kMaxHarmonic = 0.1;
/// Half of an expanded uncertainty in percent, as a fraction.
constexpr double kStandardPerExpandedPercent = 0.005;
/// Every so many frames what moves slowly is computed anew, so that no error of rounding adds up.
constexpr std::uint64_t kRefreshFrames = 64;

bool positive(double x) noexcept { return x > 0.0 && is_finite(x); }

bool not_negative(double x) noexcept { return x >= 0.0 && is_finite(x); }

bool percent(double x) noexcept { return x >= 0.0 && x <= kMaxPercent; }

bool format_ok(const StreamFormat& format) noexcept {
  return positive(format.sample_rate_hz) && positive(format.drive_full_scale_v) &&
         positive(format.input_full_scale_v) && format.block_frames >= 1 &&
         format.block_frames <= hal::kMaxBlockFrames && format.latency_frames <= kMaxLatencyFrames;
}

bool uncertainties_ok(const BenchSettings& settings) noexcept {
  return percent(settings.reference_expanded_percent) && percent(settings.drift_expanded_percent) &&
         percent(settings.gain_expanded_percent) && percent(settings.mounting_expanded_percent);
}

bool electronics_ok(const BenchSettings& settings, double sample_rate_hz) noexcept {
  return positive(settings.reference_gain) && positive(settings.device_gain) &&
         positive(settings.reference_sensitivity) && positive(settings.drift_time_s) &&
         not_negative(settings.noise_v) && not_negative(settings.offset_v) &&
         not_negative(settings.hum_v) && settings.hum_hz >= 0.0 &&
         settings.hum_hz <= 0.5 * sample_rate_hz && settings.second_harmonic >= 0.0 &&
         settings.second_harmonic <= kMaxHarmonic && settings.third_harmonic >= 0.0 &&
         settings.third_harmonic <= kMaxHarmonic;
}

std::uint32_t magnitude(std::int64_t x) noexcept {
  return static_cast<std::uint32_t>(x < 0 ? -x : x);
}

/// From `last` towards zero by at most `step`.
Word nearer_to_zero(Word last, Word step) noexcept {
  if (last > step) {
    return last - step;
  }
  // Not compared with -last: the negative of the least word does not exist.
  return last < 0 && last + step < 0 ? last + step : 0;
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

Status SimBench::configure(const BenchSettings& settings) noexcept {
  if (running()) {
    return Status::kAlreadyRunning;
  }
  if (!format_ok(format()) || !uncertainties_ok(settings) ||
      !electronics_ok(settings, format().sample_rate_hz) ||
      static_cast<std::size_t>(settings.fault.kind) >= kFaultKinds) {
    return Status::kInvalidArgument;
  }
  const Status status = plant_.configure(settings.device, settings.shaker,
                                         1.0 / format().sample_rate_hz, settings.skew_s);
  if (status != Status::kOk) {
    return status;
  }
  settings_ = settings;
  dac_ = {};
  reference_ = {};
  device_ = {};
  pipeline_ = {};
  drift_factor_ = 1.0;
  offset_climb_v_ = 0.0;
  clock_ = 0;
  started_at_ = 0;
  last_device_ = 0;
  event_over_ = false;
  stuck_ = false;
  swapped_ = false;
  configured_ = true;

  const double turns_per_frame = settings.hum_hz / format().sample_rate_hz;
  hum_step_ = static_cast<std::uint64_t>(turns_per_frame * kTwoTo64);
  hum_turn_ = sincos(kTwoPi * turns_per_frame);

  adc_.half_scale = hal::kWordsPerFullScale;
  adc_.words_per_code = 1;
  if (!settings.ideal_converters) {
    adc_.half_scale = static_cast<double>(std::int64_t{1} << (kAdcBits - 1U));
    adc_.words_per_code = std::int64_t{1} << (32U - kAdcBits);
  }
  adc_.codes_per_v = adc_.half_scale / format().input_full_scale_v;
  draw();
  return Status::kOk;
}

void SimBench::draw() noexcept {
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
  truth_.gain_factor = 1.0 + kStandard * settings_.gain_expanded_percent * gain;
  truth_.mounting_factor = 1.0 + kStandard * settings_.mounting_expanded_percent * mounting;
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
}

double SimBench::now_s() const noexcept {
  return configured_ ? static_cast<double>(clock_) / format().sample_rate_hz : 0.0;
}

Status SimBench::do_start() noexcept {
  if (!configured_) {
    return Status::kHardwareFault;
  }
  started_at_ = clock_;
  return Status::kOk;
}

hal::Exchange SimBench::do_exchange(Span<const Word> drive, Span<Frame> response) noexcept {
  const bool lost = event_due(FaultKind::kLostBlock);
  const bool late = event_due(FaultKind::kLateBlock);
  hal::Exchange exchange{Status::kOk, clock_ - started_at_};
  for (std::size_t i = 0; i < drive.size(); ++i) {
    response[i] = advance(drive[i]);
  }
  if (!lost && !late) {
    return exchange;
  }
  // Nobody hands over a second block meanwhile: the DAC holds its word.
  exchange = {late ? Status::kLateBlock : Status::kOk, clock_ - started_at_};
  for (Frame& frame : response) {
    frame = advance(dac_.last);
  }
  return exchange;
}

std::uint32_t SimBench::do_ramp_to_zero(Word step_per_frame) noexcept {
  std::uint32_t frames = 0;
  while (dac_.last != 0 && frames < hal::kMaxRampFrames) {
    advance(nearer_to_zero(dac_.last, step_per_frame));
    ++frames;
  }
  return frames;
}

void SimBench::do_stop() noexcept {
  if (!configured_) {
    return;
  }
  // What is still on its way reaches the shaker, so that the next start finds an empty pipeline.
  for (std::uint32_t i = 0; i < format().latency_frames; ++i) {
    advance(0);
  }
}

/// True once, for the first block that reaches the frame of this kind of fault.
bool SimBench::event_due(FaultKind kind) noexcept {
  if (settings_.fault.kind != kind || event_over_ ||
      settings_.fault.at_frame >= clock_ + format().block_frames) {
    return false;
  }
  event_over_ = true;
  return true;
}

Frame SimBench::advance(Word word) noexcept {
  record(word);
  const auto slot = [this](std::uint64_t frame) {
    return static_cast<std::size_t>(frame % pipeline_.size());
  };
  pipeline_[slot(clock_)] = word;
  const Word at_dac = pipeline_[slot(clock_ - format().latency_frames)];
  if (clock_ % kRefreshFrames == 0) {
    refresh();
  }
  if (clock_ == settings_.fault.at_frame) {
    break_down();
  }
  device_.offset_v += offset_climb_v_;
  const PlantOutput sensed = plant_.step(drive_v(at_dac));
  const NoisePair noise = noise_.pair();
  Frame frame;
  frame.reference =
      digitised(conditioned(reference_, sensed.acceleration_mps2 * drift_factor_, noise.first));
  frame.device = digitised(conditioned(device_, sensed.device_v, noise.second));
  if (stuck_) {
    frame.device = last_device_;
  }
  last_device_ = frame.device;
  if (swapped_) {
    frame = {frame.device, frame.reference};
  }
  ++clock_;
  return frame;
}

void SimBench::record(Word word) noexcept {
  const std::uint32_t amplitude = magnitude(word);
  const std::uint32_t step =
      magnitude(static_cast<std::int64_t>(word) - static_cast<std::int64_t>(dac_.last));
  dac_.max_amplitude = amplitude > dac_.max_amplitude ? amplitude : dac_.max_amplitude;
  dac_.max_step = step > dac_.max_step ? step : dac_.max_step;
  dac_.last = word;
  ++dac_.frames;
  dac_.frames_since_nonzero = word == 0 ? dac_.frames_since_nonzero + 1 : 0;
}

void SimBench::refresh() noexcept {
  const double turns = kTwoToMinus53 * static_cast<double>((clock_ * hum_step_) >> 11U);
  reference_.hum = sincos(kTwoPi * turns + reference_.hum_phase_rad);
  device_.hum = sincos(kTwoPi * turns + device_.hum_phase_rad);
  const double progress = now_s() / settings_.drift_time_s;
  drift_factor_ = 1.0 + truth_.reference_drift * (progress < 1.0 ? progress : 1.0);
  plant_.flush();
}

void SimBench::break_down() noexcept {
  switch (settings_.fault.kind) {
    case FaultKind::kNone:
    case FaultKind::kLostBlock:
    case FaultKind::kLateBlock:
      return;
    case FaultKind::kStuckChannel:
      stuck_ = true;
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
      offset_climb_v_ = kOffsetClimbPerSecond_v / format().sample_rate_hz;
      return;
  }
}

/// What the amplifier gets while the DAC holds `word`: the highest bits of it, then distorted.
double SimBench::drive_v(Word word) const noexcept {
  double codes = static_cast<double>(word) / hal::kWordsPerFullScale;
  if (!settings_.ideal_converters) {
    constexpr std::int64_t kHalfScale = std::int64_t{1} << (kDacBits - 1U);
    constexpr std::int64_t kWordsPerCode = std::int64_t{1} << (32U - kDacBits);
    // Above zero while it is divided, so that it rounds down.
    const std::int64_t code = (word + kHalfScale * kWordsPerCode) / kWordsPerCode - kHalfScale;
    codes = static_cast<double>(code) / kHalfScale;
  }
  const double volts = codes * format().drive_full_scale_v;
  // A sine of amplitude A in x^2 has a second harmonic of A^2/2, in x^3 a third one of A^3/4. The
  // cubic term compresses, as an amplifier near its limit does.
  return volts * (1.0 + volts * (2.0 * settings_.second_harmonic -
                                 volts * (4.0 * settings_.third_harmonic)));
}

/// The voltage at the ADC. Moves the channel's hum on by one frame.
double SimBench::conditioned(Channel& channel, double sensor, double noise) const noexcept {
  const SinCos angle = channel.hum;
  channel.hum = {angle.sin * hum_turn_.cos + angle.cos * hum_turn_.sin,
                 angle.cos * hum_turn_.cos - angle.sin * hum_turn_.sin};
  // sin(x) + sin(3x)/3
  const double hum = angle.sin * (2.0 - (4.0 / 3.0) * angle.sin * angle.sin);
  return sensor * channel.scale + channel.offset_v + settings_.hum_v * hum +
         settings_.noise_v * noise;
}

Word SimBench::digitised(double volts) const noexcept {
  double code = volts * adc_.codes_per_v;
  code = code < adc_.half_scale - 1.0 ? code : adc_.half_scale - 1.0;
  code = code > -adc_.half_scale ? code : -adc_.half_scale;
  const std::int64_t rounded = static_cast<std::int64_t>(code + (adc_.half_scale + 0.5)) -
                               static_cast<std::int64_t>(adc_.half_scale);
  return static_cast<Word>(rounded * adc_.words_per_code);
}

}  // namespace emax::sim
