// The job from a device to its maximum energy in short steps: fit, response, search, trials, trend.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/evaluate/stage.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/base/wichmann_hill.hpp"

namespace emax {

class AdaptiveTrials;
class FrequencyResponse;

namespace app {

class EvaluationHelper;
class EvaluationWorkspace;

/// Runs the job in short steps, so that a console or Ctrl-C is never kept waiting.
///
///     Evaluation evaluation(results, workspace);
///     evaluation.start_from_points(points, settings);
///     while (!evaluation.done()) {
///       evaluation.step();
///     }
///
/// A goal short of kReport does a part of the job; `pursue()` goes on from there. The digits are
/// the same in whatever order the parts are asked for.
///
/// A step does about as much as 1024 cells of products with Phi: some hundred thousand
/// instructions where double is in hardware, some million where it is not; one product at least.
///
/// A run is two references: what it has found is in the results, what it needs to go on in the
/// workspace. A new one on the same two goes on where the last one was. Both together take less
/// than 98 KiB. Results are those of the settings and the device alone: they depend neither on
/// earlier evaluations nor on lent memory.
class Evaluation {
 public:
  /// Both outlive this object.
  Evaluation(EvaluationResults& results, EvaluationWorkspace& workspace) noexcept
      : results_(results), work_(workspace) {}

  /// The fit of measured points, then everything else for the device that it finds.
  ///
  /// Whatever is wrong with settings, points or device, and a T that needs too many cells, is found
  /// here. Results of before are lost in every case.
  ///
  /// @returns
  /// * kOk: `step()` until `done()`.
  /// * kInvalidArgument: A setting out of its range (`check()` says which), or uncertainties so
  /// large that the ranges of paper equation (21) leave what a device may be.
  /// * kTooManyCells: T, or one of the trend's, needs too many cells: `failure.duration_s`.
  /// * Else what `Wlsp::fit()` or `ModalModel::set()` answered; `fit` then holds the fit as far as
  /// it came. Unless it is kOk, `stage` of the results is kFailed and their `failure` says why.
  Status start_from_points(const FrequencyResponse& points, const Settings& settings,
                           Goal goal = Goal::kReport) noexcept;

  /// The same for a device whose parameters are known. With uncertainties of zero there is no Monte
  /// Carlo run.
  Status start_from_model(const Device& device, const Settings& settings,
                          Goal goal = Goal::kReport) noexcept;

  /// The same with the covariance of S, f0 and beta, of a fit that was made before.
  Status start_from_model(const Device& device, const double (&covariance)[3][3],
                          const Settings& settings, Goal goal = Goal::kReport) noexcept;

  /// Goes on with the same device to another goal: what is complete is kept, what the goal lacks is
  /// computed. A run that is under way is stopped as by `stop()`.
  ///
  /// @param[in] settings Those of the start, but for what belongs to Monte Carlo (trials, adaptive,
  ///   probability, distribution, birge, seed, generator) and to the trend (its times). Results
  ///   that were made with other settings than these are dropped.
  /// @returns
  /// * kOk: `step()` until `done()`.
  /// * kInvalidArgument: No device has been accepted before, a setting is out of its range or
  ///   differs where it must not, or the ranges of the trials leave what a device may be.
  /// * kTooManyCells: A time of the trend needs too many cells.
  /// Unless it is kOk, nothing has changed but `failure` of the results, which says why.
  Status pursue(const Settings& settings, Goal goal) noexcept;

  /// Ends the work: `done()` is true, complete parts are kept, the one under way is dropped.
  void stop() noexcept;

  /// Does a short piece of work; nothing before a start or when done. After kFailed, `failure` of
  /// the results says why.
  void step() noexcept;

  bool done() const noexcept { return results_.done(); }
  /// @returns Progress of this stage from 0 to 1; of kAdaptive an estimate, which may go back.
  double progress() const noexcept;

  /// Lends memory for the value of each trial: with it each trial is computed once, without it once
  /// per pass (three or four). The results are the same, also if the memory holds only some of the
  /// trials. After a start, until the evaluation is done.
  void lend_trial_store(Span<double> store) noexcept;

  /// The damping to hold where a table has magnitudes alone that do not determine it
  /// (`Wlsp::give_damping()`); 0 for none. For the starts to come, on the same results.
  void give_damping(double damping) noexcept { results_.fit.give_damping(damping); }

