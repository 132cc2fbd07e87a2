// The report as text.
#include "emax/app/report/report.hpp"

#include <limits>

#include "emax/app/report/report_warnings.hpp"
#include "emax/base/elementary.hpp"

#include "report_figures.hpp"
#include "report_parts.hpp"

namespace emax::app {
namespace {

constexpr double kLargeResidual = 3.0;
constexpr std::size_t kResidualsShown = 10;
constexpr std::size_t kFrequencyWidth = 2 + kLabelWidth + 13;
constexpr std::size_t kTraceShown = 12;
constexpr double kLeastCorrelationShown = 0.0005;  // Less would be -0.000.
// Below it the energies leave a line by 4 % of their range or more.
constexpr double kLeastTrendCorrelation = 0.999;
constexpr double kQuantile99 = 2.326347874040841;  // Of N(0, 1) at 99 %.
constexpr std::size_t kDamping = 2;                // Of the parameters.
constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;
constexpr double kPercent = 100.0;

const char* const kParameterNames[] = {"S", "f0", "beta"};
const char* const kParameterUnits[] = {"V/(m/s^2)", "Hz", "1"};

double square(double x) noexcept { return x * x; }

/// The value that a chi-square of `dof` degrees of freedom over `dof` stays below with the
/// probability of the normal quantile `z`; Wilson and Hilferty.
double reduced_chi_square_quantile(std::size_t dof, double z) noexcept {
  if (dof == 0) {
    return 0.0;
  }
  const double variance = 2.0 / (9.0 * static_cast<double>(dof));
  const double root = 1.0 - variance + z * sqrt(variance);
  return root > 0.0 ? root * root * root : 0.0;
}

// What was put in

void write_points(const EvaluationResults& results, const ReportContext& context,
                  ReportWriter& out) noexcept {
  const Span<const ResponsePoint> points = results.fit.response().points();
  if (context.measurement != nullptr) {
    const bool is_simulated = context.measurement->simulated != nullptr;
    out.text("measured on the ").text(is_simulated ? "simulated " : "").text("bench").line();
  } else {
    out.text("measured points");
    if (context.source_name != nullptr) {
      out.text(": ");
      out.quote(context.source_name);
    }
    out.line();
  }
  out.indent().integer(points.size()).text(" points from ").exact(points[0].frequency_hz);
  out.text(" Hz to ").exact(points[points.size() - 1].frequency_hz).text(" Hz").line();
  if (context.read_as != nullptr) {
    out.indent();
    out.quote(context.read_as).line();
  }
}

void write_source(const EvaluationResults& results, const ReportContext& context,
                  ReportWriter& out) noexcept {
  out.label("Device");
  if (results.source == Source::kModel) {
    out.text("parameters as given").line();
    const Accelerometer& device = results.device.estimate;
    const ParameterBox& u = results.device.u;
    out.indent().text("S = ").exact(device.sensitivity).text(" V/(m/s^2)");
    out.and_v_per_g(device.sensitivity, 7).text(", standard u = ").exact(u.sensitivity);
    out.and_v_per_g(u.sensitivity, 3).line();
    out.indent().text("f0 = ").exact(device.natural_frequency_hz).text(" Hz, standard u = ");
    out.exact(u.natural_frequency_hz).line();
    out.indent()
        .text("beta = ")
        .exact(device.damping)
        .text(", standard u = ")
        .exact(u.damping)
        .line();
    return;
  }
  write_points(results, context, out);
}

void write_filter(const EvaluationResults& results, ReportWriter& out) noexcept {
  const Settings& settings = results.settings;
  const ReferenceFilter& filter = results.model.filter();
  out.label("Reference filter").text("Butterworth low-pass, order ");
  out.integer(static_cast<std::uint64_t>(filter.relative_degree)).text(", cutoff ");
  out.exact(filter.band_hz).text(" Hz").line();
  out.label("Filter gain").general(filter.gain, 7).text(" V/(m/s^2)");
  out.and_v_per_g(filter.gain, 7).text(", ");
  switch (settings.gain_mode) {
    case GainMode::kAuto:
      out.text("the estimate of S, the same in every trial");
      break;
    case GainMode::kFixed:
      out.text("as given, the same in every trial");
      break;
    case GainMode::kTrack:
      out.text("the estimate of S; in each trial that trial's S");
      break;
  }
  out.line();
}

void write_delay(const EvaluationResults& results, ReportWriter& out) noexcept {
  out.line();
  out.indent().text("the reference delayed by ").general(kMicro * results.model.delay_s(), 5);
  out.text(" us");
  if (results.settings.delay_choice == DelayChoice::kGiven) {
    out.text(", as given");
  }
}

void write_method(const EvaluationResults& results, ReportWriter& out) noexcept {
  const Settings& settings = results.settings;
  out.label("Criterion");
  switch (settings.criterion) {
    case Criterion::kIntegralSquareError:
      out.text("integral-square error: energy of sensor minus filter, equation (15)");
      break;
    case Criterion::kEnergyDifference:
      out.text("energy difference: E(sensor) minus E(filter), equations (5), (13)");
      break;
    case Criterion::kInBandError:
      out.text("in-band error: energy of sensor minus G x, behind the filter");
      write_delay(results, out);
      break;
  }
  out.line();
  out.label("Method");
  if (settings.method == Method::kBest) {
    out.text("best: many starts, fixed point and pulses, the best refined").line();
    return;
  }
  out.text("paper: fixed point from the first column of Phi, step ");
  out.general(kMicro * settings.step_s, 10).text(" us, J = ").integer(settings.iterations).line();
}

void write_random_numbers(const Settings& settings, ReportWriter& out) noexcept {
  out.label("Random numbers").text("Wichmann-Hill ");
  const bool is_2006 = settings.generator == Generator::k2006;
  out.text(is_2006 ? "2006" : "1982").text(", seed ");
  const std::size_t count = is_2006 ? 4 : 3;
  for (std::size_t i = 0; i < count; ++i) {
    out.text(i == 0 ? "" : ",").integer(settings.seed[i]);
  }
  out.line();
}

void write_input(const EvaluationResults& results, const ReportContext& context,
                 ReportWriter& out) noexcept {
  const Settings& settings = results.settings;
  out.heading(ReportSection::kInput, "WHAT WAS PUT IN");
  write_source(results, context, out);
  write_filter(results, out);
  out.label("Time T").general(kMilli * settings.duration_s, 10).text(" ms").line();
  out.label("Limit a").general(results.limit_mps2, 7).text(" m/s^2");
  out.and_g(results.limit_mps2, 7);
  out.text(settings.limit_is_auto ? ", the number of S" : ", as given").line();
  write_method(results, out);
  write_random_numbers(settings, out);
}

// Fit

double estimate_of(const Accelerometer& device, std::size_t parameter) noexcept {
  const double values[] = {device.sensitivity, device.natural_frequency_hz, device.damping};
  return values[parameter];
}

struct Estimate {
  const char* name;
  const char* unit;
  double value;
  double u;
  double u_by_draws;
  double expanded;
  bool is_held;
};

void write_estimate(const Estimate& estimate, ReportWriter& out) noexcept {
  const bool is_short = out.rounds_to_u();
  const int decimals = is_short ? decimals_of(estimate.expanded, 2) : decimals_for(estimate.u);
  const int of_u = is_short ? decimals_of(estimate.u, 2) : decimals;  // Twice it rounds to U.
  out.part(ReportPart::kLine);
  out.cell(0).text("  ").left(11).text(estimate.name);
  if (estimate.is_held) {
    out.cell(15).general(estimate.value, 4);
    for (int i = 0; i < 3; ++i) {
      out.cell(15).text("held");
    }
    out.cell(0).text("  ").text(estimate.unit).line();
    return;
  }
  out.cell(15).fixed(estimate.value, decimals);
  out.cell(15).fixed(estimate.u, of_u);
  out.cell(15).fixed(estimate.u_by_draws, of_u);
  out.cell(15).fixed(estimate.expanded, decimals);
  out.cell(0).text("  ").text(estimate.unit).line();
}

void write_estimates(const EvaluationResults& results, ReportWriter& out) noexcept {
  const double coverage = kCoverageFactor * results.trial_scale();
  const WlspDrawsResult& draws = results.fit_draws;
  out.part(ReportPart::kTable);
  out.part(ReportPart::kHead);
  out.cell(0).text("  ").left(11).text("parameter");
  out.cell(15).text("estimate");
  out.cell(15).text("u");
  out.cell(15).text("u by draws");
  out.cell(15).text("U (k = 2)");
  out.cell(0).text("  unit").line();
  for (std::size_t i = 0; i < kWlspParameters; ++i) {
    const double u = sqrt(results.covariance(i, i));
    const Estimate estimate = {kParameterNames[i],
                               kParameterUnits[i],
                               estimate_of(results.fit.result().model, i),
                               u,
                               sqrt(draws.covariance[i][i]),
                               coverage * u,
                               i == kDamping && results.fit.result().is_damping_held};
    write_estimate(estimate, out);
    if (i == 0 && out.in_g()) {
      constexpr double kG = kStandardGravity_mps2;
      write_estimate({estimate.name, "V/g", kG * estimate.value, kG * estimate.u,
                      kG * estimate.u_by_draws, kG * estimate.expanded, false},
                     out);
    }
  }
  out.part(ReportPart::kText);
  out.text("  u: standard uncertainty from the stated ones, by formula and by ");
  out.integer(draws.draws).text(" Monte Carlo draws");
  if (draws.discarded > 0) {
    out.text(" (").integer(draws.discarded).text(" more gave no device)");
  }
  if (results.fit.response().has_common()) {
    out.text(",\n  both with the part that is common to all points");
  }
  if (results.trial_scale() > 1.0) {
    out.text("; U is times the Birge ratio");
  }
  out.line();
}

void write_truth(const EvaluationResults& results, const Accelerometer& truth,
                 ReportWriter& out) noexcept {
  out.label("Truth of the bench").text("S = ").exact(truth.sensitivity).text(" V/(m/s^2)");
  out.and_v_per_g(truth.sensitivity, 7)
      .text(", f0 = ")
      .exact(truth.natural_frequency_hz)
      .text(" Hz, beta = ");
  out.exact(truth.damping).line();
  out.indent().text("the estimates are off by");
  for (std::size_t i = 0; i < kWlspParameters; ++i) {
    const double off = estimate_of(results.fit.result().model, i) - estimate_of(truth, i);
    out.text(i == 0 ? " " : i == 1 ? ", " : " and ");
    out.fixed(off / sqrt(results.covariance(i, i)), 2);
  }
  out.text(" u").line();
}

void write_common_part(const Wlsp& fit, ReportWriter& out) noexcept {
  if (!fit.response().has_common()) {
    out.label("Common part").text("not stated: if the uncertainties hold one, u(S) is too small");
    out.line();
    return;
  }
  out.label("Common part").fixed(kPercent * fit.response().common()[0], 4);
  out.text(" % of every amplitude (standard u), one effect for all points").line();
}

void write_correlations(const EvaluationResults& results, ReportWriter& out) noexcept {
  out.label("Correlation");
  for (std::size_t i = 0; i < kWlspParameters; ++i) {
    for (std::size_t j = i + 1; j < kWlspParameters; ++j) {
      const double scale = sqrt(results.covariance(i, i) * results.covariance(j, j));
      const double r = scale > 0.0 ? results.covariance(i, j) / scale : 0.0;
      out.text(i + j == 1 ? "" : ", ").text("r(").text(kParameterNames[i]).text(",");
      out.text(kParameterNames[j]).text(") = ").fixed(abs(r) < kLeastCorrelationShown ? 0.0 : r, 3);
    }
  }
  out.line();
}

double size_of(Complex residual) noexcept {
  const double re = abs(residual.re);
  const double im = abs(residual.im);
  return re > im ? re : im;
}

/// The point with the largest residual among those after (`before`, `index`) in the order of size,
/// equal ones in the order of frequency; the number of points if there is none.
std::size_t next_largest(const Wlsp& fit, double before, std::size_t index) noexcept {
  const std::size_t count = fit.response().size();
  std::size_t next = count;
  double largest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double size = size_of(fit.normalised_residual(i));
    const bool is_after = size < before || (size == before && i > index);
    if (is_after && size > largest) {
      largest = size;
      next = i;
    }
  }
  return next;
}

void write_large_residuals(const Wlsp& fit, ReportWriter& out) noexcept {
  const Span<const ResponsePoint> points = fit.response().points();
  std::size_t large = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    large += size_of(fit.normalised_residual(i)) > kLargeResidual ? 1u : 0u;
  }
  out.line();
  out.label("Large residuals").integer(large).text(" of ").integer(points.size());
  out.text(" points are beyond 3 (normalised, of 1/K)");
  const std::size_t shown = large < kResidualsShown ? large : kResidualsShown;
  if (shown < large) {
    out.text("; the ").integer(shown).text(" largest:");
  }
  out.line();
  if (large == 0) {
    return;
  }
  out.part(ReportPart::kTable);
  out.part(ReportPart::kHead);
  out.cell(kFrequencyWidth).text("frequency/Hz");
  out.cell(12).text("real");
  out.cell(12).text("imaginary").line();
  double before = std::numeric_limits<double>::infinity();
  std::size_t index = 0;
  for (std::size_t i = 0; i < shown; ++i) {
    index = next_largest(fit, before, index);
    const Complex residual = fit.normalised_residual(index);
    before = size_of(residual);
    out.part(ReportPart::kLine);
    out.cell(kFrequencyWidth).general(points[index].frequency_hz, 7);
    out.cell(12).fixed(residual.re, 1);
    out.cell(12).fixed(residual.im, 1).line();
  }
}

