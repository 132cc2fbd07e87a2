// What the job starts from, what it may go on with, and what comes of it.
#include "emax/app/evaluate/evaluation.hpp"

#include <algorithm>

#include "emax/app/report/report.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

// Beyond these a^2 E would leave the range in which its squares are finite.
constexpr double kMinSensitivity = 1e-30;
constexpr double kMaxSensitivity = 1e30;

constexpr char kWrongSetting[] =
    "A setting is outside its range; give a value inside the stated range.";
constexpr char kWrongSensitivity[] =
    "The sensitivity is outside 1e-30 to 1e30 V/(m/s^2); check its unit.";
constexpr char kWrongDevice[] =
    "The sensitivity must be above 0, the natural frequency from 1e-3 to 1e9 Hz and the damping "
    "from 1e-4 to below 1; check the parameters and their units.";
constexpr char kWrongUncertainty[] = "An uncertainty is below 0 or not a number; give 0 or more.";
constexpr char kBoxTooLarge[] =
    "The ranges of the parameters, estimate minus to plus standard uncertainty, leave what a "
    "device may be (S and f0 above 0, damping from 1e-4 to below 1); give smaller uncertainties.";
constexpr char kNormalTooWide[] =
    "Six standard deviations from the estimate leave what a device may be (S and f0 above 0, "
    "damping from 1e-4 to below 1), or the covariance is none; give smaller uncertainties.";
constexpr char kOverdamped[] =
    "The damping is 1 or more; devices with a resonance are supported, with a damping from 1e-4 to "
    "below 1, because fit and grid follow the resonance.";
constexpr char kOnlySensitivity[] =
    "The points determine the sensitivity alone: they lie so far below the resonance that f0 and "
    "the damping may be anything; measure nearer to it.";
constexpr char kTooManyCellsBest[] =
    "The grid of 12 cells per period of the resonance (or of the cutoff, if that is higher) needs "
    "more than " EMAX_TEXT_OF(EMAX_MAX_CELLS) " cells for this time; shorten it.";
constexpr char kTooManyCellsPaper[] =
    "The grid of the paper's step needs more than " EMAX_TEXT_OF(EMAX_MAX_CELLS) " cells for this time; shorten it or take a "
    "longer step.";
constexpr char kTooManyCellsTrials[] =
    "The trials of the paper's method have no room for so many cells; shorten the time, take a "
    "longer step, or give no uncertainties.";
constexpr char kTooManySwitches[] =
    "The best signal changes sign more than " EMAX_TEXT_OF(EMAX_MAX_SWITCHES) " times, more than the table holds; shorten the "
    "time.";
constexpr char kNoDevice[] =
    "There is no accepted device to go on with; start with points or parameters.";
constexpr char kOtherSettings[] =
    "A setting of the energy itself has changed; start again for a new energy.";
/// Whether all parameters moved by `side` times their uncertainties are still a device.
bool is_side_valid(const Device& device, double side) noexcept {
  const Accelerometer end = {
      device.estimate.sensitivity + side * device.u.sensitivity,
      device.estimate.natural_frequency_hz + side * device.u.natural_frequency_hz,
      device.estimate.damping + side * device.u.damping};
  return validate(end) == Status::kOk;
}

bool has_trials(Goal goal) noexcept { return goal == Goal::kMonteCarlo || goal == Goal::kReport; }
bool has_trend(Goal goal) noexcept { return goal == Goal::kTrend || goal == Goal::kReport; }

/// Whether the random numbers are the same ones.
bool is_same_generator(const Settings& a, const Settings& b) noexcept {
  return a.generator == b.generator && a.seed == b.seed;
}

bool is_same_trials(const Settings& a, const Settings& b) noexcept {
  return is_same_generator(a, b) && a.adaptive == b.adaptive &&
         (a.adaptive || a.trials == b.trials) && a.probability == b.probability &&
         a.distribution == b.distribution && a.birge == b.birge;
}

bool is_same_trend(const Settings& a, const Settings& b) noexcept {
  return a.trend_count == b.trend_count &&
         std::equal(a.trend_s.begin(), a.trend_s.begin() + a.trend_count, b.trend_s.begin());
}

/// Whether model, limit and energy are the same.
bool is_same_energy(const Settings& a, const Settings& b) noexcept {
  const bool is_fixed_gain = a.gain_mode == GainMode::kFixed;
  const bool is_paper = a.method == Method::kPaper;
  return a.filter_order == b.filter_order && a.cutoff_hz == b.cutoff_hz &&
         a.gain_mode == b.gain_mode && (!is_fixed_gain || a.gain == b.gain) &&
         a.duration_s == b.duration_s && a.limit_is_auto == b.limit_is_auto &&
         (a.limit_is_auto || a.limit_mps2 == b.limit_mps2) && a.criterion == b.criterion &&
         a.method == b.method &&
         (!is_paper || (a.step_s == b.step_s && a.iterations == b.iterations));
}

