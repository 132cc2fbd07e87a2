// Every fault of the bench's script at several times: named, the drive at zero in time, and what
// was measured before it kept.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>

#include "emax/app/measure/sweep.hpp"
#include "emax/app/measure/sweep_results.hpp"
#include "emax/app/measure/sweep_workspace.hpp"
#include "emax/sim/sim_bench.hpp"

#include "app/sweep_run.hpp"

namespace {

using emax::Status;
using emax::app::default_sweep_settings;
using emax::app::Sweep;
using emax::app::SweepPoint;
using emax::app::SweepResults;
using emax::app::SweepSettings;
using emax::app::SweepStage;
using emax::app::SweepWorkspace;
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
      // Without the second check nothing is known of a drift, and no uncertainty is not a number.
      EXPECT_EQ(run.sweep.shared.drift, 0.0);
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

/// What a single fault may be called.
bool is_name_of(FaultKind fault, Status status) {
  for (const Expectation& one : kFaults) {
    if (one.fault == fault && one.status == status) {
      return true;
    }
  }
  return false;
}

/// In exchanged channels the reference's lost signal is missed at the device's input, and an offset
/// that climbs takes the reference's input to full scale. Where both sensors are unplugged, there
/// is no signal, and the words name the cables of both.
bool is_name_of_both(FaultKind one, FaultKind other, Status status) {
  if (one == FaultKind::kUnpluggedReference && other == FaultKind::kUnpluggedDevice) {
    return status == Status::kWeakSignal;
  }
  const FaultKind beside = one == FaultKind::kSwappedChannels ? other : one;
  if (one != FaultKind::kSwappedChannels && other != FaultKind::kSwappedChannels) {
    return false;
  }
  return (beside == FaultKind::kUnpluggedReference && status == Status::kNoDevice) ||
         (beside == FaultKind::kUnpluggedDevice && status == Status::kNoReference) ||
         (beside == FaultKind::kDcDrift && status == Status::kSaturated);
}

/// A sweep near the limit of acceleration, with these faults; what the shaker has done is recorded
/// by the bench, whatever the sensors tell.
Status run_near_the_limit(std::uint64_t seed, const emax::sim::Fault& one,
                          const emax::sim::Fault& other) {
  BenchSettings settings;
  settings.seed = seed;
  settings.fault = one;
  settings.second_fault = other;
  SCOPED_TRACE(std::string(emax::sim::name_of(one.kind)) + "@" + std::to_string(one.at_frame) +
               " " + emax::sim::name_of(other.kind) + "@" + std::to_string(other.at_frame) +
               " seed " + std::to_string(seed));
  SweepSettings sweep = default_sweep_settings();
  sweep.level_mps2 = 1.8;
  sweep.acceleration_limit_mps2 = 2.0;
  sweep.drive_limit_v = 10.0;
  sweep.slew_v_per_s = 4e5;
  SweepRun run(settings);
  run.to_end(sweep);
  EXPECT_LE(run.bench.peak_mps2(), 1.1 * 2.0);
  EXPECT_TRUE(run.bench.drive_is_at_zero());
  if (one.kind == FaultKind::kGainStep) {
    return run.sweep.status;  // A quarter more is not always seen.
  }
  EXPECT_EQ(run.sweep.stage, SweepStage::kFailed);
  if (other.kind == FaultKind::kNone) {
    EXPECT_TRUE(is_name_of(one.kind, run.sweep.status)) << emax::explain(run.sweep.status);
  } else {
    EXPECT_TRUE(is_name_of(one.kind, run.sweep.status) ||
                is_name_of(other.kind, run.sweep.status) ||
                is_name_of_both(one.kind, other.kind, run.sweep.status))
        << emax::explain(run.sweep.status);
  }
  return run.sweep.status;
}

/// By hand others, and as many of each fault and of each pair as one has time for, 30 ms each:
/// EMAX_FAULT_RUNS=100 EMAX_FAULT_START=1 build/host/host_tests/app/test_sweep_faults
/// --gtest_filter=*AnyTime*
std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// A fixed sequence that depends on no library: x -> 6364136223846793005 x + 1442695040888963407.
class Times {
 public:
  std::uint64_t next() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return (state_ >> 33U) % last_;
  }

 private:
  std::uint64_t state_ = from_environment("EMAX_FAULT_START", 2024);
  std::uint64_t last_ = from_environment("EMAX_FAULT_LAST", 770000);
};