void write_fit(const EvaluationResults& results, const ReportContext& context,
               ReportWriter& out) noexcept {
  const Measurement* measurement = context.measurement;
  const WlspFit& fit = results.fit.result();
  out.heading(ReportSection::kFit, "FIT");
  out.part(ReportPart::kText);
  out.text("  S, f0 and beta by weighted least squares on 1/K, two equations for each point.\n\n");
  write_estimates(results, out);
  out.line();
  if (measurement != nullptr && measurement->simulated != nullptr) {
    write_truth(results, measurement->simulated->truth, out);
  }
  write_common_part(results.fit, out);
  out.label("chi-square").general(fit.chi2, 5).text(" with ").integer(fit.dof);
  out.text(" degrees of freedom, chi2/dof = ").general(fit.chi2 / fit.dof, 4).line();
  if (results.fit.response().shared().is_explained()) {
    out.indent()
        .text("with crosstalk, linearity and skew fitted, too, so not of the estimates above")
        .line();
  }
  out.label("Birge ratio").general(fit.birge_ratio, 4);
  out.text(" (1 where model and uncertainties hold)").line();
  write_correlations(results, out);
  write_fit_notes(results, out);
  write_fit_warning(fit, context.cause, out);
  write_doubt(context.doubt, out);
  write_large_residuals(results.fit, out);
}

