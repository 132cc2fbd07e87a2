// The figures beside the maximum energy: the ideal sensor, the in-band errors, and the uncertainty
// of each.
#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/evaluate/evaluation_workspace.hpp"
#include "emax/base/elementary.hpp"
#include "emax/energy/known_energy.hpp"

#include "evaluation_checks.hpp"

namespace emax::app {
namespace {

constexpr double kPercent = 100.0;

/// Whether something of a figure is still to be done.
bool lacks(const FigureResults& figure, bool with_uncertainty, bool with_range) noexcept {
  return !figure.is_done || (with_uncertainty && figure.exists() && !figure.uncertainty.is_done) ||
         (with_range && figure.exists() && !figure.is_range_done);
}

SearchSettings figure_search(const Settings& settings) noexcept {
  return {Method::kBest, settings.duration_s, 0.0, 0};
}

}  // namespace

FigureResults& Evaluation::figure() noexcept {
  return results_.stage == Stage::kMatched ? results_.matched : results_.band;
}

EnergyUncertainty& Evaluation::uncertainty() noexcept {
  return results_.stage == Stage::kUncertainty ? results_.uncertainty : figure().uncertainty;
}

/// @returns Whether one has begun; false if all are done.
bool Evaluation::begin_next_figure() noexcept {
  const bool with_uncertainty = work_.goal_ == Goal::kReport && results_.has_uncertainty();
  if (!results_.ideal.is_done) {
    begin_figure(Stage::kIdeal);
  } else if (lacks(results_.band, with_uncertainty, wants_figure_range())) {
    begin_figure(Stage::kBand);
  } else if (lacks(results_.matched, with_uncertainty, wants_figure_range())) {
    begin_figure(Stage::kMatched);
  } else {
    return false;
  }
  return true;
}

Status Evaluation::set_figure_model(ModalModel& model) const noexcept {
  const Accelerometer& device = results_.device.estimate;
  const Settings& settings = results_.settings;
  const ReferenceFilter filter = reference_filter(results_);
  if (results_.stage == Stage::kIdeal) {
    const bool has_delay = settings.criterion == Criterion::kInBandError &&
                           settings.delay_choice == DelayChoice::kGiven;
    return model.set_ideal(device.sensitivity, filter, settings.criterion,
                           has_delay ? settings.delay_s : 0.0);
  }
  return model.set(device, filter, figure_measure());
}

ErrorMeasure Evaluation::figure_measure() const noexcept {
  const Settings& settings = results_.settings;
  ReferenceDelay delay;
  if (results_.stage == Stage::kMatched) {
    const bool is_given = settings.delay_choice == DelayChoice::kGiven;
    delay = is_given ? delay_of(settings) : ReferenceDelay{DelayMode::kOfSensor, 0.0};
  }
  return {Criterion::kInBandError, delay};
}

// Whatever stands in the way of a figure is written down with it; the evaluation goes on.
void Evaluation::begin_figure(Stage stage) noexcept {
  using Phase = EvaluationWorkspace::FigurePhase;
  results_.stage = stage;
  if (stage != Stage::kIdeal && figure().is_done && wants_figure_range()) {
    begin_figure_range();
    return;
  }
  work_.figure_phase_ = Phase::kSearch;
  auto* const part = new (&work_.part_.figure) EvaluationWorkspace::FigurePart;
  Status status = set_figure_model(part->model);
  if (stage == Stage::kIdeal && part->model.is_nothing()) {
    results_.ideal = {true, status, 0.0};  // In band, with the filter's gain.
    work_.figure_phase_ = Phase::kEnd;
    return;
  }
  if (stage == Stage::kIdeal && results_.settings.criterion == Criterion::kEnergyDifference) {
    // The energy of what an ideal sensor passes, less as little as the filter can pass: nothing.
    const double limit = fast_switching_limit(part->model, results_.settings.duration_s);
    results_.ideal = {true, status, results_.a2() * limit};
    work_.figure_phase_ = Phase::kEnd;
    return;
  }
  if (status == Status::kOk) {
    status = work_.search_.start(part->model, figure_search(results_.settings));
  }
  if (status != Status::kOk) {
    refuse_figure(status);
  } else if (stage == Stage::kBand) {
    part->peak.start(part->model);
    work_.figure_phase_ = Phase::kSettling;
  }
}

void Evaluation::refuse_figure(Status status) noexcept {
  if (results_.stage == Stage::kIdeal) {
    results_.ideal = {true, status, 0.0};
  } else {
    figure().is_done = true;
    figure().status = status;
    figure().is_short = results_.settings.duration_s < kMuchShorter * results_.band_settling.time_s;
  }
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kEnd;
}

void Evaluation::step_figure() noexcept {
  using Phase = EvaluationWorkspace::FigurePhase;
  switch (work_.figure_phase_) {
    case Phase::kSettling:
      step_figure_settling();
      return;
    case Phase::kSearch:
      step_figure_search();
      return;
    case Phase::kBound:
      step_figure_bound();
      return;
    case Phase::kPrediction:
      step_figure_prediction();
      return;
    case Phase::kTrials:
      step_figure_trials();
      return;
    case Phase::kGuard:
      step_figure_guard();
      return;
    case Phase::kRange:
      step_figure_range();
      return;
    case Phase::kEnd:
      go_on();
      return;
  }
}

double Evaluation::progress_of_figure() const noexcept {
  using Phase = EvaluationWorkspace::FigurePhase;
  switch (work_.figure_phase_) {
    case Phase::kSettling:
      return 0.0;
    case Phase::kSearch:
      return work_.search_.progress();
    case Phase::kBound:
      return work_.part_.figure.bound.progress();
    case Phase::kPrediction:
      return work_.part_.trial.trials.progress();
    case Phase::kTrials:
      return progress_of_trials();
    case Phase::kGuard:
      return work_.guard_.progress();
    case Phase::kRange:
      return kHasFigureRanges ? work_.part_.figure_range.range.progress() : 1.0;
    case Phase::kEnd:
      break;
  }
  return 1.0;
}

/// How long a time the error takes to develop: the filter rings longer than the peak of the whole
/// error lets see.
void Evaluation::step_figure_settling() noexcept {
  EvaluationWorkspace::FigurePart& part = work_.part_.figure;
  if (!part.peak.done()) {
    part.peak.step(part.model);
    if (part.peak.done()) {
      part.settling.start(part.model, kSettled * abs(part.peak.result().value));
    }
    return;
  }
  part.settling.step(part.model);
  if (part.settling.done()) {
    results_.band_settling = part.settling.result();
    work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kSearch;
  }
}

void Evaluation::step_figure_search() noexcept {
  EvaluationWorkspace::FigurePart& part = work_.part_.figure;
  const Status status = work_.search_.step(part.model, work_.grid_);
  if (status != Status::kOk) {
    refuse_figure(status);
    return;
  }
  if (!work_.search_.done()) {
    return;
  }
  const double duration_s = results_.settings.duration_s;
  const MaximumEnergy& found = work_.search_.result();
  if (results_.stage == Stage::kIdeal) {
    const double limit = fast_switching_limit(part.model, duration_s);
    results_.ideal = {true, Status::kOk,
                      results_.a2() * (found.energy > limit ? found.energy : limit)};
    work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kEnd;
    return;
  }
  FigureResults& figure = this->figure();
  if (figure.is_done) {  // Searched again for the trials, which need the signal.
    begin_figure_trials();
    return;
  }
  figure.energy_v2s = results_.a2() * found.energy;
  figure.rounding_v2s = results_.a2() * found.rounding;
  figure.delay_s = part.model.delay_s();
  figure.epsilon_percent =
      kPercent * delay_tolerance(part.model) / results_.device.estimate.sensitivity;
  figure.switches = static_cast<std::uint16_t>(found.signal.count());
  for (std::size_t i = 0; i < figure.times_s().size(); ++i) {
    figure.times_kept_s[i] = found.signal.times_s()[i];
  }
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kBound;
  if (part.bound.start(part.model, duration_s, work_.grid_) != Status::kOk) {
    end_figure_energy(false);
  }
}

void Evaluation::step_figure_bound() noexcept {
  EvaluationWorkspace::FigurePart& part = work_.part_.figure;
  const Status status = part.bound.step(part.model, work_.grid_);
  if (status != Status::kOk || part.bound.done()) {
    end_figure_energy(status == Status::kOk);
  }
}

void Evaluation::end_figure_energy(bool is_proven) noexcept {
  FigureResults& figure = this->figure();
  figure.has_bound = is_proven;
  figure.bound_v2s = is_proven ? results_.a2() * work_.part_.figure.bound.bound() : 0.0;
  figure.is_done = true;
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kEnd;
  if (work_.goal_ == Goal::kReport && results_.has_uncertainty()) {
    begin_figure_trials();
  } else if (wants_figure_range()) {
    begin_figure_range();
  }
}

/// Whether the dampings that the points leave open are gone through for each figure.
bool Evaluation::wants_figure_range() const noexcept {
  return kHasFigureRanges && work_.goal_ == Goal::kReport && results_.is_damping_open();
}

void Evaluation::begin_figure_range() noexcept {
  if constexpr (!kHasFigureRanges) {
    return;
  }
  auto* const part = new (&work_.part_.figure_range) EvaluationWorkspace::FigureRangePart;
  part->range.start(
      results_.judgement,
      {reference_filter(results_), figure_measure(), figure().energy_v2s / results_.a2()},
      figure_search(results_.settings), results_.settings.gain_mode != GainMode::kFixed);
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kRange;
}

void Evaluation::step_figure_range() noexcept {
  if constexpr (!kHasFigureRanges) {
    return;
  }
  FigureRange& range = work_.part_.figure_range.range;
  range.step(work_.search_, work_.grid_);
  if (!range.done()) {
    return;
  }
  FigureResults& figure = this->figure();
  figure.is_range_done = true;
  figure.has_range = range.is_found();
  figure.least_v2s = results_.a2() * range.low();
  figure.greatest_v2s = results_.a2() * range.high();
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kEnd;
}

// The search's result is still there; the model's place is that of the trials.
void Evaluation::begin_figure_trials() noexcept {
  TrialSettings settings = trial_settings(Distribution::kNormal);
  settings.search = figure_search(results_.settings);
  settings.gain_follows = false;
  settings.holds_sensitivity = results_.settings.gain_mode != GainMode::kFixed;
  work_.grid_.share_nothing();
  auto* const place = new (work_.grid_.numbers().data()) EvaluationWorkspace::FigureModel;
  (void)set_figure_model(place->model);  // As it was for the search.
  auto* const part = new (&work_.part_.trial) EvaluationWorkspace::TrialPart;
  work_.stored_ = 0;
  const Status status = part->trials.start(place->model, work_.search_.result(), settings);
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kPrediction;
  if (status != Status::kOk) {
    refuse_uncertainty(status);
  }
}

/// Whether the gain follows S where E has an uncertainty, as it does for the figures of the band:
/// an error of S is then one of gain, and none in band.
bool Evaluation::holds_sensitivity() const noexcept {
  return results_.settings.criterion == Criterion::kInBandError &&
         results_.settings.gain_mode != GainMode::kFixed;
}

void Evaluation::begin_uncertainty() noexcept {
  results_.stage = Stage::kUncertainty;
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kPrediction;
  auto* const part = new (&work_.part_.trial) EvaluationWorkspace::TrialPart;
  work_.stored_ = 0;
  TrialSettings settings = trial_settings(Distribution::kNormal);
  if (holds_sensitivity()) {
    settings.gain_follows = false;
    settings.holds_sensitivity = true;
  }
  const Status status = part->trials.start(results_.model, results_.maximum, settings);
  if (status != Status::kOk) {
    refuse_uncertainty(status);
  }
}

void Evaluation::refuse_uncertainty(Status status) noexcept {
  uncertainty() = {};
  uncertainty().is_done = true;
  uncertainty().status = status;
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kEnd;
}

void Evaluation::step_figure_prediction() noexcept {
  EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  if (!part.trials.ready()) {
    part.trials.prepare(work_.search_, work_.grid_);
    return;
  }
  const Settings& settings = results_.settings;
  work_.grid_.share_with_store();
  const std::uint32_t wanted = settings.adaptive ? results_.adaptive.trials : settings.trials;
  const std::uint32_t most = part.trials.most_trials();
  work_.trials_ = wanted < most ? wanted : most;
  const Status status =
      part.monte_carlo.start(work_.trials_, settings.probability, work_.grid_.store());
  if (status != Status::kOk) {
    refuse_uncertainty(status);
    return;
  }
  work_.progress_ = 0.0;
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kTrials;
}

void Evaluation::step_figure_trials() noexcept {
  run_slice();
  EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  if (!part.monte_carlo.done()) {
    return;
  }
  const MonteCarloResult result = part.monte_carlo.result();
  if (result.status != Status::kOk) {
    refuse_uncertainty(result.status);
    return;
  }
  if (part.is_relative) {
    take_relative(uncertainty());
  } else {
    take_uncertainty(uncertainty());
    work_.guard_.start(result.trials, result.trial_of_maximum, EnergyGuard::kSpreadOfFigure);
    if (begin_relative()) {
      return;
    }
  }
  if (part.trials.search_settings().method == Method::kPaper) {
    uncertainty().is_done = true;
    work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kEnd;
    return;
  }
  work_.progress_ = 0.0;
  work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kGuard;
}

void Evaluation::step_figure_guard() noexcept {
  EnergyGuard& guard = work_.guard_;
  // A search that fails counts as disagreement.
  (void)guard.step(work_.part_.trial.trials, work_.search_, work_.grid_);
  if (guard.done()) {
    uncertainty().guard = results_of(guard);
    uncertainty().is_done = true;
    work_.figure_phase_ = EvaluationWorkspace::FigurePhase::kEnd;
  }
}

/// What the trials that are done say; the guard is still to come.
void Evaluation::take_uncertainty(EnergyUncertainty& known) const noexcept {
  const EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  const MonteCarloResult result = part.monte_carlo.result();
  known.status = Status::kOk;
  known.trials = result.trials;
  known.redraws = part.trials.redraws();
  const BranchNotes notes = part.trials.notes();
  known.rough_trials = notes.rough_trials;
  known.rough_part = notes.rough_part;
  known.mean_v2s = result.mean;
  known.u_v2s = result.u;
  known.symmetric = result.symmetric;
  known.shortest = result.shortest;
  known.has_relative = false;
  // percent_of() of an energy is as sqrt(E) is.
  constexpr double kRounding = 1e-12;
  const double u = sqrt(part.root.squares / static_cast<double>(part.root.count - 1));
  const bool is_rounding = u <= kRounding * part.root.origin;  // Not where an energy has no root.
  known.u_percent = is_rounding ? 0.0 : results_.percent_of(1.0) * u;
}

/// Whether the trials that run are of an uncertainty whose percentages are of another S in each.
bool Evaluation::are_relative() const noexcept {
  return is_of_uncertainty() && results_.settings.gain_mode == GainMode::kFixed &&
         results_.device.u.sensitivity > 0.0;
}

/// Whether the trials that run, or have just been run, are those of an uncertainty.
bool Evaluation::is_of_uncertainty() const noexcept {
  return results_.stage >= Stage::kBand ||
         (are_trials_normal() && results_.stage == Stage::kMonteCarlo);
}

/// @returns Whether the same trials are run once more, for the intervals of E (S/S_t)^2.
bool Evaluation::begin_relative() noexcept {
  EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  part.is_relative =
      are_relative() && part.monte_carlo.start(work_.trials_, results_.settings.probability,
                                               work_.grid_.store()) == Status::kOk;
  return part.is_relative;
}

void Evaluation::take_relative(EnergyUncertainty& known) const noexcept {
  const MonteCarloResult result = work_.part_.trial.monte_carlo.result();
  known.relative_symmetric = result.symmetric;
  known.relative_shortest = result.shortest;
  known.has_relative = result.status == Status::kOk;
}

/// @returns The S of a trial that has just been made, or whose energy was taken from the store.
double Evaluation::sensitivity_of(std::uint32_t trial, bool is_stored) noexcept {
  EnergyTrials& trials = work_.part_.trial.trials;
  return is_stored ? trials.device(trial).sensitivity : trials.sensitivity();
}

/// Takes sqrt(E) over the trial's own S, for that of the estimate, while the first pass runs.
void Evaluation::note_root(std::uint32_t trial, double energy_v2s, bool is_stored) noexcept {
  EvaluationWorkspace::TrialPart& part = work_.part_.trial;
  EvaluationWorkspace::Scatter& root = part.root;
  if (!is_of_uncertainty() || part.is_relative || part.monte_carlo.pass() != 1) {
    return;
  }
  const Accelerometer& estimate = results_.device.estimate;
  const bool is_figure = results_.stage == Stage::kBand || results_.stage == Stage::kMatched;
  const bool is_held =
      results_.settings.gain_mode != GainMode::kFixed && (is_figure || holds_sensitivity());
  const double sensitivity = sensitivity_of(trial, is_stored && !is_held);
  const double value = sqrt(energy_v2s) * (estimate.sensitivity / sensitivity);
  if (root.count == 0) {
    root.origin = value;
  }
  ++root.count;
  const double off = value - root.origin;
  const double before = off - root.mean;
  root.mean += before / static_cast<double>(root.count);
  root.squares += before * (off - root.mean);
}

}  // namespace emax::app
