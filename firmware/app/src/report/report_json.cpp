// results.json.
#include "emax/app/base/json_writer.hpp"
#include "emax/app/base/version.hpp"
#include "emax/app/evaluate/figure_range.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_warnings.hpp"
#include "emax/app/settings/setting_field.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/status.hpp"
#include "emax/base/units.hpp"

#include "report_parts.hpp"

namespace emax::app {
namespace {

constexpr double kPercent = 100.0;

const char* source_of(const EvaluationResults& results, const Measurement* measurement) noexcept {
  if (measurement != nullptr) {
    return "bench";
  }
  return results.source == Source::kPoints ? "points" : "model";
}

void write_number_or_null(const char* name, bool exists, double value, JsonWriter& json) noexcept {
  if (exists) {
    json.number(name, value);
  } else {
    json.null(name);
  }
}

void write_model(const EvaluationResults& results, const ReportContext& context,
                 JsonWriter& json) noexcept {
  const Device& device = results.device;
  const bool is_fit = results.source == Source::kPoints;
  json.open("model");
  json.number("S", device.estimate.sensitivity);
  json.number("f0", device.estimate.natural_frequency_hz);
  json.number("beta", device.estimate.damping);
  json.number("uS", device.u.sensitivity);
  json.number("uf0", device.u.natural_frequency_hz);
  write_number_or_null("ubeta", !results.is_damping_open(), device.u.damping, json);
  json.open("covariance", '[');
  for (std::size_t i = 0; i < kWlspParameters; ++i) {
    json.open_row(nullptr);
    for (std::size_t j = 0; j < kWlspParameters; ++j) {
      json.number(nullptr, results.covariance(i, j));
    }
    json.close_row();
  }
  json.close(']');
  if (is_fit) {
    json.number("chi2", results.fit.result().chi2);
    json.integer("dof", results.fit.result().dof);
  } else {
    json.null("chi2");
    json.null("dof");
  }
  json.number("u_factor", results.trial_scale());
  if (is_fit && results.fit.response().has_common()) {
    json.number("common_percent", kCoverageFactor * kPercent * results.fit.response().common()[0]);
  } else {
    json.null("common_percent");
  }
  json.words("source", source_of(results, context.measurement));
  if (context.source_name != nullptr) {
    json.words("name", context.source_name);
  } else {
    json.null("name");
  }
  json.close();
}

// The bench

void write_fault(const SweepResults& sweep, const EvaluationResults* refused,
                 JsonWriter& json) noexcept {
  const bool is_sweep = sweep.status != Status::kOk;
  if (!is_sweep && refused == nullptr) {
    json.null("fault");
    return;
  }
  json.open("fault");
  json.words("name", is_sweep ? name_of_fault(sweep.status) : "identification");
  if (is_sweep && sweep.failed_frequency_hz > 0.0) {
    json.number("frequency", sweep.failed_frequency_hz);
  } else {
    json.null("frequency");
  }
  json.words("advice", is_sweep ? explain(sweep.status) : refused->failure.reason);
  json.close();
}

void write_simulated(const SimulatedBench* simulated, JsonWriter& json) noexcept {
  if (simulated == nullptr) {
    json.null("seed");
    json.null("truth");
    return;
  }
  json.integer("seed", simulated->seed);
  if (simulated->unstruck != nullptr) {
    json.words("unstruck", simulated->unstruck);
  }
  json.open("truth");
  json.number("S", simulated->truth.sensitivity);
  json.number("f0", simulated->truth.natural_frequency_hz);
  json.number("beta", simulated->truth.damping);
  json.close();
}

/// A number of a struct, as a row of a table: less code than a call for each.
struct NamedNumber {
  const char* name;
  std::size_t offset;
};

constexpr NamedNumber kBenchNumbers[] = {
    {"level", offsetof(SweepSettings, level_mps2)},
    {"acceleration_limit", offsetof(SweepSettings, acceleration_limit_mps2)},
    {"drive_limit", offsetof(SweepSettings, drive_limit_v)},
    {"slew", offsetof(SweepSettings, slew_v_per_s)},
    {"reference_percent", offsetof(SweepSettings, reference.expanded_percent)},
    {"reference_gain", offsetof(SweepSettings, reference_gain)},
    {"reference_gain_percent", offsetof(SweepSettings, reference_gain_expanded_percent)},
    {"device_gain", offsetof(SweepSettings, device_gain)},
    {"device_gain_percent", offsetof(SweepSettings, device_gain_expanded_percent)},
    {"ratio", offsetof(SweepSettings, ratio_correction)},
    {"ratio_percent", offsetof(SweepSettings, ratio_expanded_percent)},
    {"mounting_percent", offsetof(SweepSettings, mounting_expanded_percent)},
    {"skew", offsetof(SweepSettings, skew_s)},
    {"skew_u", offsetof(SweepSettings, skew_expanded_s)},
    {"clock_ppm", offsetof(SweepSettings, clock_expanded_ppm)},
    {"crosstalk_percent", offsetof(SweepSettings, crosstalk_expanded_percent)},
    {"linearity_percent", offsetof(SweepSettings, linearity_expanded_percent)},
};

constexpr NamedNumber kSharedNumbers[] = {
    {"skew", offsetof(SharedEffects, skew_s)},
    {"clock", offsetof(SharedEffects, clock)},
    {"drift", offsetof(SharedEffects, drift)},
    {"corner", offsetof(SharedEffects, corner_hz)},
    {"images", offsetof(SharedEffects, images)},
    {"leak", offsetof(SharedEffects, leak)},
    {"leak_back", offsetof(SharedEffects, leak_back)},
    {"linearity", offsetof(SharedEffects, linearity)},
};

void write_numbers(Span<const NamedNumber> rows, const void* object, JsonWriter& json) noexcept {
  for (const NamedNumber& row : rows) {
    json.number(row.name, member_at<double>(object, row.offset));
  }
}

void write_common(const SweepResults& sweep, JsonWriter& json) noexcept {
  const double before = sqrt(norm(sweep.check_before));
  const double after = sqrt(norm(sweep.check_after));
  json.open("check");
  json.number("frequency", sweep.settings.check_hz);
  write_number_or_null("before", before > 0.0, before, json);
  write_number_or_null("after", after > 0.0, after, json);
  json.close();
  const bool has_drift = before > 0.0 && after > 0.0;
  write_number_or_null("drift_percent", has_drift,
                       has_drift ? kPercent * (after / before - 1.0) : 0.0, json);
  const CommonBudget& common = sweep.common;
  json.open("common");
  json.number("reference", common.reference);
  json.number("gain", common.gain);
  json.number("mounting", common.mounting);
  write_number_or_null("drift", has_drift, common.drift, json);
  json.number("total", common.total);
  json.close();
  json.number("common_percent", kCoverageFactor * kPercent * common.total);
  const SharedEffects& shared = sweep.shared;
  json.open("shared");
  write_numbers(kSharedNumbers, &shared, json);
  json.close();
}

void write_budget(const SweepResults& sweep, JsonWriter& json) noexcept {
  json.open_row("flagged");
  for (const SweepPoint& point : sweep.points()) {
    if (point.flagged) {
      json.number(nullptr, point.point.frequency_hz);
    }
  }
  json.close_row();
  json.open("budget", '[');
  for (const SweepPoint& point : sweep.points()) {
    const double row[] = {point.point.frequency_hz,  point.budget.noise,
                          point.budget.quantisation, point.budget.hum,
                          point.budget.distortion,   point.point.u_phase_rad,
                          point.budget.shared,       point.acceleration_mps2};
    json.open_row(nullptr);
    for (const double value : row) {
      json.number(nullptr, value);
    }
    json.close_row();
  }
  json.close(']');
}

void write_bench(const Measurement* measurement, const EvaluationResults* refused,
                 JsonWriter& json) noexcept {
  if (measurement == nullptr) {
    json.null("bench");
    return;
  }
  const SweepResults& sweep = measurement->sweep;
  const SweepSettings& settings = sweep.settings;
  json.open("bench");
  write_simulated(measurement->simulated, json);
  write_fault(sweep, refused, json);
  json.integer("points", sweep.points().size());
  json.integer("frequencies", settings.frequency_count);
  json.number("sample_rate", measurement->format.sample_rate_hz);
  write_numbers(kBenchNumbers, &settings, json);
  write_common(sweep, json);
  write_budget(sweep, json);
  json.close();
}

const char* name_of(GainMode mode) noexcept {
  if (mode == GainMode::kFixed) {
    return "fixed";
  }
  return mode == GainMode::kTrack ? "track" : "auto";
}

void write_filter(const EvaluationResults& results, JsonWriter& json) noexcept {
  const ReferenceFilter& filter = results.model.filter();
  json.open("filter");
  json.integer("order", static_cast<std::uint64_t>(filter.relative_degree));
  json.number("cutoff", filter.band_hz);
  json.number("gain", filter.gain);
  json.words("gain_mode", name_of(results.settings.gain_mode));
  json.close();
}

void write_impulse_response(const EvaluationResults& results, JsonWriter& json) noexcept {
  const SettlingTime& settling = results.settling_time;
  json.open("impulse_response");
  json.number("peak", results.peak.value);
  json.number("peak_time_s", results.peak.time_s);
  if (settling.found) {
    json.number("settling_time_s", settling.time_s);
  } else {
    json.null("settling_time_s");
  }
  json.close();
}

const char* name_of(Criterion criterion) noexcept {
  switch (criterion) {
    case Criterion::kIntegralSquareError:
      return "ise";
    case Criterion::kEnergyDifference:
      return "difference";
    case Criterion::kInBandError:
      break;
  }
  return "band";
}

const char* name_of(DelayChoice choice) noexcept {
  if (choice == DelayChoice::kNone) {
    return "none";
  }
  return choice == DelayChoice::kGiven ? "given" : "auto";
}

void write_energy(const EvaluationResults& results, JsonWriter& json) noexcept {
  const Settings& settings = results.settings;
  const MaximumEnergy& maximum = results.maximum;
  json.open("energy");
  json.words("criterion", name_of(settings.criterion));
  const bool is_in_band = settings.criterion == Criterion::kInBandError;
  json.words("delay_mode", name_of(is_in_band ? settings.delay_choice : DelayChoice::kNone));
  json.number("delay_s", results.model.delay_s());
  json.words("method", settings.method == Method::kBest ? "best" : "paper");
  json.number("T", settings.duration_s);
  json.number("a", results.limit_mps2);
  json.number("E", results.energy_v2s());
  json.number("xi", results.xi());
  json.number("rms", results.rms_error_v());
  if (results.has_bound) {
    json.number("bound", results.bound_v2s);
  } else {
    json.null("bound");
  }
  json.open_row("switch_times");
  for (const double time_s : maximum.signal.times_s()) {
    json.number(nullptr, time_s);
  }
  json.close_row();
  json.integer("iterations", maximum.iterations);
  if (results.has_absolute_error) {
    json.number("absolute_error", results.absolute_error_v);
  } else {
    json.null("absolute_error");
  }
  json.close();
}

// The in-band errors

void write_interval_in_percent(const char* name, const EvaluationResults& results,
                               const CoverageInterval& interval, JsonWriter& json) noexcept {
  json.pair(name, results.percent_of(interval.low), results.percent_of(interval.high));
}

void write_disagreements(const GuardResults& guard, JsonWriter& json) noexcept {
  if (guard.searches > 0) {
    json.integer("disagreements", guard.disagreements);
  } else {
    json.null("disagreements");
  }
}

/// The number of trials, where it is not the one asked for.
void write_fewer_trials(const EvaluationResults& results, const EnergyUncertainty& known,
                        JsonWriter& json) noexcept {
  if (results.has_fewer_trials(known)) {
    json.integer("trials", known.trials);
  }
}

/// What the report states in the place of +-U; null where U is the one to use.
void write_instead_of_u(const EvaluationResults& results, const EnergyUncertainty& known,
                        double energy_v2s, JsonWriter& json) noexcept {
  if (energy_v2s >= 0.0 && results.is_one_sided(known, energy_v2s)) {
    const CoverageInterval interval =
        results.interval_percent_of(known.shortest_of_percent(), energy_v2s);
    json.pair("instead_of_U_percent", interval.low, interval.high);
  } else {
    json.null("instead_of_U_percent");
  }
}

void write_figure_uncertainty(const EvaluationResults& results, const FigureResults& figure,
                              JsonWriter& json) noexcept {
  const EnergyUncertainty& known = figure.uncertainty;
  if (!known.exists()) {
    for (const char* name :
         {"u", "U", "interval", "shortest", "u_percent", "U_percent", "interval_percent",
          "shortest_percent", "instead_of_U_percent", "disagreements"}) {
      json.null(name);
    }
    return;
  }
  write_fewer_trials(results, known, json);
  json.number("u", known.u_v2s);
  json.number("U", kCoverageFactor * known.u_v2s);
  json.pair("interval", known.symmetric.low, known.symmetric.high);
  json.pair("shortest", known.shortest.low, known.shortest.high);
  json.number("u_percent", known.u_percent);
  json.number("U_percent", kCoverageFactor * known.u_percent);
  write_interval_in_percent("interval_percent", results, known.symmetric_of_percent(), json);
  write_interval_in_percent("shortest_percent", results, known.shortest_of_percent(), json);
  write_instead_of_u(results, known, figure.energy_v2s, json);
  write_disagreements(known.guard, json);
}

void write_figure(const EvaluationResults& results, const FigureResults& figure,
                  JsonWriter& json) noexcept {
  json.number("E", figure.energy_v2s);
  json.number("rms", sqrt(figure.energy_v2s / results.settings.duration_s));
  json.number("rms_percent", results.percent_of(figure.energy_v2s));
  write_number_or_null("bound", figure.has_bound, figure.bound_v2s, json);
  write_number_or_null("bound_percent", figure.has_bound, results.percent_of(figure.bound_v2s),
                       json);
  json.integer("switches", figure.switches);
  json.open_row("switch_times");
  for (const double time_s : figure.times_s()) {
    json.number(nullptr, time_s);
  }
  json.close_row();
  if (kHasFigureRanges && figure.has_range) {
    write_interval_in_percent("range_percent", results, {figure.least_v2s, figure.greatest_v2s},
                              json);
  }
  write_figure_uncertainty(results, figure, json);
}

void write_band(const EvaluationResults& results, JsonWriter& json) noexcept {
  const FigureResults& matched = results.matched;
  if (!results.band.exists()) {
    json.null("band");
    json.words("band_refused", results.band.refusal());
    return;
  }
  json.open("band");
  write_figure(results, results.band, json);
  write_number_or_null("settling_time_s", results.band_settling.found, results.band_settling.time_s,
                       json);
  if (matched.exists()) {
    json.open("matched");
    json.words("delay_mode",
               name_of(results.settings.delay_choice == DelayChoice::kGiven ? DelayChoice::kGiven
                                                                            : DelayChoice::kAuto));
    json.number("delay_s", matched.delay_s);
    json.number("epsilon_percent", matched.epsilon_percent);
    write_figure(results, matched, json);
    json.close();
    json.null("matched_refused");
  } else {
    json.null("matched");
    json.words("matched_refused", matched.refusal());
  }
  json.close();
  json.null("band_refused");
}

void write_ideal(const EvaluationResults& results, JsonWriter& json) noexcept {
  if (!results.ideal.exists()) {
    json.null("ideal");
    return;
  }
  json.open("ideal");
  json.number("E", results.ideal.energy_v2s);
  json.number("rms_percent", results.percent_of(results.ideal.energy_v2s));
  json.close();
}

void write_uncertainty(const EvaluationResults& results, JsonWriter& json) noexcept {
  const EnergyUncertainty& known = results.uncertainty;
  if (!known.exists()) {
    json.null("uncertainty");
    return;
  }
  json.open("uncertainty");
  json.words("distribution", "normal");
  json.number("probability", results.settings.probability);
  write_fewer_trials(results, known, json);
  json.number("u", known.u_v2s);
  json.number("U", kCoverageFactor * known.u_v2s);
  json.pair("interval", known.symmetric.low, known.symmetric.high);
  json.pair("shortest", known.shortest.low, known.shortest.high);
  json.integer("redrawn", known.redraws);
  // An energy difference may be below 0, and that of a trial, too.
  const bool has_root = results.energy_v2s() >= 0.0 && is_finite(known.u_percent);
  write_number_or_null("u_percent", has_root, known.u_percent, json);
  write_number_or_null("U_percent", has_root, kCoverageFactor * known.u_percent, json);
  write_instead_of_u(results, known, results.energy_v2s(), json);
  write_disagreements(known.guard, json);
  json.close();
}

/// @param[in] least_s The T that it asks for; 0 if it asks for none.
void write_warning(const char* about, const char* words, double least_s,
                   JsonWriter& json) noexcept {
  json.open(nullptr);
  json.words("about", about);
  json.words("text", words);
  if (least_s > 0.0) {
    json.number("least_time_s", least_s);
  }
  json.close();
}

void write_if_due(Warning warning, const EvaluationResults& results, const ReportContext& context,
                  JsonWriter& json) noexcept {
  if (holds(warning, results, context)) {
    const char* const words =
        warning == Warning::kUnits ? context.doubt : words_of(warning, results);
    write_warning(about(warning), words, least_time_s(warning, results), json);
  }
}

void write_warnings(const EvaluationResults& results, const ReportContext& context,
                    JsonWriter& json) noexcept {
  json.open("warnings", '[');
  if (context.other_criterion != nullptr) {
    write_warning("energy", context.other_criterion, 0.0, json);
  }
  for (const Warning warning : kWarnings) {
    write_if_due(warning, results, context, json);
  }
  json.close(']');
}

void write_monte_carlo(const EvaluationResults& results, JsonWriter& json) noexcept {
  if (!results.has_monte_carlo) {
    json.null("monte_carlo");
    return;
  }
  const MonteCarloResult& result = results.trials.result;
  const Accelerometer& at = results.device_at_maximum;
  json.open("monte_carlo");
  json.integer("trials", result.trials);
  json.number("probability", result.probability);
  json.words("distribution",
             results.settings.distribution == Distribution::kBox ? "box" : "normal");
  json.open_row("seed");
  for (const std::uint32_t seed : results.settings.seed) {
    json.integer(nullptr, seed);
  }
  json.close_row();
  json.number("E_max", result.maximum);
  json.open("at");
  json.number("S", at.sensitivity);
  json.number("f0", at.natural_frequency_hz);
  json.number("beta", at.damping);
  json.close();
  json.integer("trial", result.trial_of_maximum);
  json.number("mean", result.mean);
  json.number("u", result.u);
  json.pair("interval", result.symmetric.low, result.symmetric.high);
  json.pair("shortest", result.shortest.low, result.shortest.high);
  write_disagreements(results.guard, json);
  json.close();
}

const char* name_of(Determined determined) noexcept {
  switch (determined) {
    case Determined::kAll:
      return "all";
    case Determined::kAllButDamping:
      return "all but beta";
    case Determined::kSensitivity:
      return "S";
    case Determined::kNothing:
      break;
  }
  return "nothing";
}

// What the points determine, as fitted, and the range of the energy where they leave beta open.
void write_fit(const EvaluationResults& results, const ReportContext& context,
               JsonWriter& json) noexcept {
  const FitJudgement& judgement = results.judgement;
  if (results.source != Source::kPoints || context.measurement != nullptr) {
    return;
  }
  const WlspFit& fit = results.fit.result();
  json.open("fit");
  json.words("determined", name_of(judgement.determined));
  write_number_or_null("beta", fit.u_sensitivity > 0.0, fit.model.damping, json);
  write_number_or_null("ubeta", fit.u_sensitivity > 0.0, fit.u_damping, json);
  json.integer("unknown_phases", fit.unknown_phases);
  if (judgement.frequency_low_hz > 0.0) {
    json.number("f0_above", judgement.frequency_low_hz);
  }
  if (context.read_as != nullptr) {
    json.words("read_as", context.read_as);
  }
  if (context.cause != nullptr) {
    json.words("cause", context.cause);
  }
  if (results.is_damping_open()) {
    json.pair("beta_range", judgement.damping_low, judgement.damping_high);
  }
  if (results.has_cut_range) {
    json.pair("E_range", results.cut_low_v2s, results.cut_high_v2s);
  }
  json.close();
}

void write_trend(const EvaluationResults& results, JsonWriter& json) noexcept {
  if (results.trend_points().empty()) {
    json.null("trend");
    return;
  }
  json.open("trend");
  json.number("slope", results.trend.slope);
  json.number("intercept", results.trend.intercept);
  json.open("points", '[');
  for (const TrendPoint& point : results.trend_points()) {
    json.pair(nullptr, point.duration_s, point.energy_v2s);
  }
  json.close(']');
  json.close();
}

void write_label(const char* name, const char* words, JsonWriter& json) noexcept {
  if (words != nullptr) {
    json.words(name, words);
  } else {
    json.null(name);
  }
}

void write_head(const Labels& labels, JsonWriter& json) noexcept {
  json.words("version", kVersion);
  if (!labels.any()) {
    return;
  }
  json.open("labels");
  write_label("device", labels.device, json);
  write_label("serial", labels.serial, json);
  write_label("operator", labels.operated_by, json);
  write_label("date", labels.date, json);
  write_label("note", labels.note, json);
  for (const NamedLabel& label : labels.more) {
    json.words(label.key, label.words);
  }
  json.close();
}

// For a front end

void write_point(const ResponsePoint& point, double common, JsonWriter& json) noexcept {
  const double shared = common * point.amplitude;
  json.open(nullptr);
  json.number("f_hz", point.frequency_hz);
  json.number("amplitude", point.amplitude);
  json.number("phase_deg", point.phase_rad * kDegreesPerRadian);
  json.number("u_amplitude",
              kCoverageFactor * sqrt(point.u_amplitude * point.u_amplitude + shared * shared));
  json.number("u_phase_deg", kCoverageFactor * point.u_phase_rad * kDegreesPerRadian);
  json.close();
}

void write_points(const InstrumentState& state, JsonWriter& json) noexcept {
  json.open("points", '[');
  if (state.measurement != nullptr) {
    for (const SweepPoint& point : state.measurement->sweep.points()) {
      write_point(point.point, state.measurement->sweep.common.total, json);
    }
  } else {
    for (std::size_t i = 0; i < state.points.size(); ++i) {
      write_point(state.points.points()[i], state.points.common()[i], json);
    }
  }
  json.close(']');
}

void write_row(const char* name, Span<const double> values, JsonWriter& json) noexcept {
  json.open_row(name);
  for (const double value : values) {
    json.number(nullptr, value);
  }
  json.close_row();
}

void write_sweep_settings(const SweepSettings& settings, JsonWriter& json) noexcept {
  json.open("settings");
  std::size_t count = 0;  // Of the list of before, which the next one may share.
  for (const SettingField& field : fields_of(settings)) {
    switch (field.kind) {
      case SettingKind::kNumbers:
        count = member_at<std::size_t>(&settings, field.beside);
        [[fallthrough]];
      case SettingKind::kMoreNumbers:
        write_row(field.name,
                  Span<const double>(&member_at<double>(&settings, field.offset), count), json);
        break;
      case SettingKind::kNumber:
      case SettingKind::kWhole:
        json.number(field.name, number_in(field, &settings));
        break;
      case SettingKind::kSwitch:
      case SettingKind::kChoice:
      case SettingKind::kNumberOrWord:
      case SettingKind::kWholes:
        break;  // No setting of a sweep is one.
    }
  }
  json.close();
}

void write_silence(const SilentChannel& channel, JsonWriter& json) noexcept {
  json.open_row(nullptr);
  json.number(nullptr, channel.offset_v);
  json.number(nullptr, channel.drift_v);
  json.number(nullptr, channel.noise_v);
  for (const double hum_v : channel.hum_v) {
    json.number(nullptr, hum_v);
  }
  json.close_row();
}

void write_sweep_rows(const SweepResults& sweep, JsonWriter& json) noexcept {
  json.open("rows", '[');
  for (const SweepPoint& point : sweep.points()) {
    const double row[] = {point.point.phase_rad,
                          point.point.u_amplitude,
                          point.point.u_phase_rad,
                          point.acceleration_mps2,
                          point.drive_v,
                          static_cast<double>(point.residual_percent),
                          point.flagged ? 1.0 : 0.0,
                          point.scatters ? 1.0 : 0.0};
    write_row(nullptr, row, json);
  }
  json.close(']');
}

void write_sweep(const Measurement* measurement, JsonWriter& json) noexcept {
  if (measurement == nullptr) {
    json.null("sweep");
    return;
  }
  const SweepResults& sweep = measurement->sweep;
  json.open("sweep");
  json.integer("status", static_cast<std::uint64_t>(sweep.status));
  json.integer("stage", static_cast<std::uint64_t>(sweep.stage));
  write_sweep_settings(sweep.settings, json);
  write_sweep_rows(sweep, json);
  json.open("silence", '[');
  write_silence(sweep.inputs.silent_reference, json);
  write_silence(sweep.inputs.silent_device, json);
  json.close(']');
  const double check[] = {sweep.check_before.re, sweep.check_before.im, sweep.check_after.re,
                          sweep.check_after.im};
  write_row("check", check, json);
  const double noise[] = {sweep.noise.reference_v, sweep.noise.device_v,
                          static_cast<double>(sweep.noise.dof)};
  write_row("noise", noise, json);
  json.close();
}

void write_error_system(const InstrumentState& state, JsonWriter& json) noexcept {
  if (!state.has_model) {
    json.null("filter");
    json.null("impulse_response");
    return;
  }
  write_filter(state.evaluation, json);
  write_impulse_response(state.evaluation, json);
}

void write_energies(const InstrumentState& state, JsonWriter& json) noexcept {
  if (state.has_energy) {
    write_energy(state.evaluation, json);
  } else {
    json.null("energy");
  }
  if (state.has_band) {
    write_band(state.evaluation, json);
    write_ideal(state.evaluation, json);
  } else {
    json.null("band");
    json.null("band_refused");
    json.null("ideal");
  }
}

void write_trials(const InstrumentState& state, JsonWriter& json) noexcept {
  if (state.has_uncertainty) {
    write_uncertainty(state.evaluation, json);
  } else {
    json.null("uncertainty");
  }
  if (state.has_trials) {
    write_monte_carlo(state.evaluation, json);
  } else {
    json.null("monte_carlo");
  }
  if (state.has_trend) {
    write_trend(state.evaluation, json);
  } else {
    json.null("trend");
  }
}

// Of the parts that the settings of now leave valid.
void write_warnings(const InstrumentState& state, const ReportContext& context,
                    JsonWriter& json) noexcept {
  json.open("warnings", '[');
  for (const Warning warning : kWarnings) {
    const ReportSection place = place_of(warning);
    const bool is_valid = place == ReportSection::kMonteCarlo    ? state.has_trials
                          : place == ReportSection::kUncertainty ? state.has_uncertainty
                          : place == ReportSection::kFit         ? state.has_model
                          : place == ReportSection::kMeasurement ? true
                                                                 : state.has_energy;
    if (is_valid) {
      write_if_due(warning, state.evaluation, context, json);
    }
  }
  json.close(']');
}

/// What stands where there is no energy.
void write_nothing_evaluated(JsonWriter& json) noexcept {
  for (const char* part : {"filter", "impulse_response", "energy", "band", "band_refused", "ideal",
                           "uncertainty", "monte_carlo", "trend"}) {
    json.null(part);
  }
}

}  // namespace

void write_instrument_json(const InstrumentState& state, TextWriter& out) noexcept {
  ReportContext context;
  context.measurement = state.measurement;
  JsonWriter json(out);
  json.open(nullptr);
  write_head(context.labels, json);
  write_points(state, json);
  write_sweep(state.measurement, json);
  if (state.has_model) {
    write_model(state.evaluation, context, json);
    write_fit(state.evaluation, context, json);
  } else {
    json.null("model");
  }
  write_bench(state.measurement, nullptr, json);
  write_error_system(state, json);
  write_energies(state, json);
  write_trials(state, json);
  write_warnings(state, context, json);
  json.boolean("simulated", is_simulated(context));
  json.close();
  out.line();
}

void write_json(const EvaluationResults& results, const ReportContext& context,
                TextWriter& out) noexcept {
  JsonWriter json(out);
  json.open(nullptr);
  write_head(context.labels, json);
  write_model(results, context, json);
  write_fit(results, context, json);
  write_bench(context.measurement, nullptr, json);
  write_filter(results, json);
  write_impulse_response(results, json);
  write_energy(results, json);
  write_band(results, json);
  write_ideal(results, json);
  write_uncertainty(results, json);
  write_monte_carlo(results, json);
  write_trend(results, json);
  write_warnings(results, context, json);
  json.boolean("simulated", is_simulated(context));
  json.close();
  out.line();
}

void write_sensitivity_json(const EvaluationResults& results, const ReportContext& context,
                            TextWriter& out) noexcept {
  const FitJudgement& judgement = results.judgement;
  JsonWriter json(out);
  json.open(nullptr);
  write_head(context.labels, json);
  json.open("model");
  json.number("S", judgement.device.sensitivity);
  json.null("f0");
  json.null("beta");
  json.number("uS", judgement.u_sensitivity);
  for (const char* number :
       {"uf0", "ubeta", "covariance", "chi2", "dof", "u_factor", "common_percent"}) {
    json.null(number);
  }
  json.words("source", source_of(results, context.measurement));
  write_label("name", context.source_name, json);
  json.close();
  write_fit(results, context, json);
  write_bench(context.measurement, nullptr, json);
  write_nothing_evaluated(json);
  write_warnings(results, context, json);
  json.boolean("simulated", is_simulated(context));
  json.close();
  out.line();
}

void write_measurement_json(const ReportContext& context, const EvaluationResults* refused,
                            TextWriter& out) noexcept {
  JsonWriter json(out);
  json.open(nullptr);
  write_head(context.labels, json);
  json.null("model");
  write_bench(context.measurement, refused, json);
  write_nothing_evaluated(json);
  json.open("warnings", '[');
  write_warning("measurement", "a fault has ended the work, so there is no maximum energy", 0.0,
                json);
  json.close(']');
  json.boolean("simulated", is_simulated(context));
  json.close();
  out.line();
}

}  // namespace emax::app
