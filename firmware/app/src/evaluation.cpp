// The stages of the job, and the slices that each of them is cut into.
#include "emax/app/evaluation.hpp"

#include <algorithm>

#include "emax/app/report.hpp"
#include "emax/capacity.hpp"
#include "emax/elementary.hpp"

namespace emax::app {
namespace {

constexpr std::uint32_t kDrawsPerStep = 4;
constexpr std::uint64_t kFitDrawsOffset = std::uint64_t{1} << 60U;

// Work is counted in cells of Phi's products: a value from the store costs next to nothing.
constexpr std::size_t kWorkPerStep = 1024;
constexpr std::size_t kWorkOfStoredValue = 2;

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
constexpr char kTrialsFailed[] =
    "The energies of the trials cannot be summed up; check the units of the parameters.";

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
  const Status fit_status = fit_.fit(points);
  const WlspFit& fit = fit_.result();
  if (fit_status != Status::kOk) {
    return fail(fit_status, Stage::kFitDraws,
                fit_status == Status::kOverdamped ? kOverdamped : explain(fit_status));
  }
  device_.estimate = fit.model;
  device_.u = {fit.u_sensitivity, fit.u_natural_frequency_hz, fit.u_damping};
  return prepare(workspace);
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
  peak_ = {};
  settling_ = {};
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
  if (!has_monte_carlo_) {
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
    return {Status::kInvalidArgument, Stage::kMonteCarlo, is_box ? kBoxTooLarge : kNormalTooWide};
  }
  return {};
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
  const ParameterBox& u = device_.u;
  return u.sensitivity != 0.0 || u.natural_frequency_hz != 0.0 || u.damping != 0.0;
}

void Evaluation::step(EvaluationWorkspace& workspace) noexcept {
  const Stage before = stage_;
  step_stage(workspace);
  if (stage_ == before) {
    progress_ = progress_of(workspace);
  }
}

void Evaluation::step_stage(EvaluationWorkspace& workspace) noexcept {
  switch (stage_) {
    case Stage::kModel:
      step_model(workspace);
      return;
    case Stage::kFitDraws:
      step_fit_draws(workspace);
      return;
    case Stage::kEnergy:
      step_energy(workspace);
      return;
    case Stage::kBound:
      step_bound(workspace);
      return;
    case Stage::kPrediction:
      step_prediction(workspace);
      return;
    case Stage::kAdaptive:
      step_adaptive(workspace);
      return;
    case Stage::kMonteCarlo:
      step_monte_carlo(workspace);
      return;
    case Stage::kGuard:
      step_guard(workspace);
      return;
    case Stage::kTrend:
      step_trend(workspace);
      return;
    case Stage::kIdle:
    case Stage::kDone:
    case Stage::kFailed:
      return;
  }
}

double Evaluation::progress_of(const EvaluationWorkspace& workspace) const noexcept {
  switch (stage_) {
    case Stage::kFitDraws:
      return static_cast<double>(draws_.made()) / kFitDraws;
    case Stage::kEnergy:
      return workspace.search_.progress();
    case Stage::kBound:
      return workspace.part_.bound.bound.progress();
    case Stage::kAdaptive:
      return adaptive_progress(workspace.part_.trial.adaptive);
    case Stage::kMonteCarlo:
      // With a store that holds all trials only the first pass takes time.
      return store_.size() < monte_carlo_trials_
                 ? workspace.part_.trial.monte_carlo.progress()
                 : static_cast<double>(stored_) / static_cast<double>(monte_carlo_trials_);
    case Stage::kGuard:
      return guard_.progress();
    case Stage::kTrend: {
      const double running = trend_search_runs_ ? workspace.search_.progress() : 0.0;
      return (static_cast<double>(trend_done_) + running) /
             static_cast<double>(settings_.trend_count);
    }
    case Stage::kIdle:
    case Stage::kModel:
    case Stage::kPrediction:
    case Stage::kDone:
    case Stage::kFailed:
      return progress_;
  }
  return progress_;
}

// The scatter of a mean over blocks falls with the root of their number: that says how many it
// takes until the largest of the four is small enough.
double Evaluation::adaptive_progress(const AdaptiveTrials& adaptive) const noexcept {
  const AdaptiveResult so_far = adaptive.result();
  if (so_far.blocks < 2 || !(so_far.tolerance > 0.0)) {
    return 0.0;
  }
  double largest = 0.0;
  const double scatters[] = {so_far.s_mean, so_far.s_u, so_far.s_low, so_far.s_high};
  for (const double s : scatters) {
    largest = s > largest ? s : largest;
  }
  const double ratio = 2.0 * largest / so_far.tolerance;
  return ratio > 1.0 ? 1.0 / (ratio * ratio) : 1.0;
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

void Evaluation::begin_model(EvaluationWorkspace& workspace) noexcept {
  auto* const part = new (&workspace.part_.model) EvaluationWorkspace::ModelPart;
  part->peak.start(model_);
  // Without an answer for so long a T the value stays 0.
  (void)part->absolute_error.start(model_, settings_.duration_s);
  stage_ = Stage::kModel;
}

void Evaluation::step_model(EvaluationWorkspace& workspace) noexcept {
  EvaluationWorkspace::ModelPart& part = workspace.part_.model;
  if (!part.peak.done()) {
    part.peak.step(model_);
    if (part.peak.done()) {
      peak_ = part.peak.result();
      part.settling.start(model_, kSettled * abs(peak_.value));
    }
    return;
  }
  if (!part.settling.done()) {
    part.settling.step(model_);
    return;
  }
  if (!part.absolute_error.done()) {
    part.absolute_error.step(model_);
    return;
  }
  settling_ = part.settling.result();
  absolute_error_ = part.absolute_error.value();
  has_model_ = true;
  go_on(workspace);
}

void Evaluation::begin_fit_draws() noexcept {
  WichmannHill generator = seeded_generator();
  generator.jump(kFitDrawsOffset);
  const Status status = draws_.start(fit_, kFitDraws, generator);
  if (status != Status::kOk) {
    (void)fail(status, Stage::kFitDraws, explain(status));
    return;
  }
  stage_ = Stage::kFitDraws;
}

void Evaluation::step_fit_draws(EvaluationWorkspace& workspace) noexcept {
  draws_.step(fit_, kDrawsPerStep);
  if (draws_.done()) {
    has_fit_draws_ = true;
    go_on(workspace);
  }
}

void Evaluation::begin_energy(EvaluationWorkspace& workspace) noexcept {
  const Status status =
      workspace.search_.start(model_, search_settings(settings_, settings_.duration_s));
  if (status != Status::kOk) {
    fail_search(status, Stage::kEnergy, settings_.duration_s);
    return;
  }
  stage_ = Stage::kEnergy;
}

void Evaluation::step_energy(EvaluationWorkspace& workspace) noexcept {
  if (has_energy_) {
    go_on(workspace);
    return;
  }
  EnergySearch& search = workspace.search_;
  const bool is_paper = settings_.method == Method::kPaper;
  const Status status =
      search.step(model_, workspace.grid_, is_paper ? Span<double>(trace_) : Span<double>());
  if (status != Status::kOk) {
    fail_search(status, Stage::kEnergy, settings_.duration_s);
    return;
  }
  if (!search.done()) {
    return;
  }
  maximum_ = search.result();
  trace_count_ = search.trace_count();
  has_energy_ = true;  // What comes next begins with a step of its own.
}

// A device and time for which no bound passes its check, or for which its grid would be too large,
// are reported without one.
void Evaluation::begin_bound(EvaluationWorkspace& workspace) noexcept {
  auto* const part = new (&workspace.part_.bound) EvaluationWorkspace::BoundPart;
  if (part->bound.start(model_, settings_.duration_s, workspace.grid_) != Status::kOk) {
    is_bound_done_ = true;  // The next step goes on: from here it would be a recursion.
  }
  stage_ = Stage::kBound;
}

void Evaluation::step_bound(EvaluationWorkspace& workspace) noexcept {
  if (is_bound_done_) {
    go_on(workspace);
    return;
  }
  EnergyBound& bound = workspace.part_.bound.bound;
  const Status status = bound.step(model_, workspace.grid_);
  if (status == Status::kOk && !bound.done()) {
    return;
  }
  bound_ = bound.bound();
  has_bound_ = status == Status::kOk;
  is_bound_done_ = true;
  go_on(workspace);
}

void Evaluation::begin_trials(EvaluationWorkspace& workspace) noexcept {
  const ParameterBox& u = device_.u;
  TrialSettings trial_settings;
  const double scale = trial_scale();
  trial_settings.distribution = settings_.distribution;
  trial_settings.box = {scale * u.sensitivity, scale * u.natural_frequency_hz, scale * u.damping};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      trial_settings.covariance[i][j] = scale * scale * covariance(i, j);
    }
  }
  trial_settings.generator = seeded_generator();
  trial_settings.gain_follows = settings_.gain_mode == GainMode::kTrack;
  trial_settings.search = search_settings(settings_, settings_.duration_s);
  auto* const part = new (&workspace.part_.trial) EvaluationWorkspace::TrialPart;
  const Status status = part->trials.start(model_, maximum_, trial_settings);
  if (status != Status::kOk) {
    const bool is_box = settings_.distribution == Distribution::kBox;
    (void)fail(status, Stage::kMonteCarlo, is_box ? kBoxTooLarge : kNormalTooWide);
    return;
  }
  workspace.grid_.share_with_store();
  stage_ = Stage::kPrediction;
}

