// The picture of a comparison, drawn by gnuplot.
#include "desk/compare/comparison_picture.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "emax/base/elementary.hpp"

#include "desk/cli/console.hpp"
#include "desk/compare/comparison_report.hpp"
#include "desk/pictures/gnuplot.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

constexpr std::size_t kMostRows = 40;
constexpr std::size_t kNameShown = 24;
constexpr std::size_t kFrameHeight = 206;
constexpr std::size_t kRowHeight = 44;
constexpr double kMilli = 1e3;

std::string conditions_of(const Result& first) {
  StringSink sink;
  TextWriter out(sink);
  out.text("T = ").general(kMilli * first.duration_s, 6).text(" ms, a = ");
  out.general(first.limit_mps2, 6).text(" m/s², filter of order ").general(first.order, 3);
  out.text(", ").general(first.cutoff_hz, 6).text(" Hz, ");
  out.text(first.criterion == "ise" ? "integral-square error" : "energy difference");
  out.text(first.method == "paper" ? ", paper's method" : "");
  return sink.text();
}

void write_heading(const std::string& text, double height, TextWriter& out) {
  out.text("set label ").text(gnuplot_string(text).c_str());
  out.text(" at screen 0.5, screen ").exact(height).text(" center\n");
}

void write_marks(const Comparison& comparison, std::size_t rows, TextWriter& out) {
  out.text("set ytics (");
  for (std::size_t i = 0; i < rows; ++i) {
    const std::string name =
        text_of(comparison.ranks[i]) + "  " + shortened(name_of(comparison.results[i]), kNameShown);
    out.text(i == 0 ? "" : ", ").text(gnuplot_string(name).c_str()).text(" ").integer(i + 1);
  }
  out.text(")\n");
}

// Energy, expanded uncertainty and bound in mV^2 s, and the row.
void write_numbers(const Comparison& comparison, std::size_t rows, TextWriter& out) {
  out.text("$devices << END\n");
  for (std::size_t i = 0; i < rows; ++i) {
    const Result& result = comparison.results[i];
    out.exact(kMilli * result.energy_v2s).text(" ");
    out.exact(kMilli * kCoverageFactor * result.u_energy_v2s).text(" ");
    if (result.has_bound) {
      out.exact(kMilli * result.bound_v2s);
    } else {
      out.text("NaN");
    }
    out.text(" ").integer(i + 1).line();
  }
  out.text("END\n");
}

}  // namespace

void write_comparison_script(const Comparison& comparison, TextWriter& out) {
  const std::size_t rows = std::min(comparison.results.size(), kMostRows);
  out.text("# Draws the comparison: gnuplot ").text(kComparisonScript).text("\n");
  out.text("set encoding utf8\nset minussign\nset terminal svg noenhanced font 'sans-serif,15' ");
  out.text("background '#ffffff' fixed size 900,").integer(kFrameHeight + kRowHeight * rows);
  out.text("\nset output '").text(kComparisonPicture).text("'\n");
  // In pixels from the top and the bottom, whatever the number of rows.
  const auto height = static_cast<double>(kFrameHeight + kRowHeight * rows);
  write_heading("Rank, device and maximum energy", 1.0 - 25.0 / height, out);
  write_heading(conditions_of(comparison.results.front()), 1.0 - 48.0 / height, out);
  out.text("set tmargin at screen ").exact(1.0 - 70.0 / height);
  out.text("\nset bmargin at screen ").exact(118.0 / height);
  out.text("\nset key center at screen 0.5, screen ").exact(26.0 / height);
  out.text(" vertical maxrows 2\nset xlabel 'E in mV² s'\nset yrange [");
  out.integer(rows).text(".6:0.4]\nset offsets graph 0.05, graph 0.05, 0, 0\n");
  out.text("set grid x lc '#c0c0c0'\nset bars 1.5\n");
  write_marks(comparison, rows, out);
  write_numbers(comparison, rows, out);
  out.text("plot $devices using 1:4:2 with xerrorbars lc '#000000' lw 2 pt 7 ps 1 ");
  out.text("title 'E and its expanded uncertainty (k = 2)', \\\n");
  out.text("     $devices using 3:4 with points lc '#d05000' lw 2 pt 8 ps 1.5 ");
  out.text("title 'no signal has more (proven bound)'\nunset output\n");
}

}  // namespace emax::desk
