// The tables that go beside the report.
#include "emax/app/report/report.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"
#include "emax/model/accelerometer.hpp"

namespace emax::app {
namespace {

constexpr int kTableDigits = 15;
constexpr int kSharedDigits = 12;
constexpr int kLevelDigits = 6;

void write_row(Span<const double> numbers, TextWriter& out) noexcept {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    out.text(i == 0 ? "" : ",").exact(numbers[i]);
  }
  out.line();
}

/// The columns of a table of points, without line feed.
///
/// @param[in] common_u The relative standard uncertainty that the point shares with all others.
void write_point(const ResponsePoint& point, double common_u, TextWriter& out) noexcept {
  // 15 digits give the angles back as they were before they became radians, and a total from which
  // the common part was taken.
  out.exact(point.frequency_hz).text(",").exact(point.amplitude).text(",");
  const bool has_phase = is_phase_known(point);
  if (has_phase) {
    out.general(point.phase_rad * kDegreesPerRadian, kTableDigits);
  }
  out.text(",");
  if (common_u > 0.0) {
    const double common = common_u * point.amplitude;
    const double total = sqrt(point.u_amplitude * point.u_amplitude + common * common);
    out.general(kCoverageFactor * total, kTableDigits).text(",");
  } else {
    out.exact(kCoverageFactor * point.u_amplitude).text(",");
  }
  if (has_phase) {
    out.general(kCoverageFactor * point.u_phase_rad * kDegreesPerRadian, kTableDigits);
  }
}

/// What all points have in common, expanded, in the unit of the amplitude.
void write_common(const ResponsePoint& point, double common_u, TextWriter& out) noexcept {
  out.text(",").general(kCoverageFactor * common_u * point.amplitude, kTableDigits);
}

void write_level(const SweepPoint& point, TextWriter& out) noexcept {
  out.text(",").general(point.acceleration_mps2, kLevelDigits);
}

/// What points share in other ways than by one factor, for whoever reads the table back.
void write_shared(const SharedEffects& shared, TextWriter& out) noexcept {
  const struct {
    const char* name;
    double value;
  } effects[] = {{"skew", shared.skew_s},         {"clock", shared.clock},
                 {"drift", shared.drift},         {"corner", shared.corner_hz},
                 {"images", shared.images},       {"leak", shared.leak},
                 {"leak_back", shared.leak_back}, {"linearity", shared.linearity}};
  // The corner alone is no effect.
  const double sum = shared.skew_s + shared.clock + shared.drift + shared.images + shared.leak +
                     shared.leak_back + shared.linearity;
  if (!(sum > 0.0)) {
    return;
  }
  out.text("# shared:");
  for (const auto& effect : effects) {
    out.text(" ").text(effect.name).text("=").general(effect.value, kSharedDigits);
  }
  out.line();
}

/// Row `row` of `rows` equally spaced ones from 0 to `end`; the last is `end` itself.
double spaced(std::size_t row, std::size_t rows, double end) noexcept {
  return row + 1 == rows ? end : end * (static_cast<double>(row) / static_cast<double>(rows - 1));
}

/// No curve may be a pattern of its rows.
std::size_t signal_rows(const EvaluationResults& results) noexcept {
  constexpr double kRowsPerPeriod = 20.0;
  const double f0_hz = results.device.estimate.natural_frequency_hz;
  const double cutoff_hz = results.settings.cutoff_hz;
  const double periods = (f0_hz > cutoff_hz ? f0_hz : cutoff_hz) * results.settings.duration_s;
  const auto rows = static_cast<std::size_t>(kRowsPerPeriod * periods) + 1;
  return rows > kSignalRows ? rows : kSignalRows;
}

void write_signal_row(const EvaluationResults& results, double time_s, double sign,
                      TextWriter& out) noexcept {
  const double row[] = {time_s, sign * results.limit_mps2, results.output_v(time_s)};
  write_row(row, out);
}

}  // namespace