// Error system

void write_no_error(ReportWriter& out) noexcept {
  out.part(ReportPart::kText)
      .text("  The sensor is the filter, so the error is 0 for every signal.\n");
}

void write_error_system(const EvaluationResults& results, ReportWriter& out) noexcept {
  const Peak& peak = results.peak;
  const SettlingTime& settling = results.settling_time;
  out.heading(ReportSection::kErrorSystem,
              results.settings.criterion == Criterion::kInBandError
                  ? "ERROR SYSTEM (impulse response k of the in-band error)"
                  : "ERROR SYSTEM (impulse response k = sensor minus filter)");
  if (results.model.is_nothing()) {
    write_no_error(out);
    return;
  }
  out.label("Peak of k").general(peak.value, 7).text(" V/(m/s) at ");
  out.fixed(kMicro * peak.time_s, 2).text(" us").line();
  write_settling_time("5 % settling time", settling, out);
  write_short_time("the settling time", settling, results, out);
}

// Maximum energy

void write_trace(const EvaluationResults& results, ReportWriter& out) noexcept {
  const Span<const double> trace = results.trace();
  const std::size_t shown = trace.size() < kTraceShown ? trace.size() : kTraceShown;
  out.label("E_0, E_1, ... (V^2 s)");
  for (std::size_t i = 0; i < shown; ++i) {
    if (i > 0 && i % 4 == 0) {
      out.line();
      out.indent();
    }
    out.right(16).scientific(trace[i], 8);
  }
  out.text(shown < trace.size() ? " ..." : "").line();
}

