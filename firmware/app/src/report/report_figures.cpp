// Figures in percent of S a, with as many digits as their uncertainty carries.
#include "report_figures.hpp"

#include "emax/app/evaluate/figure_range.hpp"
#include "emax/app/report/report_warnings.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;
constexpr double kPercent = 100.0;
constexpr std::size_t kTimesPerLine = 6;
constexpr std::size_t kTimesShown = 60;  // All of them are in results.json.
constexpr std::size_t kNameWidth = 40;
constexpr std::size_t kNumberWidth = 14;
constexpr std::size_t kExpandedWidth = 18;  // Of U, or of an interval in its place.
constexpr std::size_t kWidthOfRest = 6;     // " to 0."
constexpr int kMostPlain = 9;
constexpr double kHalf = 0.5;
constexpr int kMostDecimals = 12;

double power_of_ten(int exponent) noexcept {
  double power = 1.0;
  for (int i = 0; i < exponent; ++i) {
    power *= 10.0;
  }
  return power;
}

struct Row {
  const char* name;
  bool is_marked;
  double percent;
  bool has_u;  ///< Or an interval, or a range.
  bool has_expanded;
  double expanded;  ///< U in percent.
  bool has_bound;
  double bound_percent;
  bool is_one_sided;          ///< The interval stands in the place of U.
  CoverageInterval interval;  ///< In percent.
};

const char* name_of_figure(bool is_band, const EvaluationResults& results) noexcept {
  if (is_band) {
    return "In band, with its delay";
  }
  return results.settings.delay_choice == DelayChoice::kGiven ? "In band, given delay taken out"
                                                              : "In band, constant delay taken out";
}

/// What U justifies, but two digits of the number at least.
int decimals_beside(double percent, double expanded) noexcept {
  constexpr int kDigits = 2;
  const int of_u = decimals_of(expanded, kDigits);
  const int least = decimals_of(percent, kDigits);
  return least > of_u && percent > 0.0 ? least : of_u;
}

/// As many decimals as leave the number no larger than its bound, if so many are needed.
int decimals_below(double percent, int decimals, double bound_percent) noexcept {
  constexpr int kDigits = 4;
  const int most = decimals_of(bound_percent, kDigits);
  while (decimals < most &&
         rounded_down(percent + kHalf / power_of_ten(decimals), decimals) > bound_percent) {
    ++decimals;
  }
  return decimals;
}

/// In so many decimals; a number so small that the column has no room for them has an exponent.
void write_cell(double percent, int decimals, int digits, ReportWriter& out,
                std::size_t width = kNumberWidth) noexcept {
  out.cell(width);
  if (percent == 0.0) {
    out.integer(0);
  } else if (decimals > kMostPlain) {
    out.scientific(percent, digits - 1);
  } else {
    out.fixed(percent, decimals);
  }
}

/// U, or the interval in its place.
void write_expanded(const Row& row, int decimals, ReportWriter& out) noexcept {
  constexpr int kDigitsOfU = 2;
  if (!row.has_u) {
    out.cell(kExpandedWidth).text("-");
  } else if (!row.is_one_sided) {
    write_cell(row.expanded, decimals, kDigitsOfU, out, kExpandedWidth);
  } else {
    // Outwards, both in the decimals of the far end; a range in one digit more where there is room.
    constexpr int kMostOfRange = 4;
    const int finer = decimals_of(row.interval.high, kDigitsOfU + 1);
    const int of_end = kHasFigureRanges && !row.has_expanded && finer <= kMostOfRange
                           ? finer
                           : decimals_of(row.interval.high, kDigitsOfU);
    const double low = rounded_down(row.interval.low, of_end);
    const double high = rounded_up(row.interval.high, of_end);
    const std::size_t beside = kWidthOfRest + static_cast<std::size_t>(of_end);
    out.cell(beside < kExpandedWidth ? kExpandedWidth - beside : 0);
    low > 0.0 ? out.fixed(low, of_end) : out.integer(0);
    out.text(" to ").fixed(high, of_end);
  }
}

