// The work of `emax report`: a sequencer, and the simulated bench or the instrument that measures.
#pragma once

#include <vector>

#include "emax/app/report/measurement.hpp"
#include "emax/app/sequencer/sequencer.hpp"
#include "emax/sim/sim_bench.hpp"

#include "desk/cli/console_progress.hpp"
#include "desk/cli/options.hpp"
#include "desk/cli/problem.hpp"
#include "desk/instrument/instrument_client.hpp"

namespace emax::desk {

/// A bench with the sequencer that drives it, or an instrument whose sweep it takes over.
class BenchJob final {
 public:
  BenchJob() = default;
  BenchJob(const BenchJob&) = delete;
  BenchJob& operator=(const BenchJob&) = delete;

  /// Builds the bench and begins to measure on it, for a report.
  ///
  /// @returns Why it does not start, if so.
  Problem start(const ReportOptions& options);

  /// Works until nothing is left to do, or until it is asked to stop. However it ends, the drive is
  /// at zero.
  ///
  /// A sweep that a fault has ended after half of its points is evaluated all the same.
  ///
  /// @returns The fault of the sweep with its frequency and what to check, or that it was stopped,
  /// if so. Failures of the evaluation are left to the caller.
  Problem run(ConsoleProgress& progress);

  /// The same, where an instrument measures: sets it up, waits for its sweep, and begins to
  /// evaluate what it has measured.
  ///
  /// @returns Why there is no sweep, or that it has ended early, as of `run()`.
  Problem measure_with_instrument(const ReportOptions& options, ConsoleProgress& progress);

  /// What an instrument has told of a sweep that it was lost in.
  const std::vector<EarlyPoint>& early_points() const noexcept { return early_points_; }

  app::Sequencer& sequencer() noexcept { return sequencer_; }
  /// @returns Whether there is a result although a fault has ended the sweep.
  bool has_result_of_rest() const noexcept {
    return is_rest_ && sequencer_.evaluation().done() &&
           sequencer_.evaluation().status() == Status::kOk;
  }
  /// @returns The scripted faults that the sweep's end came before, for its user; else nothing.
  Problem unstruck() const;
  /// @returns Whether the sweep began at all.
  bool has_measured() const noexcept { return sequencer_.sweep().stage != app::SweepStage::kIdle; }
  /// @returns Whether the sweep came to an end of its own, with points that a stop must not lose.
  bool has_swept() const noexcept {
    const app::SweepResults& sweep = sequencer_.sweep();
    return has_measured() && sweep.done() && sweep.status != Status::kStopped &&
           !sweep.points().empty();
  }
  /// @returns Whether an instrument has ended a sweep that was not fetched.
  bool has_left_sweep() const noexcept { return has_left_sweep_; }
  /// Refers to this object.
  app::Measurement measurement() const noexcept {
    return {sequencer_.sweep(), is_remote_ ? remote_.format : bench_.format(),
            is_remote_ && !remote_.is_simulated ? nullptr : &simulated_};
  }

 private:
  Problem stop();
  Problem work(ConsoleProgress& progress);
  bool evaluate_rest();
  Problem describe_sweep() const;

  sim::SimBench bench_;
  app::Sequencer sequencer_;
  app::SimulatedBench simulated_;
  InstrumentSweep remote_;
  const ReportOptions* options_ = nullptr;
  bool is_remote_ = false;
  bool is_rest_ = false;
  bool has_left_sweep_ = false;
  std::vector<EarlyPoint> early_points_;
};

}  // namespace emax::desk