void write_how_found(const EvaluationResults& results, ReportWriter& out) noexcept {
  const MaximumEnergy& maximum = results.maximum;
  const Settings& settings = results.settings;
  const double cell_s = settings.duration_s / static_cast<double>(maximum.cells);
  out.label("Found on").integer(maximum.cells).text(" cells of ");
  out.general(kMicro * cell_s, 5).text(" us");
  if (settings.method == Method::kPaper) {
    out.text(maximum.at_rest ? ", at rest after " : ", not yet at rest after ");
    out.integer(maximum.iterations).text(" iterations").line();
    write_trace(results, out);
    return;
  }
  out.text(", the best of ").integer(maximum.starts).text(" starts, after ");
  out.integer(maximum.iterations).text(" iterations").line();
}

void write_bound(const EvaluationResults& results, ReportWriter& out) noexcept {
  const double energy = results.energy_v2s();
  const double bound = results.bound_v2s;
  write_upper_bound(results.has_bound, bound, out);
  if (results.has_bound && energy > 0.0) {
    out.label("Gap").general(kPercent * (bound - energy) / energy, 4);
    out.text(" % of E; the true maximum lies between the two").line();
  }
}

void write_energy(const EvaluationResults& results, ReportWriter& out) noexcept {
  const double energy = results.energy_v2s();
  out.heading(ReportSection::kEnergy, "MAXIMUM ENERGY (at the estimates)");
  const Criterion criterion = results.settings.criterion;
  out.energy("E", energy, results.uncertainty.u_v2s).line();
  out.label("xi = E/(a^2 T)").general(results.xi(), 7).text(" (V/(m/s^2))^2");
  if (out.in_g()) {
    out.text(" (").general(square(kStandardGravity_mps2) * results.xi(), 7).text(" (V/g)^2)");
  }
  out.line();
  const bool is_error = criterion != Criterion::kEnergyDifference;
  out.label(is_error ? "rms error sqrt(E/T)" : "sqrt(E/T)");
  if (energy >= 0.0) {
    const double full = results.device.estimate.sensitivity * results.limit_mps2;
    const double rms = results.rms_error_v();
    out.general(rms, 5).text(" V = ").general(kPercent * rms / full, 4).text(" % of S a").line();
  } else {
    out.text("none, the energy difference is negative").line();
  }
  if (results.model.is_nothing()) {
    write_no_error(out);
    return;
  }
  const SwitchingSignal& signal = results.maximum.signal;
  write_switching_times(signal.count(), signal.times_s(), out);
  write_how_found(results, out);
  if (results.settings.method == Method::kBest) {
    out.part(ReportPart::kText)
        .text(is_error ? "  The best signal found.\n"
                       : "  The best signal found that stays at +-a; one between the limits may "
                         "have more.\n");
  } else {
    out.part(ReportPart::kText)
        .text("  Where the paper's procedure ends; other signals may reach more (method best).\n");
  }
  write_bound(results, out);
  out.label("Largest |y|");
  if (results.has_absolute_error) {
    out.general(results.absolute_error_v, 7);
    out.text(" V, of any signal: a times the integral of |k|").line();
  } else {
    out.text("not computed: k moves too often for so long a T").line();
  }
}

