// The picture of a comparison, drawn by gnuplot.
#include "desk/compare/comparison_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "desk/cli/console.hpp"
#include "desk/compare/comparison_words.hpp"
#include "desk/compare/figure_text.hpp"
#include "desk/compare/name_lines.hpp"
#include "desk/pictures/axis_scale.hpp"
#include "desk/pictures/gnuplot.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

constexpr std::size_t kMostRows = 40;
constexpr double kMuch = 30.0;

// In pixels, but for the lines of a name.
constexpr double kWidth = 900.0;
constexpr double kAbove = 76.0;
constexpr double kBelow = 130.0;
constexpr double kLineHeight = 19.0;
constexpr double kRowMargin = 14.0;
constexpr double kRowHeight = 46.0;  // At least.
constexpr double kLetter = 8.4;
constexpr double kNameWidth = 27.0;
constexpr std::size_t kPictureNameLines = 2 * kNameShown / 27;  // Broad letters take 1.5.

struct Range {
  double least = HUGE_VAL;
  double largest = -HUGE_VAL;
};

// What the picture shows, and how.
struct Layout {
  std::size_t rows = 0;
  std::vector<std::vector<std::string>> names;  // In lines, with rank and mark.
  std::vector<double> middles;                  // Of the rows, from the top of the first.
  double rows_height = 0.0;
  double height = 0.0;
  double left = 0.0;
  Scale scale = {1.0, ""};
  bool is_logarithmic = false;
  Range axis;  // Where it is logarithmic.
};

bool spans_decades(const Comparison& comparison, std::size_t rows) {
  Range range;
  for (std::size_t i = 0; i < rows; ++i) {
    const double value = comparison.figure(comparison.results[i]).value;
    range = {std::min(range.least, value), std::max(range.largest, value)};
  }
  return range.least > 0.0 && range.largest > kMuch * range.least;
}

// Of the bar: the interval where the figure is at one end of it.
Range ends_of(const Figure& figure) {
  return figure.is_one_sided || figure.has_range
             ? Range{figure.low, figure.high}
             : Range{figure.value - figure.expanded, figure.value + figure.expanded};
}

// Bars that reach to 0 have no end on such an axis: it starts below all points.
Range axis_of(const Comparison& comparison, std::size_t rows, double factor) {
  constexpr double kMargin = 1.5;
  constexpr double kBelowPoint = 10.0;
  Range axis;
  for (std::size_t i = 0; i < rows; ++i) {
    const Figure& figure = comparison.figure(comparison.results[i]);
    const Range ends = ends_of(figure);
    const double low = std::max(ends.least, figure.value / kBelowPoint);
    const double high = std::max(ends.largest, figure.bound);
    axis = {std::min(axis.least, low), std::max(axis.largest, high)};
  }
  return {factor * axis.least / kMargin, factor * axis.largest * kMargin};
}

std::vector<std::string> name_of_row(const Comparison& comparison, std::size_t index) {
  const Result& result = comparison.results[index];
  std::vector<std::string> lines =
      name_lines(result, kNameWidth, kPictureNameLines, Typeface::kProportional);
  for (std::string& line : lines) {
    const bool is_cut = line.size() >= 3 && line.compare(line.size() - 3, 3, "...") == 0;
    line = is_cut ? line.substr(0, line.size() - 3) + "…" : line;
  }
  lines.front().insert(0, text_of(comparison.ranks[index]) + "  ");
  if (result.fit_warns) {
    lines.emplace_back("fit warns: not told apart");
  }
  if (result.has_open_damping) {
    lines.emplace_back(result.figure(comparison.by).has_range ? "over the dampings left open"
                                                              : "damping not known");
  }
  if (result.is_simulated) {
    lines.emplace_back("simulated: not told apart");
  }
  return lines;
}

