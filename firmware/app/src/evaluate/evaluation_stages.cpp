// The stages of the job, and the slices that each of them is cut into.
#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/evaluate/evaluation_workspace.hpp"
#include "emax/base/elementary.hpp"

#include "evaluation_checks.hpp"

namespace emax::app {
namespace {

constexpr std::uint32_t kDrawsPerStep = 4;
constexpr std::uint64_t kFitDrawsOffset = std::uint64_t{1} << 60U;

// Work is counted in cells of Phi's products: a value from the store costs next to nothing.
constexpr std::size_t kWorkPerStep = 1024;
constexpr std::size_t kWorkOfStoredValue = 2;

}  // namespace

void Evaluation::step() noexcept {
  const Stage before = results_.stage;
  step_stage();
  if (results_.stage == before) {
    work_.progress_ = progress_of_stage();
  }
}

double Evaluation::progress() const noexcept {
  if (results_.stage == Stage::kIdle || done()) {
    return results_.stage == Stage::kDone ? 1.0 : 0.0;
  }
  return work_.progress_;
}

void Evaluation::step_stage() noexcept {
  switch (results_.stage) {
    case Stage::kModel:
      step_model();
      return;
    case Stage::kFitDraws:
      step_fit_draws();
      return;
    case Stage::kEnergy:
      step_energy();
      return;
    case Stage::kBound:
      step_bound();
      return;
    case Stage::kPrediction:
      step_prediction();
      return;
    case Stage::kAdaptive:
      step_adaptive();
      return;
    case Stage::kMonteCarlo:
      step_monte_carlo();
      return;
    case Stage::kGuard:
      step_guard();
      return;
    case Stage::kIdeal:
    case Stage::kBand:
    case Stage::kMatched:
    case Stage::kUncertainty:
      step_figure();
      return;
    case Stage::kTrend:
      step_trend();
      return;
    case Stage::kIdle:
    case Stage::kDone:
    case Stage::kFailed:
      return;
  }
}

double Evaluation::progress_of_stage() const noexcept {
  switch (results_.stage) {
    case Stage::kFitDraws:
      return static_cast<double>(work_.draws_.made()) / kFitDraws;
    case Stage::kEnergy:
      return work_.search_.progress();
    case Stage::kBound:
      return work_.part_.bound.bound.progress();
    case Stage::kPrediction:
      return !results_.is_damping_open() ? work_.part_.trial.trials.progress()
             : kHasFigureRanges && results_.settings.criterion == Criterion::kInBandError
                 ? work_.part_.figure_range.range.progress()
                 : work_.part_.cut.range.progress();
    case Stage::kAdaptive:
      return adaptive_progress(work_.part_.trial.adaptive);
    case Stage::kMonteCarlo:
      return progress_of_trials();
    case Stage::kGuard:
      return work_.guard_.progress();
    case Stage::kIdeal:
    case Stage::kBand:
    case Stage::kMatched:
    case Stage::kUncertainty:
      return progress_of_figure();
    case Stage::kTrend: {
      const double running = work_.trend_search_runs_ ? work_.search_.progress() : 0.0;
      return (static_cast<double>(results_.trend_looked_at) + running) /
             static_cast<double>(results_.settings.trend_count);
    }
    case Stage::kIdle:
    case Stage::kModel:
    case Stage::kDone:
    case Stage::kFailed:
      return work_.progress_;
  }
  return work_.progress_;
}

double Evaluation::progress_of_trials() const noexcept {
  // With a store that holds all trials only the first pass takes time.
  const EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  const double of_run =
      work_.store_.size() < work_.trials_
          ? part.monte_carlo.progress()
          : static_cast<double>(work_.stored_) / static_cast<double>(work_.trials_);
  return are_relative() ? 0.5 * (of_run + (part.is_relative ? 1.0 : 0.0)) : of_run;
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

void Evaluation::begin_model() noexcept {
  auto* const part = new (&work_.part_.model) EvaluationWorkspace::ModelPart;
  part->peak.start(results_.model);
  results_.has_absolute_error =
      part->absolute_error.start(results_.model, results_.settings.duration_s) == Status::kOk;
  results_.stage = Stage::kModel;
}

void Evaluation::step_model() noexcept {
  EvaluationWorkspace::ModelPart& part = work_.part_.model;
  if (!part.peak.done()) {
    part.peak.step(results_.model);
    if (part.peak.done()) {
      results_.peak = part.peak.result();
      part.settling.start(results_.model, kSettled * abs(results_.peak.value));
    }
    return;
  }
  if (!part.settling.done()) {
    part.settling.step(results_.model);
    return;
  }
  if (!part.absolute_error.done()) {
    part.absolute_error.step(results_.model);
    return;
  }
  results_.settling_time = part.settling.result();
  results_.absolute_error_v = results_.limit_mps2 * part.absolute_error.value();
  results_.has_model = true;
  go_on();
}

WichmannHill Evaluation::seeded_generator() const noexcept {
  WichmannHill generator;
  // `check()` has seen the seed.
  (void)generator.seed(results_.settings.generator, results_.settings.seed);
  return generator;
}

void Evaluation::begin_fit_draws() noexcept {
  WichmannHill generator = seeded_generator();
  generator.jump(kFitDrawsOffset);
  const Status status = work_.draws_.start(results_.fit, kFitDraws, generator);
  if (status != Status::kOk) {
    (void)fail({status, Stage::kFitDraws, explain(status)});
    return;
  }
  results_.stage = Stage::kFitDraws;
}

void Evaluation::step_fit_draws() noexcept {
  WlspDraws& draws = work_.draws_;
  if (work_.helper_ != nullptr) {
    work_.helper_->make_fit_draws(draws, results_.fit);
  } else {
    draws.step(results_.fit, kDrawsPerStep);
  }
  if (draws.done()) {
    results_.fit_draws = draws.result();
    results_.has_fit_draws = true;
    go_on();
  }
}

void Evaluation::begin_energy() noexcept {
  if (begin_search(Stage::kEnergy, results_.settings.duration_s)) {
    results_.stage = Stage::kEnergy;
  }
}

/// @returns Whether the search has begun; else the evaluation has failed.
bool Evaluation::begin_search(Stage stage, double duration_s) noexcept {
  return is_well(
      work_.search_.start(results_.model, search_settings(results_.settings, duration_s)), stage,
      duration_s);
}

bool Evaluation::is_well(Status of_search, Stage stage, double duration_s) noexcept {
  if (of_search != Status::kOk) {
    (void)fail(failure_of_search(of_search, results_.settings, stage, duration_s,
                                 results_.settling_time.time_s));
  }
  return of_search == Status::kOk;
}

void Evaluation::step_energy() noexcept {
  if (results_.has_energy) {
    go_on();
    return;
  }
  EnergySearch& search = work_.search_;
  const Span<double> all(results_.trace_v2s);
  const Span<double> trace = results_.settings.method == Method::kPaper ? all : Span<double>();
  const Status status = search.step(results_.model, work_.grid_, trace);
  if (!is_well(status, Stage::kEnergy, results_.settings.duration_s) || !search.done()) {
    return;
  }
  results_.maximum = search.result();
  results_.trace_count = search.trace_count();
  for (double& energy : all.first(results_.trace_count)) {
    energy = results_.a2() * energy;
  }
  results_.has_energy = true;  // What comes next begins with a step of its own.
}

// A device and time for which no bound passes its check, or for which its grid would be too large,
// are reported without one.
void Evaluation::begin_bound() noexcept {
  auto* const part = new (&work_.part_.bound) EvaluationWorkspace::BoundPart;
  if (part->bound.start(results_.model, results_.settings.duration_s, work_.grid_) != Status::kOk) {
    results_.is_bound_done = true;  // The next step goes on: from here it would be a recursion.
  }
  results_.stage = Stage::kBound;
}

void Evaluation::step_bound() noexcept {
  if (results_.is_bound_done) {
    go_on();
    return;
  }
  EnergyBound& bound = work_.part_.bound.bound;
  const Status status = bound.step(results_.model, work_.grid_);
  if (status == Status::kOk && !bound.done()) {
    return;
  }
  results_.bound_v2s = results_.a2() * bound.bound();
  results_.has_bound = status == Status::kOk;
  results_.is_bound_done = true;
  go_on();
}

void Evaluation::begin_trials() noexcept {
  const Settings& settings = results_.settings;
  auto* const part = new (&work_.part_.trial) EvaluationWorkspace::TrialPart;
  work_.stored_ = 0;
  const Status status =
      part->trials.start(results_.model, results_.maximum, trial_settings(settings.distribution));
  if (status != Status::kOk) {
    (void)fail(failure_of_width(status, settings.distribution));
    return;
  }
  results_.stage = Stage::kPrediction;
}

TrialSettings Evaluation::trial_settings(Distribution distribution) const noexcept {
  const Settings& settings = results_.settings;
  const ParameterBox& u = results_.device.u;
  TrialSettings trial_settings;
  const double scale = results_.trial_scale();
  trial_settings.distribution = distribution;
  trial_settings.box = {scale * u.sensitivity, scale * u.natural_frequency_hz, scale * u.damping};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      trial_settings.covariance[i][j] = scale * scale * results_.covariance(i, j);
    }
  }
  trial_settings.generator = seeded_generator();
  trial_settings.gain_follows = settings.gain_mode == GainMode::kTrack;
  trial_settings.search = search_settings(settings, settings.duration_s);
  trial_settings.pieces = work_.pieces_;
  trial_settings.expected_trials = settings.adaptive ? 0U : settings.trials;
  return trial_settings;
}

