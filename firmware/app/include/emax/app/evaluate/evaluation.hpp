// The job from a device to its maximum energy in short steps: fit, response, search, trials, trend.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/evaluate/cut_range.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/bound/energy_bound.hpp"
#include "emax/energy/energy_search.hpp"
#include "emax/identify/fit_judgement.hpp"
#include "emax/identify/frequency_response.hpp"
#include "emax/identify/wlsp.hpp"
#include "emax/model/absolute_error.hpp"
#include "emax/model/modal_model.hpp"
#include "emax/model/response_scan.hpp"
#include "emax/uncertainty/energy_guard.hpp"
#include "emax/uncertainty/energy_trials.hpp"
#include "emax/uncertainty/monte_carlo.hpp"
#include "emax/uncertainty/trend.hpp"

namespace emax::app {

/// A device with the standard uncertainties of its parameters.
struct Device {
  Accelerometer estimate;
  ParameterBox u;  ///< Standard uncertainties; also the half-widths of paper equation (21).
};

enum class Source : std::uint8_t { kPoints, kModel };

enum class Stage : std::uint8_t {
  kIdle,
  kModel,       ///< Peak, settling time and the largest absolute error.
  kFitDraws,    ///< Covariance of the fit by Monte Carlo draws.
  kEnergy,      ///< The largest energy at the estimate.
  kBound,       ///< What no signal can exceed.
  kPrediction,  ///< How the best signal changes over the ranges of the parameters.
  kAdaptive,    ///< Number of trials by JCGM 101 7.9.
  kMonteCarlo,
  kGuard,  ///< Full searches for some of the trials.
  kTrend,
  kDone,
  kFailed,
};

/// @returns "fit", "energy", "number of trials", "Monte Carlo", "trend" and so on, for a progress
/// line.
const char* name_of(Stage stage) noexcept;

/// How far an evaluation goes. What a goal needs is done first; what is there already is kept.
enum class Goal : std::uint8_t {
  kModel,       ///< Fit, error system, its peak and settling time, the largest absolute error.
  kEnergy,      ///< kModel, the largest energy at the estimate, and its upper bound.
  kMonteCarlo,  ///< kEnergy, the trials and the guard.
  kTrend,       ///< kEnergy and the trend.
  kReport,      ///< Everything, with the draws of the fit.
};

/// The largest energy for one duration of the trend.
struct TrendPoint {
  double duration_s = 0.0;
  double energy = 0.0;  ///< For a = 1.
};

/// Why an evaluation was refused or has ended early.
struct Failure {
  Status status = Status::kOk;
  /// The stage that failed: kIdle for what was put in, kFitDraws for the fit.
  Stage stage = Stage::kIdle;
  const char* reason =
      nullptr;              ///< One sentence: what is wrong and what to do. Null if all is well.
  double duration_s = 0.0;  ///< The T of the search that failed; 0 if it was no search.
};

/// A result whose status is zero, too: one default that is not would take flash for the whole
/// object that the result is a part of.
template <typename Result>
constexpr Result all_zero() noexcept {
  Result result;
  result.status = Status::kOk;
  return result;
}

/// What is kept of the trials: the results and a coarse histogram.
class TrialResults {
 public:
  static constexpr std::size_t kRows = 64;

  const MonteCarloResult& result() const noexcept { return result_; }
  /// The number of values in equal bins from the smallest to the largest.
  Span<const std::uint32_t> histogram() const noexcept { return Span<const std::uint32_t>(rows_); }

  /// Takes over the results of a procedure that is done.
  void take(const MonteCarlo& monte_carlo, const MonteCarloStore& store) noexcept;

 private:
  MonteCarloResult result_ = all_zero<MonteCarloResult>();
  std::uint32_t rows_[kRows] = {};
};

/// The memory that an evaluation works in, lent by the caller to each call that needs it. Between
/// `done()` and the next `start_...()` or `pursue()` it may hold anything else. 80 KiB, all zero
/// before use.
class EvaluationWorkspace {
 private:
  friend class Evaluation;

  // Made in place, one at a time; <new> is no header of a freestanding program.
  struct InPlace {
    static void* operator new(std::size_t /*size*/, void* place) noexcept { return place; }
  };
  struct ModelPart : InPlace {
    PeakSearch peak;
    SettlingSearch settling;
    AbsoluteError absolute_error;
  };
  struct BoundPart : InPlace {
    EnergyBound bound;
  };
  struct CutPart : InPlace {
    CutRange range;
  };
  struct TrialPart : InPlace {
    EnergyTrials trials;
    MonteCarlo monte_carlo;
    AdaptiveTrials adaptive;
  };
  union Part {
    constexpr Part() noexcept : trial() {}
    ModelPart model;
    BoundPart bound;
    CutPart cut;
    TrialPart trial;
  };

