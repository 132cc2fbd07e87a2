// What the results say of themselves: whose they are, and what they hold for.
#include "emax/app/evaluate/evaluation_results.hpp"

#include "emax/app/evaluate/figure_range.hpp"
#include "emax/base/elementary.hpp"

#include "evaluation_checks.hpp"

namespace emax::app {
namespace {

/// Whether so many bytes are the same.
bool is_same_memory(const void* a, const void* b, std::size_t bytes) noexcept {
  const auto* const first = static_cast<const unsigned char*>(a);
  const auto* const second = static_cast<const unsigned char*>(b);
  bool is_same = true;
  for (std::size_t i = 0; is_same && i < bytes; ++i) {
    is_same = first[i] == second[i];
  }
  return is_same;
}

/// Whether the points are the same, bit for bit, but for phases that nobody knows: a fit puts those
/// of its model in their place.
bool is_same_response(const FrequencyResponse& a, const FrequencyResponse& b) noexcept {
  bool is_same = a.size() == b.size();
  for (std::size_t i = 0; is_same && i < a.size(); ++i) {
    ResponsePoint point = a.points()[i];
    const ResponsePoint& other = b.points()[i];
    point.phase_rad = is_phase_known(point) ? point.phase_rad : other.phase_rad;
    is_same = is_same_memory(&point, &other, sizeof point);
  }
  return is_same;
}

/// Whether two tables of numbers are the same, bit for bit; no type here has gaps.
template <typename T>
bool is_same(Span<const T> a, Span<const T> b) noexcept {
  return a.size() == b.size() && is_same_memory(a.data(), b.data(), a.size() * sizeof(T));
}

}  // namespace

GuardResults results_of(const EnergyGuard& guard) noexcept {
  return {static_cast<std::uint16_t>(guard.searches()),
          static_cast<std::uint16_t>(guard.disagreements()),
          static_cast<float>(guard.largest_excess())};
}

void TrialResults::take(const MonteCarlo& monte_carlo, const MonteCarloStore& store) noexcept {
  static_assert(MonteCarlo::kBins % kHistogramRows == 0);
  constexpr std::size_t kBinsPerRow = MonteCarlo::kBins / kHistogramRows;
  result = monte_carlo.result();
  const Span<const std::uint32_t> bins = monte_carlo.histogram(store);
  for (std::size_t row = 0; row < kHistogramRows; ++row) {
    rows[row] = 0;
    for (std::size_t i = 0; i < kBinsPerRow && !bins.empty(); ++i) {
      rows[row] += bins[row * kBinsPerRow + i];
    }
  }
}

// What has a flag is nothing without it.
void EvaluationResults::clear() noexcept {
  device = {};
  limit_mps2 = 0.0;
  absolute_error_v = 0.0;
  emax::clear(maximum);
  failure = {};
  trace_count = 0;
  source = Source::kPoints;
  stage = Stage::kIdle;
  is_accepted = false;
  has_model = false;
  has_absolute_error = false;
  has_energy = false;
  has_bound = false;
  is_bound_done = false;
  judgement = {};
  has_fit_draws = false;
  ideal = {};
  band_settling = {};
  band.clear();
  matched.clear();
  drop_trials();
  drop_uncertainties();
  drop_trend();
}

CoverageInterval widened(const CoverageInterval& interval, double figure) noexcept {
  return {figure < interval.low ? figure : interval.low,
          figure > interval.high ? figure : interval.high};
}

bool is_one_sided(double figure, double expanded, const CoverageInterval& interval) noexcept {
  const double below = figure - interval.low;
  const double above = interval.high - figure;
  return expanded > 0.0 && interval.high > interval.low &&
         (expanded > figure || 2.0 * below < above || 2.0 * above < below);
}

const char* FigureResults::refusal() const noexcept {
  if (status == Status::kDelayNotResolved && is_short) {
    return "T is too short beside the settling time for so small an error to develop; take a "
           "longer one.";
  }
  // Device and settings are valid, but for a gain of 0.
  return status == Status::kInvalidArgument ? kNoGain : explain(status);
}

void FigureResults::clear() noexcept {
  is_done = false;
  status = Status::kOk;
  has_bound = false;
  is_short = false;
  switches = 0;
  energy_v2s = 0.0;
  rounding_v2s = 0.0;
  bound_v2s = 0.0;
  delay_s = 0.0;
  epsilon_percent = 0.0;
  uncertainty = {};
  is_range_done = false;
  has_range = false;
}

void EvaluationResults::drop_uncertainties() noexcept {
  uncertainty = {};
  band.uncertainty = {};
  matched.uncertainty = {};
}

bool EvaluationResults::has_uncertainties() const noexcept {
  const bool has_band = !band.exists() || band.uncertainty.is_done;
  const bool has_matched = !matched.exists() || matched.uncertainty.is_done;
  return uncertainty.is_done && has_band && has_matched;
}

bool EvaluationResults::has_figure_ranges() const noexcept {
  const bool has_band = !band.exists() || band.is_range_done;
  const bool has_matched = !matched.exists() || matched.is_range_done;
  return !kHasFigureRanges || (has_band && has_matched);
}

void EvaluationResults::drop_trials() noexcept {
  guard = {};
  has_monte_carlo = false;
  has_cut_range = false;
  is_cut_done = false;
}

void EvaluationResults::drop_trend() noexcept {
  trend_count = 0;
  trend_looked_at = 0;
  trend_left_out = 0;
  has_trend = false;
}

bool EvaluationResults::has_uncertainty() const noexcept {
  if (is_damping_open()) {
    return false;
  }
  const ParameterBox& u = device.u;
  return u.sensitivity != 0.0 || u.natural_frequency_hz != 0.0 || u.damping != 0.0;
}

bool EvaluationResults::holds_energy_of(const Settings& wanted) const noexcept {
  return is_accepted && is_same_energy(settings, wanted);
}

bool EvaluationResults::holds(Goal goal, const Settings& wanted) const noexcept {
  if (!has_model || !holds_energy_of(wanted)) {
    return false;
  }
  const bool holds_energy = has_energy && is_bound_done;
  const bool holds_trials = has_monte_carlo && is_same_trials(settings, wanted);
  const bool has_rest_of_trials =
      is_damping_open() ? is_cut_done && has_figure_ranges() : !has_uncertainty();
  const bool holds_trend = has_trend && is_same_trend(settings, wanted);
  const bool holds_draws = has_fit_draws && is_same_random(settings, wanted);
  switch (goal) {
    case Goal::kModel:
      return true;
    case Goal::kEnergy:
      return holds_energy;
    case Goal::kMonteCarlo:
      return holds_energy && holds_trials;
    case Goal::kTrend:
      return holds_energy && holds_trend;
    case Goal::kBand:
      return holds_energy && has_figures();
    case Goal::kUncertainty:
      return holds_energy &&
             (is_damping_open() ? has_cut_range
                                : uncertainty.is_done && is_same_trials(settings, wanted));
    case Goal::kReport:
      return holds_energy && has_figures() &&
             ((holds_trials && has_uncertainties()) || has_rest_of_trials) &&
             (holds_trend || wanted.trend_count == 0) && (holds_draws || source == Source::kModel);
  }
  return false;
}

bool EvaluationResults::is_of(const Device& other) const noexcept {
  return is_accepted && source == Source::kModel && is_same_memory(&device, &other, sizeof device);
}

bool EvaluationResults::is_of(const FrequencyResponse& points) const noexcept {
  const FrequencyResponse& own = fit.response();
  return has_fit() && is_same_response(own, points) && is_same(own.common(), points.common());
}

double EvaluationResults::covariance(std::size_t i, std::size_t j) const noexcept {
  if (source == Source::kPoints) {
    return fit.result().covariance[i][j];
  }
  return given_covariance[i][j];
}

double EvaluationResults::trial_scale(const Settings& wanted) const noexcept {
  const double ratio = source == Source::kPoints ? fit.result().birge_ratio : 1.0;
  return wanted.birge && ratio > 1.0 ? ratio : 1.0;
}

double EvaluationResults::percent_of(double energy) const noexcept {
  constexpr double kPercent = 100.0;
  return kPercent * sqrt(energy / settings.duration_s) / (device.estimate.sensitivity * limit_mps2);
}

CoverageInterval EvaluationResults::interval_percent_of(const CoverageInterval& energies_v2s,
                                                        double energy) const noexcept {
  // A difference of energies may be below 0, and has no root there.
  const double low = energies_v2s.low > 0.0 ? energies_v2s.low : 0.0;
  const double high = energies_v2s.high > 0.0 ? energies_v2s.high : 0.0;
  return widened({percent_of(low), percent_of(high)}, percent_of(energy));
}

bool EvaluationResults::is_one_sided(const EnergyUncertainty& known, double energy) const noexcept {
  if (!known.exists()) {
    return false;
  }
  // Without a U some of the trials have no root.
  return !is_finite(known.u_percent) ||
         app::is_one_sided(percent_of(energy), known.expanded_percent(),
                           interval_percent_of(known.shortest_of_percent(), energy));
}

double EvaluationResults::rms_error_v() const noexcept {
  return sqrt(energy_v2s() / settings.duration_s);
}

}  // namespace emax::app