/// Calls `run(i, seed, fault)` for the i-th random time of each fault.
template <typename Run>
void at_any_times_of_any_fault(Run run) {
  Times times;
  const std::uint64_t runs = from_environment("EMAX_FAULT_RUNS", 20);
  for (const Expectation& one : kFaults) {
    for (std::uint64_t i = 0; i < runs; ++i) {
      const std::uint64_t seed = times.next();
      run(i, seed, emax::sim::Fault{one.fault, times.next()});
    }
  }
}

TEST(SweepFaults, AnyTimeOfAnyFaultKeepsTheLimitOfAcceleration) {
  at_any_times_of_any_fault([](std::uint64_t, std::uint64_t seed, const emax::sim::Fault& fault) {
    (void)run_near_the_limit(seed, fault, {});
  });
}

TEST(SweepFaults, AnyTimesOfAnyTwoFaultsKeepTheLimitOfAcceleration) {
  Times times;
  const std::uint64_t runs = from_environment("EMAX_FAULT_RUNS", 20);
  for (const Expectation& one : kFaults) {
    for (const Expectation& other : kFaults) {
      for (std::uint64_t i = 0; i < runs && one.fault < other.fault; ++i) {
        const std::uint64_t seed = times.next();
        const std::uint64_t first = times.next();
        (void)run_near_the_limit(seed, {one.fault, first}, {other.fault, times.next()});
      }
    }
  }
}

TEST(SweepFaults, AnyTimesOfAGainStepAndAnotherFaultKeepTheLimitOfAcceleration) {
  Times times;
  const std::uint64_t runs = from_environment("EMAX_FAULT_RUNS", 20);
  for (const FaultKind other : {FaultKind::kSwappedChannels, FaultKind::kInvertedPolarity}) {
    for (std::uint64_t i = 0; i < runs; ++i) {
      const std::uint64_t seed = times.next();
      const std::uint64_t first = times.next();
      (void)run_near_the_limit(seed, {FaultKind::kGainStep, first}, {other, times.next()});
    }
  }
}

/// A device that gives fewer volts than the reference: exchanged, it makes the reference read less
/// than there is, by as much as the drive would then rise. Level and limit are the same.
Status run_of_a_device_of_few_volts(std::uint64_t seed, double sensitivity, double level_mps2,
                                    const emax::sim::Fault& one, const emax::sim::Fault& other) {
  BenchSettings settings;
  settings.seed = seed;
  settings.device.sensitivity = sensitivity;
  settings.fault = one;
  settings.second_fault = other;
  SCOPED_TRACE(std::string(emax::sim::name_of(one.kind)) + "@" + std::to_string(one.at_frame) +
               " " + emax::sim::name_of(other.kind) + "@" + std::to_string(other.at_frame) +
               " seed " + std::to_string(seed) + " S " + std::to_string(sensitivity));
  SweepSettings sweep = default_sweep_settings();
  sweep.level_mps2 = level_mps2;
  sweep.acceleration_limit_mps2 = level_mps2;
  sweep.drive_limit_v = 10.0;
  sweep.slew_v_per_s = 4e5;
  sweep.expected_sensitivity = sensitivity;
  SweepRun run(settings);
  run.to_end(sweep);
  EXPECT_LE(run.bench.peak_mps2(), 1.1 * level_mps2);
  EXPECT_TRUE(run.bench.drive_is_at_zero());
  EXPECT_EQ(run.sweep.stage, SweepStage::kFailed);
  // Its words would let the user raise the drive.
  EXPECT_NE(run.sweep.status, Status::kLevelNotReached);
  return run.sweep.status;
}

constexpr double kFewVolts[] = {0.1, 0.2, 0.4};

TEST(SweepFaults, AnyTimeOfAnyFaultKeepsTheLimitWithADeviceOfFewVolts) {
  at_any_times_of_any_fault([](std::uint64_t i, std::uint64_t seed, const emax::sim::Fault& fault) {
    (void)run_of_a_device_of_few_volts(seed, kFewVolts[i % 3], 2.0, fault, {});
  });
}