void write_frequency_response_csv(const EvaluationResults& results, const SweepResults* sweep,
                                  TextWriter& out) noexcept {
  const FrequencyResponse& response = results.fit.response();
  const bool has_points = results.source == Source::kPoints;
  const bool has_common = has_points && response.has_common();
  out.text("f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg,model_amplitude,model_phase_deg,")
      .text("residual_re,residual_im")
      .text(has_common ? ",u_common" : "")
      .text(sweep != nullptr ? ",level_mps2\n" : "\n");
  if (!has_points) {
    return;
  }
  const Accelerometer& model = results.device.estimate;
  const Span<const ResponsePoint> points = response.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ResponsePoint& point = points[i];
    const Complex residual = results.fit.normalised_residual(i);
    write_point(point, response.common()[i], out);
    out.text(",").exact(amplitude(model, point.frequency_hz));
    out.text(",").exact(phase_rad(model, point.frequency_hz) * kDegreesPerRadian);
    out.text(",").exact(residual.re).text(",").exact(residual.im);
    if (has_common) {
      write_common(point, response.common()[i], out);
    }
    if (sweep != nullptr) {
      write_level(sweep->table[i], out);
    }
    out.line();
  }
  write_shared(response.shared(), out);
}

void write_measured_points_csv(const Measurement& measurement, TextWriter& out) noexcept {
  const double common_u = measurement.sweep.common.total;
  out.text("f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg");
  out.text(common_u > 0.0 ? ",u_common" : "").text(",level_mps2\n");
  for (const SweepPoint& point : measurement.sweep.points()) {
    write_point(point.point, common_u, out);
    if (common_u > 0.0) {
      write_common(point.point, common_u, out);
    }
    write_level(point, out);
    out.line();
  }
  write_shared(measurement.sweep.shared, out);
}

void write_impulse_response_csv(const EvaluationResults& results, TextWriter& out) noexcept {
  out.text("t_s,k,ka,kf\n");
  const ModalModel& model = results.model;
  const double duration_s = results.settings.duration_s;
  const double settling_s = results.settling_time.time_s;
  const double end_s = settling_s > duration_s ? settling_s : duration_s;
  for (std::size_t i = 0; i < kResponseRows; ++i) {
    const double time_s = spaced(i, kResponseRows, end_s);
    const double row[] = {time_s, model.impulse_response(time_s),
                          model.device_impulse_response(time_s),
                          model.filter_impulse_response(time_s)};
    write_row(row, out);
  }
}

void write_signal_csv(const EvaluationResults& results, TextWriter& out) noexcept {
  out.text("t_s,x_mps2,y_v\n");
  const Span<const double> switches_s = results.maximum.signal.times_s();
  const double end_s = results.settings.duration_s;
  double sign = 1.0;
  std::size_t next = 0;
  const std::size_t rows = signal_rows(results);
  for (std::size_t i = 0; i < rows; ++i) {
    const double time_s = spaced(i, rows, end_s);
    for (; next < switches_s.size() && switches_s[next] <= time_s; ++next) {
      write_signal_row(results, switches_s[next], sign, out);
      sign = -sign;
      write_signal_row(results, switches_s[next], sign, out);
    }
    // A switch that falls on a row has been written, from both sides.
    if (next == 0 || switches_s[next - 1] != time_s) {
      write_signal_row(results, time_s, sign, out);
    }
  }
}

void write_trend_csv(const EvaluationResults& results, TextWriter& out) noexcept {
  out.text("T_s,E,fit\n");
  const Trend& trend = results.trend;
  for (const TrendPoint& point : results.trend_points()) {
    const double row[] = {point.duration_s, point.energy_v2s,
                          trend.slope * point.duration_s + trend.intercept};
    write_row(row, out);
  }
}

void write_histogram_csv(const EvaluationResults& results, TextWriter& out) noexcept {
  out.text("E_low,E_high,count\n");
  if (!results.has_monte_carlo) {
    return;
  }
  const MonteCarloResult& result = results.trials.result;
  const Span<const std::uint32_t> bins = results.trials.histogram();
  const std::size_t rows = result.maximum > result.minimum ? kHistogramRows : 1;
  const std::size_t bins_per_row = bins.size() / rows;
  const double width = (result.maximum - result.minimum) / static_cast<double>(rows);
  double low = result.minimum;
  for (std::size_t row = 0; row < rows; ++row) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < bins_per_row; ++i) {
      count += bins[row * bins_per_row + i];
    }
    const bool is_last = row + 1 == rows;
    const double high =
        is_last ? result.maximum : result.minimum + static_cast<double>(row + 1) * width;
    out.exact(low).text(",").exact(high).text(",").integer(count).line();
    low = high;
  }
}

}  // namespace emax::app