Layout layout_of(const Comparison& comparison) {
  Layout layout;
  layout.rows = std::min(comparison.results.size(), kMostRows);
  double widest = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < layout.rows; ++i) {
    layout.names.push_back(name_of_row(comparison, i));
    const double height = std::max(
        kRowHeight, kRowMargin + kLineHeight * static_cast<double>(layout.names.back().size()));
    layout.middles.push_back(layout.rows_height + 0.5 * height);
    layout.rows_height += height;
    for (const std::string& line : layout.names.back()) {
      widest = std::max(widest, width_of(line, Typeface::kProportional));
    }
    largest = std::max(largest, std::abs(comparison.figure(comparison.results[i]).value));
  }
  layout.height = kAbove + kBelow + layout.rows_height;
  layout.left = (30.0 + kLetter * widest) / kWidth;
  layout.is_logarithmic = spans_decades(comparison, layout.rows);
  layout.scale =
      comparison.by == FigureKind::kEnergy ? scaled(largest, "V² s") : Scale{1.0, "% of S·a"};
  if (layout.is_logarithmic) {
    layout.axis = axis_of(comparison, layout.rows, layout.scale.factor);
  }
  return layout;
}

std::string title_of(const Comparison& comparison) {
  const char* const titles[kFigureKinds] = {
      "Worst error in the filter's band, constant delay taken out",
      "Worst error in the filter's band, with the sensor's delay",
      comparison.results.front().criterion == "difference" ? "Largest energy difference"
                                                           : "Largest energy of the error"};
  return titles[static_cast<std::size_t>(comparison.by)];
}

std::string name_of_axis(const Comparison& comparison, const Scale& scale) {
  return (comparison.by == FigureKind::kEnergy ? "E in " : "rms error in ") + scale.unit;
}

void write_heading(const std::string& text, double height, TextWriter& out) {
  out.text("set label ").text(gnuplot_string(text).c_str());
  out.text(" at screen 0.5, screen ").exact(height).text(" center\n");
}

// What is of interest to somebody who has only the picture.
std::string line_of_conditions(const Comparison& comparison) {
  const Result& first = comparison.results.front();
  StringSink sink;
  TextWriter out(sink);
  out.text("T = ").general(1e3 * first.duration_s, 6).text(" ms, ");
  if (comparison.by == FigureKind::kEnergy) {
    out.text("a = ").general(first.limit_mps2, 6).text(" m/s², ");
  }
  out.text("filter of order ").general(first.order, 3);
  out.text(", ").general(first.cutoff_hz, 6).text(" Hz");
  if (first.gain_mode == "fixed") {
    out.text(", gain ").general(first.gain, 6).text(" V/(m/s²)");
  }
  if (comparison.by == FigureKind::kEnergy) {
    out.text(", ").text(criterion_of(first).c_str());
    out.text(first.method == "paper" ? ", paper's method" : "");
  }
  return sink.text();
}

void write_headings(const Comparison& comparison, const Layout& layout, TextWriter& out) {
  const std::string banner = banner_of(comparison);
  const char* how = banner.empty() ? "" : "SIMULATION: ";
  write_heading(how + std::string(title_of(comparison)), 1.0 - 25.0 / layout.height, out);
  write_heading(line_of_conditions(comparison), 1.0 - 48.0 / layout.height, out);
}

void write_names(const Layout& layout, TextWriter& out) {
  out.text("set ytics (");
  for (std::size_t i = 0; i < layout.rows; ++i) {
    out.text(i == 0 ? "" : ", \\\n  ");
    const char* between = "";
    for (const std::string& line : layout.names[i]) {
      out.text(between).text(gnuplot_string(line).c_str());
      between = ".\"\\n\".";
    }
    out.text(" ").exact(layout.middles[i]);
  }
  out.text(")\n");
}

// Figure, ends of its bar, bound, and the row.
void write_numbers(const Comparison& comparison, const Layout& layout, bool marked,
                   TextWriter& out) {
  const double factor = layout.scale.factor;
  out.text(marked ? "$marked << END\n" : "$devices << END\n");
  for (std::size_t i = 0; i < layout.rows; ++i) {
    const Result& result = comparison.results[i];
    if (is_marked(result) != marked) {
      continue;
    }
    const Figure& figure = comparison.figure(result);
    const Range ends = ends_of(figure);
    const double low = factor * ends.least;
    out.exact(factor * figure.value).text(" ");
    out.exact(layout.is_logarithmic ? std::max(low, layout.axis.least) : low).text(" ");
    out.exact(factor * ends.largest).text(" ");
    if (figure.has_bound) {
      out.exact(factor * figure.bound);
    } else {
      out.text("NaN");
    }
    out.text(" ").exact(layout.middles[i]).line();
  }
  out.text("END\n");
}