TEST(SweepFaults, AnExchangeAndAnotherFaultAnyTimeWithADeviceOfFewVolts) {
  Times times;
  const std::uint64_t runs = from_environment("EMAX_FAULT_RUNS", 20);
  for (const Expectation& other : kFaults) {
    for (std::uint64_t i = 0; i < runs && other.fault != FaultKind::kSwappedChannels; ++i) {
      const std::uint64_t seed = times.next();
      const std::uint64_t first = times.next();
      (void)run_of_a_device_of_few_volts(seed, kFewVolts[i % 3], i % 2 == 0 ? 2.0 : 1.0,
                                         {FaultKind::kSwappedChannels, first},
                                         {other.fault, times.next()});
    }
  }
}

TEST(SweepFaults, ExchangedCablesOfADeviceOfFewVoltsAreRefusedAtTheFirstLook) {
  // They once gave 9.4 times the limit.
  for (const double sensitivity : {0.01, 0.02, 0.05, 0.1, 0.2, 0.3}) {
    for (const std::uint64_t at_frame : {0U, 16000U, 22000U}) {
      EXPECT_EQ(run_of_a_device_of_few_volts(1, sensitivity, 1.0,
                                             {FaultKind::kSwappedChannels, at_frame}, {}),
                Status::kSwappedChannels)
          << sensitivity << " " << at_frame;
    }
  }
}

TEST(SweepFaults, AReferenceThatDiesBeforeAnExchangeRaisesNothing) {
  // Its input then reads a tenth, which once let the acceleration rise to 9.2 times the limit.
  (void)run_of_a_device_of_few_volts(212268403, 0.1, 2.0, {FaultKind::kUnpluggedReference, 207713},
                                     {FaultKind::kSwappedChannels, 221310});
}

// Which of two inputs reads the acceleration nobody tells: the level stays below the limit by both.
TEST(SweepFaults, ExchangedCablesWithoutADataSheetKeepTheLimit) {
  for (const double sensitivity : {0.1, 0.3, 0.7}) {
    BenchSettings bench;
    bench.device.sensitivity = sensitivity;
    bench.device.natural_frequency_hz = 20000.0;  // The phase says nothing at the check.
    bench.fault = {FaultKind::kSwappedChannels, 0};
    SweepSettings settings = default_sweep_settings();
    settings.expected_sensitivity = 0.0;
    settings.level_mps2 = 2.0;
    settings.acceleration_limit_mps2 = 2.0;
    settings.drive_limit_v = 10.0;
    settings.slew_v_per_s = 4e5;
    SweepRun run(bench);
    run.to_end(settings);
    EXPECT_LE(run.bench.peak_mps2(), 1.1 * 2.0) << sensitivity;
  }
}

TEST(SweepFaults, ExchangedChannelsThatTurnRoundRaiseNothing) {
  // Taken for a device beyond its resonance, they once let the acceleration rise to 1.3 times the
  // limit: the level followed the device's sensor.
  (void)run_near_the_limit(2032813279, {FaultKind::kSwappedChannels, 532717},
                           {FaultKind::kInvertedPolarity, 537493});
  (void)run_near_the_limit(389054, {FaultKind::kSwappedChannels, 532970},
                           {FaultKind::kInvertedPolarity, 537172});
}

TEST(SweepFaults, PairsThatOnceHadOtherNames) {
  // Below the converter's step the drive is no sine any more: a channel too large for its level.
  (void)run_near_the_limit(490387, {FaultKind::kSaturation, 291415},
                           {FaultKind::kSwappedChannels, 298466});
  // The second fault falls into the second look at the first, and leaves half of a sine.
  (void)run_near_the_limit(567131, {FaultKind::kSwappedChannels, 55701},
                           {FaultKind::kInvertedPolarity, 98529});
  // The offset climbs from the second look at a device without a signal on.
  (void)run_near_the_limit(246651, {FaultKind::kUnpluggedDevice, 23251},
                           {FaultKind::kDcDrift, 27816});
}

TEST(SweepFaults, ChannelThatGetsStuckInASecondLookIsNoDrift) {
  // They once were a DC drift: the mean of words that have just got stuck is another one.
  struct Case {
    std::uint64_t seed;
    std::uint64_t stuck_at;
    emax::sim::Fault other;
  };
  const Case cases[] = {{523176434, 297679, {FaultKind::kSwappedChannels, 227281}},
                        {885058587, 237358, {FaultKind::kSwappedChannels, 98752}},
                        {868081633, 443342, {FaultKind::kSwappedChannels, 428662}},
                        {1037403019, 332687, {FaultKind::kInvertedPolarity, 279692}},
                        {1345090125, 167797, {FaultKind::kInvertedPolarity, 69803}}};
  for (const Case& c : cases) {
    (void)run_near_the_limit(c.seed, {FaultKind::kStuckChannel, c.stuck_at}, c.other);
  }
}