  GridWorkspace grid_;
  EnergySearch search_;
  Part part_;
};

static_assert(std::is_trivially_copyable_v<EvaluationWorkspace>);

/// Runs the job in short steps, so that a console or Ctrl-C is never kept waiting.
///
///     evaluation.start_from_points(points, settings, workspace);
///     while (!evaluation.done()) {
///       evaluation.step(workspace);
///     }
///
/// A goal short of kReport does a part of the job; `pursue()` goes on from there. The digits are
/// the same in whatever order the parts are asked for.
///
/// A step does about as much as 1024 cells of products with Phi: some hundred thousand
/// instructions where double is in hardware, some million where it is not; one product at least.
///
/// The object keeps results; the memory to find them is the workspace. Both together take less than
/// 92 KiB and are all zero before use.
///
/// Energies are
/// kept for a = 1 and leave through the accessors in V^2 s. Results are those of the settings and
/// the device alone: they depend neither on earlier evaluations nor on lent memory.
class Evaluation {
 public:
  /// The fit of measured points, then everything else for the device that it finds.
  ///
  /// Whatever is wrong with settings, points or device, and a T that needs too many cells, is found
  /// here. Results of before are lost in every case.
  ///
  /// @returns
  /// * kOk: `step()` until `done()`.
  /// * kInvalidArgument: A setting out of its range (`check()` says which), or uncertainties so
  /// large that the ranges of paper equation (21) leave what a device may be.
  /// * kTooManyCells: T, or one of the trend's, needs too many cells: `failure().duration_s`.
  /// * Else what `Wlsp::fit()` or `ModalModel::set()` answered; `fit()` then holds the fit as far
  /// as it came.
  /// Unless it is kOk, `stage()` is kFailed and `failure()` says why.
  Status start_from_points(const FrequencyResponse& points, const Settings& settings,
                           EvaluationWorkspace& workspace, Goal goal = Goal::kReport) noexcept;

  /// The same for a device whose parameters are known. With uncertainties of zero there is no Monte
  /// Carlo run.
  Status start_from_model(const Device& device, const Settings& settings,
                          EvaluationWorkspace& workspace, Goal goal = Goal::kReport) noexcept;

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
  /// Unless it is kOk, nothing has changed but `failure()`, which says why.
  Status pursue(const Settings& settings, Goal goal, EvaluationWorkspace& workspace) noexcept;

  /// Ends the work: `done()` is true, complete parts are kept, the one under way is dropped.
  void stop() noexcept;

  /// Does a short piece of work; nothing before a start or when done. After kFailed, `failure()`
  /// says why.
  void step(EvaluationWorkspace& workspace) noexcept;

  bool done() const noexcept { return stage_ == Stage::kDone || stage_ == Stage::kFailed; }
  Stage stage() const noexcept { return stage_; }
  /// @returns Progress of this stage from 0 to 1; of kAdaptive an estimate, which may go back.
  double progress() const noexcept { return progress_; }
  Status status() const noexcept { return failure_.status; }
  const Failure& failure() const noexcept { return failure_; }

  /// Lends memory for the value of each trial: with it each trial is computed once, without it once
  /// per pass (three or four). The results are the same, also if the memory holds only some of the
  /// trials. Valid until the evaluation is done; may be lent before or after the start.
  void lend_trial_store(Span<double> store) noexcept {
    store_ = store;
    stored_ = 0;
  }

  /// The damping to hold where a table has magnitudes alone that do not determine it
  /// (`Wlsp::give_damping()`); 0 for none. For the starts to come.
  void give_damping(double damping) noexcept { fit_.give_damping(damping); }