void Evaluation::begin_cut_range() noexcept {
  const Settings& settings = results_.settings;
  const SearchSettings search = search_settings(settings, settings.duration_s);
  results_.stage = Stage::kPrediction;
  if (kHasFigureRanges && settings.criterion == Criterion::kInBandError) {
    auto* const part = new (&work_.part_.figure_range) EvaluationWorkspace::FigureRangePart;
    part->range.start(results_.judgement,
                      {reference_filter(results_), measure_of(settings), results_.maximum.energy},
                      search, settings.gain_mode != GainMode::kFixed);
    return;
  }
  auto* const part = new (&work_.part_.cut) EvaluationWorkspace::CutPart;
  part->range.start(results_.model, results_.judgement, search,
                    settings.gain_mode == GainMode::kTrack);
}

void Evaluation::step_cut_range() noexcept {
  if (kHasFigureRanges && results_.settings.criterion == Criterion::kInBandError) {
    step_cut_range(work_.part_.figure_range.range);
  } else {
    step_cut_range(work_.part_.cut.range);
  }
}

template <typename Range>
void Evaluation::step_cut_range(Range& range) noexcept {
  range.step(work_.search_, work_.grid_);
  if (!range.done()) {
    return;
  }
  const double energy = results_.maximum.energy;
  const double low = range.low() < energy ? range.low() : energy;
  const double high = range.high() > energy ? range.high() : energy;
  results_.cut_low_v2s = results_.a2() * low;
  results_.cut_high_v2s = results_.a2() * high;
  results_.has_cut_range = range.is_found();
  results_.is_cut_done = true;
  go_on();
}

