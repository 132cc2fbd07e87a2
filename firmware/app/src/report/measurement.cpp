// The report's section on the measurement, and the report of one that failed.
#include "emax/app/report/measurement.hpp"

#include "emax/app/report/report_warnings.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

#include "report_parts.hpp"

namespace emax::app {
namespace {

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;
constexpr double kPercent = 100.0;
constexpr std::size_t kMaxLine = 98;
constexpr double kReached = 0.9;  // Of the level.

// Out of line, for its size.
[[gnu::noinline]] double magnitude(Complex z) noexcept { return sqrt(norm(z)); }

[[gnu::noinline]] TextWriter& percent(TextWriter& out, double share) noexcept {
  return out.fixed(kPercent * share, 4);
}

[[gnu::noinline]] double length(double a, double b) noexcept { return sqrt(a * a + b * b); }

/// Words below a label, in as many lines as they need.
void wrap(ReportWriter& out, const char* words) noexcept {
  std::size_t column = 2 + kLabelWidth;
  out.indent();
  for (bool is_first = true; *words != '\0'; is_first = false) {
    std::size_t length = 0;
    while (words[length] != '\0' && words[length] != ' ') {
      ++length;
    }
    if (column + 1 + length > kMaxLine) {
      out.line();
      out.indent();
      column = 2 + kLabelWidth;
    } else if (!is_first) {
      out.text(" ");
      ++column;
    }
    out.text(Span<const char>(words, length));
    column += length;
    words += words[length] == ' ' ? length + 1 : length;
  }
  out.line();
}

// Full scale of a channel, or what a resonance makes of it, may not allow the level.
void write_reached(const SweepResults& sweep, ReportWriter& out) noexcept {
  double least = kReached * sweep.settings.level_mps2;
  std::size_t lowered = 0;
  for (const SweepPoint& point : sweep.points()) {
    if (point.acceleration_mps2 < kReached * sweep.settings.level_mps2) {
      ++lowered;
      least = point.acceleration_mps2 < least ? point.acceleration_mps2 : least;
    }
  }
  if (lowered > 0) {
    out.label("Level reached").text("less at ").integer(lowered).text(" points, down to ");
    out.general(least, 3).text(" m/s^2: full scale or the limit is near").line();
  }
}

void write_settings(const Measurement& measurement, ReportWriter& out) noexcept {
  const SweepSettings& settings = measurement.sweep.settings;
  out.label("Bench");
  if (measurement.simulated != nullptr) {
    out.text("simulated, seed ").integer(measurement.simulated->seed).text(", ");
  }
  out.general(measurement.format.sample_rate_hz, 10).text(" samples per second").line();
  out.label("Level").general(settings.level_mps2, 6).text(" m/s^2");
  out.and_g(settings.level_mps2, 6).text(" peak, never above ");
  out.general(settings.acceleration_limit_mps2, 6).text(" m/s^2");
  out.and_g(settings.acceleration_limit_mps2, 6).line();
  write_reached(measurement.sweep, out);
  out.label("Drive").text("never above ").general(settings.drive_limit_v, 6).text(" V and ");
  out.general(settings.slew_v_per_s, 6).text(" V/s").line();
  out.label("Record").integer(settings.repeats).text(" repeats of at least ");
  out.integer(settings.cycles).text(" periods and ").general(kMilli * settings.repeat_s, 6);
  out.text(" ms, each fitted by a sine").line();
}

/// "U = 0.5 us", or that none was stated.
void write_expanded(double expanded, const char* unit, ReportWriter& out) noexcept {
  if (expanded > 0.0) {
    out.text("U = ").general(expanded, 4).text(unit);
  } else {
    out.text("U not stated: 0");
  }
}

void write_stated(const char* label, double expanded, const char* unit,
                  ReportWriter& out) noexcept {
  out.label(label);
  write_expanded(expanded, unit, out);
  out.line();
}

void write_chain(const SweepSettings& settings, ReportWriter& out) noexcept {
  const ReferenceCalibration& reference = settings.reference;
  out.label("Reference").general(reference.sensitivity[0], 7).text(" V/(m/s^2)");
  out.and_v_per_g(reference.sensitivity[0], 7);
  if (reference.count > 1) {
    out.text(" at ").general(reference.frequency_hz[0], 6).text(" Hz, a table of ");
    out.integer(reference.count).text(" frequencies");
  }
  out.text(", U = ").general(reference.expanded_percent, 4).text(" % (k = 2)").line();
  out.label("Conditioners").text("gain ").general(settings.reference_gain, 6);
  out.text(" (reference, U = ").general(settings.reference_gain_expanded_percent, 4);
  out.text(" %) and ").general(settings.device_gain, 6).text(" (device, U = ");
  out.general(settings.device_gain_expanded_percent, 4).text(" %)").line();
  if (settings.ratio_correction != 1.0 || settings.ratio_expanded_percent > 0.0) {
    out.label("Ratio").text("of the channels ").general(settings.ratio_correction, 8);
    out.text(", U = ").general(settings.ratio_expanded_percent, 4).text(" %, taken out").line();
  }
  out.label("Mounting").text("U = ").general(settings.mounting_expanded_percent, 4);
  out.text(" %, with transverse motion and temperature").line();
  out.label("Skew").text("device sampled ").general(kMicro * settings.skew_s, 6);
  out.text(" us after the reference, taken out, ");
  write_expanded(kMicro * settings.skew_expanded_s, " us", out);
  out.line();
  write_stated("Clock", settings.clock_expanded_ppm, " ppm", out);
  write_stated("Crosstalk", settings.crosstalk_expanded_percent, " %", out);
  write_stated("Linearity", settings.linearity_expanded_percent, " %", out);
}

void write_silence(const SweepResults& sweep, ReportWriter& out) noexcept {
  const SilentChannel& reference = sweep.inputs.silent_reference;
  const SilentChannel& device = sweep.inputs.silent_device;
  out.label("Without drive");
  if (!(reference.noise_v > 0.0) && !(device.noise_v > 0.0)) {
    out.text("not measured, or without any noise").line();
    return;
  }
  out.text("noise ").fixed(kMilli * reference.noise_v, 3).text(" mV (reference) and ");
  out.fixed(kMilli * device.noise_v, 3).text(" mV (device)").line();
}

void write_check(const SweepResults& sweep, ReportWriter& out) noexcept {
  const double before = magnitude(sweep.check_before);
  const double after = magnitude(sweep.check_after);
  out.label("Check").text("at ").general(sweep.settings.check_hz, 6).text(" Hz ");
  if (!(before > 0.0)) {
    out.text("not measured").line();
    return;
  }
  out.general(before, 6).text(" V/(m/s^2)");
  out.and_v_per_g(before, 6).text(" before");
  if (!(after > 0.0)) {
    out.text(", not measured after").line();
    return;
  }
  out.text(", ").general(after, 6);
  out.and_v_per_g(after, 6).text(" after: ");
  percent(out, after / before - 1.0).text(" % drift").line();
}

void write_flagged(const SweepResults& sweep, ReportWriter& out) noexcept {
  std::size_t flagged = 0;
  for (const SweepPoint& point : sweep.points()) {
    flagged += point.flagged ? 1u : 0u;
  }
  out.label("Flagged");
  if (flagged == 0) {
    out.text("none").line();
    return;
  }
  out.integer(flagged).text(flagged == 1 ? " point, * below" : " points, * below").line();
  for (const SweepPoint& point : sweep.points()) {
    if (!point.flagged) {
      continue;
    }
    out.indent().general(point.point.frequency_hz, 7);
    const bool is_hum = point.budget.hum > kMuchHum;
    if (is_hum || point.scatters) {
      out.text(is_hum ? " Hz: leave it out, hum of the mains is in it, u "
                      : " Hz: the repeats differ by more than chance, u ");
      percent(out, is_hum ? point.budget.hum : point.budget.noise).text(" % of the mean").line();
    } else {
      out.text(" Hz: distorted, the sine leaves ")
          .fixed(static_cast<double>(point.residual_percent), 2);
      out.text(" % of the amplitude over").line();
    }
  }
  out.part(ReportPart::kWarning)
      .text("  WARNING: look at the flagged points before the results are used.\n");
}

void write_common(const SweepResults& sweep, ReportWriter& out) noexcept {
  const CommonBudget& common = sweep.common;
  percent(out.label("Common to all points").text("reference "), common.reference);
  percent(out.text(" %, gains "), common.gain);
  percent(out.text(" %, mounting "), common.mounting).text(" %, drift ");
  if (magnitude(sweep.check_before) > 0.0 && magnitude(sweep.check_after) > 0.0) {
    percent(out, common.drift).text(" %").line();
  } else {
    out.text("not known").line();
  }
  percent(out.indent().text("together "), common.total).text(" %; expanded (k = 2) ");
  out.general(kCoverageFactor * kPercent * common.total, 3).text(" %").line();
}

// The table of points with their budgets

struct Column {
  std::size_t width;
  const char* name;
  const char* unit;
};

constexpr Column kFrequency = {10, "f", "Hz"};
constexpr Column kAmplitude = {12, "A", "V/(m/s^2)"};
constexpr Column kAmplitudePerG = {12, "A", "V/g"};
constexpr Column kRest[] = {{9, "phase", "deg"}, {8, "noise", "%"},       {10, "ADC step", "%"},
                            {8, "hum", "%"},     {12, "distortion", "%"}, {9, "shared", "%"},
                            {9, "U(A)", "%"},    {11, "U(phase)", "deg"}};

void write_budget_head(const char* const Column::*words, ReportWriter& out) noexcept {
  out.part(ReportPart::kHead);
  out.cell(kFrequency.width).text(kFrequency.*words);
  out.cell(kAmplitude.width).text(kAmplitude.*words);
  if (out.in_g()) {
    out.cell(kAmplitudePerG.width).text(kAmplitudePerG.*words);
  }
  for (const Column& column : kRest) {
    out.cell(column.width).text(column.*words);
  }
  out.line();
}

/// @param[in] beside Standard uncertainties that the point's own leave out, as of shared_beside().
void write_budget_row(const SweepPoint& point, const CommonBudget& common, Complex beside,
                      int decimals, ReportWriter& out) noexcept {
  const ResponsePoint& response = point.point;
  const PointBudget& budget = point.budget;
  out.part(ReportPart::kLine);
  out.cell(0).text(point.flagged ? " *" : "  ").right(8).general(response.frequency_hz, 7);
  out.cell(12).fixed(response.amplitude, decimals);
  if (out.in_g()) {
    // A factor of ten nearly: one decimal less has the same digits.
    const int less = decimals > 0 ? decimals - 1 : 0;
    out.cell(12).fixed(kStandardGravity_mps2 * response.amplitude, less);
  }
  out.cell(9).fixed(kDegreesPerRadian * response.phase_rad, 3);
  percent(out.cell(8), budget.noise);
  percent(out.cell(10), budget.quantisation);
  percent(out.cell(8), budget.hum);
  percent(out.cell(12), budget.distortion);
  percent(out.cell(9), length(budget.shared, beside.re));
  const double own = length(response.u_amplitude / response.amplitude, beside.re);
  percent(out.cell(9), kCoverageFactor * length(own, common.total));
  out.cell(11)
      .fixed(kCoverageFactor * kDegreesPerRadian * length(response.u_phase_rad, beside.im), 4)
      .line();
}

void write_budget(const SweepResults& sweep, const Wlsp* fit, ReportWriter& out) noexcept {
  const Span<const SweepPoint> points = sweep.points();
  if (points.empty()) {
    return;
  }
  out.part(ReportPart::kText)
      .text(
          "\n  Uncertainty budget in the manner of ISO 16063-21: standard uncertainties of each "
          "point by\n"
          "  itself, then the expanded ones (k = 2), U(A) with what is common to all points.\n"
          "  Noise: pooled over all points, with ")
      .integer(sweep.noise.dof)
      .text(
          " degrees of freedom, or a point's own if that is larger.\n"
          "  Distortion: harmonics. Shared: drift, the drive's steps, squares of crosstalk")
      .text(fit != nullptr ? ";\n  clock, crosstalk, linearity.\n"
                           : ";\n  no clock, crosstalk, linearity.\n")
      .text(
          "  ADC step, distortion and drift are rectangular, the rest is normal: halves of the U "
          "stated.\n\n");
  out.part(ReportPart::kTable);
  write_budget_head(&Column::name, out);
  write_budget_head(&Column::unit, out);
  double least_u = points[0].point.amplitude;
  for (const SweepPoint& point : points) {
    const double u = length(point.point.u_amplitude, sweep.common.total * point.point.amplitude);
    least_u = u < least_u ? u : least_u;
  }
  const int decimals = decimals_for(least_u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    write_budget_row(points[i], sweep.common, fit != nullptr ? fit->shared_beside(i) : Complex{},
                     decimals, out);
  }
}

void write_fault(const SweepResults& sweep, const EvaluationResults* refused,
                 ReportWriter& out) noexcept {
  out.heading(ReportSection::kFault, "FAULT");
  if (sweep.status == Status::kOk) {
    out.label("identification").text("the points lead to no result").line();
    wrap(out, refused->failure.reason);
    return;
  }
  out.label(name_of_fault(sweep.status));
  if (sweep.failed_frequency_hz > 0.0) {
    out.text("at ").general(sweep.failed_frequency_hz, 7).text(" Hz");
  } else {
    out.text("before the first frequency, with the drive at zero");
  }
  out.line();
  wrap(out, explain(sweep.status));
}

}  // namespace

const char* name_of_fault(Status status) noexcept {
  switch (status) {
    case Status::kLostBlock:
      return "lost block";
    case Status::kLateBlock:
      return "late block";
    case Status::kHardwareFault:
      return "hardware fault";
    case Status::kSaturated:
      return "saturated channel";
    case Status::kStuckChannel:
      return "stuck channel";
    case Status::kNoReference:
      return "no reference";
    case Status::kNoDevice:
      return "no device";
    case Status::kWeakSignal:
      return "weak signal";
    case Status::kLevelNotReached:
      return "level not reached";
    case Status::kSwappedChannels:
      return "swapped channels";
    case Status::kInvertedPolarity:
      return "inverted polarity";
    case Status::kDistorted:
      return "distorted response";
    case Status::kDcDrift:
      return "DC drift";
    case Status::kHum:
      return "mains hum";
    case Status::kFewSteps:
      return "few steps";
    case Status::kStopped:
      return "stopped";
    case Status::kOk:
    case Status::kNotProven:
    case Status::kNothingStored:
    case Status::kUnknownRecord:
    case Status::kDelayTooLong:
    case Status::kDelayNotResolved:
    case Status::kLostDigits:
    case Status::kInvalidArgument:
    case Status::kOverdamped:
    case Status::kInvalidOrder:
    case Status::kTooFewPoints:
    case Status::kTooManyPoints:
    case Status::kNotAscending:
    case Status::kUncertaintyNotPositive:
    case Status::kNotIdentifiable:
    case Status::kNotPhysical:
    case Status::kTooManySwitches:
    case Status::kTooManyCells:
    case Status::kTooFewTrials:
    case Status::kBufferTooSmall:
    case Status::kSyntax:
    case Status::kNotRunning:
    case Status::kAlreadyRunning:
    case Status::kDriveLimit:
      break;
  }
  return "failed measurement";
}

void write_measurement_section(const Measurement& measurement, const Wlsp* fit,
                               ReportWriter& out) noexcept {
  const SweepResults& sweep = measurement.sweep;
  out.heading(ReportSection::kMeasurement,
              "MEASUREMENT (stepped sine, back to back with the reference sensor)");
  write_settings(measurement, out);
  write_chain(sweep.settings, out);
  write_silence(sweep, out);
  write_check(sweep, out);
  out.label("Points measured").integer(sweep.points().size()).text(" of ");
  out.integer(sweep.settings.frequency_count).line();
  for (const Warning warning :
       {Warning::kEnded, Warning::kDataSheet, Warning::kBeyondTable, Warning::kChange}) {
    if (contradicts(warning, sweep)) {
      out.part(ReportPart::kWarning).text("  WARNING: ");
      out.text(words_of_contradiction(warning));
      if (warning == Warning::kDataSheet) {
        out.text(" (").general(magnitude(sweep.check_before) / sweep.settings.expected_sensitivity,
                               3);
        out.text(" times it there)");
      }
      out.text(".\n");
    }
  }
  write_flagged(sweep, out);
  write_common(sweep, out);
  write_budget(sweep, fit, out);
}

void write_measurement(const ReportContext& context, const EvaluationResults* refused,
                       TextWriter& out, ReportMarkup* markup) noexcept {
  ReportWriter writer(out, context, markup);
  write_title(context, writer);
  writer.part(ReportPart::kWarning)
      .text("NOT COMPLETE: a fault has ended the work, so there is no maximum energy.\n");
  write_fault(context.measurement->sweep, refused, writer);
  write_measurement_section(*context.measurement, nullptr, writer);
}

}  // namespace emax::app
