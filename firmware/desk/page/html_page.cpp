// The report as a page.
#include "desk/page/html_page.hpp"

#include <algorithm>
#include <cmath>

#include "emax/app/base/version.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/rounding.hpp"
#include "desk/page/html_markup.hpp"

namespace emax::desk {

namespace {

using app::EvaluationResults;
using app::TextWriter;

constexpr double kMilli = 1e3;
constexpr double kPercent = 100.0;

// Nothing may be loaded, neither from outside nor by what a label might say.
constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
)";

constexpr const char* kStyle = R"(<style>
:root { color-scheme: light dark; --text: #1a1a1a; --soft: #595959; --line: #c4c4c4; --paper: #ffffff;
  --warn: #8a2b00; --warn-paper: #fff1e6; --note-paper: #f1f4f8; }
@media (prefers-color-scheme: dark) {
  :root { --text: #ececec; --soft: #b4b4b4; --line: #5a5a5a; --paper: #161616; --warn: #ffb080;
    --warn-paper: #3a2413; --note-paper: #242a31; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 1.5rem; max-width: 62rem; background: var(--paper); color: var(--text);
  font: 1rem/1.45 sans-serif; overflow-wrap: anywhere; }
h1 { margin: 0 0 .2rem; font-size: 1.7rem; line-height: 1.2; }
h2 { margin: 2.2rem 0 .5rem; padding-top: .6rem; border-top: 1px solid var(--line); font-size: 1.25rem; }
p { margin: .6rem 0; }
.about { color: var(--soft); }
#title .about { white-space: pre-line; }
.headline { display: grid; grid-template-columns: repeat(auto-fit, minmax(14rem, 1fr)); gap: .8rem 1.5rem;
  margin: 1rem 0; padding: 1rem; border: 2px solid var(--text); }
.headline div { min-width: 0; }
.headline dt { color: var(--soft); font-size: .9rem; }
.headline dd { margin: 0; font-size: 1.1rem; }
.headline .first { grid-column: 1 / -1; }
.headline .first dd { font-size: 2rem; font-weight: bold; line-height: 1.2; }
.warning, .note { padding: .6rem .8rem; border-left: .4rem solid var(--line); background: var(--note-paper); }
.warning { border-color: var(--warn); background: var(--warn-paper); color: var(--warn); font-weight: bold; }
table { border-collapse: collapse; }
.rows { width: 100%; }
.rows th { width: 14rem; padding: .15rem 1rem .15rem 0; font-weight: normal; color: var(--soft); }
.rows th, .rows td { text-align: left; vertical-align: top; }
.wide { overflow-x: auto; margin: .8rem 0; }
.numbers { font-variant-numeric: tabular-nums; font-size: .88rem; overflow-wrap: normal; }
.numbers th, .numbers td { padding: .12rem .7rem; text-align: right; white-space: nowrap; }
.numbers thead tr:last-child th { border-bottom: 1px solid var(--text); }
figure { margin: 1.2rem 0; }
figure svg { display: block; width: 100%; height: auto; background: #ffffff; color: #000000; }
figcaption { margin-top: .4rem; color: var(--soft); font-size: .92rem; }
a { color: inherit; }
footer { margin-top: 2.5rem; padding-top: .6rem; border-top: 1px solid var(--line); color: var(--soft);
  font-size: .9rem; }
@page { size: A4; margin: 15mm; }
@media print {
  :root { --text: #000000; --soft: #404040; --line: #a0a0a0; --paper: #ffffff; --warn: #000000;
    --warn-paper: #ffffff; --note-paper: #ffffff; color-scheme: light; }
  html { font-size: 9.5pt; }
  body { max-width: none; padding: 0; }
  figure { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  figure svg { max-height: 85mm; }
  #fit svg { max-height: 120mm; }
  h1, h2, h2 + p, thead { break-after: avoid; }
  figure, .wide, .numbers tr, .headline, .warning, .note { break-inside: avoid; }
  .warning { border: 1.5pt solid #000000; }
  .wide { overflow: visible; }
  .numbers { font-size: 8pt; }
  .numbers th, .numbers td { padding: .05rem .35rem; }
}
</style>
</head>
<body>
)";

template <typename Write>
std::string words_of(const Write& write) {
  std::string html;
  HtmlWords sink(html);
  TextWriter out(sink);
  write(out);
  return html;
}

std::string quoted(const char* text) {
  std::string html;
  append_quoted(html, text);
  return html;
}

// Pictures

// gnuplot gives the same names to parts of every picture; in one page each needs its own.
std::string with_own_names(const std::string& tag, const std::string& prefix) {
  std::string result = tag;
  for (const std::string start : {"id='", "id=\"", "href='#", "href=\"#", "url(#"}) {
    for (std::size_t at = result.find(start); at != std::string::npos;
         at = result.find(start, at + start.size())) {
      result.insert(at + start.size(), prefix);
    }
  }
  return result;
}

// What is from `start` to `end` is left out, if it is there.
void remove_part(std::string& text, const std::string& start, const std::string& end) {
  const std::size_t first = text.find(start);
  const std::size_t last = text.find(end, first);
  if (first != std::string::npos && last != std::string::npos) {
    text.erase(first, last + end.size() - first);
  }
}

void append_svg(std::string& html, const PagePicture& picture, std::size_t number) {
  std::string svg = picture.svg.substr(std::min(picture.svg.find("<svg"), picture.svg.size()));
  remove_part(svg, "<title>", "</title>");
  remove_part(svg, "<desc>", "</desc>");
  const std::string prefix = "p" + std::to_string(number) + "-";
  bool is_first = true;
  for (std::size_t at = 0; at < svg.size();) {
    const std::size_t open = std::min(svg.find('<', at), svg.size());
    const std::size_t close = std::min(svg.find('>', open), svg.size() - 1);
    html.append(svg, at, open - at);
    std::string tag = with_own_names(svg.substr(open, close + 1 - open), prefix);
    if (is_first) {
      tag.insert(4, " role=\"img\" aria-label=\"" + quoted(picture.picture.title.c_str()) + "\"");
      is_first = false;
    }
    html += tag;
    at = close + 1;
  }
}

class Pictures final : public SectionEnd {
 public:
  explicit Pictures(const std::vector<PagePicture>& pictures) : pictures_(pictures) {}

  void add_to(std::string& html, app::ReportSection section) override {
    for (std::size_t i = 0; i < pictures_.size(); ++i) {
      const Picture& picture = pictures_[i].picture;
      if (picture.section == section) {
        html += "<figure>\n";
        append_svg(html, pictures_[i], i + 1);
        html += "<figcaption>" + quoted(picture.caption.c_str()) + "</figcaption>\n</figure>\n";
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

void append_figure(std::string& html, const char* kind, const std::string& name,
                   const std::string& value) {
  html += std::string("<div") + kind + "><dt>" + name + "</dt><dd>" + value + "</dd></div>\n";
}

std::string range_of(const EvaluationResults& results) {
  if (!results.has_cut_range) {
    return "not found";
  }
  const EnergyFormat format(results.cut_high_v2s, 0.0);
  return format.number(results.cut_low_v2s) + " to " + format.number(results.cut_high_v2s) +
         format.unit();
}

void append_energies(std::string& html, const EvaluationResults& results) {
  const double energy = results.energy_v2s();
  const bool is_ise = results.settings.criterion == Criterion::kIntegralSquareError;
  const std::string largest = is_ise ? "Largest energy of the error" : "Largest energy difference";
  if (!results.has_monte_carlo) {
    const EnergyFormat format(energy, 0.0);
    append_figure(html, " class=\"first\"", largest + ", E<sub>max</sub>",
                  format.number(energy) + format.unit());
    if (results.is_damping_open()) {
      append_figure(html, "", "Range of E, as the points leave the damping open",
                    range_of(results));
      return;
    }
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
  const std::string name = name_of(labels);
  return std::string(kHead) + "<title>" + name + " - emax report</title>\n" + kStyle +
         "<main>\n<header>\n<h1>" + name + "</h1>\n<p class=\"about\">" +
         "The largest error that this accelerometer can make</p>\n</header>\n";
}

std::string closing() {
  return std::string("</main>\n<footer>Made by emax ") + app::kVersion +
         ". The same as text is in report.txt, the numbers for programs are in results.json, the " +
         "tables of the pictures in the CSV files beside them.</footer>\n</body>\n</html>\n";
}

void write_html(TextWriter& out, const std::string& html) {
  out.text(Span<const char>(html.data(), html.size()));
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
