// The limit of acceleration: shakers that nobody has told about, few steps, and faults that a
// bench can have beside it.
#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "emax/app/measure/sweep.hpp"
#include "emax/sim/sim_bench.hpp"

#include "app/sweep_run.hpp"

namespace {

using emax::Status;
using emax::app::default_sweep_settings;
using emax::app::SweepSettings;
using emax::sim::BenchSettings;
using emax::sim::FaultKind;
using emax::test::SweepRun;

// Steps of the drive that are large beside the limit: an accepted limit is kept, another is refused
// before the drive has more than five of them.
TEST(SweepLimit, LimitsOfFewStepsAreKeptOrRefused) {
  struct Case {
    double full_scale_v;
    double limit_mps2;
    bool is_accepted;
  };
  // 2 m/s^2 per V: 0.05 m/s^2 by five steps of 10 V, and three times that is needed.
  const Case cases[] = {{10.0, 0.2, true},   {10.0, 0.1, false}, {10.0, 0.06, false},
                        {10.0, 0.01, false}, {1.0, 0.2, true},   {1.0, 0.1, true},
                        {1.0, 0.06, true},   {1.0, 0.02, true},  {1.0, 0.01, false}};
  for (const Case& c : cases) {
    for (const double noise_v : {0.0, 1e-4, 5e-3}) {
      SCOPED_TRACE(std::to_string(c.full_scale_v) + " V, " + std::to_string(c.limit_mps2) +
                   " m/s^2, noise " + std::to_string(noise_v));
      BenchSettings bench;
      bench.noise_v = noise_v;
      bench.front_end.drive_v = c.full_scale_v;
      SweepSettings settings = default_sweep_settings();
      settings.frequency_count = 4;
      settings.frequency_hz = {30.0, 300.0, 3000.0, 6000.0};
      settings.level_mps2 = c.limit_mps2;
      settings.acceleration_limit_mps2 = c.limit_mps2;
      settings.drive_full_scale_v = c.full_scale_v;
      settings.drive_limit_v = std::min(5.0, c.full_scale_v);
      SweepRun run(bench);
      run.to_end(settings);
      EXPECT_EQ(run.sweep.status, c.is_accepted ? Status::kOk : Status::kFewSteps)
          << emax::explain(run.sweep.status);
      const double steps_v = 0.0025 * c.full_scale_v;
      // Half a step of rounding, and the armature rings with each step: less than 7 for 5.
      EXPECT_LE(run.bench.peak_mps2(), c.is_accepted ? 1.1 * c.limit_mps2 : 1.4 * 2.0 * steps_v);
    }
  }
}

// Of a shaker that nobody has told about, the first look finds out how lively it is: its drive
// comes slowly, so that the limit is seen before it is much exceeded.
TEST(SweepLimit, TheFirstLookAtALivelyShakerKeepsTheLimit) {
  for (const double gain : {20.0, 100.0, 400.0}) {
    for (const double limit_mps2 : {0.5, 2.0, 10.0, 19.0}) {
      for (const double noise_v : {0.0, 1e-4, 1e-3}) {
        SCOPED_TRACE(std::to_string(gain) + " m/s^2 per V, " + std::to_string(limit_mps2) +
                     " m/s^2, noise " + std::to_string(noise_v));
        BenchSettings bench;
        bench.noise_v = noise_v;
        bench.shaker.gain = gain;
        bench.device.sensitivity = 0.3;
        SweepSettings settings = default_sweep_settings();
        settings.frequency_count = 3;
        settings.frequency_hz = {100.0, 500.0, 1000.0};
        settings.expected_sensitivity = 0.3;
        settings.level_mps2 = 0.5 * limit_mps2;
        settings.acceleration_limit_mps2 = limit_mps2;
        SweepRun run(bench);
        run.to_end(settings);
        const double step_mps2 = gain * 10.0 / 2048.0;  // 12 bits.
        const bool has_steps = settings.level_mps2 > 5.0 * step_mps2;
        if (has_steps) {
          EXPECT_EQ(run.sweep.status, Status::kOk) << emax::explain(run.sweep.status);
        } else {
          EXPECT_TRUE(run.sweep.status == Status::kFewSteps ||
                      run.sweep.status == Status::kWeakSignal)
              << emax::explain(run.sweep.status);
          EXPECT_TRUE(run.sweep.status == Status::kFewSteps || run.sweep.least_level_mps2 > 0.0);
        }
        // The armature rings to twice the height of a step.
        EXPECT_LE(run.bench.peak_mps2(), 1.1 * limit_mps2 + (has_steps ? 0.0 : 2.0 * step_mps2));
      }
    }
  }
}

SweepSettings near_the_limit(double level_mps2, double limit_mps2) {
  SweepSettings settings = default_sweep_settings();
  settings.level_mps2 = level_mps2;
  settings.acceleration_limit_mps2 = limit_mps2;
  settings.drive_limit_v = 10.0;
  settings.slew_v_per_s = 4e5;
  return settings;
}

// A level far below what a step of the drive makes: the drive once went on below nothing, and then
// to ten times the limit.
TEST(SweepLimit, ALevelFarBelowAStepEndsBeforeTheDriveIsNone) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    BenchSettings bench;
    bench.seed = seed;
    bench.noise_v = 0.05;
    bench.shaker.gain = 200.0;
    bench.device = {0.01, 20000.0, 0.3182};
    bench.device_gain = 100.0;
    bench.front_end.reference_v = 50.0;
    SweepSettings settings = near_the_limit(0.05, 5.0);
    settings.check_hz = 30.0;
    settings.device_gain = 100.0;
    settings.expected_sensitivity = 0.01;
    settings.reference_full_scale_v = 50.0;
    SweepRun run(bench);
    run.to_end(settings);
    EXPECT_EQ(run.sweep.status, Status::kFewSteps) << emax::explain(run.sweep.status);
    EXPECT_LE(run.bench.peak_mps2(), 1.1 * 5.0 + 2.0 * 200.0 * 10.0 / 2048.0);
  }
}