// Monte Carlo

void write_interval(ReportWriter& out, const char* name, double probability,
                    const CoverageInterval& interval) noexcept {
  out.label(name).scientific(interval.low, 7).text(" to ").scientific(interval.high, 7);
  out.text(" V^2 s (").general(kPercent * probability, 6).text(" %)").line();
}

void write_adaptive(const AdaptiveResult& adaptive, ReportWriter& out) noexcept {
  out.label("Adaptive, JCGM 101 7.9");
  out.text(adaptive.stabilised ? "stable" : "NOT stable").text(" after ");
  out.integer(adaptive.blocks).text(" blocks, tolerance ").general(adaptive.tolerance, 2);
  out.text(" V^2 s").line();
  if (!adaptive.stabilised) {
    out.part(ReportPart::kWarning)
        .text(
            "  WARNING: the results were not yet stable when the greatest number of blocks was\n"
            "  reached; their last digits are uncertain.\n");
  }
}

void write_trials(const EvaluationResults& results, const MonteCarloResult& result,
                  ReportWriter& out) noexcept {
  const std::uint32_t rule = minimum_trials(result.probability);
  out.label("Trials").integer(result.trials);
  if (rule > 0) {
    out.text("; rule (3), 1e4/(1 - p), asks for ").integer(rule);
  }
  out.line();
  if (results.settings.adaptive) {
    write_adaptive(results.adaptive, out);
    return;
  }
  if (rule == 0 || result.trials < rule) {
    out.part(ReportPart::kWarning)
        .text(
            "  WARNING: fewer trials than rule (3) asks for; the intervals and the maximum are\n"
            "  less certain than their digits say.\n");
  }
}

