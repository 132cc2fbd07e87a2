// A sweep on the simulated bench, and what its tests ask of every one.
#pragma once

#include <cmath>
#include <complex>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "emax/app/measure/sweep.hpp"
#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/measure/sweep_workspace.hpp"
#include "emax/sim/sim_bench.hpp"

#include "hal/bench_run.hpp"

namespace emax::test {

/// K(j 2 pi f) from its definition.
inline std::complex<double> response_of(const sim::Device& device, double sensitivity,
                                        double frequency_hz) {
  const double ratio = frequency_hz / device.natural_frequency_hz;
  return sensitivity / std::complex<double>(1.0 - ratio * ratio, 2.0 * device.damping * ratio);
}

struct SweepRun {
  emax::sim::SimBench bench;
  emax::app::SweepResults sweep;
  emax::app::SweepWorkspace work;
  std::uint64_t last_step_frames = 0;  ///< Of the bench, in the step that ended the sweep.

  explicit SweepRun(const sim::BenchSettings& settings,
                    const hal::StreamFormat& format = sim::kBenchFormat)
      : bench(format) {
    EXPECT_EQ(bench.configure(settings), Status::kOk);
  }

  emax::Status start(const emax::app::SweepSettings& settings) { return run().start(settings); }
  void step() { run().step(); }
  void stop() { run().stop(); }

  void to_end(const emax::app::SweepSettings& settings) {
    ASSERT_EQ(start(settings), emax::Status::kOk);
    while (!sweep.done()) {
      const std::uint64_t before = bench.clock_frames();
      step();
      last_step_frames = bench.clock_frames() - before;
    }
    EXPECT_FALSE(bench.running());
    EXPECT_EQ(bench.dac().last, 0);
  }

  void expect_limits_kept(const app::SweepSettings& settings) const {
    // The 12 bits of the converter round each word by half a step, 2^19.
    const double volt = 2147483648.0 / bench.format().drive_full_scale_v;
    EXPECT_LE(bench.dac().max_amplitude, settings.drive_limit_v * volt);
    EXPECT_LE(bench.dac().max_step,
              settings.slew_v_per_s / bench.format().sample_rate_hz * volt + 0.5);
  }

 private:
  emax::app::Sweep run() { return {sweep, work, bench}; }
};

}  // namespace emax::test
