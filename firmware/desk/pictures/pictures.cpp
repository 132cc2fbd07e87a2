// The pictures of a report, drawn by gnuplot.
#include "desk/pictures/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report.hpp"
#include "emax/base/units.hpp"
#include "emax/model/accelerometer.hpp"

#include "desk/cli/console.hpp"
#include "desk/pictures/axis_scale.hpp"
#include "desk/pictures/gnuplot.hpp"

namespace emax::desk {

namespace {

using app::EvaluationResults;
using app::kCoverageFactor;
using app::TextWriter;

constexpr std::uint32_t kNameShown = 36;
constexpr double kMilli = 1e3;
constexpr double kPercent = 100.0;
// Rows per period of the fastest oscillation, below which a curve would be a pattern of its rows.
constexpr double kLeastRowsPerPeriod = 20.0;
// Fewer rows make a curve of corners.
constexpr double kLeastRows = 400.0;
constexpr double kPeriodsShown = 50.0;
constexpr int kEnergyDigits = 4;

// Words and numbers as a string.
template <typename Write>
std::string words_of(const Write& write) {
  StringSink sink;
  TextWriter out(sink);
  write(out);
  return sink.text();
}

// As it is printed in books: 5.115 × 10⁻³.
std::string in_print(double value, int digits) {
  constexpr const char* kRaised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  const std::string plain = words_of([&](TextWriter& out) { out.scientific(value, digits - 1); });
  const std::size_t e = plain.find('e');
  const int exponent = e < plain.size() ? std::atoi(plain.c_str() + e + 1) : 0;
  std::string text = plain.substr(0, e);
  if (exponent == 0) {
    return text;
  }
  text += exponent < 0 ? " × 10⁻" : " × 10";
  for (const char digit : std::to_string(std::abs(exponent))) {
    text += kRaised[digit - '0'];
  }
  return text;
}

// Titles

std::string parameters_of(const EvaluationResults& results) {
  const Accelerometer& device = results.device.estimate;
  return words_of([&](TextWriter& out) {
    out.text("S = ").general(device.sensitivity, 5).text(" V/(m/s²), f0 = ");
    out.general(device.natural_frequency_hz, 6).text(" Hz, β = ").general(device.damping, 5);
  });
}

std::string filter_of(const EvaluationResults& results) {
  const ReferenceFilter& filter = results.model.filter();
  return words_of([&](TextWriter& out) {
    out.text("reference filter: Butterworth, order ");
    out.integer(static_cast<std::uint64_t>(filter.relative_degree)).text(", cutoff ");
    out.general(filter.band_hz, 6).text(" Hz, gain ").general(filter.gain, 5);
    out.text(" V/(m/s²)");
  });
}

const char* name_of(Criterion criterion) {
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

std::string conditions_of(const EvaluationResults& results, bool with_time, bool in_g) {
  const app::Settings& settings = results.settings;
  return words_of([&](TextWriter& out) {
    if (with_time) {
      out.text("T = ").general(kMilli * settings.duration_s, 6).text(" ms, ");
    }
    out.text("a = ").general(results.limit_mps2, 5).text(" m/s²");
    if (in_g) {
      out.text(" (").general(results.limit_mps2 / app::kStandardGravity_mps2, 5).text(" g)");
    }
    out.text(", filter of order ");
    out.integer(static_cast<std::uint64_t>(settings.filter_order)).text(", ");
    out.general(settings.cutoff_hz, 6).text(" Hz, ");
    out.text(name_of(settings.criterion));
    out.text(settings.method == Method::kPaper ? ", paper's method" : "");
  });
}

std::string fit_quality_of(const EvaluationResults& results) {
  const WlspFit& fit = results.fit.result();
  return words_of([&](TextWriter& out) {
    out.text("bars: expanded uncertainty (k = 2); χ²/dof = ").general(fit.chi2 / fit.dof, 4);
    out.text(", Birge ratio ").general(fit.birge_ratio, 3);
  });
}

std::string energy_of(const EvaluationResults& results) {
  const double energy = results.energy_v2s();
  return words_of([&](TextWriter& out) {
    out.text("E = ").text(in_print(energy, kEnergyDigits).c_str()).text(" V² s");
    if (energy >= 0.0) {
      const double full = results.device.estimate.sensitivity * results.limit_mps2;
      const bool is_error = results.settings.criterion != Criterion::kEnergyDifference;
      out.text(is_error ? ", rms error " : ", √(E/T) = ")
          .general(results.rms_error_v(), 4)
          .text(" V = ");
      out.general(kPercent * results.rms_error_v() / full, 4).text(" % of S·a");
    }
  });
}

std::string trials_of(const EvaluationResults& results) {
  const MonteCarloResult& result = results.trials.result;
  const bool is_box = results.settings.distribution == Distribution::kBox;
  return words_of([&](TextWriter& out) {
    out.integer(result.trials).text(" trials, S, f0 and β ");
    out.text(is_box ? "uniform within ±u; standard deviation over the box "
                    : "jointly normal; u(E) = ");
    out.text(in_print(result.u, 2).c_str()).text(" V² s");
  });
}

std::string line_of(const EvaluationResults& results) {
  const Trend& trend = results.trend;
  return words_of([&](TextWriter& out) {
    out.text("line: E = ").general(trend.slope, 5).text(" V² · T ");
    out.text(trend.intercept < 0.0 ? "− " : "+ ");
    out.text(in_print(std::abs(trend.intercept), 3).c_str());
    out.text(" V² s, correlation ").fixed(trend.correlation, 6);
  });
}

// A gnuplot expression for a title of several lines, in which no character has a meaning.
std::string title_lines(const std::string& first, const std::string& second,
                        const std::string& third) {
  return gnuplot_string(first) + ".\"\\n\".\\\n  " + gnuplot_string(second) + ".\"\\n\".\\\n  " +
         gnuplot_string(third);
}

// Axes

// The same for units that have prefixes.
Scale prefixed(double largest, const std::string& unit) {
  constexpr const char* kPrefixes[] = {"n", "µ", "m", "", "k"};
  const int thousands = std::clamp(thousands_of(largest), -3, 1);
  return {std::pow(10.0, -3 * thousands), kPrefixes[thousands + 3] + unit};
}

Scale time_scale(double end_s) {
  const Scale scale = prefixed(end_s, "s");
  return scale.factor < 1.0 ? Scale{1.0, "s"} : scale;
}

Scale energy_scale(const EvaluationResults& results) {
  return scaled(results.energy_v2s(), "V² s");
}

// As many decimals as tell the marks of an axis of that length apart.
int decimals_of_axis(double length) {
  constexpr double kMarks = 10.0;
  return std::max(0, static_cast<int>(std::ceil(-std::log10(length / kMarks))));
}

// What each picture starts from, whatever the one before it has set.
void write_start(TextWriter& out, const Picture& picture, int height) {
  out.text(
      "\nreset\nset minussign\nset border lw 1\nset grid lc '#c8c8c8' lw 1 dt (2,3)\n"
      "set xzeroaxis lt 1 lc '#808080' lw 1\nset xlabel offset 0,0.3\nset "
      "pointintervalbox 0\n"
      "set datafile separator ','\n"
      "set style line 1 lc '#000000' lw 2 dt solid\n"
      "set style line 2 lc '#0060b0' lw 2 dt (10,5)\n"
      "set style line 3 lc '#d05000' lw 2.5 dt (2,4)\n"
      "set style line 4 lc '#000000' lw 1.2 pt 7 ps 0.4\n"
      "set style line 5 lc '#d05000' lw 2 pt 8 ps 1.5\n"
      "set style line 6 lc '#000000' lw 1 pt 7 ps 0.9\n"
      "set terminal svg noenhanced font 'sans-serif,15' background '#ffffff' fixed size 900,");
  out.integer(static_cast<std::uint64_t>(height)).text("\nset output ");
  out.text(gnuplot_string(picture.file).c_str()).line();
}

void write_value(TextWriter& out, const char* name, double value) {
  out.text(name).text(" = ").exact(value).line();
}

void write_axis(TextWriter& out, const char* axis, const char* name, const std::string& unit) {
  out.text("set ").text(axis).text("label '").text(name).text(" in ").text(unit.c_str());
  out.text("'\n");
}

// Frequency response

// What the axes of the frequency response have to reach to.
struct ResponseRange {
  double least_amplitude = HUGE_VAL;
  double largest_amplitude = 0.0;
  double amplitude_deviation = 0.0;  // From the fit, relative to it, with U of its own (k = 2).
  double common = 0.0;               // Relative U of what all amplitudes have in common.
  double phase_deviation_rad = 0.0;
};

ResponseRange range_of(const EvaluationResults& results) {
  const Accelerometer& device = results.device.estimate;
  const Span<const double> common = results.fit.response().common();
  const Span<const ResponsePoint> points = results.fit.response().points();
  ResponseRange range;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ResponsePoint& point = points[i];
    const double fitted = amplitude(device, point.frequency_hz);
    const double lag_rad = phase_rad(device, point.frequency_hz);
    range.least_amplitude = std::min({range.least_amplitude, point.amplitude, fitted});
    range.largest_amplitude = std::max({range.largest_amplitude, point.amplitude, fitted});
    range.amplitude_deviation = std::max(
        range.amplitude_deviation,
        (std::abs(point.amplitude - fitted) + kCoverageFactor * point.u_amplitude) / fitted);
    range.common = std::max(range.common, kCoverageFactor * common[i]);
    range.phase_deviation_rad =
        std::max(range.phase_deviation_rad,
                 std::abs(point.phase_rad - lag_rad) + kCoverageFactor * point.u_phase_rad);
  }
  return range;
}

// A large resonance would leave nothing of the rest on a linear axis.
bool spans_much(const ResponseRange& range) {
  constexpr double kMuch = 20.0;
  return range.largest_amplitude > kMuch * range.least_amplitude;
}

// A logarithmic axis, with marks at 1, 2 and 5 where there are not two decades of them.
void write_frequency_axis(const EvaluationResults& results, TextWriter& out) {
  constexpr double kMargin = 1.15;
  const Span<const ResponsePoint> points = results.fit.response().points();
  const double first = points[0].frequency_hz;
  const double last = points[points.size() - 1].frequency_hz;
  out.text("set logscale x\nset xrange [").general(first / kMargin, 4).text(":");
  out.general(last * kMargin, 4).text("]\n");
  if (last < 100.0 * first) {
    const int decades_from = static_cast<int>(std::floor(std::log10(first / kMargin)));
    const int decades_to = static_cast<int>(std::ceil(std::log10(last * kMargin)));
    out.text("set xtics (");
    for (int decade = decades_from; decade <= decades_to; ++decade) {
      for (const double step : {1.0, 2.0, 5.0}) {
        out.text(decade == decades_from && step == 1.0 ? "" : ", ");
        out.exact(step * std::pow(10.0, decade));
      }
    }
    out.text(")\n");
  }
}

// The key of all panels, and what the band of the amplitudes' deviations is.
void write_response_key(double common, TextWriter& out) {
  out.text("set key at screen ").text(common > 0.0 ? "0.26" : "0.5");
  out.text(", screen 0.02 center bottom horizontal Left reverse\n");
  if (common > 0.0) {
    out.text("set label 1 'shaded: common to all amplitudes, U = ").general(kPercent * common, 2);
    out.text(" %' at screen 0.98, screen 0.037 right\n");
  }
}

// How far the amplitudes are from the fit, with the uncertainties of each point's own; what they
// have in common moves all of them alike.
void write_amplitude_deviation(const ResponseRange& range, const Scale& percent, TextWriter& out) {
  constexpr double kMargin = 1.1;
  const bool has_common = range.common > 0.0;
  out.text("own(u, c) = u > c ? sqrt(u*u - c*c) : 0\n");
  const double end = kMargin * kPercent * percent.factor * range.amplitude_deviation;
  out.text("set yrange [").exact(-end).text(":").exact(end).text("]\nplot ");
  if (has_common) {
    out.text("'frequency_response.csv' skip 1 using 1:(-$10/$2*percent):($10/$2*percent) \\\n");
    out.text("  with filledcurves fs solid noborder lc '#d8e4f0' title 'common part', \\\n  ");
  }
  const char* const own = has_common ? "own($4, $10)" : "$4";
  out.text("'frequency_response.csv' skip 1 using 1:(deviation($1, $2 - ").text(own);
  out.text(")):(0):\\\n  (2*").text(own).text("/amplitude($1)*percent) ");
  out.text("with vectors as 1 title 'U of the point', \\\n");
  out.text("  '' skip 1 using 1:(deviation($1, $2)) with points ls 4 title 'measured', \\\n");
  out.text("  0 ls 2 title 'fit'\nset yrange [*:*]\n");
}

void write_frequency_response(const Picture& picture, const EvaluationResults& results,
                              TextWriter& out) {
  const Accelerometer& device = results.device.estimate;
  constexpr double kPlain = 0.01;
  // Numbers such as 0.0107 leave no room for the name of the axis.
  constexpr double kWithoutWideTicks = 0.1;
  const ResponseRange range = range_of(results);
  const bool is_logarithmic = spans_much(range);
  const Scale response = is_logarithmic
                             ? Scale{1.0, "V/(m/s²)"}
                             : scaled(range.largest_amplitude, "V/(m/s²)", kWithoutWideTicks);
  const Scale percent = scaled(kPercent * range.amplitude_deviation, "%", kPlain);
  const Scale degrees = scaled(kDegreesPerRadian * range.phase_deviation_rad, "°", kPlain);
  write_start(out, picture, 670);
  write_value(out, "S", device.sensitivity);
  write_value(out, "f0", device.natural_frequency_hz);
  write_value(out, "beta", device.damping);
  out.text("amplitude(f) = S/sqrt((1 - (f/f0)**2)**2 + (2*beta*f/f0)**2)\n");
  out.text("phase(f) = -atan2(2*beta*f/f0, 1 - (f/f0)**2)*180/pi\n");
  out.text("set multiplot layout 2,2 columnsfirst margins 0.12,0.98,0.15,0.84 spacing 0.12,0.05 ")
      .text("title ");
  const std::string title =
      title_lines(picture.title, parameters_of(results), fit_quality_of(results));
  out.text(title.c_str()).line();
  write_frequency_axis(results, out);
  write_value(out, "As", response.factor);
  write_value(out, "percent", kPercent * percent.factor);
  write_value(out, "degrees", degrees.factor);
  out.text("deviation(f, a) = (a/amplitude(f) - 1)*percent\n");
  out.text("turn(f, p) = (p - phase(f))*degrees\n");
  // Not by yerrorbars, which blank out what is around their points: short bars would be gone.
  out.text(
      "set style arrow 1 heads size screen 0.0015,90 fixed lc '#404040' lw 0.6\nset samples 400\n");
  write_response_key(range.common, out);
  out.text(is_logarithmic ? "set logscale y\nset format x ''\n" : "set format x ''\n");
  write_axis(out, "y", "amplitude", response.unit);
  out.text(
      "plot 'frequency_response.csv' skip 1 using 1:(($2 - $4)*As):(0):(2*$4*As) with vectors "
      "as 1 notitle, \\\n"
      "  '' skip 1 using 1:($2*As) with points ls 4 title 'measured', \\\n");
  out.text(
      "  amplitude(x)*As ls 2 title 'fit'\n"
      "unset label\n"
      "unset logscale y\nunset key\nset format x '%g'\nset xlabel 'frequency in Hz'\n"
      "set ylabel 'phase in °'\n"
      "plot 'frequency_response.csv' skip 1 using 1:($3 - $5):(0):(2*$5) with vectors as 1 \\\n"
      "  title 'U of the point', '' skip 1 using 1:3 with points ls 4 title 'measured', \\\n"
      "  phase(x) ls 2 title 'fit'\n"
      "set format x ''\nset xlabel ''\nset samples 2\n");
  write_axis(out, "y", "measured − fit", percent.unit);
  write_amplitude_deviation(range, percent, out);
  out.text("set format x '%g'\nset xlabel 'frequency in Hz'\n");
  write_axis(out, "y", "measured − fit", degrees.unit);
  out.text(
      "plot 'frequency_response.csv' skip 1 using 1:(turn($1, $3 - $5)):(0):(2*$5*degrees) \\\n"
      "  with vectors as 1 title 'U of the point', \\\n"
      "  '' skip 1 using 1:(turn($1, $3)) with points ls 4 title 'measured', 0 ls 2 title 'fit'\n"
      "unset multiplot\n");
}

// Impulse response

double end_of_table_s(const EvaluationResults& results) {
  return std::max(results.settling_time.time_s, results.settings.duration_s);
}

double fastest_hz(const EvaluationResults& results) {
  return std::max(results.device.estimate.natural_frequency_hz, results.model.filter().band_hz);
}

// Of the time after the device has settled only a part is shown.
double shown_s(const EvaluationResults& results) {
  constexpr double kBeyondSettling = 1.5;
  const SettlingTime& settling = results.settling_time;
  const double end_s = end_of_table_s(results);
  return settling.found ? std::min(end_s, kBeyondSettling * settling.time_s) : end_s;
}

double end_of_picture_s(const EvaluationResults& results) {
  const double end_s = shown_s(results);
  return has_start_table(results) ? std::min(end_s, kPeriodsShown / fastest_hz(results)) : end_s;
}

bool is_in_band(const EvaluationResults& results) {
  return results.settings.criterion == Criterion::kInBandError;
}

void write_impulse_response(const Picture& picture, const EvaluationResults& results,
                            TextWriter& out) {
  const double end_s = end_of_picture_s(results);
  const Scale time = time_scale(end_s);
  const Scale response = scaled(results.peak.value, "V/(m/s)");
  const SettlingTime& settling = results.settling_time;
  const std::string table =
      gnuplot_string(has_start_table(results) ? kStartTable : "impulse_response.csv");
  write_start(out, picture, 500);
  const std::string title = title_lines(picture.title, parameters_of(results), filter_of(results));
  out.text("set title ").text(title.c_str()).line();
  write_axis(out, "x", "time", time.unit);
  write_axis(out, "y", "response", response.unit);
  write_value(out, "ts", time.factor);
  write_value(out, "ks", response.factor);
  out.text("set xrange [0:").exact(time.factor * end_s);
  out.text("]\nset bmargin 4.9\nset key bmargin center horizontal Left reverse\n");
  if (settling.found && settling.time_s <= end_s) {
    out.text("set arrow 1 from ").exact(time.factor * settling.time_s);
    out.text(", graph 0 rto graph 0, graph 1 nohead lc '#606060' dt (6,4)\nset label 1 ");
    // On the side where there is room.
    const bool is_right = settling.time_s > 0.5 * end_s;
    out.text("'settled to 5 %' at ").exact(time.factor * settling.time_s);
    out.text(is_right ? ", graph 0.06 right offset -1,0\n" : ", graph 0.06 left offset 1,0\n");
  }
  out.text("plot ").text(table.c_str());
  if (is_in_band(results)) {  // Small beside the two.
    out.text(" skip 1 using ($1*ts):($2*ks) with lines ls 1 title 'k of the in-band error'\n");
    return;
  }
  out.text(" skip 1 using ($1*ts):($2*ks) with lines ls 1 title 'k = ka − kf', \\\n");
  out.text("  '' skip 1 using ($1*ts):($3*ks) with lines ls 2 title 'sensor, ka', \\\n");
  out.text("  '' skip 1 using ($1*ts):($4*ks) with lines ls 3 title 'filter, kf'\n");
}

// Signal

void write_signal(const Picture& picture, const EvaluationResults& results, TextWriter& out) {
  const double end_s = results.settings.duration_s;
  const double limit = results.limit_mps2;
  const Scale time = time_scale(end_s);
  const double full_v = results.device.estimate.sensitivity * limit;
  const Scale error = prefixed(results.has_absolute_error ? results.absolute_error_v : full_v, "V");
  const Scale acceleration = scaled(limit, "m/s²");
  const double shown_limit = acceleration.factor * limit;
  write_start(out, picture, 560);
  const std::string title =
      title_lines(picture.title, energy_of(results), conditions_of(results, true, picture.in_g));
  out.text("set multiplot title ").text(title.c_str()).line();
  write_value(out, "ts", time.factor);
  write_value(out, "ys", error.factor);
  out.text("set xrange [0:").exact(time.factor * end_s).text("]\nunset key\n");
  out.text("set lmargin at screen 0.12\nset rmargin at screen 0.97\n");
  out.text("set tmargin at screen 0.83\nset bmargin at screen 0.64\nset format x ''\n");
  write_value(out, "xs", acceleration.factor);
  out.text("set yrange [").exact(-1.3 * shown_limit).text(":").exact(1.3 * shown_limit);
  out.text("]\nset ytics ('−").general(shown_limit, 4).text("' ").exact(-shown_limit);
  out.text(", '0' 0, '").general(shown_limit, 4).text("' ").exact(shown_limit).text(")\n");
  write_axis(out, "y", "x", acceleration.unit);
  out.text("plot 'signal.csv' skip 1 using ($1*ts):($2*xs) with lines ls 1 title 'x'\n");
  out.text("set tmargin at screen 0.6\nset bmargin at screen 0.13\n");
  out.text("set format x '%g'\nset ytics autofreq\nset yrange [*:*]\n");
  write_axis(out, "x", "time", time.unit);
  write_axis(out, "y", "error y", error.unit);
  out.text("plot 'signal.csv' skip 1 using ($1*ts):($3*ys) with lines ls 1 title 'y'\n");
  out.text("unset multiplot\n");
}

// Histogram

// An energy of the axis: of large numbers that differ by little, the difference to E counts.
struct EnergyAxis {
  Scale scale;
  double origin;
  double low;  // Of the axis, in its unit.
  double high;
};

EnergyAxis histogram_axis(const EvaluationResults& results) {
  constexpr double kMargin = 0.04;
  constexpr int kMostDecimals = 5;
  const MonteCarloResult& result = results.trials.result;
  const double energy = results.energy_v2s();
  const double least = std::min(result.minimum, energy);
  const double most = std::max(result.maximum, energy);
  const double margin = kMargin * (most - least);
  Scale scale = energy_scale(results);
  double origin = 0.0;
  if (decimals_of_axis(scale.factor * (most - least)) > kMostDecimals) {
    origin = energy;
    scale = scaled(std::max(most - energy, energy - least), "V² s");
  }
  return {scale, origin, scale.factor * (least - margin - origin),
          scale.factor * (most + margin - origin)};
}

void write_mark(TextWriter& out, const char* position, const char* style) {
  out.text("set arrow from ").text(position).text(", graph 0 rto graph 0, graph 1 nohead front ");
  out.text(style).line();
}

void write_histogram(const Picture& picture, const EvaluationResults& results, TextWriter& out) {
  const MonteCarloResult& result = results.trials.result;
  const EnergyAxis axis = histogram_axis(results);
  write_start(out, picture, 480);
  const std::string title =
      title_lines(picture.title, trials_of(results), conditions_of(results, true, picture.in_g));
  out.text("set title ").text(title.c_str()).line();
  write_value(out, "Es", axis.scale.factor);
  write_value(out, "origin", axis.origin);
  write_value(out, "low", axis.scale.factor * (result.symmetric.low - axis.origin));
  write_value(out, "high", axis.scale.factor * (result.symmetric.high - axis.origin));
  write_value(out, "E", axis.scale.factor * (results.energy_v2s() - axis.origin));
  out.text("middle(a, b) = ((a + b)/2 - origin)*Es\n");
  out.text("inside(a, b) = middle(a, b) > low && middle(a, b) < high\n");
  write_axis(out, "x", axis.origin == 0.0 ? "E" : "E minus E at the estimates", axis.scale.unit);
  out.text("set ylabel 'trials per bin'\nset format x '%.");
  out.integer(static_cast<std::uint64_t>(decimals_of_axis(axis.high - axis.low))).text("f'\n");
  out.text("set xrange [").exact(axis.low).text(":").exact(axis.high).text("]\n");
  out.text("set yrange [0:*]\nset bmargin 4.9\nset key bmargin center horizontal Left reverse\n");
  write_mark(out, "low", "ls 2");
  write_mark(out, "high", "ls 2");
  write_mark(out, "E", "ls 1");
  out.text("plot 'histogram.csv' skip 1 using (middle($1, $2)):3:(($2 - $1)*Es) \\\n");
  out.text("  with boxes fs solid border lc '#808080' lc '#dcdcdc' notitle, \\\n");
  out.text("  '' skip 1 using (middle($1, $2)):(inside($1, $2) ? $3 : NaN):(($2 - $1)*Es) \\\n");
  out.text("  with boxes fs solid border lc '#606060' lc '#a0a0a0' notitle, \\\n");
  out.text("  keyentry with lines ls 1 title 'E at the estimates', \\\n");
  out.text("  keyentry with lines ls 2 title '");
  const bool is_box = results.settings.distribution == Distribution::kBox;
  out.general(kPercent * result.probability, 6);
  out.text(is_box ? " % of the trials over the box'\n" : " % coverage interval'\n");
}

// Trend

void write_trend(const Picture& picture, const EvaluationResults& results, TextWriter& out) {
  const Span<const app::TrendPoint> points = results.trend_points();
  const double duration_s = results.settings.duration_s;
  const double last_s = std::max(points[points.size() - 1].duration_s, duration_s);
  const Scale time = time_scale(last_s);
  const Scale energy = scaled(points[points.size() - 1].energy_v2s, "V² s");
  write_start(out, picture, 480);
  const std::string title =
      title_lines(picture.title, line_of(results), conditions_of(results, false, picture.in_g));
  out.text("set title ").text(title.c_str()).line();
  write_value(out, "ts", time.factor);
  write_value(out, "Es", energy.factor);
  write_axis(out, "x", "length T of the signal", time.unit);
  write_axis(out, "y", "E", energy.unit);
  out.text("set xrange [0:").exact(1.05 * time.factor * last_s).text("]\n");
  out.text("set yrange [*<0:0<*]\nset offsets 0, 0, graph 0.1, 0\n");
  // Where the line does not go.
  out.text(results.trend.slope < 0.0 ? "set key top right" : "set key top left");
  out.text(" Left reverse\n");
  // Of the report's own T, which need not be among those of the trend.
  out.text("$report << END\n").exact(duration_s).text(",").exact(results.energy_v2s());
  out.text(",");
  if (results.has_bound) {
    out.exact(results.bound_v2s);
  }
  out.text("\nEND\n");
  out.text("plot 'trend.csv' skip 1 using ($1*ts):($3*Es) with lines ls 2 ");
  out.text("title 'straight line', \\\n");
  out.text("  $report using ($1*ts):($2*Es) with points ls 6 notitle, \\\n");
  if (results.has_bound) {
    out.text("  $report using ($1*ts):($3*Es) with points ls 5 ");
    out.text("title 'proven: no signal has more', \\\n");
  }
  out.text("  'trend.csv' skip 1 using ($1*ts):($2*Es) with points ls 6 ");
  out.text("title 'largest energy found'\n");
}

// The pictures

struct Kind {
  const char* file;
  app::ReportSection section;
  const char* title;
  const char* caption;
  const char* caption_in_band;  // Null where it is the same.
  bool (*exists)(const EvaluationResults& results);
  void (*write)(const Picture& picture, const EvaluationResults& results, TextWriter& out);
};

bool always(const EvaluationResults& /*results*/) { return true; }

bool has_points(const EvaluationResults& results) { return results.source == app::Source::kPoints; }

bool has_histogram(const EvaluationResults& results) {
  return results.has_monte_carlo && results.trials.result.maximum > results.trials.result.minimum;
}

bool has_trend(const EvaluationResults& results) { return !results.trend_points().empty(); }

constexpr Kind kKinds[] = {
    {kPictureFiles[0], app::ReportSection::kFit, "frequency response",
     "Left: the measured points and the fitted model. Right: how far the points are from the "
     "model, with the uncertainties of each point's own (k = 2); shaded, what all amplitudes have "
     "in common, which moves them alike. With a good fit most bars cross the dashed line and what "
     "remains has no shape. A bow, a step or a resonance there is what the model does not know of, "
     "or "
     "an effect that points share: stated clock, crosstalk and linearity can bend it, and no bar "
     "holds them.",
     nullptr, has_points, write_frequency_response},
    {kPictureFiles[1], app::ReportSection::kErrorSystem, "impulse responses",
     "The error system k is the sensor's response less that of the reference filter. From where "
     "it has settled on, k adds little to what an error can reach; E still grows with T.",
     "The error system k: what the filter passes of the sensor's response less that of an ideal "
     "sensor. From where it has settled on, k adds little to what an error can reach; E still "
     "grows "
     "with T.",
     always, write_impulse_response},
    {kPictureFiles[2], app::ReportSection::kEnergy, "the worst signal found",
     "Above: the signal within ±a with the largest E that was found; it only ever switches between "
     "the limits. Below: its error, the sensor's output less that of the reference filter.",
     "Above: the signal within ±a with the largest E that was found; it only ever switches between "
     "the limits. Below: its error, what the filter passes of the sensor's output less G x.",
     always, write_signal},
    {kPictureFiles[3], app::ReportSection::kMonteCarlo, "energy within the uncertainties",
     "How often the Monte Carlo trials of the paper came to which energy; the dark part holds the "
     "stated share of them. With S, f0 and β uniform within ±u this is no coverage interval of E, "
     "and its width is not the standard uncertainty of E: these are under Uncertainty of E.",
     nullptr, has_histogram, write_histogram},
    {kPictureFiles[4], app::ReportSection::kTrend, "energy over the length of the signal",
     "The largest energy for signals of different lengths, and the straight line through them. "
     "At the estimates the triangle is above every signal of any shape of its length.",
     nullptr, has_trend, write_trend},
};

std::string name_of_device(const app::Labels& labels) {
  return words_of([&](TextWriter& out) {
    out.one_line(labels.device != nullptr ? labels.device : "Accelerometer", kNameShown);
  });
}

}  // namespace

std::vector<Picture> pictures_of(const EvaluationResults& results,
                                 const app::ReportContext& context) {
  std::vector<Picture> pictures;
  const std::string name = name_of_device(context.labels);
  const std::string mark = is_simulated(context) ? "SIMULATION: " : "";
  for (const Kind& kind : kKinds) {
    if (kind.exists(results)) {
      const bool has_own = is_in_band(results) && kind.caption_in_band != nullptr;
      pictures.push_back({kind.file, kind.section, mark + name + ": " + kind.title,
                          has_own ? kind.caption_in_band : kind.caption, context.in_g});
    }
  }
  return pictures;
}

void write_picture_script(const std::vector<Picture>& pictures, const EvaluationResults& results,
                          TextWriter& out) {
  out.text("# Draws the pictures of a report from the tables beside it: gnuplot ");
  out.text(kPictureScript).line();
  out.text("set encoding utf8\n");
  for (const Picture& picture : pictures) {
    for (const Kind& kind : kKinds) {
      if (std::string_view(kind.file) == picture.file) {
        kind.write(picture, results, out);
      }
    }
  }
  out.text("\nunset output\n");
}

bool has_start_table(const EvaluationResults& results) {
  const double row_s = end_of_table_s(results) / static_cast<double>(app::kResponseRows - 1);
  return row_s * fastest_hz(results) * kLeastRowsPerPeriod > 1.0 ||
         row_s * kLeastRows > shown_s(results);
}

void write_start_table(const EvaluationResults& results, TextWriter& out) {
  out.text("t_s,k,ka,kf\n");
  const ModalModel& model = results.model;
  const double end_s = end_of_picture_s(results);
  for (std::size_t row = 0; row < app::kResponseRows; ++row) {
    const double time_s =
        end_s * (static_cast<double>(row) / static_cast<double>(app::kResponseRows - 1));
    out.exact(time_s).text(",").exact(model.impulse_response(time_s)).text(",");
    out.exact(model.device_impulse_response(time_s)).text(",");
    out.exact(model.filter_impulse_response(time_s)).line();
  }
}

}  // namespace emax::desk