  // Results, each complete once its stage has passed.
  /// What the points determine; with Determined::kAllButDamping there are no trials, but the range
  /// of the energies over the dampings that are left open. Source::kPoints only.
  const FitJudgement& judgement() const noexcept { return judgement_; }
  bool is_damping_open() const noexcept {
    return source_ == Source::kPoints && judgement_.determined == Determined::kAllButDamping;
  }
  bool has_cut_range() const noexcept { return has_cut_range_; }
  double cut_low_v2s() const noexcept { return a2() * cut_low_; }
  double cut_high_v2s() const noexcept { return a2() * cut_high_; }
  /// The error system with its peak, settling time and largest absolute error is there.
  bool has_model() const noexcept { return has_model_; }
  bool has_fit() const noexcept { return is_accepted_ && source_ == Source::kPoints; }
  bool has_fit_draws() const noexcept { return has_fit_draws_; }
  bool has_energy() const noexcept { return has_energy_; }
  bool has_trend() const noexcept { return has_trend_; }
  /// The upper bound of that energy was looked for; `has_bound()` says whether there is one.
  bool is_bound_done() const noexcept { return is_bound_done_; }
  Source source() const noexcept { return source_; }
  const Settings& settings() const noexcept { return settings_; }
  const Device& device() const noexcept { return device_; }
  const Wlsp& fit() const noexcept { return fit_; }  ///< Source::kPoints only.
  WlspDrawsResult fit_draws() const noexcept { return draws_.result(); }
  /// @returns Element (i, j) of the covariance of S, f0 and beta: that of the fit, or the squares
  /// of the given uncertainties on the diagonal.
  double covariance(std::size_t i, std::size_t j) const noexcept;
  const ModalModel& model() const noexcept { return model_; }  ///< At the estimate.
  double limit_mps2() const noexcept { return limit_mps2_; }   ///< a.
  Peak peak() const noexcept { return peak_; }
  SettlingTime settling_time() const noexcept { return settling_; }  ///< To 5 % of the peak.

  const MaximumEnergy& maximum() const noexcept { return maximum_; }  ///< For a = 1.
  double energy_v2s() const noexcept { return a2() * maximum_.energy; }
  /// False where no upper bound passed its check.
  bool has_bound() const noexcept { return has_bound_; }
  /// No signal within +-a of this T has more energy than this; with `has_bound()`.
  double bound_v2s() const noexcept { return a2() * bound_; }
  /// @returns xi = E/(a^2 T), paper equation (7), in (V/(m/s^2))^2.
  double xi() const noexcept { return maximum_.energy / settings_.duration_s; }
  /// @returns sqrt(E/T) in V; not a number for an energy difference below 0.
  double rms_error_v() const noexcept;
  /// @returns The output y(t) for the signal found with its limit a, in V.
  double output_v(double time_s) const noexcept {
    return limit_mps2_ * error_output(model_, maximum_.signal, time_s);
  }
  /// @returns E_0, E_1, ... of the fixed point for a = 1; Method::kPaper only.
  Span<const double> trace() const noexcept { return Span<const double>(trace_, trace_count_); }

  /// Not for a T in which k moves more often than `AbsoluteError` takes samples.
  bool has_absolute_error() const noexcept { return has_absolute_error_; }
  /// The largest |y(t)| of any signal within +-a of this T, in V; 0 if there is none.
  double absolute_error_v() const noexcept { return limit_mps2_ * absolute_error_; }

  bool has_monte_carlo() const noexcept { return has_monte_carlo_; }
  /// Repeats some trials by full searches; none for Method::kPaper, whose trials are full runs.
  const EnergyGuard& guard() const noexcept { return guard_; }
  /// What the uncertainties are multiplied by for the trials: 1, or the Birge ratio.
  double trial_scale() const noexcept { return trial_scale(settings_); }
  const AdaptiveResult& adaptive() const noexcept { return adaptive_result_; }
  const TrialResults& monte_carlo() const noexcept { return monte_carlo_; }  ///< Values in V^2 s.
  Accelerometer device_at_maximum() const noexcept { return device_at_maximum_; }

  Span<const TrendPoint> trend_points() const noexcept {
    return Span<const TrendPoint>(trend_points_, trend_done_);
  }
  const Trend& trend() const noexcept { return trend_; }  ///< Energies in V^2 s.

  /// How many energies of the fixed point are kept.
  static constexpr std::size_t kTraceLength = 64;
  /// The number of draws for the covariance of the fit.
  static constexpr std::uint32_t kFitDraws = 10000;
  /// The fraction of the peak of k within which it has settled.
  static constexpr double kSettled = 0.05;

 private:
  double a2() const noexcept { return limit_mps2_ * limit_mps2_; }
  static SearchSettings search_settings(const Settings& settings, double duration_s) noexcept;
  WichmannHill seeded_generator() const noexcept;
  double trial_scale(const Settings& settings) const noexcept;
  double progress_of(const EvaluationWorkspace& workspace) const noexcept;
  double adaptive_progress(const AdaptiveTrials& adaptive) const noexcept;
  void step_stage(EvaluationWorkspace& workspace) noexcept;
  bool advance_trial(std::uint32_t trial, EvaluationWorkspace& workspace) noexcept;
  void run_slice(EvaluationWorkspace& workspace) noexcept;