// False for a value that is not a number, too.
bool is_uncertainty(double u) noexcept { return u >= 0.0 && is_finite(u); }

}  // namespace

const char* name_of(Stage stage) noexcept {
  switch (stage) {
    case Stage::kIdle:
      return "idle";
    case Stage::kModel:
      return "response";
    case Stage::kFitDraws:
      return "fit";
    case Stage::kEnergy:
      return "energy";
    case Stage::kBound:
      return "bound";
    case Stage::kPrediction:
      return "prediction";
    case Stage::kAdaptive:
      return "number of trials";
    case Stage::kMonteCarlo:
      return "Monte Carlo";
    case Stage::kGuard:
      return "guard";
    case Stage::kTrend:
      return "trend";
    case Stage::kDone:
      return "done";
    case Stage::kFailed:
      return "failed";
  }
  return "unknown";
}

void TrialResults::take(const MonteCarlo& monte_carlo, const MonteCarloStore& store) noexcept {
  static_assert(kRows == kHistogramRows && MonteCarlo::kBins % kRows == 0);
  constexpr std::size_t kBinsPerRow = MonteCarlo::kBins / kRows;
  result_ = monte_carlo.result();
  const Span<const std::uint32_t> bins = monte_carlo.histogram(store);
  for (std::size_t row = 0; row < kRows; ++row) {
    rows_[row] = 0;
    for (std::size_t i = 0; i < kBinsPerRow && !bins.empty(); ++i) {
      rows_[row] += bins[row * kBinsPerRow + i];
    }
  }
}

Status Evaluation::start_from_points(const FrequencyResponse& points, const Settings& settings,
                                     EvaluationWorkspace& workspace, Goal goal) noexcept {
  source_ = Source::kPoints;
  const Status status = begin(settings, goal);
  if (status != Status::kOk) {
    return status;
  }
  const Status fit_status = take_fit(fit_.fit(points));
  return fit_status == Status::kOk ? prepare(workspace) : fit_status;
}

/// The device by what the points determine.
Status Evaluation::take_fit(Status fit_status) noexcept {
  const WlspFit& fit = fit_.result();
  judgement_ = judge(fit);
  if (judgement_.determined == Determined::kSensitivity) {
    return fail(Status::kNotIdentifiable, Stage::kFitDraws, kOnlySensitivity);
  }
  if (judgement_.determined == Determined::kAllButDamping) {
    device_.estimate = judgement_.device;
    device_.u = {judgement_.u_sensitivity, judgement_.u_natural_frequency_hz, 0.0};
    return Status::kOk;
  }
  if (fit_status != Status::kOk) {
    return fail(fit_status, Stage::kFitDraws,
                fit_status == Status::kOverdamped ? kOverdamped : explain(fit_status));
  }
  device_.estimate = fit.model;
  device_.u = {fit.u_sensitivity, fit.u_natural_frequency_hz, fit.u_damping};
  return Status::kOk;
}

Status Evaluation::start_from_model(const Device& device, const Settings& settings,
                                    EvaluationWorkspace& workspace, Goal goal) noexcept {
  source_ = Source::kModel;
  const Status status = begin(settings, goal);
  if (status != Status::kOk) {
    return status;
  }
  device_ = device;
  return prepare(workspace);
}

Status Evaluation::begin(const Settings& settings, Goal goal) noexcept {
  stage_ = Stage::kIdle;
  failure_ = {};
  settings_ = settings;
  goal_ = goal;
  device_ = {};
  judgement_ = {};
  peak_ = {};
  settling_ = {};
  has_absolute_error_ = false;
  absolute_error_ = 0.0;
  clear(maximum_);
  trace_count_ = 0;
  limit_mps2_ = 0.0;
  is_accepted_ = false;
  has_model_ = false;
  has_energy_ = false;
  has_bound_ = false;
  is_bound_done_ = false;
  drop_fit_draws();
  drop_trials();
  drop_trend();
  if (check(settings).setting != nullptr) {
    return fail(Status::kInvalidArgument, Stage::kIdle, kWrongSetting);
  }
  return Status::kOk;
}

void Evaluation::drop_fit_draws() noexcept {
  draws_ = {};
  has_fit_draws_ = false;
}

