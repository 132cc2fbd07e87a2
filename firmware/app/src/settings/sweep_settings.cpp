// The default sweep, and words for every setting that cannot be used.
#include "emax/app/settings/sweep_settings.hpp"

#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

constexpr double kMaxSettle_s = 10.0;
constexpr double kMaxRepeat_s = 10.0;
constexpr std::uint32_t kMaxCycles = 1000;
constexpr double kMaxSkew_s = 1e-3;
constexpr double kMaxPercent = 50.0;
constexpr double kLargest = 1e9;
constexpr double kSmallest = 1e-9;
constexpr std::size_t kMinPoints = 3;

// The frequencies of the paper's Table 1: runs of equal steps, each from above the last one.
struct Run {
  double first_hz;
  double last_hz;
  double step_hz;
};
constexpr Run kRuns[] = {{30.0, 100.0, 10.0}, {200.0, 1000.0, 100.0}, {1200.0, 6000.0, 200.0}};

bool is_positive(double value) noexcept { return value >= kSmallest && value <= kLargest; }
bool is_percent(double value) noexcept { return value >= 0.0 && value <= kMaxPercent; }
bool is_within(double value, double low, double high) noexcept {
  return value >= low && value <= high;
}

SettingsError check_frequencies(const SweepSettings& s, const hal::StreamFormat& format) noexcept {
  if (s.frequency_count < kMinPoints || s.frequency_count > kMaxPoints) {
    return {"sweep frequencies", "3 to " EMAX_TEXT_OF(EMAX_MAX_POINTS) " frequencies"};
  }
  const double highest = format.sample_rate_hz / kMinSamplesPerPeriod;
  for (std::size_t i = 0; i < s.frequency_count; ++i) {
    if (!(s.frequency_hz[i] > 0.0) || !(s.frequency_hz[i] < highest)) {
      return {"sweep frequencies", "above 0 and below the sample rate over 2.5"};
    }
    if (i > 0 && !(s.frequency_hz[i] > s.frequency_hz[i - 1])) {
      return {"sweep frequencies", "in ascending order, each one once"};
    }
  }
  // A period must be countable in frames.
  if (!(s.frequency_hz[0] * kMaxRepeat_s >= 1.0)) {
    return {"sweep frequencies", "0.1 Hz or more"};
  }
  if (!(s.check_hz * kMaxRepeat_s >= 1.0) || !(s.check_hz < highest)) {
    return {"check frequency", "0.1 Hz or more and below the sample rate over 2.5"};
  }
  return {};
}

SettingsError check_drive(const SweepSettings& s, const hal::StreamFormat& format) noexcept {
  if (!is_positive(s.level_mps2)) {
    return {"level", "above 0, in m/s^2"};
  }
  if (!is_positive(s.limit_mps2) || s.limit_mps2 < s.level_mps2) {
    return {"acceleration limit", "at least the level, in m/s^2"};
  }
  if (!is_positive(s.drive_limit_v) || s.drive_limit_v > format.drive_full_scale_v) {
    return {"drive limit", "above 0 and at most the converter's full scale, in V"};
  }
  const double slowest = s.drive_limit_v / static_cast<double>(hal::kMaxRampFrames);
  // 1e-6 more than a 256th per frame, so that rounding to words cannot fall below.
  if (!is_within(s.slew_v_per_s / format.sample_rate_hz, slowest * (1.0 + 1e-6), kLargest)) {
    return {"slew", "enough to lead the drive limit to zero within 256 frames, in V/s"};
  }
  return {};
}

SettingsError check_record(const SweepSettings& s) noexcept {
  if (!is_within(s.settle_s, 0.0, kMaxSettle_s)) {
    return {"settling time", "0 to 10 s"};
  }
  if (s.cycles < 1 || s.cycles > kMaxCycles) {
    return {"cycles", "1 to 1000 periods"};
  }
  if (!is_within(s.repeat_s, 0.0, kMaxRepeat_s)) {
    return {"repeat duration", "0 to 10 s"};
  }
  if (s.repeats < 2 || s.repeats > kMaxRepeats) {
    return {"repeats", "2 to 16"};
  }
  return {};
}

SettingsError check_reference(const ReferenceCalibration& r) noexcept {
  if (r.count < 1 || r.count > kMaxReferencePoints) {
    return {"reference table", "1 to 32 points"};
  }
  for (std::size_t i = 0; i < r.count; ++i) {
    if (!is_positive(r.sensitivity[i])) {
      return {"reference sensitivity", "above 0, in V/(m/s^2)"};
    }
    if (r.count > 1 && !is_positive(r.frequency_hz[i])) {
      return {"reference table", "frequencies above 0 Hz"};
    }
    if (i > 0 && !(r.frequency_hz[i] > r.frequency_hz[i - 1])) {
      return {"reference table", "frequencies in ascending order, each one once"};
    }
  }
  if (!is_percent(r.expanded_percent)) {
    return {"reference uncertainty", "0 to 50 percent"};
  }
  return {};
}

SettingsError check_chain(const SweepSettings& s) noexcept {
  if (!is_positive(s.reference_gain)) {
    return {"reference gain", "above 0"};
  }
  if (!is_positive(s.device_gain)) {
    return {"device gain", "above 0"};
  }
  if (!is_percent(s.gain_expanded_percent)) {
    return {"gain uncertainty", "0 to 50 percent"};
  }
  if (!is_percent(s.mounting_expanded_percent)) {
    return {"mounting uncertainty", "0 to 50 percent"};
  }
  if (!is_within(s.skew_s, -kMaxSkew_s, kMaxSkew_s)) {
    return {"skew", "within 1 ms of either sign"};
  }
  if (!(s.expected_sensitivity == 0.0) && !is_positive(s.expected_sensitivity)) {
    return {"expected sensitivity", "above 0 in V/(m/s^2), or 0 if it is not known"};
  }
  return {};
}

}  // namespace

SweepSettings::SweepSettings() noexcept : frequency_hz{}, frequency_count(0) {
  for (const Run& run : kRuns) {
    for (double hz = run.first_hz; hz <= run.last_hz; hz += run.step_hz) {
      frequency_hz[frequency_count] = hz;
      ++frequency_count;
    }
  }
}

double sensitivity_at(const ReferenceCalibration& calibration, double frequency_hz) noexcept {
  const auto& f = calibration.frequency_hz;
  const auto& s = calibration.sensitivity;
  if (calibration.count == 1 || frequency_hz <= f[0]) {
    return s[0];
  }
  for (std::size_t i = 1; i < calibration.count; ++i) {
    if (frequency_hz <= f[i]) {
      return s[i - 1] + (s[i] - s[i - 1]) * ((frequency_hz - f[i - 1]) / (f[i] - f[i - 1]));
    }
  }
  return s[calibration.count - 1];
}

SettingsError check(const SweepSettings& settings, const hal::StreamFormat& format) noexcept {
  const SettingsError errors[] = {check_frequencies(settings, format),
                                  check_drive(settings, format), check_record(settings),
                                  check_reference(settings.reference), check_chain(settings)};
  for (const SettingsError& error : errors) {
    if (error.setting != nullptr) {
      return error;
    }
  }
  return {};
}

hal::DriveLimits drive_limits(const SweepSettings& settings,
                              const hal::StreamFormat& format) noexcept {
  const double full_scale_v = format.drive_full_scale_v;
  const double step_v = settings.slew_v_per_s / format.sample_rate_hz;
  return {hal::greatest_word_within(settings.drive_limit_v, full_scale_v),
          hal::greatest_word_within(step_v, full_scale_v)};
}

}  // namespace emax::app