void write_row(const Row& row, ReportWriter& out) noexcept {
  constexpr int kDigitsAlone = 4;
  constexpr double kHalfOfLastDigit = 5e-4;
  const bool has_digits = row.has_u && row.expanded > 0.0 && !row.is_one_sided;
  const int alone = decimals_of(row.percent, kDigitsAlone);
  const int known = has_digits ? decimals_beside(row.percent, row.expanded) : alone;
  const int decimals =
      row.has_bound ? decimals_below(row.percent, known, row.bound_percent) : known;
  out.part(ReportPart::kLine);
  out.cell(0).text("  ").left(kNameWidth - 2).text(row.name).text(row.is_marked ? " *" : "  ");
  write_cell(row.percent, decimals, kDigitsAlone, out);
  write_expanded(row, decimals, out);
  if (row.has_bound) {
    const int of_bound = decimals_of(row.bound_percent, kDigitsAlone);
    const bool is_tiny = of_bound == kMostDecimals;
    write_cell(is_tiny ? row.bound_percent * (1.0 + kHalfOfLastDigit)
                       : rounded_up(row.bound_percent, of_bound),
               of_bound, kDigitsAlone, out);
  } else {
    out.cell(kNumberWidth).text("-");
  }
  out.line();
}

Row row_of(const char* name, bool is_marked, const EvaluationResults& results,
           const FigureResults& figure) noexcept {
  const bool has_u = figure.uncertainty.exists();
  const double percent = results.percent_of(figure.energy_v2s);
  const CoverageInterval interval =
      has_u
          ? results.interval_percent_of(figure.uncertainty.shortest_of_percent(), figure.energy_v2s)
      : kHasFigureRanges ? CoverageInterval{results.percent_of(figure.least_v2s),
                                            results.percent_of(figure.greatest_v2s)}
                         : CoverageInterval{};
  return {name,
          is_marked,
          percent,
          has_u || (kHasFigureRanges && figure.has_range),
          has_u,
          figure.uncertainty.expanded_percent(),
          figure.has_bound,
          results.percent_of(figure.bound_v2s),
          (kHasFigureRanges && figure.has_range) || results.is_one_sided(figure),
          interval};
}

/// @returns Whether one has an interval in the place of U.
bool write_papers_rows(const EvaluationResults& results, std::uint32_t marked,
                       ReportWriter& out) noexcept {
  const double energy = results.energy_v2s();
  const Criterion criterion = results.settings.criterion;
  bool is_any_one_sided = false;
  if (energy < 0.0) {
    return false;
  }
  if (criterion != Criterion::kInBandError) {
    const EnergyUncertainty& known = results.uncertainty;
    const bool has_u = known.exists();
    const bool has_range = kHasFigureRanges && results.has_cut_range && results.cut_low_v2s > 0.0;
    const bool is_error = criterion == Criterion::kIntegralSquareError;
    const double percent = results.percent_of(energy);
    const double expanded = known.expanded_percent();
    const CoverageInterval interval =
        has_u ? results.interval_percent_of(known.shortest_of_percent(), energy)
        : has_range
            ? results.interval_percent_of({results.cut_low_v2s, results.cut_high_v2s}, energy)
            : CoverageInterval{};
    is_any_one_sided = has_range || results.is_one_sided(known, energy);
    write_row(
        {is_error ? "The paper's figure, sqrt(E/T)" : "The energy difference, sqrt(E/T)",
         (marked & kRowEnergy) != 0, percent, has_u || has_range, has_u, expanded,
         results.has_bound, results.percent_of(results.bound_v2s), is_any_one_sided, interval},
        out);
  }
  if (results.ideal.exists() &&
      (results.ideal.energy_v2s > 0.0 || criterion != Criterion::kInBandError)) {
    write_row({criterion == Criterion::kInBandError ? "The first of an ideal sensor, K = S"
                                                    : "The same of an ideal sensor, K = S",
               false,
               results.percent_of(results.ideal.energy_v2s),
               false,
               false,
               0.0,
               false,
               0.0,
               false,
               {}},
              out);
  }
  return is_any_one_sided;
}

void write_refusal(const char* name, const EvaluationResults& results, const FigureResults& figure,
                   ReportWriter& out) noexcept {
  out.part(ReportPart::kNote).text("  Note: no error ").text(name).text(":\n  ");
  out.text(figure.refusal());
  if (figure.is_short) {
    out.text("\n  The settling time is ")
        .general(kMilli * results.band_settling.time_s, 4)
        .text(" ms.");
  }
  out.line();
}

