// The job from a device to its maximum energy in short steps: fit, response, search, trials, trend.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/absolute_error.hpp"
#include "emax/app/settings.hpp"
#include "emax/energy_bound.hpp"
#include "emax/energy_guard.hpp"
#include "emax/energy_search.hpp"
#include "emax/energy_trials.hpp"
#include "emax/frequency_response.hpp"
#include "emax/modal_model.hpp"
#include "emax/monte_carlo.hpp"
#include "emax/span.hpp"
#include "emax/status.hpp"
#include "emax/trend.hpp"
#include "emax/wlsp.hpp"

namespace emax::app {

/// A device with the standard uncertainties of its parameters.
struct Device {
  Accelerometer estimate;
  ParameterBox u;  ///< Standard uncertainties; also the half-widths of paper equation (21).
};

enum class Source : std::uint8_t { kPoints, kModel };

enum class Stage : std::uint8_t {
  kIdle,
  kFitDraws,  ///< Covariance of the fit by Monte Carlo draws.
  kEnergy,    ///< The largest energy at the estimate.
  kBound,     ///< What no signal can exceed.
  kAdaptive,  ///< Number of trials by JCGM 101 7.9.
  kMonteCarlo,
  kGuard,  ///< Full searches for some of the trials.
  kTrend,
  kDone,
  kFailed,
};

/// @returns "fit", "energy", "number of trials", "Monte Carlo", "trend" and so on, for a progress
/// line.
const char* name_of(Stage stage) noexcept;

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

/// Runs the job in steps of a few milliseconds at most on a PC, so that a console or Ctrl-C is
/// never kept waiting.
///
///     evaluation.start_from_points(points, settings);
///     while (!evaluation.done()) {
///       evaluation.step();
///     }
///
/// One run of the fixed point of Method::kBest, at most 171 trials, or 100 draws of the fit make
/// one step. With Method::kPaper a step is one run of the fixed point, which takes iterations times
/// T/step cells.
///
/// All memory is inside: at most 150 KiB, of which the grid's workspace is 83 KiB. Energies are
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
  Status start_from_points(const FrequencyResponse& points, const Settings& settings) noexcept;

  /// The same for a device whose parameters are known. With uncertainties of zero there is no Monte
  /// Carlo run.
  Status start_from_model(const Device& device, const Settings& settings) noexcept;

  /// Does a short piece of work; nothing before a start or when done. After kFailed, `failure()`
  /// says why.
  void step() noexcept;

  bool done() const noexcept { return stage_ == Stage::kDone || stage_ == Stage::kFailed; }
  Stage stage() const noexcept { return stage_; }
  /// @returns Progress of this stage from 0 to 1; of kAdaptive an estimate, which may go back.
  double progress() const noexcept;
  Status status() const noexcept { return failure_.status; }
  const Failure& failure() const noexcept { return failure_; }

  /// Lends memory for the value of each trial: with it each trial is computed once, without it once
  /// per pass (three or four). The results are the same, also if the memory holds only some of the
  /// trials. Valid until the evaluation is done; may be lent before or after the start.
  void lend_trial_store(Span<double> store) noexcept {
    store_ = store;
    stored_ = 0;
  }

  // Results, each complete once its stage has passed.
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
  double bound_v2s() const noexcept { return a2() * bound_.bound(); }
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

  /// The largest |y(t)| of any signal within +-a of this T, in V, and for a = 1 with its signal.
  double absolute_error_v() const noexcept { return limit_mps2_ * absolute_error_.value; }
  const AbsoluteError& absolute_error() const noexcept { return absolute_error_; }

  bool has_monte_carlo() const noexcept { return has_monte_carlo_; }
  /// Repeats some trials by full searches; none for Method::kPaper, whose trials are full runs.
  const EnergyGuard& guard() const noexcept { return guard_; }
  /// What the uncertainties are multiplied by for the trials: 1, or the Birge ratio.
  double trial_scale() const noexcept;
  const AdaptiveResult& adaptive() const noexcept { return adaptive_result_; }
  const MonteCarlo& monte_carlo() const noexcept { return monte_carlo_; }  ///< Values in V^2 s.
  Accelerometer device_at_maximum() const noexcept { return device_at_maximum_; }

  Span<const TrendPoint> trend_points() const noexcept {
    return Span<const TrendPoint>(trend_points_, trend_done_);
  }
  const Trend& trend() const noexcept { return trend_; }  ///< Energies in V^2 s.

  /// The number of draws for the covariance of the fit.
  static constexpr std::uint32_t kFitDraws = 10000;
  /// The fraction of the peak of k within which it has settled.
  static constexpr double kSettled = 0.05;

 private:
  double a2() const noexcept { return limit_mps2_ * limit_mps2_; }
  SearchSettings search_settings(double duration_s) const noexcept;
  WichmannHill seeded_generator() const noexcept;
  std::uint32_t trial_cost() const noexcept;
  double trial_value(std::uint32_t trial) noexcept;
  template <typename Procedure>
  void run_slice(Procedure& procedure) noexcept;
  double adaptive_progress() const noexcept;
  double monte_carlo_progress() const noexcept;

  Status begin(const Settings& settings) noexcept;
  Status prepare() noexcept;
  Status check_box() noexcept;
  Status check_grids() noexcept;
  Status fail(Status status, Stage stage, const char* reason, double duration_s = 0.0) noexcept;
  Status fail_search(Status status, Stage stage, double duration_s) noexcept;
  void step_fit_draws() noexcept;
  void begin_energy() noexcept;
  void step_energy() noexcept;
  void begin_bound() noexcept;
  void step_bound() noexcept;
  void begin_trials() noexcept;
  void step_adaptive() noexcept;
  void begin_monte_carlo(std::uint32_t trials) noexcept;
  void step_monte_carlo() noexcept;
  void step_guard() noexcept;
  void begin_trend() noexcept;
  void step_trend() noexcept;
  void add_trend_point(double energy) noexcept;
  void end_trend() noexcept;

  GridWorkspace workspace_;
  EnergySearch search_;
  EnergyBound bound_;
  EnergyTrials trials_;
  EnergyGuard guard_;
  MonteCarlo monte_carlo_;
  // Points at monte_carlo_ during kAdaptive, at nothing otherwise.
  AdaptiveTrials adaptive_trials_;
  Settings settings_;
  Device device_;
  Wlsp fit_;
  WlspDraws draws_;
  ModalModel model_;
  Peak peak_;
  SettlingTime settling_;
  AbsoluteError absolute_error_;
  MaximumEnergy maximum_;
  AdaptiveResult adaptive_result_;
  Accelerometer device_at_maximum_;
  TrendPoint trend_points_[kMaxTrendPoints] = {};
  Trend trend_;
  Failure failure_;
  Span<double> store_;
  double trace_[EnergySearch::kTraceLength] = {};
  std::size_t trace_count_ = 0;
  std::size_t trend_done_ = 0;
  double limit_mps2_ = 0.0;
  std::uint32_t stored_ = 0;  // Trials 0 to stored_ - 1 are in the store.
  std::uint32_t monte_carlo_trials_ = 0;
  Source source_ = Source::kPoints;
  Stage stage_ = Stage::kIdle;
  bool has_bound_ = false;
  bool has_monte_carlo_ = false;
  bool trend_search_runs_ = false;
};

static_assert(std::is_trivially_copyable_v<Evaluation>);
static_assert(sizeof(Evaluation) <= 150 * 1024);

}  // namespace emax::app