void Evaluation::step_prediction() noexcept {
  if (results_.is_damping_open()) {
    step_cut_range();
    return;
  }
  EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  if (!part.trials.ready()) {
    part.trials.prepare(work_.search_, work_.grid_);
    return;
  }
  work_.grid_.share_with_store();
  if (!results_.settings.adaptive) {
    begin_monte_carlo(results_.settings.trials);
    return;
  }
  const Status status =
      part.adaptive.start(part.monte_carlo, work_.grid_.store(), results_.settings.probability);
  if (status != Status::kOk) {
    (void)fail({status, Stage::kAdaptive, explain(status)});
    return;
  }
  work_.progress_ = 0.0;
  results_.stage = Stage::kAdaptive;
}

/// A step of a trial. @returns Whether its energy is there.
bool Evaluation::advance_trial(std::uint32_t trial) noexcept {
  EnergyTrials& trials = work_.part_.trial.trials;
  if (work_.trial_runs_) {
    trials.step(work_.grid_);
  } else {
    trials.begin(trial, work_.grid_);
  }
  work_.trial_runs_ = !trials.done();
  return trials.done();
}

/// Whether a helper makes this trial, which is the next one for the store.
bool Evaluation::is_helped(std::uint32_t trial) const noexcept {
  return work_.helper_ != nullptr && trial == work_.stored_ && trial < work_.store_.size();
}