void write_interval(const char* name, const CoverageInterval& interval, double probability,
                    ReportWriter& out) noexcept {
  constexpr int kDigits = 7;
  out.label(name).scientific(interval.low, kDigits).text(" to ");
  out.scientific(interval.high, kDigits).text(" V^2 s (");
  out.general(kPercent * probability, 6).text(" %)").line();
}

/// How many trials there were where they are fewer than asked for, and what that leaves open: the
/// part of the energies that is within the ends has the standard deviation of a binomial share.
void write_fewer_trials(const EvaluationResults& results, const EnergyUncertainty& known,
                        ReportWriter& out) noexcept {
  if (!results.has_fewer_trials(known)) {
    return;
  }
  const double p = results.settings.probability;
  const double u = sqrt(p * (1.0 - p) / static_cast<double>(known.trials));
  out.label("Trials").integer(known.trials).text(", as many take a refinement; ");
  out.general(kPercent * p, 6).text(" % is within ");
  out.general(kPercent * kCoverageFactor * u, 2).text(" % (k = 2)").line();
}

/// u, U and both intervals; or without U the interval that stands in its place, as in the figures.
void write_known(const EvaluationResults& results, const EnergyUncertainty& known,
                 double energy_v2s, ReportWriter& out) noexcept {
  const double probability = results.settings.probability;
  const bool has_expanded = !(energy_v2s >= 0.0 && results.is_one_sided(known, energy_v2s));
  out.label(has_expanded ? "u(E); U (k = 2)" : "u(E)").scientific(known.u_v2s, 1);
  if (has_expanded) {
    out.text("; ").scientific(kCoverageFactor * known.u_v2s, 1);
  }
  out.text(" V^2 s").line();
  if (has_expanded) {
    write_interval("Symmetric interval", known.symmetric, probability, out);
  }
  write_interval(has_expanded ? "Shortest interval" : "Interval, in place of U",
                 has_expanded ? known.shortest : widened(known.shortest, energy_v2s), probability,
                 out);
  write_fewer_trials(results, known, out);
  write_guard(known.guard, out);
  write_rough_trials(known.rough_trials, known.rough_part, out);
}

/// Over the dampings that the points leave open.
void write_range(const EvaluationResults& results, const FigureResults& figure,
                 ReportWriter& out) noexcept {
  out.label("Range, as beta is open");
  if (!figure.has_range) {
    out.text("none: within it a search needs more room, or the delay is too long").line();
    return;
  }
  constexpr int kDigits = 4;
  out.general(results.percent_of(figure.least_v2s), kDigits).text(" to ");
  out.general(results.percent_of(figure.greatest_v2s), kDigits).text(" % of S a");
  const bool is_of_sensor = results.settings.delay_choice != DelayChoice::kGiven;
  out.text(&figure == &results.matched && is_of_sensor ? ", each with its own delay" : "").line();
}

void write_figure(const EvaluationResults& results, const FigureResults& figure,
                  ReportWriter& out) noexcept {
  const double duration_s = results.settings.duration_s;
  out.energy("E", figure.energy_v2s, figure.uncertainty.u_v2s).line();
  out.label("rms error sqrt(E/T)").general(sqrt(figure.energy_v2s / duration_s), 5);
  out.text(" V = ").general(results.percent_of(figure.energy_v2s), 4).text(" % of S a").line();
  write_switching_times(figure.switches, figure.times_s(), out);
  write_upper_bound(figure.has_bound, figure.bound_v2s, out);
  const EnergyUncertainty& known = figure.uncertainty;
  if (known.exists()) {
    write_known(results, known, figure.energy_v2s, out);
  }
  if (kHasFigureRanges && figure.is_range_done) {
    write_range(results, figure, out);
  }
}

}  // namespace

int decimals_of(double value, int digits) noexcept {
  const double least = power_of_ten(digits - 1);
  int decimals = 0;
  for (double scaled = value; scaled < 0.995 * least && decimals < kMostDecimals; scaled *= 10.0) {
    ++decimals;
  }
  return decimals;
}