TEST(SweepFaults, AReferenceThatDiesWhileItIsReadRaisesNothing) {
  // Died at a moment where it once let the drive rise to 4.8 times the limit.
  BenchSettings bench;
  bench.seed = 98587;
  bench.fault = {FaultKind::kUnpluggedReference, 132095};
  SweepSettings settings = default_sweep_settings();
  settings.acceleration_limit_mps2 = 2.0;
  settings.drive_limit_v = 10.0;
  SweepRun run(bench);
  run.to_end(settings);
  EXPECT_EQ(run.sweep.status, Status::kNoReference);
  EXPECT_LE(run.bench.peak_mps2(), 2.0);
}

// A reference that loses gain: to keep the level, as much more drive would be needed, and the
// device sees that the shaker has not changed.
class FadingReference final : public emax::hal::AnalogStream {
 public:
  FadingReference() noexcept : AnalogStream({1e5, 10.0, 10.0, 64, 0}) {}
  /// 4 until then: V of drive per V of the reference.
  void fade_to(int divisor) noexcept { divisor_ = divisor; }
  double largest_v() const noexcept { return 10.0 / 2147483648.0 * largest_; }

 private:
  Status do_start() noexcept override { return Status::kOk; }
  emax::hal::Exchange do_exchange(emax::Span<const emax::hal::Word> drive,
                                  emax::Span<emax::hal::Frame> response) noexcept override {
    for (std::size_t i = 0; i < drive.size(); ++i) {
      response[i] = {drive[i] / divisor_, drive[i] / 4};
      largest_ = std::max(largest_, std::abs(static_cast<double>(drive[i])));
    }
    frames_ += drive.size();
    return {Status::kOk, frames_ - drive.size()};
  }
  std::uint32_t do_ramp_to_zero(emax::hal::Word) noexcept override { return 256; }
  void do_stop() noexcept override {}
  bool do_drive_is_at_zero() const noexcept override { return true; }

  std::uint64_t frames_ = 0;
  std::int32_t divisor_ = 4;
  double largest_ = 0.0;
};

TEST(SweepFaults, ADeviceThatSeesMoreThanTheReferenceCounts) {
  FadingReference stream;
  static SweepResults results;
  static SweepWorkspace work;
  Sweep sweep(results, work, stream);
  SweepSettings settings = default_sweep_settings();
  settings.level_mps2 = 0.25;  // 0.25 V at the reference, 1 V of drive.
  ASSERT_EQ(sweep.start(settings), Status::kOk);
  while (!sweep.done()) {
    if (results.point_count == 3) {
      stream.fade_to(80);
    }
    sweep.step();
  }
  EXPECT_NE(results.status, Status::kOk);
  EXPECT_EQ(results.points().size(), 3U);
  EXPECT_LT(stream.largest_v(), 1.1);
}

// Near the limit a quarter more drive is too much. It fades while the fourth frequency is measured:
// at the end of the first look, in the ramp to the level, or in one of the repeats there.
TEST(SweepFaults, AReferenceThatLosesAFifthWithinAFrequencyRaisesNothing) {
  SweepSettings settings = default_sweep_settings();
  settings.acceleration_limit_mps2 = 1.0;
  settings.level_mps2 = 0.9;  // 0.9 V at the reference, 3.6 V of drive.
  for (int blocks = 620; blocks < 1540; blocks += 60) {
    SCOPED_TRACE(blocks);
    FadingReference stream;
    static SweepResults results;
    static SweepWorkspace work;
    results = SweepResults();
    Sweep sweep(results, work, stream);
    ASSERT_EQ(sweep.start(settings), Status::kOk);
    int until_fade = blocks;
    while (!sweep.done()) {
      until_fade -= results.point_count == 3 ? 1 : 0;
      if (until_fade == 0) {
        stream.fade_to(5);
      }
      sweep.step();
    }
    EXPECT_EQ(results.status, Status::kNoReference) << emax::explain(results.status);
    EXPECT_EQ(results.points().size(), 3U);
    EXPECT_LE(stream.largest_v(), 4.0 * 1.0);
  }
}

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
