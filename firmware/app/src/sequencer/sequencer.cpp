// The device, the jobs and their ends.
#include "emax/app/sequencer/sequencer.hpp"

namespace emax::app {

// The device

void Sequencer::take(const Device& device) noexcept {
  identification_.device = device;
  has_identification_ = false;
  origin_ = Origin::kModel;
}

void Sequencer::take(const Identification& identification) noexcept {
  identification_ = identification;
  has_identification_ = true;
  origin_ = Origin::kModel;
}

void Sequencer::take(const FrequencyResponse& points) noexcept {
  points_ = points;
  if (has_measured(points)) {
    (void)points_.set_shared(sweep_.shared);  // It was accepted by the sweep's own points.
  }
  has_identification_ = false;
  points_origin_ = Origin::kTable;
  origin_ = Origin::kTable;
}

void Sequencer::take(const SweepResults& sweep) noexcept {
  sweep_ = sweep;
  (void)sweep_.copy_to(points_);
  has_identification_ = false;
  points_origin_ = Origin::kSweep;
  origin_ = Origin::kSweep;
}

void Sequencer::give_damping(double damping) noexcept {
  evaluation_.clear();
  evaluation_.fit.give_damping(damping);
}

bool Sequencer::take_points() noexcept {
  const bool changes = origin_ == Origin::kModel && points_.size() > 0;
  if (changes) {
    origin_ = points_origin_;
  }
  return changes;
}

bool Sequencer::clear_points() noexcept {
  points_.clear();
  points_origin_ = Origin::kNothing;
  if (origin_ == Origin::kModel) {
    return false;
  }
  origin_ = Origin::kNothing;
  return true;
}

void Sequencer::reset() noexcept {
  abort();
  (void)clear_points();
  has_identification_ = false;
  origin_ = Origin::kNothing;
  evaluation_.clear();
}

bool Sequencer::is_of_device() const noexcept {
  switch (origin_) {
    case Origin::kNothing:
      return false;
    case Origin::kSweep:
    case Origin::kTable:
      return evaluation_.is_of(points_);
    case Origin::kModel:
      return evaluation_.is_of(identification_.device);
  }
  return false;
}

Obstacle Sequencer::obstacle_to(Part part) const noexcept {
  if ((job_ == Job::kSweep || job_ == Job::kLoopback) && part != Part::kSettings) {
    return Obstacle::kSweepRuns;
  }
  const bool computes = job_ == Job::kEvaluation || job_ == Job::kFixedPoint;
  return computes && part != Part::kSweepSettings ? Obstacle::kComputes : Obstacle::kNone;
}

// The sweep

Refusal Sequencer::measure(hal::AnalogStream& stream, const SweepSettings& settings) noexcept {
  if (is_working()) {
    return {obstacle_to(Part::kDevice)};
  }
  stream_ = &stream;
  const Status status = sweep_run().start(settings);
  if (status == Status::kInvalidArgument) {
    return {Obstacle::kSweepSetting, status};
  }
  if (status != Status::kOk) {
    return {Obstacle::kSweep, status};
  }
  points_.clear();
  points_origin_ = Origin::kSweep;
  has_identification_ = false;
  origin_ = Origin::kSweep;
  evaluates_next_ = false;
  begin(Job::kSweep);
  return {};
}

Refusal Sequencer::measure_and_evaluate(hal::AnalogStream& stream, const SweepSettings& sweep,
                                        const Settings& settings, Goal goal) noexcept {
  const Refusal refusal = measure(stream, sweep);
  if (!refusal) {
    evaluation_.clear();
    evaluation_.settings = settings;
    goal_ = goal;
    evaluates_next_ = true;
  }
  return refusal;
}

void Sequencer::end_sweep() noexcept {
  job_ = Job::kNone;
  (void)sweep_.copy_to(points_);  // A sweep that is done has points that a table takes.
  if (sweep_.status != Status::kOk) {
    failure_ = {Obstacle::kSweep, sweep_.status};
    return;
  }
  if (evaluates_next_) {
    const Refusal refusal = evaluate(evaluation_.settings, goal_);
    failure_ = refusal ? refusal : failure_;
  }
}

// The loopback

Refusal Sequencer::loop_back(hal::AnalogStream& stream, const SweepSettings& settings) noexcept {
  if (is_working()) {
    return {obstacle_to(Part::kDevice)};
  }
  stream_ = &stream;
  (void)stream.loop_back(true);
  const Status status = workspace_.loopback.start(stream, settings);
  if (status != Status::kOk) {
    (void)stream.loop_back(false);
    return {Obstacle::kSweep, status};
  }
  begin(Job::kLoopback);
  return {};
}

void Sequencer::step_loopback() noexcept {
  workspace_.loopback.step(*stream_);
  if (workspace_.loopback.done()) {
    end_loopback();
  }
}

void Sequencer::end_loopback() noexcept {
  job_ = Job::kNone;
  (void)stream_->loop_back(false);
  const Status status = workspace_.loopback.status();
  has_loopback_ = status == Status::kOk;
  if (status == Status::kNoReference) {
    failure_ = {Obstacle::kNoWire};
  } else if (status == Status::kInvertedPolarity) {
    failure_ = {Obstacle::kTurnedWire};
  } else if (status == Status::kDistorted) {
    failure_ = {Obstacle::kUnsteadyWire};
  } else if (!has_loopback_) {
    failure_ = {Obstacle::kSweep, status};
  }
}

// The evaluation

/// Of a fit of before power off the evaluation takes the parameters with their covariance, but not
/// the Birge ratio.
bool Sequencer::needs_lost_fit(const Settings& settings) const noexcept {
  const Identification& fit = identification_;
  const bool is_poor = fit.chi2 > static_cast<double>(fit.dof);
  return has_identification_ && fit.source == Source::kPoints && settings.birge && is_poor;
}

Refusal Sequencer::missing_input(const Settings& settings, Goal goal) const noexcept {
  if (origin_ == Origin::kNothing) {
    return {Obstacle::kNoDevice};
  }
  if ((wants_trials(goal) || wants_uncertainty(goal)) && needs_lost_fit(settings)) {
    return {Obstacle::kNoFit};
  }
  if (origin_ != Origin::kModel && points_.size() == 0) {
    return {Obstacle::kNoPoints};
  }
  return {};
}

Status Sequencer::start_evaluation(const Settings& settings, Goal goal) noexcept {
  Evaluation run = evaluation_run();
  if (is_of_device() && evaluation_.holds_energy_of(settings)) {
    return run.pursue(settings, goal);
  }
  if (origin_ != Origin::kModel) {
    return run.start_from_points(points_, settings, goal);
  }
  const bool is_fit = has_identification_ && identification_.source == Source::kPoints;
  return is_fit ? run.start_from_model(identification_.device, identification_.covariance, settings,
                                       goal)
                : run.start_from_model(identification_.device, settings, goal);
}

Refusal Sequencer::evaluate(const Settings& settings, Goal goal) noexcept {
  if (is_working()) {
    return {obstacle_to(Part::kDevice)};
  }
  if (const Refusal refusal = missing_input(settings, goal)) {
    return refusal;
  }
  has_fixed_point_ = false;
  has_loopback_ = false;
  const Status status = start_evaluation(settings, goal);
  if (status != Status::kOk) {
    return {Obstacle::kEvaluation, status};
  }
  evaluation_run().lend_trial_store(trial_store_);
  evaluation_run().lend_trial_pieces(trial_pieces_);
  evaluation_run().lend_helper(helper_);
  goal_ = goal;
  begin(Job::kEvaluation);
  if (evaluation_.done()) {
    end_evaluation();
  }
  return {};
}

void Sequencer::end_evaluation() noexcept {
  job_ = Job::kNone;
  if (evaluation_.status() != Status::kOk) {
    failure_ = {Obstacle::kEvaluation, evaluation_.status()};
  } else if ((goal_ == Goal::kMonteCarlo && !evaluation_.has_monte_carlo) ||
             (goal_ == Goal::kUncertainty && !evaluation_.uncertainty.is_done)) {
    const bool has_range = goal_ == Goal::kUncertainty && evaluation_.has_cut_range;
    const bool is_open = evaluation_.is_damping_open();
    failure_ = {has_range ? Obstacle::kNone
                : is_open ? Obstacle::kOpenDamping
                          : Obstacle::kNoUncertainty};
  } else if (goal_ == Goal::kTrend && !evaluation_.has_trend) {
    failure_ = {Obstacle::kNoTimes};
  }
}

// The fixed point

Refusal Sequencer::iterate_fixed_point(const Settings& settings) noexcept {
  if (is_working()) {
    return {obstacle_to(Part::kDevice)};
  }
  if (!evaluation_.is_accepted) {
    return {Obstacle::kNoDevice};
  }
  has_fixed_point_ = false;
  if (workspace_.fixed_point.start(evaluation_.model, evaluation_.limit_mps2, settings) !=
      Status::kOk) {
    return {Obstacle::kGrid};
  }
  begin(Job::kFixedPoint);
  return {};
}

// All of them

void Sequencer::begin(Job job) noexcept {
  job_ = job;
  failure_ = {};
  has_fixed_point_ = false;
  has_loopback_ = false;
}

void Sequencer::step() noexcept {
  switch (job_) {
    case Job::kNone:
      return;
    case Job::kSweep:
      sweep_run().step();
      if (sweep_.done()) {
        end_sweep();
      }
      return;
    case Job::kLoopback:
      step_loopback();
      return;
    case Job::kEvaluation:
      evaluation_run().step();
      if (evaluation_.done()) {
        end_evaluation();
      }
      return;
    case Job::kFixedPoint:
      workspace_.fixed_point.step();
      has_fixed_point_ = workspace_.fixed_point.done();
      job_ = has_fixed_point_ ? Job::kNone : job_;
      return;
  }
}

void Sequencer::abort() noexcept {
  if (job_ == Job::kSweep) {
    sweep_run().stop();
    (void)sweep_.copy_to(points_);
  }
  if (job_ == Job::kLoopback) {
    workspace_.loopback.stop(*stream_);
    (void)stream_->loop_back(false);
  }
  if (job_ == Job::kEvaluation) {
    evaluation_run().stop();
  }
  job_ = Job::kNone;
}

double Sequencer::progress() const noexcept {
  switch (job_) {
    case Job::kNone:
      return 1.0;
    case Job::kSweep:
      return sweep_.progress();
    case Job::kLoopback:
      return workspace_.loopback.progress();
    case Job::kEvaluation:
      return workspace_.evaluation.progress();
    case Job::kFixedPoint:
      return workspace_.fixed_point.progress();
  }
  return 1.0;
}

const char* Sequencer::stage_name() const noexcept {
  switch (job_) {
    case Job::kNone:
      return "idle";
    case Job::kSweep:
      return "sweep";
    case Job::kLoopback:
      return "loopback";
    case Job::kEvaluation:
      return name_of(evaluation_.stage);
    case Job::kFixedPoint:
      return "fixed point";
  }
  return "idle";
}

}  // namespace emax::app