double rounded_down(double value, int decimals) noexcept {
  const double scale = power_of_ten(decimals);
  return floor(value * scale) / scale;
}

double rounded_up(double value, int decimals) noexcept {
  return 0.0 - rounded_down(-value, decimals);  // Never -0.
}

void write_guard(const GuardResults& guard, ReportWriter& out) noexcept {
  if (guard.searches == 0) {
    return;
  }
  out.label("Guard").integer(guard.searches).text(" full searches, ");
  out.integer(guard.disagreements);
  out.text(guard.disagreements == 1 ? " disagreement" : " disagreements").line();
  if (guard.disagreements > 0) {
    out.part(ReportPart::kWarning).text("  WARNING: ");
    if (guard.largest_excess > 0.0F) {
      out.text("in these trials a search found up to ");
      out.general(kPercent * static_cast<double>(guard.largest_excess), 3)
          .text(
              " % more energy with another signal:\n"
              "  maximum and intervals are too low by up to that.\n");
    } else {
      out.text("in these trials the search has failed: another signal may have more energy.\n");
    }
  }
}

void write_upper_bound(bool exists, double bound_v2s, ReportWriter& out) noexcept {
  out.label("Upper bound");
  if (exists) {
    out.scientific(bound_v2s, 8);
    out.text(" V^2 s: proven at the estimates for any signal within +-a").line();
  } else {
    out.text("none passed its check for this device and time").line();
  }
}

void write_switching_times(std::size_t switches, Span<const double> times_s,
                           ReportWriter& out) noexcept {
  out.label("Signal").text("+a from the start, ").integer(switches);
  out.text(switches == 1 ? " switch" : " switches");
  if (times_s.size() > kTimesShown) {
    times_s = times_s.first(kTimesShown);
  }
  if (times_s.size() < switches) {
    out.text(", the first ").integer(times_s.size());
  }
  out.text(times_s.empty() ? "" : ", at (ms)");
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (i % kTimesPerLine == 0) {
      out.line();
      out.indent();
    }
    out.right(11).fixed(kMilli * times_s[i], 6);
  }
  out.line();
}

/// The one that was asked for leads. @returns Whether one has an interval in the place of U.
bool write_band_rows(const EvaluationResults& results, std::uint32_t marked,
                     ReportWriter& out) noexcept {
  const bool is_band_first = results.settings.delay_choice == DelayChoice::kNone;
  bool any = false;
  for (const bool is_band : {is_band_first, !is_band_first}) {
    const FigureResults& figure = is_band ? results.band : results.matched;
    if (figure.exists()) {
      const Row row = row_of(name_of_figure(is_band, results),
                             (marked & (is_band ? kRowBand : kRowMatched)) != 0, results, figure);
      write_row(row, out);
      any = any || row.is_one_sided;
    }
  }
  return any;
}

void write_figures(const EvaluationResults& results, const ReportContext& context,
                   ReportWriter& out) noexcept {
  const std::uint32_t marks = context.mark != nullptr ? context.marked : 0U;
  const bool is_given = results.settings.delay_choice == DelayChoice::kGiven;
  out.heading(ReportSection::kFigures,
              "THE FIGURES (at the estimates; worst rms error of signals within +-a, in % of S a)");
  out.part(ReportPart::kTable);
  out.part(ReportPart::kHead);
  out.cell(0).text("  ").left(kNameWidth).text("error");
  out.cell(kNumberWidth).text("found");
  out.cell(kExpandedWidth).text("U (k = 2)");
  out.cell(kNumberWidth).text("none exceeds").line();
  const bool is_band_one_sided = write_band_rows(results, marks, out);
  const bool is_one_sided = write_papers_rows(results, marks, out) || is_band_one_sided;
  if (!results.band.exists()) {
    write_refusal("in band", results, results.band, out);
  } else if (!results.matched.exists()) {
    write_refusal("in band with the delay taken out", results, results.matched, out);
  }
  out.part(ReportPart::kText)
      .text(
          "  In band: what the sensor does wrong within the filter's band; 0 for an ideal sensor\n"
          "  with S = G, the filter's gain")
      .text(is_given ? ", but not with a delay given" : "")
      .text(".\n  None exceeds: proven at the estimates.\n");
  if (kHasFigureRanges && is_one_sided && results.is_damping_open()) {
    out.text("  x to y: over the dampings that the points leave open, with f0 +- 2u.\n");
  } else if (is_one_sided) {
    out.text("  x to y: where the figure is with ");
    out.general(kPercent * results.settings.probability, 6);
    out.text(" %, as +-U says too little.\n");
  }
  if (results.settings.criterion == Criterion::kIntegralSquareError) {
    out.text(
        "  The paper's figure also holds the filter's delay and what the filter keeps out: "
        "compare\n"
        "  it with that of an ideal sensor.\n");
    if (results.settings.gain_mode == GainMode::kAuto && results.uncertainty.exists()) {
      out.text("  U in band leaves out an error of S, as G follows S; the paper's U holds it.\n");
    }
  } else if (results.settings.criterion == Criterion::kEnergyDifference) {
    out.text(
        "  The energy difference is no error, but the sensor's energy less that of the filter.\n");
  }
  if (context.other_criterion != nullptr) {
    out.part(ReportPart::kWarning).text("  WARNING: ").text(context.other_criterion).line();
  }
  if (context.mark != nullptr) {
    out.part(ReportPart::kText).text("  * ").text(context.mark).line();
  }
}