void write_maximum(const EvaluationResults& results, const MonteCarloResult& result,
                   ReportWriter& out) noexcept {
  const Accelerometer& at = results.device_at_maximum;
  out.label("E_max").scientific(result.maximum, 8).text(" V^2 s in trial ");
  out.integer(result.trial_of_maximum).text(" (the first is 0), with").line();
  out.indent().text("S = ").general(at.sensitivity, 8).text(" V/(m/s^2)");
  out.and_v_per_g(at.sensitivity, 8)
      .text(", f0 = ")
      .general(at.natural_frequency_hz, 8)
      .text(" Hz, beta = ")
      .general(at.damping, 8)
      .line();
}

/// What the trials themselves have to say about their numbers.
void write_trial_warnings(const TrialResults& trials, ReportWriter& out) noexcept {
  if (trials.branches.is_crowded) {
    out.part(ReportPart::kWarning)
        .text("  WARNING: more signals than the trials have room for may be the worst within the\n")
        .text("  parameters' ranges. They take the best ")
        .integer(trials.branches.branches)
        .text("; more may be worse.\n");
  }
  constexpr std::uint32_t kOnePercent = 100;
  if (trials.redraws > trials.result.trials / kOnePercent) {
    out.part(ReportPart::kWarning)
        .text("  WARNING: ")
        .integer(trials.redraws)
        .text(" draws of the parameters were no device and were made again. E is not\n")
        .text("  normal there; check the uncertainties.\n");
  }
}

