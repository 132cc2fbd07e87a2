// What an instrument does, one thing at a time: measure, evaluate, or iterate the fixed point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/evaluate/evaluation_workspace.hpp"
#include "emax/app/measure/loopback.hpp"
#include "emax/app/measure/sweep.hpp"
#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/measure/sweep_workspace.hpp"
#include "emax/app/sequencer/fixed_point_run.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/app/store/saved_state.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// What runs.
enum class Job : std::uint8_t { kNone, kSweep, kLoopback, kEvaluation, kFixedPoint };

/// Where a device or its points come from.
enum class Origin : std::uint8_t {
  kNothing,
  kSweep,  ///< Points measured here.
  kTable,  ///< Points handed over.
  kModel,  ///< Parameters, given or kept from an identification of before.
};

/// What work needs unchanged while it runs.
enum class Part : std::uint8_t { kSweepSettings, kSettings, kDevice };

/// What stands in the way.
enum class Obstacle : std::uint8_t {
  kNone,
  kSweepRuns,      ///< What it needs must not change.
  kComputes,       ///< The same, of an evaluation or a fixed point.
  kSweepSetting,   ///< `refused` of the sweep's results names it.
  kSweep,          ///< The stream did not start, or the sweep has failed: `status`.
  kNoWire,         ///< A loopback that does not see its drive.
  kTurnedWire,     ///< A loopback that sees one channel with the opposite sign of the other.
  kUnsteadyWire,   ///< A loopback whose ratio or phase changes with time or frequency.
  kNoDevice,       ///< Neither points nor parameters.
  kNoPoints,       ///< The device is that of points, and there are none.
  kNoFit,          ///< The trials need the fit of before power off, of which u is left.
  kEvaluation,     ///< `failure` of the evaluation's results says why.
  kGrid,           ///< The fixed point needs more cells than there are, or less than one.
  kNoUncertainty,  ///< No trials without it.
  kOpenDamping,    ///< No trials where the points leave the damping open, and no range of E either.
  kNoTimes,        ///< No trend without them.
};

/// Why something is not done, or has not come to a good end; true if there is a reason.
struct Refusal {
  Obstacle obstacle = Obstacle::kNone;
  Status status = Status::kOk;  ///< Of kSweepSetting, kSweep and kEvaluation; else kOk.

  explicit operator bool() const noexcept { return obstacle != Obstacle::kNone; }
};

/// Measures with the sweep, evaluates points or a device, and runs the fixed point, one of them at
/// a time and in short steps.
///
///     static Sequencer sequencer;
///     sequencer.measure_and_evaluate(stream, sweep_settings, settings, Goal::kReport);
///     while (sequencer.is_working()) {
///       sequencer.step();
///     }
///
/// What was measured or computed stays until the next of its kind begins. Whether it is the answer
/// to a question of now, `holds()` says.
///
/// All memory is inside: the results of sweep and evaluation, the points, and one workspace for
/// what runs. While nothing runs, anybody may borrow that. 104 KiB, all zero before use.
class Sequencer {
 public:
  // What is evaluated. Each change is for when `obstacle_to(Part::kDevice)` is kNone.

  /// A device by its parameters.
  void take(const Device& device) noexcept;
  /// The damping to hold where points have magnitudes alone that do not determine it
  /// (`Wlsp::give_damping()`); 0 for none. Results of before are gone.
  void give_damping(double damping) noexcept;
  /// The device of a fit of before power off.
  void take(const Identification& identification) noexcept;
  /// The device that these points give. Those of the last sweep keep what they share
  /// (`has_measured()`).
  void take(const FrequencyResponse& points) noexcept;
  /// The device that another instrument has measured: a sweep that is `done()`.
  void take(const SweepResults& sweep) noexcept;
  /// The device that the points at hand give, in place of one by its parameters.
  ///
  /// @returns Whether that is a change.
  bool take_points() noexcept;
  /// Forgets the points.
  ///
  /// @returns Whether the device was theirs: there is none then.
  bool clear_points() noexcept;
  /// Ends what runs, and forgets points, device and results of the evaluation.
  void reset() noexcept;

  /// @returns kSweepRuns or kComputes if work runs that needs this part unchanged; else kNone.
  Obstacle obstacle_to(Part part) const noexcept;

  // Work. Each start answers a refusal and changes nothing but what it says, or begins.

  /// A sweep. With its start the points of before are gone, and the device is the one measured.
  ///
  /// @param[in] stream Nobody else uses it until the sweep has ended.
  Refusal measure(hal::AnalogStream& stream, const SweepSettings& settings) noexcept;

  /// Makes the next sweep wait for rest first: the shaker may swing for what happened before.
  void expect_swinging() noexcept { sweep_.may_swing = true; }

  /// A sweep, and with its points an evaluation.
  Refusal measure_and_evaluate(hal::AnalogStream& stream, const SweepSettings& sweep,
                               const Settings& settings, Goal goal) noexcept;

  /// A loopback, which leaves all results as they are. Where the stream has a switch, it is turned
  /// for it; else somebody has connected a wire from the drive to both inputs.
  Refusal loop_back(hal::AnalogStream& stream, const SweepSettings& settings) noexcept;

  /// An evaluation towards this goal. What is complete and holds for these settings is kept, so
  /// nothing may be left to do: it has then ended at once, and `failure()` says how.
  Refusal evaluate(const Settings& settings, Goal goal) noexcept;

  /// The fixed point for the device that was evaluated last.
  Refusal iterate_fixed_point(const Settings& settings) noexcept;

  /// Does a short piece of what runs: a block of the sweep, a step of the evaluation, one product.
  void step() noexcept;