void Evaluation::step_prediction(EvaluationWorkspace& workspace) noexcept {
  EvaluationWorkspace::TrialPart& part = workspace.part_.trial;
  if (!part.trials.ready()) {
    part.trials.prepare(maximum_, workspace.grid_);
    return;
  }
  if (!settings_.adaptive) {
    begin_monte_carlo(settings_.trials, workspace);
    return;
  }
  const Status status =
      part.adaptive.start(part.monte_carlo, workspace.grid_.store(), settings_.probability);
  if (status != Status::kOk) {
    (void)fail(status, Stage::kAdaptive, explain(status));
    return;
  }
  progress_ = 0.0;
  stage_ = Stage::kAdaptive;
}

/// A step of a trial. @returns Whether its energy is there.
bool Evaluation::advance_trial(std::uint32_t trial, EvaluationWorkspace& workspace) noexcept {
  EnergyTrials& trials = workspace.part_.trial.trials;
  if (trial_runs_) {
    trials.step(workspace.grid_);
  } else {
    trials.begin(trials.device(trial), maximum_, workspace.grid_);
  }
  trial_runs_ = !trials.done();
  return trials.done();
}

void Evaluation::run_slice(EvaluationWorkspace& workspace) noexcept {
  EvaluationWorkspace::TrialPart& part = workspace.part_.trial;
  MonteCarloStore& store = workspace.grid_.store();
  const bool adapts = stage_ == Stage::kAdaptive;
  const std::size_t work_of_trial = part.trials.work(maximum_);
  for (std::size_t work = 0; work < kWorkPerStep;) {
    if (adapts ? part.adaptive.done() : part.monte_carlo.done()) {
      return;
    }
    const std::uint32_t trial =
        adapts ? part.adaptive.next_trial(part.monte_carlo) : part.monte_carlo.next_trial();
    double value = 0.0;
    if (trial < stored_) {
      value = store_[trial];
      work += kWorkOfStoredValue;
    } else {
      work += work_of_trial;
      if (!advance_trial(trial, workspace)) {
        continue;
      }
      value = a2() * part.trials.energy();
      if (trial == stored_ && trial < store_.size()) {
        store_[trial] = value;
        ++stored_;
      }
    }
    if (adapts) {
      part.adaptive.add(value, part.monte_carlo, store);
    } else {
      part.monte_carlo.add(value, store);
    }
  }
}