void write_monte_carlo(const EvaluationResults& results, ReportWriter& out) noexcept {
  if (results.is_damping_open()) {
    write_cut_range(results, out);
    return;
  }
  const bool is_box = results.settings.distribution == Distribution::kBox;
  out.heading(ReportSection::kMonteCarlo,
              is_box ? "MONTE CARLO OF THE PAPER (S, f0 and beta uniform within estimate +- u, "
                       "equation (21))"
                     : "MONTE CARLO OF THE PAPER (but S, f0 and beta jointly normal)");
  if (!results.has_monte_carlo) {
    out.part(ReportPart::kText).text("  Not run: all uncertainties are zero.\n");
    return;
  }
  const MonteCarloResult& result = results.trials.result;
  write_trials(results, result, out);
  if (results.trial_scale() > 1.0) {
    out.label("Uncertainties").text("times the Birge ratio, ");
    out.general(results.trial_scale(), 4).line();
  }
  write_maximum(results, result, out);
  out.label("Mean of E").scientific(result.mean, 8).text(" V^2 s").line();
  out.label(is_box ? "Std deviation over box" : "Standard deviation");
  out.scientific(result.u, 2).text(" V^2 s").line();
  write_interval(out, is_box ? "Interval over the box" : "Symmetric interval", result.probability,
                 result.symmetric);
  write_interval(out, is_box ? "Shortest over the box" : "Shortest interval", result.probability,
                 result.shortest);
  write_rough_trials(results.trials.branches.rough_trials, results.trials.branches.rough_part, out);
  write_guard(results.guard, out);
  write_trial_warnings(results.trials, out);
}

// Trend

void write_left_out(const EvaluationResults& results, ReportWriter& out) noexcept {
  if (results.trend_left_out == 0) {
    return;
  }
  out.part(ReportPart::kNote).text("  Note: left out, as they need more than ");
  out.integer(kMaxSwitches).text(" switches or ").integer(kMostDefaultCells).text(" cells: T =");
  bool is_first = true;
  for (std::size_t i = 0; i < results.settings.trend_count; ++i) {
    if ((results.trend_left_out >> i & 1U) != 0) {
      out.text(is_first ? " " : ", ").general(kMilli * results.settings.trend_s[i], 8);
      is_first = false;
    }
  }
  out.text(" ms.\n");
}

void write_trend(const EvaluationResults& results, ReportWriter& out) noexcept {
  const Span<const TrendPoint> points = results.trend_points();
  out.heading(ReportSection::kTrend, "TREND (maximum energy at the estimates against T)");
  if (points.empty()) {
    out.part(ReportPart::kText);
    out.text(results.trend_left_out == 0 ? "  Not asked for.\n" : "  No line: too few lengths.\n");
    write_left_out(results, out);
    return;
  }
  const Trend& trend = results.trend;
  out.part(ReportPart::kTable);
  out.part(ReportPart::kHead);
  out.cell(12).text("T/ms");
  out.cell(20).text("E/(V^2 s)");
  out.cell(20).text("line/(V^2 s)").line();
  for (const TrendPoint& point : points) {
    out.part(ReportPart::kLine);
    out.cell(12).general(kMilli * point.duration_s, 8);
    out.cell(20).scientific(point.energy_v2s, 8);
    out.cell(20).scientific(trend.slope * point.duration_s + trend.intercept, 8).line();
  }
  out.label("Line").text("E = ").general(trend.slope, 7).text(" V^2 * T ");
  out.text(trend.intercept < 0.0 ? "- " : "+ ").general(abs(trend.intercept), 7).text(" V^2 s");
  out.line();
  out.label("Correlation").fixed(trend.correlation, 7).line();
  write_left_out(results, out);
  if (abs(trend.correlation) < kLeastTrendCorrelation) {
    out.part(ReportPart::kNote)
        .text("  Note: E is not linear in T here; the line says nothing about other lengths.\n");
  }
}

/// Rounded down to what a user types.
void write_time(const char* words, double longest_s, TextWriter& out) noexcept {
  constexpr int kDigits = 4;
  const int decimals = decimals_of(longest_s, kDigits);
  out.text(words).general(rounded_down(longest_s, decimals), 10).text(" s");
}

}  // namespace

