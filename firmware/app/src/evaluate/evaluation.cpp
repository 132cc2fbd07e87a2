// What the job starts from, and what it goes on with.
#include "emax/app/evaluate/evaluation.hpp"

#include "emax/app/evaluate/evaluation_workspace.hpp"

#include "evaluation_checks.hpp"

namespace emax::app {

Status Evaluation::start_from_points(const FrequencyResponse& points, const Settings& settings,
                                     Goal goal) noexcept {
  const Status status = begin(Source::kPoints, settings);
  if (status != Status::kOk) {
    return status;
  }
  const Status fit_status = take_fit(results_.fit.fit(points));
  return fit_status == Status::kOk ? prepare(goal) : fit_status;
}

/// The device by what the points determine.
Status Evaluation::take_fit(Status fit_status) noexcept {
  const WlspFit& fit = results_.fit.result();
  results_.judgement = judge(fit);
  const FitJudgement& judgement = results_.judgement;
  if (judgement.determined == Determined::kSensitivity) {
    return fail(failure_of_sensitivity_alone());
  }
  if (judgement.determined == Determined::kAllButDamping) {
    results_.device.estimate = judgement.device;
    results_.device.u = {judgement.u_sensitivity, judgement.u_natural_frequency_hz, 0.0};
    return Status::kOk;
  }
  if (fit_status != Status::kOk) {
    return fail(failure_of_fit(fit_status));
  }
  results_.device.estimate = fit.model;
  results_.device.u = {fit.u_sensitivity, fit.u_natural_frequency_hz, fit.u_damping};
  return Status::kOk;
}

Status Evaluation::start_from_model(const Device& device, const Settings& settings,
                                    Goal goal) noexcept {
  const Status status = begin(Source::kModel, settings);
  if (status != Status::kOk) {
    return status;
  }
  results_.device = device;
  const ParameterBox& u = device.u;
  const double us[] = {u.sensitivity, u.natural_frequency_hz, u.damping};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      results_.given_covariance[i][j] = i == j ? us[i] * us[i] : 0.0;
    }
  }
  return prepare(goal);
}

Status Evaluation::start_from_model(const Device& device, const double (&covariance)[3][3],
                                    const Settings& settings, Goal goal) noexcept {
  const Status status = begin(Source::kModel, settings);
  if (status != Status::kOk) {
    return status;
  }
  results_.device = device;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      results_.given_covariance[i][j] = covariance[i][j];
    }
  }
  return prepare(goal);
}

Status Evaluation::begin(Source source, const Settings& settings) noexcept {
  results_.clear();
  results_.source = source;
  results_.settings = settings;
  const Failure failure = check_settings(settings);
  return failure.status == Status::kOk ? Status::kOk : fail(failure);
}

Status Evaluation::prepare(Goal goal) noexcept {
  const Settings& settings = results_.settings;
  const Accelerometer& estimate = results_.device.estimate;
  Failure failure = check_device(estimate);
  if (failure.status != Status::kOk) {
    return fail(failure);
  }
  results_.limit_mps2 = settings.limit_is_auto ? estimate.sensitivity : settings.limit_mps2;
  const Status status =
      results_.model.set(estimate, reference_filter(results_), measure_of(settings));
  if (status != Status::kOk) {
    return fail(failure_of_model(status, settings));
  }
  failure = check_goal(results_, settings, goal);
  if (failure.status != Status::kOk) {
    return fail(failure);
  }
  results_.is_accepted = true;
  begin_run(goal);
  return results_.failure.status;
}

Status Evaluation::pursue(const Settings& settings, Goal goal) noexcept {
  results_.failure = check_pursuit(results_, settings);
  if (results_.failure.status == Status::kOk) {
    results_.failure = check_goal(results_, settings, goal);
  }
  if (results_.failure.status != Status::kOk) {
    return results_.failure.status;
  }
  drop_incomplete();
  if (!is_same_random(settings, results_.settings)) {
    results_.has_fit_draws = false;
  }
  if (!is_same_trials(settings, results_.settings)) {
    results_.drop_trials();
    results_.drop_uncertainties();
  }
  if (!is_same_trend(settings, results_.settings)) {
    results_.drop_trend();
  }
  results_.settings = settings;
  begin_run(goal);
  return results_.failure.status;
}

void Evaluation::begin_run(Goal goal) noexcept {
  work_.goal_ = goal;
  work_.store_ = {};
  work_.pieces_ = {};
  work_.helper_ = nullptr;
  work_.stored_ = 0;
  work_.trial_runs_ = false;
  work_.trend_search_runs_ = false;
  go_on();
}

/// Begins the first part that the goal still lacks.
void Evaluation::go_on() noexcept {
  const Goal goal = work_.goal_;
  work_.progress_ = 0.0;
  if (!results_.has_model) {
    begin_model();
  } else if (goal == Goal::kReport && results_.has_fit() && !results_.has_fit_draws) {
    begin_fit_draws();
  } else if (goal != Goal::kModel && !results_.has_energy) {
    begin_energy();
  } else if (goal != Goal::kModel && !results_.is_bound_done) {
    begin_bound();
  } else if (wants_trend(goal) && !results_.has_trend && results_.settings.trend_count != 0) {
    results_.stage = Stage::kTrend;
  } else if ((needs_trials(goal, results_.settings) || wants_uncertainty(goal)) &&
             results_.is_damping_open() && !results_.is_cut_done) {
    begin_cut_range();
  } else if (needs_trials(goal, results_.settings) && !results_.has_monte_carlo &&
             results_.has_uncertainty()) {
    begin_trials();
  } else if (wants_figures(goal) && begin_next_figure()) {
    return;
  } else if (wants_uncertainty(goal) && !results_.uncertainty.is_done &&
             results_.has_uncertainty()) {
    begin_uncertainty();
  } else {
    results_.stage = Stage::kDone;
  }
}

void Evaluation::stop() noexcept {
  if (results_.stage == Stage::kIdle || results_.stage == Stage::kFailed) {
    return;
  }
  drop_incomplete();
  results_.stage = Stage::kDone;
}

void Evaluation::drop_incomplete() noexcept {
  if (!results_.has_monte_carlo && !results_.is_cut_done) {
    results_.drop_trials();
  }
  if (!results_.has_trend) {
    results_.drop_trend();
  }
}

void Evaluation::lend_trial_pieces(TrialPieces pieces) noexcept { work_.pieces_ = pieces; }

void Evaluation::lend_helper(EvaluationHelper* helper) noexcept { work_.helper_ = helper; }

void Evaluation::lend_trial_store(Span<double> store) noexcept {
  work_.store_ = store;
  work_.stored_ = 0;
}

Status Evaluation::fail(const Failure& failure) noexcept {
  results_.failure = failure;
  results_.stage = Stage::kFailed;
  return failure.status;
}

}  // namespace emax::app