void Evaluation::step_adaptive(EvaluationWorkspace& workspace) noexcept {
  run_slice(workspace);
  const AdaptiveTrials& adaptive = workspace.part_.trial.adaptive;
  if (!adaptive.done()) {
    return;
  }
  adaptive_result_ = adaptive.result();
  if (adaptive_result_.status != Status::kOk) {
    (void)fail(adaptive_result_.status, Stage::kAdaptive, kTrialsFailed);
    return;
  }
  begin_monte_carlo(adaptive_result_.trials, workspace);
}

void Evaluation::begin_monte_carlo(std::uint32_t trials, EvaluationWorkspace& workspace) noexcept {
  const Status status = workspace.part_.trial.monte_carlo.start(trials, settings_.probability,
                                                                workspace.grid_.store());
  if (status != Status::kOk) {
    (void)fail(status, Stage::kMonteCarlo, explain(status));
    return;
  }
  monte_carlo_trials_ = trials;
  progress_ = 0.0;
  stage_ = Stage::kMonteCarlo;
}

void Evaluation::step_monte_carlo(EvaluationWorkspace& workspace) noexcept {
  run_slice(workspace);
  EvaluationWorkspace::TrialPart& part = workspace.part_.trial;
  if (!part.monte_carlo.done()) {
    return;
  }
  monte_carlo_.take(part.monte_carlo, workspace.grid_.store());
  const MonteCarloResult& result = monte_carlo_.result();
  if (result.status != Status::kOk) {
    (void)fail(result.status, Stage::kMonteCarlo, kTrialsFailed);
    return;
  }
  device_at_maximum_ = part.trials.device(result.trial_of_maximum);
  if (settings_.method == Method::kPaper) {
    has_monte_carlo_ = true;
    go_on(workspace);
    return;
  }
  guard_.start(monte_carlo_trials_, result.trial_of_maximum);
  progress_ = 0.0;
  stage_ = Stage::kGuard;
}