  /// Lends memory for the polynomials of parts of the ranges (`TrialSettings::pieces`): with it
  /// trials of devices with many switches take microseconds, without it each may be a refinement.
  /// After a start, until the evaluation is done.
  void lend_trial_pieces(TrialPieces pieces) noexcept;

  /// Lends other cores, or null for none. They make the trials for which a store is lent, and the
  /// draws of the fit. After a start, until the evaluation is done.
  void lend_helper(EvaluationHelper* helper) noexcept;

  /// The number of draws for the covariance of the fit.
  static constexpr std::uint32_t kFitDraws = 10000;
  /// The fraction of the peak of k within which it has settled.
  static constexpr double kSettled = 0.05;

 private:
  WichmannHill seeded_generator() const noexcept;
  double progress_of_stage() const noexcept;
  double adaptive_progress(const AdaptiveTrials& adaptive) const noexcept;
  void step_stage() noexcept;
  bool advance_trial(std::uint32_t trial) noexcept;
  bool is_helped(std::uint32_t trial) const noexcept;
  void store_trials(std::uint32_t end) noexcept;
  void run_slice() noexcept;

  Status begin(Source source, const Settings& settings) noexcept;
  Status prepare(Goal goal) noexcept;
  void begin_run(Goal goal) noexcept;
  void go_on() noexcept;
  void drop_incomplete() noexcept;
  Status fail(const Failure& failure) noexcept;
  void begin_model() noexcept;
  void step_model() noexcept;
  void begin_fit_draws() noexcept;
  void step_fit_draws() noexcept;
  void begin_energy() noexcept;
  bool begin_search(Stage stage, double duration_s) noexcept;
  bool is_well(Status of_search, Stage stage, double duration_s) noexcept;
  void step_energy() noexcept;
  void begin_bound() noexcept;
  void step_bound() noexcept;
  Status take_fit(Status fit_status) noexcept;
  void begin_cut_range() noexcept;
  void step_cut_range() noexcept;
  template <typename Range>
  void step_cut_range(Range& range) noexcept;
  void begin_trials() noexcept;
  void note_root(std::uint32_t trial, double energy_v2s, bool is_stored) noexcept;
  bool holds_sensitivity() const noexcept;
  bool are_trials_normal() const noexcept;
  void step_prediction() noexcept;
  void step_adaptive() noexcept;
  void begin_monte_carlo(std::uint32_t trials) noexcept;
  void step_monte_carlo() noexcept;
  void begin_guard() noexcept;
  void step_guard() noexcept;
  void end_trials() noexcept;
  bool begin_next_figure() noexcept;
  void begin_figure(Stage stage) noexcept;
  void begin_uncertainty() noexcept;
  void step_figure() noexcept;
  void step_figure_settling() noexcept;
  void step_figure_search() noexcept;
  void step_figure_bound() noexcept;
  void step_figure_prediction() noexcept;
  void step_figure_trials() noexcept;
  void step_figure_guard() noexcept;
  void take_uncertainty(EnergyUncertainty& known) const noexcept;
  bool is_of_uncertainty() const noexcept;
  bool are_relative() const noexcept;
  bool begin_relative() noexcept;
  void take_relative(EnergyUncertainty& known) const noexcept;
  double sensitivity_of(std::uint32_t trial, bool is_stored) noexcept;
  void end_figure_energy(bool is_proven) noexcept;
  void begin_figure_trials() noexcept;
  void begin_figure_range() noexcept;
  void step_figure_range() noexcept;
  bool wants_figure_range() const noexcept;
  void refuse_figure(Status status) noexcept;
  void refuse_uncertainty(Status status) noexcept;
  double progress_of_figure() const noexcept;
  double progress_of_trials() const noexcept;
  Status set_figure_model(ModalModel& model) const noexcept;
  ErrorMeasure figure_measure() const noexcept;
  FigureResults& figure() noexcept;
  EnergyUncertainty& uncertainty() noexcept;
  TrialSettings trial_settings(Distribution distribution) const noexcept;
  void step_trend() noexcept;
  void add_trend_point(double energy_v2s) noexcept;
  bool leaves_out(Status of_search) noexcept;
  void end_trend() noexcept;

  EvaluationResults& results_;
  EvaluationWorkspace& work_;
};

static_assert(std::is_trivially_copyable_v<Evaluation>);

}  // namespace app
}  // namespace emax
