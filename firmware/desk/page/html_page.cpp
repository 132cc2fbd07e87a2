// The report as a page.
#include "desk/page/html_page.hpp"

#include <algorithm>
#include <cmath>

#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_warnings.hpp"
#include "emax/base/units.hpp"

#include "desk/cli/console.hpp"
#include "desk/compare/figure_text.hpp"
#include "desk/files/rounding.hpp"
#include "desk/page/certificate_part.hpp"
#include "desk/page/html_markup.hpp"
#include "desk/page/page_frame.hpp"
#include "desk/page/page_picture.hpp"
#include "desk/report/figure_settling.hpp"
#include "desk/report/warning_words.hpp"

namespace emax::desk {

namespace {

using app::EvaluationResults;
using app::kCoverageFactor;
using app::TextWriter;

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;
constexpr double kPercent = 100.0;

const char* name_of(Criterion criterion) {
  switch (criterion) {
    case Criterion::kIntegralSquareError:
      return "Largest energy of the error";
    case Criterion::kEnergyDifference:
      return "Largest energy difference";
    case Criterion::kInBandError:
      break;
  }
  return "Largest energy of the in-band error";
}

const char* name_in_line(Criterion criterion) {
  switch (criterion) {
    case Criterion::kIntegralSquareError:
      return "integral-square error";
    case Criterion::kEnergyDifference:
      return "energy difference";
    case Criterion::kInBandError:
      break;
  }
  return "in-band error";
}

// Pictures

class Pictures final : public SectionEnd {
 public:
  explicit Pictures(const std::vector<PagePicture>& pictures) : pictures_(pictures) {}

  void add_to(std::string& html, app::ReportSection section) override {
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      const Picture& picture = pictures_[i].picture;
      if (picture.section == section) {
        append_picture(html, pictures_[i].svg, {picture.title, picture.caption}, i + 1);
      }
    }
  }

 private:
  const std::vector<PagePicture>& pictures_;
};

// Headline

// Energies that stand together have one power of ten and as many decimals as their uncertainty
// calls for.
class EnergyFormat {
 public:
  static constexpr int kDecimalsAlone = 4;

  /// @param[in] expanded The expanded uncertainty, which gets two digits; 0 for none.
  EnergyFormat(double energy, double expanded)
      : exponent_(energy != 0.0 ? exponent_of(energy) : 0), decimals_(kDecimalsAlone) {
    constexpr int kMostDecimals = 12;
    if (expanded > 0.0) {
      decimals_ = std::clamp(exponent_ - exponent_of(expanded) + 1, 1, kMostDecimals);
    }
  }

  std::string number(double energy) const {
    return words_of(
        [&](TextWriter& out) { out.fixed(energy * std::pow(10.0, -exponent_), decimals_); });
  }

  std::string unit() const {
    const std::string power = (exponent_ < 0 ? "−" : "") + std::to_string(std::abs(exponent_));
    return (exponent_ == 0 ? "" : " ×&nbsp;10<sup>" + power + "</sup>") + "&nbsp;V²&nbsp;s";
  }

 private:
  static int exponent_of(double energy) {
    return static_cast<int>(std::floor(std::log10(std::abs(energy))));
  }