void write_axes(const Comparison& comparison, const Layout& layout, TextWriter& out) {
  out.text("set xlabel ");
  out.text(gnuplot_string(name_of_axis(comparison, layout.scale)).c_str());
  out.text("\nset yrange [").exact(layout.rows_height).text(":0]\n");
  if (!layout.is_logarithmic) {
    out.text("set offsets graph 0.05, graph 0.05, 0, 0\n");
    return;
  }
  out.text("set logscale x\nset xrange [").exact(layout.axis.least).text(":");
  out.exact(layout.axis.largest).text("]\n");
  constexpr double kFew = 1e3;  // Decades alone are then too few marks.
  if (layout.axis.largest < kFew * layout.axis.least) {
    out.text("set xtics (");
    const int last = static_cast<int>(std::ceil(std::log10(layout.axis.largest)));
    int decade = static_cast<int>(std::floor(std::log10(layout.axis.least)));
    for (const char* between = ""; decade <= last; ++decade) {
      for (const double step : {1.0, 2.0, 5.0}) {
        out.text(between).exact(step * std::pow(10.0, decade));
        between = ", ";
      }
    }
    out.text(")\n");
  }
}

// What a mark means for the bars of those that have one.
const char* words_on_marked(const Comparison& comparison, std::size_t rows) {
  const auto first = comparison.results.begin();
  const auto end = first + static_cast<std::ptrdiff_t>(rows);
  const bool any_of_none = std::any_of(
      first, end, [&](const Result& result) { return is_told_from_none(result, comparison.by); });
  const bool any_range = std::any_of(
      first, end, [&](const Result& result) { return comparison.figure(result).has_range; });
  return !any_range     ? "told apart from no other"
         : !any_of_none ? "and its range over the dampings left open"
                        : "or its range, or told apart from no other: see its name";
}

void write_plot(const Comparison& comparison, const Layout& layout, TextWriter& out) {
  const auto first = comparison.results.begin();
  const auto end = first + static_cast<std::ptrdiff_t>(layout.rows);
  const bool has_marked = std::any_of(first, end, is_marked);
  const bool has_others = !std::all_of(first, end, is_marked);
  write_numbers(comparison, layout, false, out);
  write_numbers(comparison, layout, true, out);
  const char* before = "plot ";
  if (has_others) {
    out.text(before).text("$devices using 1:5:2:3 with xerrorbars lc '#000000' lw 2 pt 7 ps 1 ");
    out.text("title 'largest found, and its expanded uncertainty (k = 2)', \\\n     ");
    before = "";
  }
  if (has_marked) {
    out.text(before).text("$marked using 1:5:2:3 with xerrorbars lc '#000000' lw 1 pt 6 ps 1 ");
    out.text("title 'the same, ").text(words_on_marked(comparison, layout.rows));
    out.text("', \\\n     ");
  }
  const char* data = has_others ? "$devices" : "$marked";
  out.text(data).text(" using 4:5 with points lc '#d05000' lw 2 pt 8 ps 1.5 ");
  out.text("title 'at the estimates no signal has more (proven)'");
  if (has_others && has_marked) {
    out.text(", \\\n     $marked using 4:5 with points lc '#d05000' lw 2 pt 8 ps 1.5 notitle");
  }
  out.text("\nunset output\n");
}

}  // namespace

void write_comparison_script(const Comparison& comparison, TextWriter& out) {
  const Layout layout = layout_of(comparison);
  out.text("# Draws the comparison: gnuplot ").text(kComparisonScript).text("\n");
  out.text("set encoding utf8\nset minussign\nset terminal svg noenhanced font 'sans-serif,15' ");
  out.text("background '#ffffff' fixed size 900,");
  out.integer(static_cast<std::uint64_t>(layout.height));
  out.text("\nset output '").text(kComparisonPicture).text("'\n");
  write_headings(comparison, layout, out);
  // In pixels from the edges, whatever the number of rows.
  out.text("set tmargin at screen ").exact(1.0 - kAbove / layout.height);
  out.text("\nset bmargin at screen ").exact(kBelow / layout.height);
  out.text("\nset lmargin at screen ").exact(layout.left).text("\nset rmargin at screen 0.965");
  out.text("\nset key center at screen 0.5, screen ").exact(30.0 / layout.height);
  out.text(" vertical maxrows 3 Left reverse\nset grid x lc '#c0c0c0'\nset bars 1.5\n");
  write_axes(comparison, layout, out);
  write_names(layout, out);
  write_plot(comparison, layout, out);
}

}  // namespace emax::desk
