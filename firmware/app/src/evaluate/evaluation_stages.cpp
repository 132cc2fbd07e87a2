// The stages of the job, and the slices that each of them is cut into.
#include "emax/app/evaluate/evaluation.hpp"
#include "emax/base/elementary.hpp"

namespace emax::app {
namespace {

constexpr std::uint32_t kDrawsPerStep = 4;
constexpr std::uint64_t kFitDrawsOffset = std::uint64_t{1} << 60U;

// Work is counted in cells of Phi's products: a value from the store costs next to nothing.
constexpr std::size_t kWorkPerStep = 1024;
constexpr std::size_t kWorkOfStoredValue = 2;

constexpr char kTrialsFailed[] =
    "The energies of the trials cannot be summed up; check the units of the parameters.";

}  // namespace

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

void Evaluation::begin_model(EvaluationWorkspace& workspace) noexcept {
  auto* const part = new (&workspace.part_.model) EvaluationWorkspace::ModelPart;
  part->peak.start(model_);
  has_absolute_error_ = part->absolute_error.start(model_, settings_.duration_s) == Status::kOk;
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
    (void)fail(status, Stage::kMonteCarlo, width_reason(settings_.distribution));
    return;
  }
  workspace.grid_.share_with_store();
  stage_ = Stage::kPrediction;
}

void Evaluation::begin_cut_range(EvaluationWorkspace& workspace) noexcept {
  auto* const part = new (&workspace.part_.cut) EvaluationWorkspace::CutPart;
  part->range.start(model_, judgement_, search_settings(settings_, settings_.duration_s),
                    settings_.gain_mode == GainMode::kTrack);
  stage_ = Stage::kPrediction;
}

void Evaluation::step_cut_range(EvaluationWorkspace& workspace) noexcept {
  CutRange& range = workspace.part_.cut.range;
  range.step(workspace.search_, workspace.grid_);
  progress_ = range.progress();
  if (!range.done()) {
    return;
  }
  has_cut_range_ = range.is_found();
  cut_low_ = range.low() < maximum_.energy ? range.low() : maximum_.energy;
  cut_high_ = range.high() > maximum_.energy ? range.high() : maximum_.energy;
  is_cut_done_ = true;
  go_on(workspace);
}

void Evaluation::step_prediction(EvaluationWorkspace& workspace) noexcept {
  if (is_damping_open()) {
    step_cut_range(workspace);
    return;
  }
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
