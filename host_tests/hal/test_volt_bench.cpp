// The bench in volts: its response in closed form, its faults, and what it leaves to converters.
#include <cmath>
#include <complex>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "emax/base/status.hpp"
#include "emax/sim/volt_bench.hpp"

#include "hal/bench_response.hpp"
#include "hal/bench_run.hpp"

namespace emax::test {
namespace {

using sim::BenchSettings;
using sim::BenchVolts;
using sim::FaultKind;
using sim::VoltBench;

constexpr double kRate_hz = 100000.0;

BenchVolts step_to(VoltBench& bench, double drive_v, int steps) {
  BenchVolts volts;
  for (int i = 0; i < steps; ++i) {
    volts = bench.step(drive_v);
  }
  return volts;
}

TEST(VoltBench, IsSilentUntilItIsConfigured) {
  VoltBench bench;
  const BenchVolts volts = bench.step(1.0);
  EXPECT_EQ(volts.reference_v, 0.0);
  EXPECT_EQ(volts.device_v, 0.0);
  EXPECT_EQ(bench.clock_frames(), 0U);
}

TEST(VoltBench, RefusesARateThatIsNone) {
  VoltBench bench;
  EXPECT_EQ(bench.configure(ideal_bench(), 0.0), Status::kInvalidArgument);
  EXPECT_EQ(bench.configure(ideal_bench(), -1.0), Status::kInvalidArgument);
  EXPECT_EQ(bench.configure(ideal_bench(), std::nan("")), Status::kInvalidArgument);
  EXPECT_EQ(bench.configure(ideal_bench(), kRate_hz), Status::kOk);
}

// One second for the suspension's transient, one to measure: whole periods of 160 Hz.
TEST(VoltBench, AnswersWithTheShakerAndTheDevice) {
  constexpr int kHz = 160;
  const BenchSettings settings = ideal_bench();
  VoltBench bench;
  ASSERT_EQ(bench.configure(settings, kRate_hz), Status::kOk);
  Complex reference = 0.0;
  Complex device = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const double turns = static_cast<double>(i * std::int64_t{kHz} % 100000) / kRate_hz;
    const BenchVolts volts = bench.step(std::cos(kTurn * turns));
    if (i >= 100000) {
      reference += 2e-5 * volts.reference_v * std::polar(1.0, -kTurn * turns);
      device += 2e-5 * volts.device_v * std::polar(1.0, -kTurn * turns);
    }
  }
  // The reference's sensitivity and gain are 0.1 V/(m/s^2) and 10.
  const Complex expected = acceleration_seen(settings.shaker, kHz, 1e-5);
  EXPECT_LT(std::abs(reference - expected), 1e-9);
  EXPECT_LT(std::abs(device - device_seen(settings.device, settings.shaker, kHz, 1e-5, 1.25e-6)),
            1e-9);
  EXPECT_EQ(bench.clock_frames(), 200000U);
}

TEST(VoltBench, BreaksDownAtTheFrame) {
  BenchSettings settings = ideal_bench();
  VoltBench sound;
  ASSERT_EQ(sound.configure(settings, kRate_hz), Status::kOk);
  for (const FaultKind kind : {FaultKind::kSwappedChannels, FaultKind::kInvertedPolarity,
                               FaultKind::kUnpluggedReference, FaultKind::kUnpluggedDevice}) {
    settings.fault = {kind, 100};
    VoltBench bench;
    ASSERT_EQ(bench.configure(settings, kRate_hz), Status::kOk);
    ASSERT_EQ(sound.configure(ideal_bench(), kRate_hz), Status::kOk);
    const BenchVolts before = step_to(bench, 1.0, 100);
    const BenchVolts sound_before = step_to(sound, 1.0, 100);
    EXPECT_EQ(before.reference_v, sound_before.reference_v);
    EXPECT_EQ(before.device_v, sound_before.device_v);
    const BenchVolts after = bench.step(1.0);
    const BenchVolts whole = sound.step(1.0);
    ASSERT_NE(whole.reference_v, 0.0);
    ASSERT_NE(whole.device_v, whole.reference_v);
    const bool is_swapped = kind == FaultKind::kSwappedChannels;
    const double reference = kind == FaultKind::kUnpluggedReference ? 0.0
                             : is_swapped                           ? whole.device_v
                                                                    : whole.reference_v;
    const double device = kind == FaultKind::kUnpluggedDevice    ? 0.0
                          : kind == FaultKind::kInvertedPolarity ? -whole.device_v
                          : is_swapped                           ? whole.reference_v
                                                                 : whole.device_v;
    EXPECT_EQ(after.reference_v, reference) << name_of(kind);
    EXPECT_EQ(after.device_v, device) << name_of(kind);
  }
}

TEST(VoltBench, LeavesBlocksAndConvertersToOthers) {
  for (const FaultKind kind :
       {FaultKind::kLostBlock, FaultKind::kLateBlock, FaultKind::kStuckChannel}) {
    BenchSettings settings = ideal_bench();
    VoltBench sound;
    ASSERT_EQ(sound.configure(settings, kRate_hz), Status::kOk);
    settings.fault = {kind, 10};
    VoltBench bench;
    ASSERT_EQ(bench.configure(settings, kRate_hz), Status::kOk);
    for (int i = 0; i < 100; ++i) {
      const BenchVolts volts = bench.step(1.0);
      const BenchVolts expected = sound.step(1.0);
      ASSERT_EQ(volts.reference_v, expected.reference_v);
      ASSERT_EQ(volts.device_v, expected.device_v);
    }
    EXPECT_EQ(bench.clock_frames(), 100U);
  }
}

}  // namespace
}  // namespace emax::test