/// Has the helper make trials for the store, up to this one.
void Evaluation::store_trials(std::uint32_t end) noexcept {
  const std::size_t room = work_.store_.size() < end ? work_.store_.size() : end;
  const Span<double> values = work_.store_.first(room).from(work_.stored_);
  const std::size_t made =
      work_.helper_->make_trials(work_.part_.trial.trials, work_.stored_, values);
  for (double& value : values.first(made)) {
    value = results_.a2() * value;
  }
  work_.stored_ += static_cast<std::uint32_t>(made);
}

void Evaluation::run_slice() noexcept {
  EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  MonteCarloStore& store = work_.grid_.store();
  const bool adapts = results_.stage == Stage::kAdaptive;
  const std::size_t work_of_trial = part.trials.work();
  for (std::size_t work = 0; work < kWorkPerStep;) {
    if (adapts ? part.adaptive.done() : part.monte_carlo.done()) {
      return;
    }
    const std::uint32_t trial =
        adapts ? part.adaptive.next_trial(part.monte_carlo) : part.monte_carlo.next_trial();
    double value = 0.0;
    const bool is_stored = trial < work_.stored_;
    if (is_stored) {
      value = work_.store_[trial];
      work += kWorkOfStoredValue;
    } else if (is_helped(trial)) {
      store_trials(adapts ? part.adaptive.end_of_block() : work_.trials_);
      return;
    } else {
      work += work_of_trial;
      if (!advance_trial(trial)) {
        continue;
      }
      value = results_.a2() * part.trials.energy();
      if (trial == work_.stored_ && trial < work_.store_.size()) {
        work_.store_[trial] = value;
        ++work_.stored_;
      }
    }
    note_root(trial, value, is_stored);
    if (part.is_relative) {
      const double ratio = results_.device.estimate.sensitivity / sensitivity_of(trial, is_stored);
      value = ratio * ratio * value;
    }
    if (adapts) {
      part.adaptive.add(value, part.monte_carlo, store);
    } else {
      part.monte_carlo.add(value, store);
    }
  }
}

void Evaluation::step_adaptive() noexcept {
  run_slice();
  const AdaptiveTrials& adaptive = work_.part_.trial.adaptive;
  if (!adaptive.done()) {
    return;
  }
  results_.adaptive = adaptive.result();
  if (results_.adaptive.status != Status::kOk) {
    (void)fail(failure_of_trials(results_.adaptive.status, Stage::kAdaptive,
                                 work_.part_.trial.trials.is_exhausted()));
    return;
  }
  begin_monte_carlo(results_.adaptive.trials);
}

void Evaluation::begin_monte_carlo(std::uint32_t trials) noexcept {
  const Status status = work_.part_.trial.monte_carlo.start(trials, results_.settings.probability,
                                                            work_.grid_.store());
  if (status != Status::kOk) {
    (void)fail({status, Stage::kMonteCarlo, explain(status)});
    return;
  }
  work_.trials_ = trials;
  work_.progress_ = 0.0;
  results_.stage = Stage::kMonteCarlo;
}

void Evaluation::step_monte_carlo() noexcept {
  run_slice();
  EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  if (!part.monte_carlo.done()) {
    return;
  }
  if (part.is_relative) {
    take_relative(results_.uncertainty);
    begin_guard();
    return;
  }
  results_.trials.take(part.monte_carlo, work_.grid_.store());
  results_.trials.redraws = part.trials.redraws();
  results_.trials.branches = part.trials.notes();
  const MonteCarloResult& result = results_.trials.result;
  if (result.status != Status::kOk) {
    (void)fail(failure_of_trials(result.status, Stage::kMonteCarlo, part.trials.is_exhausted()));
    return;
  }
  if (are_trials_normal()) {
    take_uncertainty(results_.uncertainty);
  }
  results_.device_at_maximum = part.trials.device(result.trial_of_maximum);
  work_.guard_.start(
      work_.trials_, result.trial_of_maximum,
      part.trials.has_surface() ? EnergyGuard::kSpreadOfFigure : EnergyGuard::kSpread);
  if (!begin_relative()) {
    begin_guard();
  }
}