// What one frequency needs of drive is too much at the next, on a resonance of armature or
// suspension, and changes of the drive make one ring. Once 2.3 times the limit, without a word.
TEST(SweepLimit, ResonancesOfTheShakerAreSeenWhileTheDriveRises) {
  const std::vector<std::vector<double>> frequencies = {
      {100.0, 1000.0, 14000.0}, {5.0, 15.0, 100.0, 1000.0}, {5.0, 10.0, 20.0, 40.0, 80.0, 160.0}};
  for (const std::vector<double>& chosen : frequencies) {
    for (const double level_mps2 : {1.0, 1.8}) {
      SweepSettings settings = near_the_limit(level_mps2, 2.0);
      std::copy(chosen.begin(), chosen.end(), settings.frequency_hz.begin());
      settings.frequency_count = chosen.size();
      SweepRun run{BenchSettings()};
      run.to_end(settings);
      EXPECT_EQ(run.sweep.status, Status::kOk) << emax::explain(run.sweep.status);
      EXPECT_LE(run.bench.peak_mps2(), 1.1 * 2.0) << chosen[0] << ' ' << level_mps2;
    }
  }
  for (const double suspension_hz : {33.0, 40.0, 50.0, 55.0}) {
    BenchSettings bench;
    bench.shaker.suspension_hz = suspension_hz;
    bench.shaker.suspension_damping = 0.05;
    SweepRun run(bench);
    run.to_end(near_the_limit(1.8, 2.0));
    EXPECT_EQ(run.sweep.status, Status::kOk) << emax::explain(run.sweep.status);
    EXPECT_LE(run.bench.peak_mps2(), 1.1 * 2.0) << suspension_hz;
  }
}

// An exchange in the midst of a look leaves a reading between both. Once 1.5 times the limit.
TEST(SweepLimit, AnExchangeWithinALookRaisesNothing) {
  for (const double sensitivity : {0.64, 0.7, 0.8}) {
    for (std::uint64_t at_frame = 225000; at_frame < 330000; at_frame += 2500) {
      BenchSettings bench;
      bench.seed = at_frame;
      bench.device.sensitivity = sensitivity;
      bench.fault = {FaultKind::kSwappedChannels, at_frame};
      SweepSettings settings = near_the_limit(2.0, 2.0);
      settings.expected_sensitivity = sensitivity;
      SweepRun run(bench);
      run.to_end(settings);
      EXPECT_LE(run.bench.peak_mps2(), 1.1 * 2.0) << sensitivity << ' ' << at_frame;
    }
  }
}

