// The measurement of `emax report`: a sweep on the simulated bench.
#pragma once

#include "emax/app/measure/sweep.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/sim/sim_bench.hpp"

#include "desk/cli/console_progress.hpp"
#include "desk/cli/options.hpp"
#include "desk/cli/problem.hpp"

namespace emax::desk {

/// A bench with its sweep; 22 KiB.
class BenchJob final {
 public:
  BenchJob() = default;
  BenchJob(const BenchJob&) = delete;
  BenchJob& operator=(const BenchJob&) = delete;

  /// Builds the bench and measures. However it ends, the drive is at zero.
  ///
  /// @returns The fault with its frequency and what to check, or that it was stopped, if so.
  Problem run(const ReportOptions& options, ConsoleProgress& progress);

  const app::Sweep& sweep() const noexcept { return sweep_; }
  /// @returns Whether the sweep began at all.
  bool has_measured() const noexcept { return sweep_.stage() != app::SweepStage::kIdle; }
  /// Refers to this object.
  app::Measurement measurement() const noexcept { return {sweep_, bench_.format(), &simulated_}; }

 private:
  Problem describe_end() const;

  sim::SimBench bench_;
  app::Sweep sweep_;
  app::SweepWorkspace work_;
  app::SimulatedBench simulated_;
};

}  // namespace emax::desk