void write_settling_time(const char* label, const SettlingTime& settling,
                         ReportWriter& out) noexcept {
  out.label(label);
  if (!settling.found) {
    out.text("beyond ").general(kMilli * settling.time_s, 7).text(" ms").line();
  } else {
    out.fixed(kMilli * settling.time_s, 6).text(" ms").line();
  }
}

void write_short_time(const char* name, const SettlingTime& settling,
                      const EvaluationResults& results, ReportWriter& out) noexcept {
  const double duration_s = results.settings.duration_s;
  if (!(duration_s < settling.time_s)) {
    return;
  }
  const bool is_much = duration_s < kMuchShorter * settling.time_s;
  out.part(is_much ? ReportPart::kWarning : ReportPart::kNote)
      .text(is_much ? "  WARNING: T is much shorter than " : "  Note: T is shorter than ")
      .text(name)
      .text(", so the error has not developed within\n  T");
  constexpr int kDigits = 3;
  if (is_reachable(settling.time_s, results)) {
    const double least_ms = kMilli * settling.time_s;
    const int decimals = decimals_of(least_ms, kDigits);
    out.text(": give a T of ").fixed(rounded_up(least_ms, decimals), decimals);
    out.text(" ms or more.\n");
    return;
  }
  const double cells_ms = kMilli * longest_time_s(results);
  const double storable_ms = kMilli * storable_time_s(results);
  const double most_ms = cells_ms < storable_ms ? cells_ms : storable_ms;
  const int decimals = decimals_of(most_ms, kDigits);
  out.text(", and no T that can be searched is as long: there is room for ");
  out.fixed(rounded_down(most_ms, decimals), decimals).text(" ms.\n");
}

namespace {

void write_what_is_known(const EvaluationResults& results, ReportWriter& out) noexcept {
  const bool is_fixed = results.settings.gain_mode == GainMode::kFixed;
  out.part(ReportPart::kText);
  out.text(is_fixed
               ? "  Uncertainties by JCGM 101, jointly normal S, f0 and beta, at the gain given.\n"
               : "  Uncertainties by JCGM 101, f0 and beta jointly normal. The gain follows S, so "
                 "an error\n  of S is one of gain, and left out: u(S)/S = ");
  if (!is_fixed) {
    const Device& device = results.device;
    out.general(kPercent * device.u.sensitivity / device.estimate.sensitivity, 3).text(" %.\n");
  }
}

void write_delay_taken_out(const EvaluationResults& results, ReportWriter& out) noexcept {
  const FigureResults& matched = results.matched;
  out.label("Delay taken out").general(kMicro * matched.delay_s, 5).text(" us");
  const bool is_given = results.settings.delay_choice == DelayChoice::kGiven;
  out.text(is_given ? ", as given" : ", beta/(pi f0), the sensor's at low frequency").line();
  if (results.is_one_sided(matched)) {
    out.indent().text("the same in all trials: what their own differs by counts as error").line();
  }
  constexpr double kSeen = 5e-6;  // Less would change none of the five digits of the rms.
  if (matched.epsilon_percent >= kSeen * results.percent_of(matched.energy_v2s)) {
    out.label("Approximation").text("of the delay: the true rms may differ by ");
    out.general(matched.epsilon_percent, 2).text(" % of S a").line();
  }
}

void write_band_settling(const SettlingTime& settling, const EvaluationResults& results,
                         ReportWriter& out) noexcept {
  if (results.settings.criterion != Criterion::kInBandError &&
      results.settings.duration_s < settling.time_s) {
    write_settling_time("5 % settling, in band", settling, out);
    write_short_time("the settling time in band", settling, results, out);
  }
}

}  // namespace

