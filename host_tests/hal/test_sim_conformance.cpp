// The simulated bench keeps the contract of an analog stream, quiet or noisy, in any format.
#include <cstdint>
#include <gtest/gtest.h>
#include <string>

#include "emax/sim/sim_bench.hpp"

#include "hal/stream_conformance.hpp"

namespace emax::test {
namespace {

using hal::StreamFormat;
using sim::BenchSettings;
using sim::FaultKind;
using sim::kBenchFormat;
using sim::SimBench;

class Bench {
 public:
  Bench(const StreamFormat& format, BenchSettings settings, StreamFault fault,
        std::uint64_t at_frame)
      : bench_(format) {
    if (fault == StreamFault::kLostBlock) {
      settings.fault = {FaultKind::kLostBlock, at_frame};
    }
    if (fault == StreamFault::kLateBlock) {
      settings.fault = {FaultKind::kLateBlock, at_frame};
    }
    EXPECT_EQ(bench_.configure(settings), Status::kOk);
  }

  SimBench& stream() { return bench_; }
  double now_s() const { return bench_.now_s(); }
  DriveProbe drive() const {
    const sim::DacRecord& dac = bench_.dac();
    return {dac.last, dac.max_amplitude, dac.max_step, dac.frames, dac.frames_since_nonzero};
  }

 private:
  SimBench bench_;
};

/// With a stiff and well damped suspension, so that not all the time goes into waiting for it.
BenchSettings noisy_settings() {
  BenchSettings settings;
  settings.shaker.suspension_hz = 150.0;
  settings.shaker.suspension_damping = 0.6;
  return settings;
}

BenchSettings quiet_settings() {
  BenchSettings settings = noisy_settings();
  settings.noise_v = 0.0;
  settings.offset_v = 0.0;
  settings.hum_v = 0.0;
  return settings;
}

StreamExpectations expectations() {
  StreamExpectations expect;
  expect.can_fail = false;  // The fault script has neither.
  expect.can_refuse_start = false;
  // A jump by 5 V comes through six poles: in the middle of its first hold there are two steps of
  // the ADC, so without noise the latency shows to the frame.
  expect.arrival = std::int32_t{1} << 16;
  // The suspension decays with 565/s: from full scale to half a step of the ADC in 20 ms.
  expect.settle_frames = 2500;
  return expect;
}

std::string violated_by_bench(const StreamFormat& format, const BenchSettings& settings,
                              const StreamExpectations& expect) {
  const auto make = [&](StreamFault fault, std::uint64_t at_frame) {
    return Bench(format, settings, fault, at_frame);
  };
  return names_of(violated_clauses(make, expect));
}

TEST(SimConformance, QuietBench) {
  EXPECT_EQ(violated_by_bench(kBenchFormat, quiet_settings(), expectations()), "none");
}

TEST(SimConformance, NoisyBench) {
  StreamExpectations expect = expectations();
  // Six standard deviations of the noise, four of the offset, and the hum: 43 mV of 10 V.
  expect.quiet = 9300000;
  // Above the noise, which the jump is from its third frame on.
  expect.arrival = std::int32_t{1} << 26;
  expect.arrival_spread = 2;
  EXPECT_EQ(violated_by_bench(kBenchFormat, noisy_settings(), expect), "none");
}

TEST(SimConformance, AnyBlockLengthAndLatency) {
  const std::uint32_t formats[][2] = {{1, 0}, {7, sim::kMaxLatencyFrames}, {64, 1}};
  for (const auto& [block, latency] : formats) {
    const StreamFormat format = {100000.0, 10.0, 10.0, block, latency};
    EXPECT_EQ(violated_by_bench(format, quiet_settings(), expectations()), "none")
        << block << " frames, latency " << latency;
  }
}

}  // namespace
}  // namespace emax::test