// The device at the reference's input and nothing at its own. Once 9.4 times the limit.
TEST(SweepLimit, ADeviceThatTheDataSheetLetsBeSeenIsLookedForFirst) {
  for (const double sensitivity : {0.1, 0.2, 0.3, 0.6}) {
    for (const double limit_mps2 : {1.0, 2.0, 5.0}) {
      BenchSettings bench;
      bench.device.sensitivity = sensitivity;
      bench.fault = {FaultKind::kSwappedChannels, 0};
      bench.second_fault = {FaultKind::kUnpluggedReference, 0};
      SweepSettings settings = near_the_limit(limit_mps2, limit_mps2);
      settings.expected_sensitivity = sensitivity;
      SweepRun run(bench);
      run.to_end(settings);
      EXPECT_EQ(run.sweep.status, Status::kNoDevice) << emax::explain(run.sweep.status);
      EXPECT_LE(run.bench.peak_mps2(), 1.1 * limit_mps2) << sensitivity;
    }
  }
}

TEST(SweepLimit, WithoutAnySignalTheDriveStaysWithinWhatAnOrdinaryShakerMakesOfIt) {
  for (const double gain : {2.0, 10.0, 40.0}) {
    for (const double limit_mps2 : {4.0, 10.0, 20.0}) {
      BenchSettings bench;
      bench.shaker.gain = gain;
      bench.fault = {FaultKind::kUnpluggedReference, 0};
      bench.second_fault = {FaultKind::kUnpluggedDevice, 0};
      SweepRun run(bench);
      run.to_end(near_the_limit(limit_mps2, limit_mps2));
      EXPECT_EQ(run.sweep.status, Status::kWeakSignal) << emax::explain(run.sweep.status);
      EXPECT_LE(run.bench.peak_mps2(), 1.1 * limit_mps2) << gain;
    }
  }
}

// What crosstalk leaves of the other sensor is no signal. Once 4.6 times the limit with 42 points
// of a dead reference; and a device without its cable had the names of three other faults.
TEST(SweepLimit, WhatMayBeCrosstalkIsNoSensor) {
  for (const double natural_frequency_hz : {400.0, 4073.0, 20000.0}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      BenchSettings bench;
      bench.seed = seed;
      bench.noise_v = 1e-4;
      bench.device.natural_frequency_hz = natural_frequency_hz;
      bench.crosstalk_expanded_percent = 0.5;
      bench.fault = {FaultKind::kUnpluggedReference, 0};
      SweepSettings settings = near_the_limit(1.8, 2.0);
      settings.crosstalk_expanded_percent = 0.5;
      settings.expected_sensitivity = 0.0;
      SweepRun dead(bench);
      dead.to_end(settings);
      EXPECT_EQ(dead.sweep.status, Status::kNoReference) << emax::explain(dead.sweep.status);
      EXPECT_LE(dead.bench.peak_mps2(), 1.1 * 2.0);
      bench.fault = {FaultKind::kUnpluggedDevice, 200000 + 20000 * seed};
      SweepRun unplugged(bench);
      unplugged.to_end(settings);
      EXPECT_EQ(unplugged.sweep.status, Status::kNoDevice)
          << emax::explain(unplugged.sweep.status) << " seed " << seed;
    }
  }
}

// Ten steps of the drive are less of a sine. Three of eight sweeps were refused at a resonance.
TEST(SweepLimit, ALevelOfTenStepsIsMeasured) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    BenchSettings bench;
    bench.seed = seed;
    SweepSettings settings = default_sweep_settings();
    settings.level_mps2 = 0.1;
    SweepRun run(bench);
    run.to_end(settings);
    EXPECT_EQ(run.sweep.status, Status::kOk) << emax::explain(run.sweep.status) << ' ' << seed;
  }
}

// Two percent of hum turn the phase by more than a sensor may lead. One in five was refused as
// exchanged.
TEST(SweepLimit, HumAtAFrequencyOfTheSweepIsNoExchange) {
  for (std::uint64_t seed = 301; seed <= 320; ++seed) {
    BenchSettings bench;
    bench.seed = seed;
    bench.hum_v = 0.02;
    SweepSettings settings = default_sweep_settings();
    settings.frequency_count = 5;
    settings.frequency_hz = {30.0, 40.0, 50.0, 60.0, 150.0};
    SweepRun run(bench);
    run.to_end(settings);
    EXPECT_TRUE(run.sweep.status == Status::kOk || run.sweep.status == Status::kHum)
        << emax::explain(run.sweep.status) << " seed " << seed;
  }
}

}  // namespace