  int exponent_;
  int decimals_;
};

// A percentage with its expanded uncertainty; four digits without one.
std::string percentage(double percent, double expanded) {
  constexpr int kMostPlain = 9;  // Decimals: as in the report.
  const bool has_u = expanded > 0.0 && std::isfinite(expanded);
  return words_of([&](TextWriter& out) {
    if (!has_u) {
      out.general(percent, 4).text(" %");
      return;
    }
    constexpr int kMostDecimals = 12;
    // Two digits of U, and of the number at least.
    const double least = std::min(expanded, percent > 0.0 ? percent : expanded);
    const int decimals =
        std::clamp(1 - static_cast<int>(std::floor(std::log10(least))), 0, kMostDecimals);
    if (decimals > kMostPlain) {
      out.general(percent, 4).text(" % +- ").general(expanded, 2).text(" %");
    } else {
      out.fixed(percent, decimals).text(" % +- ").fixed(expanded, decimals).text(" %");
    }
  });
}

std::string range_of(const EvaluationResults& results) {
  if (!results.has_cut_range) {
    return "not found";
  }
  const EnergyFormat format(results.cut_high_v2s, 0.0);
  return "(" + format.number(results.cut_low_v2s) + " to " + format.number(results.cut_high_v2s) +
         ")" + format.unit();
}

// Over the dampings that the points leave open.
std::string range_of(const EvaluationResults& results, const CoverageInterval& energies_v2s) {
  const CoverageInterval range = results.interval_percent_of(energies_v2s, energies_v2s.low);
  return "; " + range_text(range.low, range.high) + " % as beta is open";
}

// With U, or with the interval where the figure is at one end of it.
std::string value_of(const EvaluationResults& results, const app::EnergyUncertainty& known,
                     double energy) {
  const double percent = results.percent_of(energy);
  if (!results.is_one_sided(known, energy)) {
    return percentage(percent, known.expanded_percent()) + " of&nbsp;S&nbsp;a";
  }
  const CoverageInterval interval =
      results.interval_percent_of(known.shortest_of_percent(), energy);
  return percentage(percent, 0.0) + " of&nbsp;S&nbsp;a; " + words_of([&](TextWriter& out) {
           out.general(kPercent * results.settings.probability, 6).text(" % interval ");
           out.text(range_text(interval.low, interval.high).c_str()).text(" %");
         });
}

void append_in_band(std::string& html, const char* kind, const EvaluationResults& results,
                    const app::FigureResults& figure) {
  std::string name = "Worst in-band error, with its delay";
  if (&figure == &results.matched) {
    const bool is_given = results.settings.delay_choice == app::DelayChoice::kGiven;
    name = std::string("Worst in-band error, ") +
           (is_given ? "the given delay taken out" : "constant delay taken out") +
           (results.is_one_sided(figure)  ? "; the delay stays that of the estimate"
            : figure.uncertainty.exists() ? " (U, k = 2)"
                                          : "");
  }
  append_figure(
      html, kind, name,
      value_of(results, figure.uncertainty, figure.energy_v2s) +
          (figure.has_range ? range_of(results, {figure.least_v2s, figure.greatest_v2s}) : ""));
}

constexpr const char* kFirst = " class=\"first\"";

void append_leading_figure(std::string& html, const EvaluationResults& results) {
  if (const app::FigureResults* figure = leading_figure(results)) {
    append_in_band(html, kFirst, results, *figure);
  }
}

void append_second_figure(std::string& html, const EvaluationResults& results) {
  const app::FigureResults* const first = leading_figure(results);
  for (const app::FigureResults* figure : {&results.matched, &results.band}) {
    if (figure != first && figure->exists()) {
      append_in_band(html, "", results, *figure);
    }
  }
}

void append_papers_figure(std::string& html, const EvaluationResults& results) {
  const double energy = results.energy_v2s();
  if (energy < 0.0 || results.settings.criterion == Criterion::kInBandError) {
    return;
  }
  const std::string value = value_of(results, results.uncertainty, energy) +
                            (results.has_cut_range && results.cut_low_v2s > 0.0
                                 ? range_of(results, {results.cut_low_v2s, results.cut_high_v2s})
                                 : "");
  const bool is_error = results.settings.criterion == Criterion::kIntegralSquareError;
  append_figure(html, "",
                is_error ? "The paper's figure, √(E/T)" : "The energy difference, as √(E/T)",
                value);
  if (results.ideal.exists() && results.ideal.energy_v2s >= 0.0) {
    append_figure(
        html, "", "The same of an ideal sensor, K = S",
        percentage(results.percent_of(results.ideal.energy_v2s), 0.0) + " of&nbsp;S&nbsp;a");
  }
}

// Whether the interval stands in the place of U, as in the report.
bool states_interval(const EvaluationResults& results) {
  const double energy = results.energy_v2s();
  return energy >= 0.0 && results.is_one_sided(results.uncertainty, energy);
}

// E with its U, where there is one.
void append_energy(std::string& html, const EvaluationResults& results) {
  const app::EnergyUncertainty& known = results.uncertainty;
  const double energy = results.energy_v2s();
  const std::string name =
      std::string(name_of(results.settings.criterion)) + " at the estimates, E";
  const double u = known.exists() && !results.is_damping_open() ? known.u_v2s : 0.0;
  const EnergyFormat format(energy, kCoverageFactor * u);
  if (!(u > 0.0) || states_interval(results)) {
    append_figure(html, "", name, EnergyFormat(energy, 0.0).number(energy) + format.unit());
    return;
  }
  append_figure(html, "", name + ", with U (k = 2)",
                "(" + format.number(energy) + "&nbsp;±&nbsp;" + format.number(kCoverageFactor * u) +
                    ")" + format.unit());
}

constexpr const char* kMore = " class=\"more\"";

void append_uncertainty(std::string& html, const EvaluationResults& results) {
  const app::EnergyUncertainty& known = results.uncertainty;
  if (results.is_damping_open()) {
    append_figure(html, kMore, "Range of E, as the points leave the damping open",
                  range_of(results));
    return;
  }
  if (!known.exists()) {
    append_figure(html, kMore, "Standard uncertainty u(E)",
                  results.has_uncertainty() ? "none: the draws are no devices"
                                            : "none: all uncertainties are zero");
    return;
  }
  const EnergyFormat format(results.energy_v2s(), kCoverageFactor * known.u_v2s);
  const std::string percent =
      words_of([&](TextWriter& out) { out.general(kPercent * results.settings.probability, 6); });
  const CoverageInterval interval = states_interval(results)
                                        ? app::widened(known.shortest, results.energy_v2s())
                                        : known.symmetric;
  append_figure(html, kMore, percent + " % coverage interval of E",
                "(" + format.number(interval.low) + " to " + format.number(interval.high) + ")" +
                    format.unit());
}

void append_papers_maximum(std::string& html, const EvaluationResults& results) {
  if (!results.has_monte_carlo) {
    return;
  }
  const MonteCarloResult& result = results.trials.result;
  const EnergyFormat format(result.maximum, kCoverageFactor * result.u);
  const bool is_paper = results.settings.criterion == Criterion::kIntegralSquareError;
  append_figure(html, kMore,
                is_paper ? "The paper's E<sub>max</sub>, largest of its Monte Carlo trials"
                         : "E<sub>max</sub>, largest of the Monte Carlo trials",
                format.number(result.maximum) + format.unit());
}

void append_bound(std::string& html, const EvaluationResults& results) {
  // At the estimates proves nothing of a device whose damping is open.
  if (results.has_bound && !results.is_damping_open()) {
    const EnergyFormat format(results.bound_v2s, 0.0);
    append_figure(
        html, kMore, "Proven at the estimates: no signal has more than",
        format.number(rounded_up(results.bound_v2s, EnergyFormat::kDecimalsAlone)) + format.unit());
  }
}

/// @param[in] settling_s Of the first figure's error; 0 for none.
void append_conditions(std::string& html, const EvaluationResults& results, double settling_s,
                       bool in_g) {
  const app::Settings& settings = results.settings;
  const double limit = results.limit_mps2;
  html +=
      "<p>" + words_of([&](TextWriter& out) {
        out.text("For signals within +-a, a = ").general(limit, 7).text(" m/s^2");
        if (in_g) {
          out.text(" (").general(limit / app::kStandardGravity_mps2, 7).text(" g)");
        }
        out.text(", of the length T = ").general(kMilli * settings.duration_s, 10);
        out.text(" ms, against a Butterworth filter of order ");
        out.integer(static_cast<std::uint64_t>(settings.filter_order)).text(" with a cutoff of ");
        out.general(settings.cutoff_hz, 7).text(" Hz; ");
        out.text(name_in_line(settings.criterion));
        if (settings.criterion == Criterion::kInBandError) {
          if (settings.delay_choice == app::DelayChoice::kNone) {
            out.text(" with the sensor's delay");
          } else {
            const bool is_given = settings.delay_choice == app::DelayChoice::kGiven;
            out.text(is_given ? " with the given delay of " : " with the sensor's delay of ");
            out.general(kMicro * results.model.delay_s(), 5).text(" us taken out");
          }
        }
        const bool is_paper = settings.method == Method::kPaper;
        out.text(is_paper ? ", by the paper's method: other signals may reach more." : ".");
        if (settling_s > 0.0) {
          out.text(" The error of the first figure settles to 5 % in ");
          out.general(kMilli * settling_s, 4).text(" ms.");
        }
      }) +
      "</p>\n";
}

std::vector<app::Warning> warnings_of(const EvaluationResults& results,
                                      const app::ReportContext& context) {
  std::vector<app::Warning> warnings;
  for (const app::Warning warning : app::kWarnings) {
    if (holds(warning, results, context)) {
      warnings.push_back(warning);
    }
  }
  return warnings;
}

// How many there are and which, beside the number that they are about.
void append_warnings(std::string& html, const EvaluationResults& results,
                     const std::vector<app::Warning>& warnings, double settling_s,
                     const char* other_criterion) {
  const bool is_other = other_criterion != nullptr;
  if (warnings.empty() && !is_other) {
    return;
  }
  std::string list = "<ul>";
  if (is_other) {
    list += "<li>" + link_to(app::ReportSection::kFigures) + ": " +
            words_of([&](TextWriter& out) { out.text(other_criterion); }) + "</li>";
  }
  for (const app::Warning warning : warnings) {
    const std::string words = sentence_of(warning, results, settling_s);
    list += "<li>" + link_to(place_of(warning)) + ": " +
            words_of([&](TextWriter& out) { out.text(words.c_str()); }) + "</li>";
  }
  const std::size_t count = warnings.size() + (is_other ? 1 : 0);
  append_figure(html, " class=\"warns\"",
                std::to_string(count) + (count == 1 ? " warning" : " warnings"), list + "</ul>");
}

// What no number of warnings tells: a short T, below the limit of a warning.
void append_short_time(std::string& html, const EvaluationResults& results, double settling_s) {
  const std::string words = note_on_time(results, settling_s);
  if (!words.empty()) {
    append_figure(html, " class=\"notes\"", "Note",
                  link_to(app::ReportSection::kInBand) + ": " +
                      words_of([&](TextWriter& out) { out.text(words.c_str()); }));
  }
}

void append_headline(std::string& html, const EvaluationResults& results, double settling_s,
                     const std::vector<app::Warning>& warnings, const char* other_criterion) {
  const bool is_clear = warnings.empty() && other_criterion == nullptr;
  html += std::string("<dl class=\"headline") + (is_clear ? "" : " doubtful") + "\">\n";
  append_leading_figure(html, results);
  append_warnings(html, results, warnings, settling_s, other_criterion);
  append_short_time(html, results, settling_s);
  append_second_figure(html, results);
  append_papers_figure(html, results);
  append_energy(html, results);
  append_uncertainty(html, results);
  append_bound(html, results);
  append_papers_maximum(html, results);
  html += "</dl>\n";
}

// Page

std::string name_of(const app::Labels& labels) {
  StringSink name;
  TextWriter out(name);
  out.one_line(labels.device != nullptr ? labels.device : "Accelerometer", app::kLabelShown);
  return quoted(name.text().c_str());
}

std::string opening(const app::ReportContext& context) {
  const bool is_marked = is_simulated(context);
  const char* const number = certificate_number(context.labels);
  const char* const kind = is_marked             ? "Simulation "
                           : is_of_item(context) ? "Calibration certificate "
                                                 : "Computation ";
  const std::string about = number == nullptr
                                ? std::string("The largest error that this accelerometer can make")
                                : kind + quoted(number) + ": the largest error that it can make";
  const std::string numbered = number == nullptr ? "" : ", number " + quoted(number);
  return page_opening(name_of(context.labels),
                      numbered + (is_marked ? " (simulation)" : "") + " - emax report", about,
                      is_marked ? app::kSimulationBanner : "", running_words(context));
}

std::string cell_of(double value, int decimals) {
  return "<td>" + words_of([&](TextWriter& out) { out.fixed(value, decimals); }) + "</td>";
}

// Two digits of U, and the value to match.
std::string cells_of(double value, double expanded) {
  constexpr int kMostDecimals = 12;
  const int decimals =
      std::clamp(1 - static_cast<int>(std::floor(std::log10(expanded))), 0, kMostDecimals);
  return cell_of(value, decimals) + cell_of(expanded, decimals);
}

// The points of a table; those of a measurement are in its budget.
void append_points(std::string& html, const EvaluationResults& results,
                   const app::ReportContext& context) {
  if (results.source != app::Source::kPoints || context.measurement != nullptr ||
      certificate_number(context.labels) == nullptr) {
    return;
  }
  html +=
      "<section id=\"points\">\n<h2>Points of the table</h2>\n<p class=\"about\">U: expanded, k = "
      "2, with what all points have in common</p>\n<details><summary>Each point</summary>\n"
      "<table class=\"numbers\">\n<thead><tr><th>f</th><th>A</th><th>U(A)</th><th>phase</th>"
      "<th>U(phase)</th></tr>\n<tr><th>Hz</th><th>V/(m/s²)</th><th>V/(m/s²)</th><th>deg</th>"
      "<th>deg</th></tr></thead>\n<tbody>\n";
  const FrequencyResponse& response = results.fit.response();
  for (std::size_t i = 0; i < response.size(); ++i) {
    const ResponsePoint& point = response.points()[i];
    const Complex beside = results.fit.shared_beside(i);
    const double u = std::hypot(point.u_amplitude, response.common()[i] * point.amplitude,
                                beside.re * point.amplitude);
    const double u_phase_rad = std::hypot(point.u_phase_rad, beside.im);
    html += "<tr><td>" + words_of([&](TextWriter& out) { out.general(point.frequency_hz, 7); }) +
            "</td>" + cells_of(point.amplitude, kCoverageFactor * u) +
            (is_phase_known(point) ? cells_of(kDegreesPerRadian * point.phase_rad,
                                              kCoverageFactor * kDegreesPerRadian * u_phase_rad)
                                   : "<td>-</td><td>-</td>") +
            "</tr>\n";
  }
  html += "</tbody></table>\n</details>\n</section>\n";
}

void append_budget(std::string& html, const std::string& budget) {
  if (!budget.empty()) {
    html +=
        "<section id=\"budget\">\n<h2>Uncertainty budget</h2>\n<details><summary>Each "
        "point</summary>\n" +
        budget + "</details>\n</section>\n";
  }
}

std::string closing() {
  return page_closing(
      "The same as text is in report.txt, the numbers for programs are in results.json, the "
      "tables of the pictures in the CSV files beside them.");
}

}  // namespace