void Evaluation::drop_trials() noexcept {
  guard_ = {};
  trial_runs_ = false;
  adaptive_result_ = {};
  device_at_maximum_ = {};
  stored_ = 0;
  has_cut_range_ = false;
  is_cut_done_ = false;
  cut_low_ = 0.0;
  cut_high_ = 0.0;
  has_monte_carlo_ = false;
}

void Evaluation::drop_trend() noexcept {
  trend_ = {};
  trend_done_ = 0;
  trend_search_runs_ = false;
  has_trend_ = false;
}

Status Evaluation::prepare(EvaluationWorkspace& workspace) noexcept {
  const Accelerometer& estimate = device_.estimate;
  const Status device_status = validate(estimate);
  if (device_status != Status::kOk) {
    return fail(device_status, Stage::kIdle,
                device_status == Status::kOverdamped ? kOverdamped : kWrongDevice);
  }
  if (estimate.sensitivity < kMinSensitivity || estimate.sensitivity > kMaxSensitivity) {
    return fail(Status::kInvalidArgument, Stage::kIdle, kWrongSensitivity);
  }
  limit_mps2_ = settings_.limit_is_auto ? estimate.sensitivity : settings_.limit_mps2;
  const bool gain_is_given = settings_.gain_mode == GainMode::kFixed;
  const Butterworth filter = {settings_.filter_order, settings_.cutoff_hz,
                              gain_is_given ? settings_.gain : estimate.sensitivity};
  const Status status = model_.set(estimate, filter, settings_.criterion);
  if (status != Status::kOk) {
    return fail(status, Stage::kIdle, explain(status));
  }
  const Failure failure = check_goal(settings_, goal_);
  if (failure.status != Status::kOk) {
    return fail(failure.status, failure.stage, failure.reason, failure.duration_s);
  }
  is_accepted_ = true;
  go_on(workspace);
  return failure_.status;
}

Status Evaluation::pursue(const Settings& settings, Goal goal,
                          EvaluationWorkspace& workspace) noexcept {
  if (!is_accepted_) {
    failure_ = {Status::kInvalidArgument, Stage::kIdle, kNoDevice};
    return failure_.status;
  }
  if (check(settings).setting != nullptr || !is_same_energy(settings, settings_)) {
    const bool is_wrong = check(settings).setting != nullptr;
    failure_ = {Status::kInvalidArgument, Stage::kIdle, is_wrong ? kWrongSetting : kOtherSettings};
    return failure_.status;
  }
  failure_ = check_goal(settings, goal);
  if (failure_.status != Status::kOk) {
    return failure_.status;
  }
  drop_incomplete();
  if (!is_same_generator(settings, settings_)) {
    drop_fit_draws();
  }
  if (!is_same_trials(settings, settings_)) {
    drop_trials();
  }
  if (!is_same_trend(settings, settings_)) {
    drop_trend();
  }
  settings_ = settings;
  goal_ = goal;
  go_on(workspace);
  return failure_.status;
}

void Evaluation::stop() noexcept {
  if (stage_ == Stage::kIdle || stage_ == Stage::kFailed) {
    return;
  }
  drop_incomplete();
  stage_ = Stage::kDone;
  progress_ = 1.0;
}

void Evaluation::drop_incomplete() noexcept {
  if (!has_fit_draws_) {
    drop_fit_draws();
  }
  if (!has_monte_carlo_ && !is_cut_done_) {
    drop_trials();
  }
  if (!has_trend_) {
    drop_trend();
  }
}

/// What would stop this goal later on, as far as it can be seen before.
Failure Evaluation::check_goal(const Settings& settings, Goal goal) const noexcept {
  const Failure failure = check_box(settings, goal);
  if (failure.status != Status::kOk || goal == Goal::kModel) {
    return failure;
  }
  const Status status = check_grid(settings, settings.duration_s);
  if (status != Status::kOk) {
    return search_failure(status, Stage::kEnergy, settings.duration_s);
  }
  if (has_trials(goal) && settings.method == Method::kPaper && has_uncertainty() &&
      search_cells(model_, search_settings(settings, settings.duration_s)) >
          GridWorkspace::kMaxTrialCells) {
    return {Status::kTooManyCells, Stage::kMonteCarlo, kTooManyCellsTrials, settings.duration_s};
  }
  for (std::size_t i = 0; i < settings.trend_count && app::has_trend(goal); ++i) {
    const Status trend_status = check_grid(settings, settings.trend_s[i]);
    if (trend_status != Status::kOk) {
      return search_failure(trend_status, Stage::kTrend, settings.trend_s[i]);
    }
  }
  return {};
}

