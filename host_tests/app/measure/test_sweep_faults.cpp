// Every fault of the bench's script at several times: named, the drive at zero in time, and what
// was measured before it kept.
#include <cmath>
#include <complex>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>

#include "emax/app/measure/sweep_results.hpp"
#include "emax/sim/sim_bench.hpp"

#include "app/sweep_run.hpp"

namespace {

using emax::Status;
using emax::app::default_sweep_settings;
using emax::app::SweepPoint;
using emax::app::SweepSettings;
using emax::app::SweepStage;
using emax::sim::BenchSettings;
using emax::sim::FaultKind;
using emax::test::response_of;
using emax::test::SweepRun;

struct Expectation {
  FaultKind fault;
  Status status;
};

const Expectation kFaults[] = {
    {FaultKind::kLostBlock, Status::kLostBlock},
    {FaultKind::kLateBlock, Status::kLateBlock},
    {FaultKind::kStuckChannel, Status::kStuckChannel},
    {FaultKind::kSaturation, Status::kSaturated},
    {FaultKind::kUnpluggedReference, Status::kNoReference},
    {FaultKind::kUnpluggedDevice, Status::kNoDevice},
    {FaultKind::kSwappedChannels, Status::kSwappedChannels},
    {FaultKind::kInvertedPolarity, Status::kInvertedPolarity},
    {FaultKind::kDcDrift, Status::kDcDrift},
};

// In the silence; in the ramp, the settling and a repeat of the check and of points at low, middle
// and high frequencies; in the check after them.
constexpr std::uint64_t kTimes[] = {0,      1000,   20100,  21500,  28000,  36500,  60000,
                                    120000, 200000, 290000, 350000, 353000, 380000, 411111,
                                    440000, 450500, 470000, 500000, 520000, 555555, 575000};

class SweepFaults : public testing::TestWithParam<Expectation> {};

TEST_P(SweepFaults, AreNamedAndEndAtZero) {
  for (const std::uint64_t at_frame : kTimes) {
    for (const std::uint64_t seed : {1U, 7U}) {
      BenchSettings settings;
      settings.seed = seed;
      settings.fault = {GetParam().fault, at_frame};
      SweepRun run(settings);
      run.to_end(default_sweep_settings());
      EXPECT_EQ(run.sweep.status, GetParam().status)
          << "frame " << at_frame << ": " << emax::explain(run.sweep.status);
      EXPECT_EQ(run.sweep.stage, SweepStage::kFailed);
      // The step that detects it exchanges a block (two where one is lost), leads the drive to zero
      // and lets the frames on their way arrive.
      EXPECT_LE(run.last_step_frames, 2 * 64 + emax::hal::kMaxRampFrames + 37);
      run.expect_limits_kept(default_sweep_settings());
      // The points before the fault are there, and good. One that the fault fell into may be too,
      // if the fault is within its noise, but then it is the last or flagged.
      std::size_t bad = 0;
      for (const SweepPoint& point : run.sweep.points()) {
        const std::complex<double> k =
            response_of(run.bench.truth().device, run.bench.truth().apparent_sensitivity,
                        point.point.frequency_hz);
        const std::complex<double> found = std::polar(point.point.amplitude, point.point.phase_rad);
        bad += std::abs(found / k - 1.0) > 6.0 * point.point.u_amplitude / point.point.amplitude;
      }
      EXPECT_EQ(bad, 0U) << "frame " << at_frame;
      const std::size_t expected_points = at_frame < 160000   ? 0
                                          : at_frame < 300000 ? 1
                                          : at_frame < 500000 ? 7
                                          : at_frame < 570000 ? 30
                                                              : 42;
      EXPECT_GE(run.sweep.points().size(), expected_points) << "frame " << at_frame;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SweepFaults, testing::ValuesIn(kFaults), [](const auto& test) {
  std::string name = emax::sim::name_of(test.param.fault);
  for (char& character : name) {
    character = character == '-' ? '_' : character;
  }
  return name;
});

TEST(SweepFaults, GainThatWasSetWrong) {
  // Ten times off: far from what the data sheet says.
  SweepSettings settings = default_sweep_settings();
  settings.device_gain = 10.0;
  SweepRun run((BenchSettings()));
  run.to_end(settings);
  EXPECT_EQ(run.sweep.status, Status::kSwappedChannels);
  EXPECT_EQ(run.sweep.failed_frequency_hz, 160.0);
  // Without a data sheet it cannot be told.
  settings.expected_sensitivity = 0.0;
  run.to_end(settings);
  EXPECT_EQ(run.sweep.status, Status::kOk);
}

TEST(SweepFaults, ExchangedCablesWithoutADataSheet) {
  SweepSettings settings = default_sweep_settings();
  settings.expected_sensitivity = 0.0;
  BenchSettings bench;
  bench.fault = {FaultKind::kSwappedChannels, 0};
  SweepRun run(bench);
  run.to_end(settings);
  EXPECT_EQ(run.sweep.status, Status::kSwappedChannels);
  bench.fault = {FaultKind::kInvertedPolarity, 0};
  SweepRun inverted(bench);
  inverted.to_end(settings);
  EXPECT_EQ(inverted.sweep.status, Status::kInvertedPolarity);
}

TEST(SweepFaults, PhaseBeyondHalfATurnIsNoFault) {
  // Far above the resonance the lag nears half a turn, and a skew set wrong by 5 us takes it
  // beyond.
  BenchSettings bench;
  bench.device.natural_frequency_hz = 900.0;
  bench.device.damping = 0.1;
  SweepSettings settings = default_sweep_settings();
  settings.skew_s = 6e-6;
  SweepRun run(bench);
  run.to_end(settings);
  EXPECT_EQ(run.sweep.status, Status::kOk);
  EXPECT_GT(run.sweep.points()[41].point.phase_rad, 2.5);
}

}  // namespace