/// By their names and in the order of the figures.
void write_in_band(const EvaluationResults& results, double leading_settling_s,
                   ReportWriter& out) noexcept {
  if (!results.band.exists()) {
    return;
  }
  out.heading(ReportSection::kInBand,
              "IN-BAND ERROR (at the estimates; energy of sensor minus G x, behind the filter)");
  const bool is_band_first = results.settings.delay_choice == DelayChoice::kNone;
  bool is_next = false;
  for (const bool is_band : {is_band_first, !is_band_first}) {
    const FigureResults& figure = is_band ? results.band : results.matched;
    if (!figure.exists()) {
      continue;
    }
    if (is_next) {
      out.line();
    }
    is_next = true;
    out.part(ReportPart::kText).text("  ").text(name_of_figure(is_band, results)).line();
    if (!is_band) {
      write_delay_taken_out(results, out);
    }
    write_figure(results, figure, out);
    if (is_band) {
      write_band_settling(results.band_settling, results, out);
    } else if (!is_band_first) {
      write_band_settling({leading_settling_s, leading_settling_s > 0.0}, results, out);
    }
  }
  if (results.band.uncertainty.exists()) {
    out.line();
    write_what_is_known(results, out);
  }
}

void write_uncertainty(const EvaluationResults& results, ReportWriter& out) noexcept {
  const EnergyUncertainty& known = results.uncertainty;
  out.heading(ReportSection::kUncertainty,
              results.source == Source::kPoints
                  ? "UNCERTAINTY OF E (JCGM 101: S, f0 and beta jointly normal, as fitted)"
                  : "UNCERTAINTY OF E (JCGM 101: S, f0 and beta normal, with the u given)");
  if (results.is_damping_open()) {
    out.part(ReportPart::kText).text("  None: the points leave beta open; see the range of E.\n");
    return;
  }
  if (!results.has_uncertainty()) {
    out.part(ReportPart::kText).text("  None: all uncertainties are zero.\n");
    return;
  }
  if (!known.exists()) {
    out.part(ReportPart::kWarning)
        .text("  WARNING: draws of the parameters leave what a device may be 65 times in a row;\n")
        .text("  E has no uncertainty. Check those of the parameters and their units.\n");
    return;
  }
  if (results.settings.criterion == Criterion::kInBandError &&
      results.settings.gain_mode != GainMode::kFixed) {
    out.part(ReportPart::kText)
        .text("  As above the gain follows S: an error of S is one of gain, and left out.\n");
  }
  out.energy("Mean of E", known.mean_v2s, known.u_v2s).text(" over ");
  out.integer(known.trials).text(" trials").line();
  write_known(results, known, results.energy_v2s(), out);
  constexpr std::uint32_t kOnePercent = 100;
  if (known.redraws > 0) {
    out.label("Drawn again").integer(known.redraws).text(" draws that were no device").line();
  }
  if (known.redraws > known.trials / kOnePercent) {
    out.part(ReportPart::kWarning)
        .text(
            "  WARNING: that is more than 1 %, so S, f0 and beta are not normal. Check their "
            "uncertainties.\n");
  }
}

void write_rough_trials(std::uint32_t trials, float part, ReportWriter& out) noexcept {
  if (trials == 0) {
    return;
  }
  out.label("Interpolated").integer(trials).text(" trials, off by up to ");
  out.general(kPercent * static_cast<double>(part), 2).text(" % of u(E)").line();
  if (part > kMostRough) {
    out.part(ReportPart::kWarning)
        .text("  WARNING: u(E) may be off in its second digit. Use its first.\n");
  }
}

}  // namespace emax::app
