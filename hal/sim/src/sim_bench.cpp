// The way of a drive word through the bench, frame by frame.
#include "emax/sim/sim_bench.hpp"

#include "emax/base/elementary.hpp"

namespace emax::sim {
namespace {

using hal::Frame;
using hal::StreamFormat;
using hal::Word;

constexpr std::int64_t kWordsPerCode = std::int64_t{1} << (32U - kDacBits);

bool positive(double x) noexcept { return x > 0.0 && is_finite(x); }

bool full_scale_ok(double volts) noexcept { return volts >= 0.0 && is_finite(volts); }

bool format_ok(const StreamFormat& format) noexcept {
  return positive(format.sample_rate_hz) && positive(format.drive_full_scale_v) &&
         positive(format.input_full_scale_v) && format.block_frames >= 1 &&
         format.block_frames <= hal::kMaxBlockFrames && format.latency_frames <= kMaxLatencyFrames;
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

}  // namespace

Status SimBench::configure(const BenchSettings& settings) noexcept {
  if (running()) {
    return Status::kAlreadyRunning;
  }
  if (!format_ok(format())) {
    return Status::kInvalidArgument;
  }
  const FrontEnd& given = settings.front_end;
  if (!full_scale_ok(given.drive_v) || !full_scale_ok(given.reference_v) ||
      !full_scale_ok(given.device_v)) {
    return Status::kInvalidArgument;
  }
  const Status status = bench_.configure(settings, format().sample_rate_hz);
  if (status != Status::kOk) {
    return status;
  }
  dac_ = {};
  pipeline_ = {};
  started_at_ = 0;
  last_device_ = 0;
  event_over_ = {};
  stuck_ = false;
  is_looped_ = false;
  configured_ = true;
  adc_.half_scale = hal::kWordsPerFullScale;
  adc_.words_per_code = 1;
  if (!settings.ideal_converters) {
    adc_.half_scale = static_cast<double>(std::int64_t{1} << (kAdcBits - 1U));
    adc_.words_per_code = std::int64_t{1} << (32U - kAdcBits);
  }
  const FrontEnd& outside = settings.front_end;
  const auto or_pin = [](double outside_v, double pin_v) {
    return outside_v > 0.0 ? outside_v : pin_v;
  };
  const double pin_v = format().input_full_scale_v;
  drive_full_scale_v_ = or_pin(outside.drive_v, format().drive_full_scale_v);
  adc_.reference_codes_per_v = adc_.half_scale / or_pin(outside.reference_v, pin_v);
  adc_.device_codes_per_v = adc_.half_scale / or_pin(outside.device_v, pin_v);
  return Status::kOk;
}

double SimBench::now_s() const noexcept {
  return configured_ ? static_cast<double>(clock_frames()) / format().sample_rate_hz : 0.0;
}

Status SimBench::do_start() noexcept {
  if (!configured_) {
    return Status::kHardwareFault;
  }
  started_at_ = clock_frames();
  return Status::kOk;
}

hal::Exchange SimBench::do_exchange(Span<const Word> drive, Span<Frame> response) noexcept {
  const bool lost = event_due(FaultKind::kLostBlock);
  const bool late = event_due(FaultKind::kLateBlock);
  hal::Exchange exchange{Status::kOk, clock_frames() - started_at_};
  for (std::size_t i = 0; i < drive.size(); ++i) {
    response[i] = advance(drive[i]);
  }
  if (!lost && !late) {
    return exchange;
  }
  // Nobody hands over a second block meanwhile: the DAC holds its word.
  exchange = {late ? Status::kLateBlock : Status::kOk, clock_frames() - started_at_};
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

/// True once for each fault of this kind, for the first block that reaches its frame.
bool SimBench::event_due(FaultKind kind) noexcept {
  const std::array<Fault, 2> faults = {settings().fault, settings().second_fault};
  for (std::size_t i = 0; i < faults.size(); ++i) {
    if (faults[i].kind == kind && !event_over_[i] &&
        faults[i].at_frame < clock_frames() + format().block_frames) {
      event_over_[i] = true;
      return true;
    }
  }
  return false;
}

Frame SimBench::advance(Word word) noexcept {
  record(word);
  const std::uint64_t clock = clock_frames();
  pipeline_[static_cast<std::size_t>(clock % pipeline_.size())] = word;
  const std::uint64_t now = clock - format().latency_frames;
  const std::array<Fault, 2> faults = {settings().fault, settings().second_fault};
  for (const Fault& fault : faults) {
    stuck_ = stuck_ || (fault.kind == FaultKind::kStuckChannel && fault.at_frame == clock);
  }
  const double now_v = drive_v(word_at(now));
  const BenchVolts volts = is_looped_ ? bench_.step_wired(now_v, later_v(now)) : bench_.step(now_v);
  Frame frame{digitised(volts.reference_v * adc_.reference_codes_per_v),
              digitised(volts.device_v * adc_.device_codes_per_v)};
  if (stuck_) {
    frame.device = last_device_;
  }
  last_device_ = frame.device;
  return frame;
}

Word SimBench::word_at(std::uint64_t frame) const noexcept {
  return pipeline_[static_cast<std::size_t>(frame % pipeline_.size())];
}

/// The word of that frame as the DAC hands it out, without the bits that it drops.
std::int64_t SimBench::code_at(std::uint64_t frame) const noexcept {
  const std::int64_t word = word_at(frame);
  return settings().ideal_converters ? word : word & -kWordsPerCode;
}

/// The drive on the wire, as far behind that frame as the device's input samples later: by the
/// polynomial through the four words around it, in integers. Up to a 32nd of the rate its skew is
/// off by 2.5e-5 of an interval at most.
double SimBench::later_v(std::uint64_t frame) const noexcept {
  constexpr int kBits = 20;
  const double intervals = truth().skew_s * truth().clock_factor * format().sample_rate_hz;
  const auto x = static_cast<std::int64_t>(intervals * (std::int64_t{1} << kBits));
  const std::int64_t before = code_at(frame - 1);
  const std::int64_t at = code_at(frame);
  const std::int64_t next = code_at(frame + 1);
  const std::int64_t second = code_at(frame + 2);
  // Six times the coefficients.
  const std::int64_t cubic = second - before + 3 * (at - next);
  const std::int64_t square = 3 * (before + next) - 6 * at + ((cubic * x) >> kBits);
  const std::int64_t slope = 6 * next - 2 * before - 3 * at - second + ((square * x) >> kBits);
  const std::int64_t word = at + ((slope * x) >> kBits) / 6;
  return static_cast<double>(word) / hal::kWordsPerFullScale * drive_full_scale_v_;
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

/// What the front end makes of the DAC's output for `word`: of the highest bits of it.
double SimBench::drive_v(Word word) const noexcept {
  double codes = static_cast<double>(word) / hal::kWordsPerFullScale;
  if (!settings().ideal_converters) {
    constexpr std::int64_t kHalfScale = std::int64_t{1} << (kDacBits - 1U);
    // Above zero while it is divided, so that it rounds down.
    const std::int64_t code = (word + kHalfScale * kWordsPerCode) / kWordsPerCode - kHalfScale;
    codes = static_cast<double>(code) / kHalfScale;
  }
  return codes * drive_full_scale_v_;
}

Word SimBench::digitised(double code) const noexcept {
  code = code < adc_.half_scale - 1.0 ? code : adc_.half_scale - 1.0;
  code = code > -adc_.half_scale ? code : -adc_.half_scale;
  const std::int64_t rounded = static_cast<std::int64_t>(code + (adc_.half_scale + 0.5)) -
                               static_cast<std::int64_t>(adc_.half_scale);
  return static_cast<Word>(rounded * adc_.words_per_code);
}

}  // namespace emax::sim
