// Checks of the settings of a sweep: ranges by the rows, here what limits one another.
#include "emax/app/settings/sweep_settings.hpp"

#include "emax/app/settings/sweep_settings_rows.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

constexpr std::size_t kMinPoints = 3;

// Runs of equal steps, each from above the last one.
struct Run {
  double first_hz;
  double last_hz;
  double step_hz;
};
constexpr Run kRuns[] = {{30.0, 100.0, 10.0}, {200.0, 1000.0, 100.0}, {1200.0, 6000.0, 200.0}};

bool is_positive(double value) noexcept {
  return value >= ranges::kSmallest && value <= ranges::kLargest;
}

bool is_zero_or_positive(double value) noexcept { return value == 0.0 || is_positive(value); }

// No front end ends below a millivolt: less is a slip, which would look like a fault of the bench.
bool is_full_scale(double value_v) noexcept { return value_v == 0.0 || value_v >= 1e-3; }

double highest_hz(const hal::StreamFormat& format) noexcept {
  return format.sample_rate_hz / kMinSamplesPerPeriod;
}

SettingsError check_frequencies(const SweepSettings& s, const hal::StreamFormat& format) noexcept {
  if (s.frequency_count < kMinPoints || s.frequency_count > kMaxPoints) {
    return {"sweep frequencies", "3 to " EMAX_TEXT_OF(EMAX_MAX_POINTS) " frequencies"};
  }
  const double highest = highest_hz(format);
  for (std::size_t i = 0; i < s.frequency_count; ++i) {
    if (!(s.frequency_hz[i] > 0.0) || !(s.frequency_hz[i] < highest)) {
      return {"sweep frequencies", "above 0 and below the sample rate over 2.5"};
    }
    if (i > 0 && !(s.frequency_hz[i] > s.frequency_hz[i - 1])) {
      return {"sweep frequencies", "in ascending order, each one once"};
    }
  }
  // A period must be countable in frames.
  if (!(s.frequency_hz[0] * ranges::kMaxRepeat_s >= 1.0)) {
    return {"sweep frequencies", "0.1 Hz or more"};
  }
  return {};
}

SettingsError check_reference_table(const ReferenceCalibration& r) noexcept {
  if (r.count < 1 || r.count > kMaxReferencePoints) {
    return {"reference table", "1 to " EMAX_TEXT_OF(EMAX_MAX_REFERENCE_POINTS) " points"};
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
  return {};
}

// 1e-6 more than a 256th per frame, so that rounding to words cannot fall below.
double slowest_v_per_s(const SweepSettings& s, const hal::StreamFormat& format) noexcept {
  constexpr double kShare = (1.0 + 1e-6) / static_cast<double>(hal::kMaxRampFrames);
  return kShare * s.drive_limit_v * format.sample_rate_hz;
}

constexpr std::size_t row(const char* name) noexcept { return row_of(kSweepSettingRows, name); }

/// False where a value is in its range but does not go with others or with the stream.
bool is_suitable(std::size_t index, const SweepSettings& s,
                 const hal::StreamFormat& format) noexcept {
  switch (index) {
    case row("acceleration limit"):
    case row("drive limit"):
    case row("slew"):
    case row("check frequency"): {
      const double value = number_in(fields_of(s)[index], &s);
      SettingLimits limits = {0.0, ranges::kLargest};
      narrow(index, s, format, limits);
      return value >= limits.min && value <= limits.max;
    }
    case row("expected sensitivity"):
      return is_zero_or_positive(s.expected_sensitivity);
    case row("drive full scale"):
      return is_full_scale(s.drive_full_scale_v);
    case row("reference full scale"):
      return is_full_scale(s.reference_full_scale_v);
    case row("device full scale"):
      return is_full_scale(s.device_full_scale_v);
    default:
      return true;
  }
}

/// What has other words than the row.
SettingsError own_check(std::size_t index, const SweepSettings& s,
                        const hal::StreamFormat& format) noexcept {
  switch (index) {
    case row("sweep frequencies"):
      return check_frequencies(s, format);
    case row("reference table"):
      return check_reference_table(s.reference);
    default:
      return {};
  }
}

}  // namespace

SweepSettings default_sweep_settings() noexcept {
  SweepSettings settings;
  for (const Run& run : kRuns) {
    for (double hz = run.first_hz; hz <= run.last_hz; hz += run.step_hz) {
      settings.frequency_hz[settings.frequency_count] = hz;
      ++settings.frequency_count;
    }
  }
  settings.level_mps2 = 1.0;
  settings.acceleration_limit_mps2 = 20.0;
  settings.drive_limit_v = 5.0;
  settings.slew_v_per_s = 1e5;
  settings.settle_s = 0.01;
  settings.cycles = 3;
  settings.repeat_s = 0.01;
  settings.repeats = 5;
  settings.reference.sensitivity[0] = 0.1;
  settings.reference.count = 1;
  settings.reference.expanded_percent = 0.5;
  settings.reference_gain = 10.0;
  settings.device_gain = 1.0;
  settings.device_gain_expanded_percent = 0.1;
  settings.ratio_correction = 1.0;
  settings.mounting_expanded_percent = 0.2;
  settings.skew_s = 1.25e-6;
  settings.check_hz = 160.0;
  settings.expected_sensitivity = 1.02;
  return settings;
}

FullScales full_scales(const SweepSettings& settings, const hal::StreamFormat& format) noexcept {
  const auto or_pin = [](double outside_v, double pin_v) {
    return outside_v > 0.0 ? outside_v : pin_v;
  };
  return {or_pin(settings.drive_full_scale_v, format.drive_full_scale_v),
          or_pin(settings.reference_full_scale_v, format.input_full_scale_v),
          or_pin(settings.device_full_scale_v, format.input_full_scale_v)};
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

void narrow(std::size_t index, const SweepSettings& settings, const hal::StreamFormat& format,
            SettingLimits& limits) noexcept {
  switch (index) {
    case row("level"):
      limits.max = settings.acceleration_limit_mps2;
      return;
    case row("acceleration limit"):
      limits.min = settings.level_mps2;
      return;
    case row("drive limit"):
      limits.max = full_scales(settings, format).drive_v;
      return;
    case row("slew"):
      limits.min = slowest_v_per_s(settings, format);
      return;
    case row("check frequency"):
      limits = {1.0 / ranges::kMaxRepeat_s, kBelowOne * highest_hz(format)};
      return;
    default:
      return;
  }
}

SettingsError check(const SweepSettings& settings, const hal::StreamFormat& format) noexcept {
  const Span<const SettingField> fields = fields_of(settings);
  for (std::size_t index = 0; index < fields.size(); ++index) {
    if (!is_in_range(fields[index], &settings) || !is_suitable(index, settings, format)) {
      return {fields[index].name, fields[index].expectation};
    }
    const SettingsError error = own_check(index, settings, format);
    if (error.setting != nullptr) {
      return error;
    }
  }
  return {};
}

hal::DriveLimits drive_limits(const SweepSettings& settings,
                              const hal::StreamFormat& format) noexcept {
  const double full_scale_v = full_scales(settings, format).drive_v;
  const double step_v = settings.slew_v_per_s / format.sample_rate_hz;
  return {hal::greatest_word_within(settings.drive_limit_v, full_scale_v),
          hal::greatest_word_within(step_v, full_scale_v)};
}

}  // namespace emax::app