  /// Ends what runs at once, with the drive at zero. What is complete stays.
  void abort() noexcept;

  Job job() const noexcept { return job_; }
  bool is_working() const noexcept { return job_ != Job::kNone; }
  /// @returns Of the job that has ended last: why it did not come to a good end.
  const Refusal& failure() const noexcept { return failure_; }
  /// @returns Progress of what runs, or of its stage, from 0 to 1; 1 if nothing runs.
  double progress() const noexcept;
  /// @returns "idle", "sweep", "fixed point", or the stage of the evaluation. Never null.
  const char* stage_name() const noexcept;

  // Results.

  /// @returns Whether the evaluation's results are those of the device of now, complete for this
  /// goal, and would come out the same with these settings.
  bool holds(Goal goal, const Settings& settings) const noexcept {
    return is_of_device() && evaluation_.holds(goal, settings);
  }
  Origin origin() const noexcept { return origin_; }
  /// Of a sweep that runs, or has ended in any way, or was handed over. What was measured before a
  /// sweep failed is in `points()`, too.
  Origin points_origin() const noexcept { return points_origin_; }
  const SweepResults& sweep() const noexcept { return sweep_; }
  /// @returns Whether some of these points are of the last sweep.
  bool has_measured(const FrequencyResponse& points) const noexcept {
    return sweep_.has_measured(points.points());
  }
  const EvaluationResults& evaluation() const noexcept { return evaluation_; }
  const FrequencyResponse& points() const noexcept { return points_; }
  /// @returns The identification of before power off; null if the device is another one by now.
  const Identification* kept_identification() const noexcept {
    return has_identification_ ? &identification_ : nullptr;
  }
  /// @returns The energies of the iterates; null unless a fixed point has ended and its memory was
  /// not used since.
  const FixedPointRun* fixed_point() const noexcept {
    return has_fixed_point_ ? &workspace_.fixed_point : nullptr;
  }
  void forget_fixed_point() noexcept { has_fixed_point_ = false; }
  /// @returns What the last loopback has found; null unless it has come to a good end and its
  /// memory was not used since.
  const LoopbackResults* loopback() const noexcept {
    return has_loopback_ ? &workspace_.loopback.results() : nullptr;
  }
  void forget_loopback() noexcept { has_loopback_ = false; }

  // Memory.

  /// Lends memory for the values of the trials, as `Evaluation::lend_trial_store()`, to every
  /// evaluation that begins from now on.
  void lend_trial_store(Span<double> store) noexcept { trial_store_ = store; }
  /// The same for `Evaluation::lend_trial_pieces()`.
  void lend_trial_pieces(TrialPieces pieces) noexcept { trial_pieces_ = pieces; }
  /// The same for `Evaluation::lend_helper()`.
  void lend_helper(EvaluationHelper* helper) noexcept { helper_ = helper; }

  /// All of the memory that `borrow()` lends, for text. 66 KiB on a board.
  Span<char> borrow_all() noexcept {
    has_fixed_point_ = false;
    has_loopback_ = false;
    return {static_cast<char*>(static_cast<void*>(&workspace_)), sizeof workspace_};
  }

  /// Memory for somebody else's work while nothing runs; anything may be in it.
  template <typename Work>
  Work& borrow() noexcept {
    static_assert(sizeof(Work) <= sizeof(Workspace));
    // NOLINTNEXTLINE(misc-redundant-expression): the two are equal for some types only.
    static_assert(alignof(Work) <= alignof(Workspace));
    static_assert(std::is_trivially_copyable_v<Work> && std::is_trivially_destructible_v<Work>);
    has_fixed_point_ = false;
    has_loopback_ = false;
    return *static_cast<Work*>(static_cast<void*>(&workspace_));
  }

 private:
  /// One memory for everything of which only one runs at a time.
  union Workspace {
    constexpr Workspace() noexcept : none{} {}

    char none;
    EvaluationWorkspace evaluation;
    SweepWorkspace sweep;
    FixedPointRun fixed_point;
    LoopbackRun loopback;
  };

  Sweep sweep_run() noexcept { return Sweep(sweep_, workspace_.sweep, *stream_); }
  Evaluation evaluation_run() noexcept { return Evaluation(evaluation_, workspace_.evaluation); }
  bool is_of_device() const noexcept;
  bool needs_lost_fit(const Settings& settings) const noexcept;
  Refusal missing_input(const Settings& settings, Goal goal) const noexcept;
  Status start_evaluation(const Settings& settings, Goal goal) noexcept;
  void begin(Job job) noexcept;
  void end_sweep() noexcept;
  void end_evaluation() noexcept;
  void step_loopback() noexcept;
  void end_loopback() noexcept;

  hal::AnalogStream* stream_ = nullptr;  // Of the sweep or loopback that runs.
  Span<double> trial_store_;
  TrialPieces trial_pieces_;
  EvaluationHelper* helper_ = nullptr;
  Refusal failure_;
  Job job_ = Job::kNone;
  Goal goal_ = Goal::kModel;
  Origin origin_ = Origin::kNothing;
  Origin points_origin_ = Origin::kNothing;
  bool has_identification_ = false;
  bool evaluates_next_ = false;  // The sweep's points.
  bool has_fixed_point_ = false;
  bool has_loopback_ = false;
  // Or the device by its parameters; zero, unlike its defaults.
  Identification identification_ = {Source::kPoints, {}, {}, 0.0, 0};
  FrequencyResponse points_;
  SweepResults sweep_;
  EvaluationResults evaluation_;
  Workspace workspace_;
};

static_assert(std::is_trivially_copyable_v<Sequencer>);

}  // namespace emax::app