Failure Evaluation::check_box(const Settings& settings, Goal goal) const noexcept {
  const ParameterBox& u = device_.u;
  if (!is_uncertainty(u.sensitivity) || !is_uncertainty(u.natural_frequency_hz) ||
      !is_uncertainty(u.damping)) {
    return {Status::kInvalidArgument, Stage::kIdle, kWrongUncertainty};
  }
  const bool is_box = settings.distribution == Distribution::kBox;
  const double widest = trial_scale(settings) * (is_box ? 1.0 : EnergyTrials::kMaxDeviations);
  if (has_trials(goal) && (!is_side_valid(device_, -widest) || !is_side_valid(device_, widest))) {
    return {Status::kInvalidArgument, Stage::kMonteCarlo, width_reason(settings.distribution)};
  }
  return {};
}

/// Why trials of this distribution cannot be made.
const char* Evaluation::width_reason(Distribution distribution) noexcept {
  return distribution == Distribution::kBox ? kBoxTooLarge : kNormalTooWide;
}

Status Evaluation::check_grid(const Settings& settings, double duration_s) const noexcept {
  return search_cells(model_, search_settings(settings, duration_s)) > kMaxCells
             ? Status::kTooManyCells
             : Status::kOk;
}

/// Begins the first part that the goal still lacks.
void Evaluation::go_on(EvaluationWorkspace& workspace) noexcept {
  const bool is_report = goal_ == Goal::kReport;
  progress_ = 0.0;
  if (!has_model_) {
    begin_model(workspace);
  } else if (is_report && source_ == Source::kPoints && !has_fit_draws_) {
    begin_fit_draws();
  } else if (goal_ != Goal::kModel && !has_energy_) {
    begin_energy(workspace);
  } else if (goal_ != Goal::kModel && !is_bound_done_) {
    begin_bound(workspace);
  } else if (has_trials(goal_) && is_damping_open() && !is_cut_done_) {
    begin_cut_range(workspace);
  } else if (has_trials(goal_) && !has_monte_carlo_ && has_uncertainty()) {
    begin_trials(workspace);
  } else if (app::has_trend(goal_) && !has_trend_ && settings_.trend_count != 0) {
    stage_ = Stage::kTrend;
  } else {
    stage_ = Stage::kDone;
    progress_ = 1.0;
  }
}

bool Evaluation::has_uncertainty() const noexcept {
  if (is_damping_open()) {
    return false;  // Trials need a range for each parameter.
  }
  const ParameterBox& u = device_.u;
  return u.sensitivity != 0.0 || u.natural_frequency_hz != 0.0 || u.damping != 0.0;
}

double Evaluation::covariance(std::size_t i, std::size_t j) const noexcept {
  if (source_ == Source::kPoints) {
    return fit_.result().covariance[i][j];
  }
  if (i != j) {
    return 0.0;
  }
  const double u = i == 0   ? device_.u.sensitivity
                   : i == 1 ? device_.u.natural_frequency_hz
                            : device_.u.damping;
  return u * u;
}

double Evaluation::rms_error_v() const noexcept {
  return sqrt(energy_v2s() / settings_.duration_s);
}

double Evaluation::trial_scale(const Settings& settings) const noexcept {
  const double ratio = source_ == Source::kPoints ? fit_.result().birge_ratio : 1.0;
  return settings.birge && ratio > 1.0 ? ratio : 1.0;
}

SearchSettings Evaluation::search_settings(const Settings& settings, double duration_s) noexcept {
  return {settings.method, duration_s, settings.step_s, settings.iterations};
}

WichmannHill Evaluation::seeded_generator() const noexcept {
  WichmannHill generator;
  (void)generator.seed(settings_.generator, settings_.seed);  // `check()` has seen the seed.
  return generator;
}

Status Evaluation::fail(Status status, Stage stage, const char* reason,
                        double duration_s) noexcept {
  failure_ = {status, stage, reason, duration_s};
  stage_ = Stage::kFailed;
  progress_ = 0.0;
  return status;
}

Failure Evaluation::search_failure(Status status, Stage stage, double duration_s) const noexcept {
  const char* reason = explain(status);
  if (status == Status::kTooManyCells) {
    reason = settings_.method == Method::kPaper ? kTooManyCellsPaper : kTooManyCellsBest;
  }
  if (status == Status::kTooManySwitches) {
    reason = kTooManySwitches;
  }
  return {status, stage, reason, duration_s};
}

void Evaluation::fail_search(Status status, Stage stage, double duration_s) noexcept {
  const Failure failure = search_failure(status, stage, duration_s);
  (void)fail(failure.status, failure.stage, failure.reason, failure.duration_s);
}

}  // namespace emax::app