void Evaluation::step_guard(EvaluationWorkspace& workspace) noexcept {
  (void)guard_.step(workspace.part_.trial.trials, maximum_, workspace.search_,
                    workspace.grid_);  // A search that fails counts as disagreement.
  if (guard_.done()) {
    has_monte_carlo_ = true;
    go_on(workspace);
  }
}

void Evaluation::step_trend(EvaluationWorkspace& workspace) noexcept {
  const double duration_s = settings_.trend_s[trend_done_];
  if (!trend_search_runs_) {
    if (duration_s == settings_.duration_s) {
      add_trend_point(maximum_.energy);
      return;
    }
    const Status status = workspace.search_.start(model_, search_settings(settings_, duration_s));
    if (status != Status::kOk) {
      fail_search(status, Stage::kTrend, duration_s);
      return;
    }
    trend_search_runs_ = true;
    return;
  }
  const Status status = workspace.search_.step(model_, workspace.grid_);
  if (status != Status::kOk) {
    fail_search(status, Stage::kTrend, duration_s);
    return;
  }
  if (workspace.search_.done()) {
    trend_search_runs_ = false;
    add_trend_point(workspace.search_.result().energy);
  }
}

void Evaluation::add_trend_point(double energy) noexcept {
  trend_points_[trend_done_] = {settings_.trend_s[trend_done_], energy};
  ++trend_done_;
  if (trend_done_ == settings_.trend_count) {
    end_trend();
  }
}

void Evaluation::end_trend() noexcept {
  double energy_v2s[kMaxTrendPoints];
  for (std::size_t i = 0; i < trend_done_; ++i) {
    energy_v2s[i] = a2() * trend_points_[i].energy;
  }
  const Span<const double> times_s(settings_.trend_s.data(), trend_done_);
  trend_ = linear_trend(times_s, Span<const double>(energy_v2s, trend_done_));
  if (trend_.status != Status::kOk) {
    (void)fail(trend_.status, Stage::kTrend, explain(trend_.status));
    return;
  }
  has_trend_ = true;
  stage_ = Stage::kDone;
  progress_ = 1.0;
}

}  // namespace emax::app