void write_fit_warning(const WlspFit& fit, const char* cause, ReportWriter& out) noexcept {
  const double reduced = fit.chi2 / fit.dof;
  const double limit = reduced_chi_square_limit(fit.dof);
  if (reduced > limit) {
    out.line();
    out.part(ReportPart::kWarning)
        .text("  WARNING: chi2/dof = ")
        .general(reduced, 4)
        .text(" is above ");
    out.fixed(limit, 2).text(", which one fit in a hundred exceeds where the model\n");
    out.text(
        "  and the stated uncertainties hold. So the device is not a second-order system over\n"
        "  these frequencies, or the stated uncertainties are too small. Those of parameters and\n"
        "  energy are then too small by about the Birge ratio of ");
    out.general(fit.birge_ratio, 3);
    out.text(
        ", and\n"
        "  the estimates themselves are not sure: other weights would move them by as much.\n"
        "  Check: the points named below (multiples of 50 or 60 Hz: hum), resonances of mounting "
        "and\n"
        "  cable, crosstalk, a delay between the channels (a phase that grows with frequency), an "
        "AC\n"
        "  coupling (the lowest frequencies), and that the table's uncertainties are expanded "
        "ones\n"
        "  (k = 2).\n");
    if (cause != nullptr) {
      write_cause("", cause, out);
    }
    return;
  }
  if (cause != nullptr) {
    out.line();
    write_cause("Note: ", cause, out);
  }
  const double low = reduced_chi_square_quantile(fit.dof, -kQuantile99);
  if (reduced < low) {
    out.line();
    out.part(ReportPart::kNote).text("  Note: chi2/dof is below ").general(low, 3);
    out.text(
        ", which one fit in a hundred undercuts: the points scatter\n"
        "  less than the stated uncertainties say. These may be too large.\n");
  }
}

void write_points_source(const EvaluationResults& results, const ReportContext& context,
                         ReportWriter& out) noexcept {
  out.label("Device");
  write_points(results, context, out);
}

double reduced_chi_square_limit(std::size_t dof) noexcept {
  return reduced_chi_square_quantile(dof, kQuantile99);
}

void write_report(const EvaluationResults& results, const ReportContext& context, TextWriter& out,
                  ReportMarkup* markup) noexcept {
  ReportWriter writer(out, context, markup);
  write_title(context, writer);
  write_figures(results, context, writer);
  write_input(results, context, writer);
  if (context.measurement != nullptr) {
    write_measurement_section(*context.measurement, &results.fit, writer);
  }
  if (results.source == Source::kPoints) {
    write_fit(results, context, writer);
  }
  write_error_system(results, writer);
  write_energy(results, writer);
  // The text is that of a board, which does not search for that time.
  write_in_band(results, writer.is_plain() ? 0.0 : context.leading_settling_s, writer);
  write_uncertainty(results, writer);
  write_monte_carlo(results, writer);
  write_trend(results, writer);
}

void write_failure(const EvaluationResults& results, TextWriter& out) noexcept {
  const Failure& failure = results.failure;
  if (failure.reason == nullptr) {
    return;
  }
  out.text(failure.reason);
  if (failure.duration_s > 0.0) {
    out.text(" (T = ").general(failure.duration_s, 10).text(" s");
    if (failure.status == Status::kTooManyCells) {
      write_time(", at most ", longest_time_s(results), out);
    } else if (failure.status == Status::kTooManySwitches) {
      write_time("; there is room for ", storable_time_s(results), out);
    }
    out.text(")");
  }
  if (failure.stage != Stage::kFitDraws) {
    return;
  }
  const WlspFit& fit = results.fit.result();
  if (failure.status == Status::kInvertedPolarity) {
    out.text(" (The fit gives S = ").general(fit.model.sensitivity, 5).text(" V/(m/s^2).)");
  } else if (failure.status == Status::kOverdamped) {
    out.text(" (The fit gives beta = ").general(fit.model.damping, 5).text(".)");
  } else if (failure.status == Status::kNotPhysical) {
    out.text(" (The fit gives mu1 = ").general(fit.mu[0], 5).text(", mu2 = ");
    out.general(fit.mu[1], 5).text(", mu3 = ").general(fit.mu[2], 5);
    out.text("; all must be above 0.)");
  }
}

}  // namespace emax::app