void write_page(const EvaluationResults& results, const app::ReportContext& given,
                const std::vector<PagePicture>& pictures, TextWriter& out) {
  app::ReportContext context = given;
  context.rounds_to_u = certificate_number(given.labels) != nullptr;
  const double settling_s = given.leading_settling_s;
  std::string body;
  HtmlWords words(body);
  TextWriter report(words);
  Pictures section_end(pictures);
  HtmlMarkup markup(body, section_end);
  write_report(results, context, report, &markup);
  markup.finish();

  const std::vector<app::Warning> warnings = warnings_of(results, context);
  std::string html = opening(context);
  append_headline(html, results, settling_s, warnings, context.other_criterion);
  append_conditions(html, results, settling_s, context.in_g);
  if (warnings.empty() && context.other_criterion == nullptr) {
    html += "<p class=\"note\">No warnings.</p>\n";
  }
  append_budget(body, markup.budget());
  append_points(body, results, context);
  body += certificate_of(results, context);
  if (pictures.empty()) {
    html += std::string("<p class=\"note\">No pictures: gnuplot was missing when this page was ") +
            "made, or has failed. Running gnuplot " + kPictureScript +
            " beside this page draws them.</p>\n";
  }
  write_html(out, html + body + closing());
}

void write_fault_page(const app::ReportContext& context, const EvaluationResults* refused,
                      TextWriter& out) {
  std::string html = opening(context);
  HtmlWords words(html);
  TextWriter report(words);
  const std::vector<PagePicture> none;
  Pictures section_end(none);
  HtmlMarkup markup(html, section_end);
  write_measurement(context, refused, report, &markup);
  markup.finish();
  append_budget(html, markup.budget());
  write_html(out, html + closing());
}

}  // namespace emax::desk