void Evaluation::begin_guard() noexcept {
  if (results_.settings.method == Method::kPaper) {
    end_trials();
    return;
  }
  work_.progress_ = 0.0;
  results_.stage = Stage::kGuard;
}

void Evaluation::step_guard() noexcept {
  EnergyGuard& guard = work_.guard_;
  // A search that fails counts as disagreement.
  (void)guard.step(work_.part_.trial.trials, work_.search_, work_.grid_);
  if (guard.done()) {
    results_.guard = results_of(guard);
    end_trials();
  }
}

/// Whether the trials of the paper's procedure are those of the uncertainty of E, too.
bool Evaluation::are_trials_normal() const noexcept {
  return results_.settings.distribution == Distribution::kNormal && !holds_sensitivity();
}

void Evaluation::end_trials() noexcept {
  results_.has_monte_carlo = true;
  if (are_trials_normal()) {
    results_.uncertainty.guard = results_.guard;
    results_.uncertainty.is_done = true;
  }
  go_on();
}

void Evaluation::step_trend() noexcept {
  const double duration_s = results_.settings.trend_s[results_.trend_looked_at];
  if (!work_.trend_search_runs_) {
    if (duration_s == results_.settings.duration_s) {
      add_trend_point(results_.energy_v2s());
      return;
    }
    const SearchSettings settings = search_settings(results_.settings, duration_s);
    const bool is_too_much = search_cells(results_.model, settings) > kMostDefaultCells &&
                             adapts_trend(results_.settings);
    const Status status =
        is_too_much ? Status::kTooManyCells : work_.search_.start(results_.model, settings);
    if (!leaves_out(status)) {
      work_.trend_search_runs_ = is_well(status, Stage::kTrend, duration_s);
    }
    return;
  }
  EnergySearch& search = work_.search_;
  const Status status = search.step(results_.model, work_.grid_);
  if (leaves_out(status)) {
    return;
  }
  if (is_well(status, Stage::kTrend, duration_s) && search.done()) {
    work_.trend_search_runs_ = false;
    add_trend_point(results_.a2() * search.result().energy);
  }
}

void Evaluation::add_trend_point(double energy_v2s) noexcept {
  const Settings& settings = results_.settings;
  results_.trend_table[results_.trend_count] = {settings.trend_s[results_.trend_looked_at],
                                                energy_v2s};
  ++results_.trend_count;
  ++results_.trend_looked_at;
  if (results_.trend_looked_at == settings.trend_count) {
    end_trend();
  }
}

/// @returns Whether this time is left out for what its search answered; the next one is then due.
bool Evaluation::leaves_out(Status of_search) noexcept {
  const bool is_too_long =
      of_search == Status::kTooManyCells || of_search == Status::kTooManySwitches;
  if (!is_too_long || !adapts_trend(results_.settings)) {
    return false;
  }
  work_.trend_search_runs_ = false;
  results_.trend_left_out |= std::uint32_t{1} << results_.trend_looked_at;
  ++results_.trend_looked_at;
  if (results_.trend_looked_at == results_.settings.trend_count) {
    end_trend();
  }
  return true;
}

void Evaluation::end_trend() noexcept {
  double energy_v2s[kMaxTrendPoints];
  double time_s[kMaxTrendPoints];
  if (results_.trend_left_out != 0 && results_.trend_count < 2) {
    results_.trend_count = 0;  // No line.
    results_.trend = {};
    results_.has_trend = true;
    go_on();
    return;
  }
  for (std::size_t i = 0; i < results_.trend_count; ++i) {
    energy_v2s[i] = results_.trend_table[i].energy_v2s;
    time_s[i] = results_.trend_table[i].duration_s;
  }
  results_.trend = linear_trend(Span<const double>(time_s, results_.trend_count),
                                Span<const double>(energy_v2s, results_.trend_count));
  if (results_.trend.status != Status::kOk) {
    (void)fail({results_.trend.status, Stage::kTrend, explain(results_.trend.status)});
    return;
  }
  results_.has_trend = true;
  go_on();
}

}  // namespace emax::app
