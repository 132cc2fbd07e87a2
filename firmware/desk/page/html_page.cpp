// The report as a page.
#include "desk/page/html_page.hpp"

#include <algorithm>
#include <cmath>

#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/rounding.hpp"
#include "desk/page/html_markup.hpp"
#include "desk/page/page_frame.hpp"
#include "desk/page/page_picture.hpp"

namespace emax::desk {

namespace {

using app::EvaluationResults;
using app::TextWriter;

constexpr double kMilli = 1e3;
constexpr double kPercent = 100.0;

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

  EnergyFormat(double energy, double u)
      : exponent_(energy != 0.0 ? exponent_of(energy) : 0), decimals_(kDecimalsAlone) {
    constexpr int kMostDecimals = 12;
    if (u > 0.0) {
      decimals_ = std::clamp(exponent_ - exponent_of(u) + 2, 3, kMostDecimals);
    }
  }

  std::string number(double energy) const {
    return words_of(
        [&](TextWriter& out) { out.fixed(energy * std::pow(10.0, -exponent_), decimals_); });
  }

  std::string unit() const {
    const std::string power = (exponent_ < 0 ? "−" : "") + std::to_string(std::abs(exponent_));
    return (exponent_ == 0 ? "" : " × 10<sup>" + power + "</sup>") + " V²&nbsp;s";
  }

 private:
  static int exponent_of(double energy) {
    return static_cast<int>(std::floor(std::log10(std::abs(energy))));
  }

  int exponent_;
  int decimals_;
};

void append_energies(std::string& html, const EvaluationResults& results) {
  const double energy = results.energy_v2s();
  const bool is_ise = results.settings.criterion == Criterion::kIntegralSquareError;
  const std::string largest = is_ise ? "Largest energy of the error" : "Largest energy difference";
  if (!results.has_monte_carlo) {
    const EnergyFormat format(energy, 0.0);
    append_figure(html, " class=\"first\"", largest + ", E<sub>max</sub>",
                  format.number(energy) + format.unit());
    append_figure(html, "", "Standard uncertainty u(E)", "none: all uncertainties are zero");
    return;
  }
  const MonteCarloResult& result = results.trials.result;
  const EnergyFormat format(result.maximum, result.u);
  append_figure(html, " class=\"first\"",
                largest + " within the device's uncertainty, E<sub>max</sub>",
                format.number(result.maximum) + format.unit());
  append_figure(html, "", "At the estimates, E", format.number(energy) + format.unit());
  append_figure(html, "", "Standard uncertainty u(E)", format.number(result.u) + format.unit());
  const std::string percent =
      words_of([&](TextWriter& out) { out.general(kPercent * result.probability, 6); });
  append_figure(html, "", percent + " % coverage interval of E",
                format.number(result.symmetric.low) + " to " +
                    format.number(result.symmetric.high) + format.unit());
}

void append_rms(std::string& html, const EvaluationResults& results) {
  if (results.energy_v2s() < 0.0) {
    return;
  }
  const double full = results.device.estimate.sensitivity * results.limit_mps2;
  const bool is_ise = results.settings.criterion == Criterion::kIntegralSquareError;
  const char* name = is_ise ? "rms error at the estimates" : "√(E/T) at the estimates";
  append_figure(html, "", name, words_of([&](TextWriter& out) {
                  out.general(results.rms_error_v(), 5).text(" V = ");
                  out.general(kPercent * results.rms_error_v() / full, 4).text(" % of S a");
                }));
}

void append_bound(std::string& html, const EvaluationResults& results) {
  if (results.has_bound) {
    const EnergyFormat format(results.bound_v2s, 0.0);
    append_figure(
        html, "", "Proven at the estimates: no signal has more than",
        format.number(rounded_up(results.bound_v2s, EnergyFormat::kDecimalsAlone)) + format.unit());
  }
}

void append_conditions(std::string& html, const EvaluationResults& results, bool in_g) {
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
        const bool is_ise = settings.criterion == Criterion::kIntegralSquareError;
        out.text(is_ise ? "integral-square error" : "energy difference");
        const bool is_paper = settings.method == Method::kPaper;
        out.text(is_paper ? ", by the paper's method: other signals may reach more." : ".");
      }) +
      "</p>\n";
}

void append_warnings(std::string& html, const HtmlMarkup& markup) {
  if (markup.warnings() == 0) {
    html += "<p class=\"note\">No warnings.</p>\n";
    return;
  }
  html += "<p class=\"warning\">" + std::to_string(markup.warnings()) +
          (markup.warnings() == 1 ? " warning" : " warnings") + ", in: " + markup.warning_links() +
          "</p>\n";
}

// Page

std::string name_of(const app::Labels& labels) {
  StringSink name;
  TextWriter out(name);
  out.one_line(labels.device != nullptr ? labels.device : "Accelerometer", app::kLabelShown);
  return quoted(name.text().c_str());
}

std::string opening(const app::Labels& labels) {
  return page_opening(name_of(labels), " - emax report",
                      "The largest error that this accelerometer can make");
}

std::string closing() {
  return page_closing(
      "The same as text is in report.txt, the numbers for programs are in results.json, the "
      "tables of the pictures in the CSV files beside them.");
}

}  // namespace

void write_page(const EvaluationResults& results, const app::ReportContext& context,
                const std::vector<PagePicture>& pictures, TextWriter& out) {
  std::string body;
  HtmlWords words(body);
  TextWriter report(words);
  Pictures section_end(pictures);
  HtmlMarkup markup(body, section_end);
  write_report(results, context, report, &markup);
  markup.finish();

  std::string html = opening(context.labels) + "<dl class=\"headline\">\n";
  append_energies(html, results);
  append_rms(html, results);
  append_bound(html, results);
  html += "</dl>\n";
  append_conditions(html, results, context.in_g);
  append_warnings(html, markup);
  if (pictures.empty()) {
    html += std::string("<p class=\"note\">No pictures: gnuplot was missing when this page was ") +
            "made, or has failed. Running gnuplot " + kPictureScript +
            " beside this page draws them.</p>\n";
  }
  write_html(out, html + body + closing());
}

void write_fault_page(const app::ReportContext& context, const EvaluationResults* refused,
                      TextWriter& out) {
  std::string html = opening(context.labels);
  HtmlWords words(html);
  TextWriter report(words);
  const std::vector<PagePicture> none;
  Pictures section_end(none);
  HtmlMarkup markup(html, section_end);
  write_measurement(context, refused, report, &markup);
  markup.finish();
  write_html(out, html + closing());
}

}  // namespace emax::desk
