// The straight line through points by ordinary least squares.
#include "emax/uncertainty/trend.hpp"

#include "emax/base/elementary.hpp"

namespace emax {
namespace {

double mean_of(Span<const double> values) noexcept {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

bool all_finite(Span<const double> values) noexcept {
  for (const double value : values) {
    if (!is_finite(value)) {
      return false;
    }
  }
  return true;
}

bool all_equal(Span<const double> values) noexcept {
  for (const double value : values) {
    if (value != values[0]) {
      return false;
    }
  }
  return true;
}

}  // namespace

Trend linear_trend(Span<const double> time_s, Span<const double> energy) noexcept {
  Trend trend;
  if (time_s.size() != energy.size() || !all_finite(time_s) || !all_finite(energy)) {
    trend.status = Status::kInvalidArgument;
    return trend;
  }
  const std::size_t points = time_s.size();
  if (points < 2) {
    trend.status = Status::kTooFewPoints;
    return trend;
  }
  if (all_equal(time_s)) {
    trend.status = Status::kNotIdentifiable;
    return trend;
  }
  const double mean_time = mean_of(time_s);
  const double mean_energy = mean_of(energy);
  double tt = 0.0;
  double te = 0.0;
  double ee = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    const double t = time_s[i] - mean_time;
    const double e = energy[i] - mean_energy;
    tt += t * t;
    te += t * e;
    ee += e * e;
  }
  const double slope = te / tt;
  const double intercept = mean_energy - slope * mean_time;
  if (!is_finite(slope) || !is_finite(intercept) || !is_finite(ee)) {
    trend.status = Status::kInvalidArgument;
    return trend;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    const double residual = (energy[i] - mean_energy) - slope * (time_s[i] - mean_time);
    squares += residual * residual;
  }
  trend.status = Status::kOk;
  trend.points = points;
  trend.slope = slope;
  trend.intercept = intercept;
  if (!all_equal(energy)) {
    const double correlation = te / (sqrt(tt) * sqrt(ee));
    trend.correlation = correlation > 1.0 ? 1.0 : (correlation < -1.0 ? -1.0 : correlation);
  }
  if (points > 2) {
    trend.residual_std = sqrt(squares / static_cast<double>(points - 2));
  }
  return trend;
}

}  // namespace emax