  Status begin(const Settings& settings, Goal goal) noexcept;
  Status prepare(EvaluationWorkspace& workspace) noexcept;
  void go_on(EvaluationWorkspace& workspace) noexcept;
  bool has_uncertainty() const noexcept;
  void drop_incomplete() noexcept;
  void drop_fit_draws() noexcept;
  void drop_trials() noexcept;
  void drop_trend() noexcept;
  Failure check_goal(const Settings& settings, Goal goal) const noexcept;
  Failure check_box(const Settings& settings, Goal goal) const noexcept;
  static const char* width_reason(Distribution distribution) noexcept;
  Status check_grid(const Settings& settings, double duration_s) const noexcept;
  Failure search_failure(Status status, Stage stage, double duration_s) const noexcept;
  Status fail(Status status, Stage stage, const char* reason, double duration_s = 0.0) noexcept;
  void fail_search(Status status, Stage stage, double duration_s) noexcept;
  void begin_model(EvaluationWorkspace& workspace) noexcept;
  void step_model(EvaluationWorkspace& workspace) noexcept;
  void begin_fit_draws() noexcept;
  void step_fit_draws(EvaluationWorkspace& workspace) noexcept;
  void begin_energy(EvaluationWorkspace& workspace) noexcept;
  void step_energy(EvaluationWorkspace& workspace) noexcept;
  void begin_bound(EvaluationWorkspace& workspace) noexcept;
  void step_bound(EvaluationWorkspace& workspace) noexcept;
  Status take_fit(Status fit_status) noexcept;
  void begin_cut_range(EvaluationWorkspace& workspace) noexcept;
  void step_cut_range(EvaluationWorkspace& workspace) noexcept;
  void begin_trials(EvaluationWorkspace& workspace) noexcept;
  void step_prediction(EvaluationWorkspace& workspace) noexcept;
  void step_adaptive(EvaluationWorkspace& workspace) noexcept;
  void begin_monte_carlo(std::uint32_t trials, EvaluationWorkspace& workspace) noexcept;
  void step_monte_carlo(EvaluationWorkspace& workspace) noexcept;
  void step_guard(EvaluationWorkspace& workspace) noexcept;
  void step_trend(EvaluationWorkspace& workspace) noexcept;
  void add_trend_point(double energy) noexcept;
  void end_trend() noexcept;

  // Defaults that are not zero would take flash for the whole object.
  static constexpr Settings kNoSettings = {0,
                                           0.0,
                                           GainMode::kAuto,
                                           0.0,
                                           0.0,
                                           false,
                                           0.0,
                                           Criterion::kIntegralSquareError,
                                           {},
                                           0.0,
                                           0,
                                           0,
                                           false,
                                           0.0,
                                           {},
                                           false,
                                           {},
                                           {},
                                           {},
                                           0};

  Settings settings_ = kNoSettings;
  Device device_;
  Wlsp fit_;
  WlspDraws draws_;
  ModalModel model_;
  Peak peak_;
  SettlingTime settling_;
  MaximumEnergy maximum_;
  EnergyGuard guard_;
  TrialResults monte_carlo_;
  AdaptiveResult adaptive_result_ = all_zero<AdaptiveResult>();
  Accelerometer device_at_maximum_;
  TrendPoint trend_points_[kMaxTrendPoints] = {};
  Trend trend_ = all_zero<Trend>();
  Failure failure_;
  FitJudgement judgement_;
  double cut_low_ = 0.0;  // For a = 1.
  double cut_high_ = 0.0;
  Span<double> store_;
  double trace_[kTraceLength] = {};
  std::size_t trace_count_ = 0;
  std::size_t trend_done_ = 0;
  double limit_mps2_ = 0.0;
  bool has_absolute_error_ = false;
  double absolute_error_ = 0.0;  // For a = 1, as the bound.
  double bound_ = 0.0;
  double progress_ = 0.0;
  std::uint32_t stored_ = 0;  // Trials 0 to stored_ - 1 are in the store.
  std::uint32_t monte_carlo_trials_ = 0;
  Source source_ = Source::kPoints;
  Stage stage_ = Stage::kIdle;
  Goal goal_ = Goal::kModel;
  bool is_accepted_ = false;  // Device and model.
  bool has_model_ = false;
  bool has_fit_draws_ = false;
  bool has_energy_ = false;
  bool has_bound_ = false;
  bool is_bound_done_ = false;  // Proven or given up.
  bool has_monte_carlo_ = false;
  bool has_cut_range_ = false;
  bool is_cut_done_ = false;  // Found or given up.
  bool has_trend_ = false;
  bool trial_runs_ = false;
  bool trend_search_runs_ = false;
};

static_assert(std::is_trivially_copyable_v<Evaluation>);
static_assert(!kHasDefaultCapacities ||
              sizeof(Evaluation) + sizeof(EvaluationWorkspace) <= 92 * 1024);

}  // namespace emax::app
