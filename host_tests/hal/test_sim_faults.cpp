// Each fault of the simulated bench does what it says, from its frame on and not before.
#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "emax/base/status.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/sim/sim_bench.hpp"

#include "hal/bench_run.hpp"

namespace emax::test {
namespace {

using hal::Exchange;
using hal::Frame;
using hal::kMaxRampFrames;
using hal::Word;
using sim::BenchSettings;
using sim::FaultKind;
using sim::kFaultKinds;
using sim::kOffsetClimbPerSecond_v;
using sim::kSaturationFactor;
using sim::name_of;
using sim::parse_fault;
using sim::SimBench;

constexpr int kFrames = 6400;
constexpr std::size_t kAt = 3001;  // Inside a block.

BenchSettings with(FaultKind kind, BenchSettings settings = {}) {
  settings.fault = {kind, kAt};
  return settings;
}

std::vector<Frame> seen(const BenchSettings& settings) {
  SimBench bench;
  EXPECT_EQ(bench.configure(settings), Status::kOk);
  return run(bench, cosine(1000, 0.5, kFrames));
}

// The response with this fault and the sound one, which must agree up to the fault's frame.
struct Both {
  std::vector<Frame> sound;
  std::vector<Frame> faulty;
};

Both both(FaultKind kind, const BenchSettings& settings = {}) {
  Both result{seen(with(FaultKind::kNone, settings)), seen(with(kind, settings))};
  for (std::size_t i = 0; i < kAt; ++i) {
    EXPECT_EQ(result.sound[i].reference, result.faulty[i].reference) << i;
    EXPECT_EQ(result.sound[i].device, result.faulty[i].device) << i;
  }
  return result;
}

TEST(SimFaults, Names) {
  const std::array<const char*, kFaultKinds> names = {"none",
                                                      "lost-block",
                                                      "late-block",
                                                      "stuck-channel",
                                                      "saturation",
                                                      "unplugged-reference",
                                                      "unplugged-device",
                                                      "swapped-channels",
                                                      "inverted-polarity",
                                                      "dc-drift",
                                                      "gain-step"};
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    const auto kind = static_cast<FaultKind>(i);
    EXPECT_STREQ(name_of(kind), names[i]);
    EXPECT_TRUE(parse_fault(names[i]).known);
    EXPECT_EQ(parse_fault(names[i]).kind, kind);
  }
  EXPECT_EQ(parse_fault("dc-drift").kind, FaultKind::kDcDrift);
  EXPECT_EQ(parse_fault("unplugged-device").kind, FaultKind::kUnpluggedDevice);
  for (const char* wrong : {"", "lost", "lost-blocks", "Lost-Block", "nonee", "unplugged-"}) {
    EXPECT_FALSE(parse_fault(wrong).known) << wrong;
    EXPECT_EQ(parse_fault(wrong).kind, FaultKind::kNone) << wrong;
  }
}

TEST(SimFaults, StuckChannelRepeatsItsLastWord) {
  const Both result = both(FaultKind::kStuckChannel);
  for (std::size_t i = kAt; i < kFrames; ++i) {
    EXPECT_EQ(result.faulty[i].reference, result.sound[i].reference);
    EXPECT_EQ(result.faulty[i].device, result.sound[kAt - 1].device);
  }
}

TEST(SimFaults, StuckFromTheStartIsZero) {
  BenchSettings settings;
  settings.fault = {FaultKind::kStuckChannel, 0};
  for (const Frame& frame : seen(settings)) {
    EXPECT_EQ(frame.device, 0);
  }
}

TEST(SimFaults, SaturationMultipliesUntilItClips) {
  const Both ideal = both(FaultKind::kSaturation, ideal_bench());
  const Both real = both(FaultKind::kSaturation);
  bool clipped_high = false;
  bool clipped_low = false;
  for (std::size_t i = kAt; i < kFrames; ++i) {
    EXPECT_EQ(real.faulty[i].reference, real.sound[i].reference);
    clipped_high = clipped_high || real.faulty[i].device == 32767 * 65536;
    clipped_low = clipped_low || real.faulty[i].device == std::numeric_limits<Word>::min();
    const double expected = kSaturationFactor * volts(ideal.sound[i], Channel::kDevice);
    if (std::abs(expected) < 9.9) {
      // Twenty roundings of half a word, 2.4e-9 V each, and one more.
      EXPECT_NEAR(volts(ideal.faulty[i], Channel::kDevice), expected, 5e-8);
    }
  }
  EXPECT_TRUE(clipped_high);
  EXPECT_TRUE(clipped_low);
}

// An unplugged channel shows what a bench without a drive shows.
TEST(SimFaults, UnpluggedLeavesOffsetHumAndNoise) {
  for (const FaultKind kind : {FaultKind::kUnpluggedReference, FaultKind::kUnpluggedDevice}) {
    const Both result = both(kind);
    SimBench silent;
    ASSERT_EQ(silent.configure({}), Status::kOk);
    const std::vector<Frame> silence = run(silent, std::vector<Word>(kFrames, 0));
    int differing = 0;
    for (std::size_t i = kAt; i < kFrames; ++i) {
      const bool reference = kind == FaultKind::kUnpluggedReference;
      EXPECT_EQ(result.faulty[i].reference, (reference ? silence : result.sound)[i].reference);
      EXPECT_EQ(result.faulty[i].device, (reference ? result.sound : silence)[i].device);
      differing += result.sound[i].reference != silence[i].reference ? 1 : 0;
    }
    EXPECT_GT(differing, 3000);
  }
}

TEST(SimFaults, GainStepMultiplies) {
  const Both result = both(FaultKind::kGainStep, ideal_bench());
  for (std::size_t i = kAt; i < kFrames; ++i) {
    EXPECT_EQ(result.faulty[i].reference, result.sound[i].reference);
    // Two roundings of half a word, 2.4e-9 V each, one of them larger by the factor.
    EXPECT_NEAR(volts(result.faulty[i], Channel::kDevice),
                sim::kGainStepFactor * volts(result.sound[i], Channel::kDevice), 6e-9);
  }
}

TEST(SimFaults, SwappedChannelsAreSwapped) {
  const Both result = both(FaultKind::kSwappedChannels);
  for (std::size_t i = kAt; i < kFrames; ++i) {
    EXPECT_EQ(result.faulty[i].reference, result.sound[i].device);
    EXPECT_EQ(result.faulty[i].device, result.sound[i].reference);
  }
}

TEST(SimFaults, InvertedPolarityChangesTheSignOfTheDevice) {
  const Both result = both(FaultKind::kInvertedPolarity, ideal_bench());
  for (std::size_t i = kAt; i < kFrames; ++i) {
    EXPECT_EQ(result.faulty[i].reference, result.sound[i].reference);
    // Halves are rounded up whatever the sign.
    EXPECT_NEAR(result.faulty[i].device, -result.sound[i].device, 1.0);
  }
}

TEST(SimFaults, DcDriftClimbs) {
  const Both result = both(FaultKind::kDcDrift, ideal_bench());
  for (std::size_t i = kAt; i < kFrames; ++i) {
    EXPECT_EQ(result.faulty[i].reference, result.sound[i].reference);
    const double climbed =
        volts(result.faulty[i], Channel::kDevice) - volts(result.sound[i], Channel::kDevice);
    const double expected = kOffsetClimbPerSecond_v * 1e-5 * static_cast<double>(i - kAt + 1);
    EXPECT_NEAR(climbed, expected, 5e-9) << i;
  }
}

// What the stream says at each block of a drive, until it stops.
struct Ending {
  Exchange last;
  std::uint64_t good_blocks = 0;
  std::vector<Frame> response;
};

Ending until_stopped(SimBench& bench) {
  constexpr Word kAmplitude = kVolt / 2 + 1;
  constexpr Word kStep = kAmplitude / 15;  // 1000 Hz rises by 1/16 of its amplitude per frame.
  EXPECT_EQ(bench.start({kAmplitude, kStep}), Status::kOk);
  // A sine, which starts at zero.
  std::vector<Word> drive = cosine(1000, 0.5, kFrames + 128);
  drive.erase(drive.begin(), drive.begin() + 75);
  Ending ending;
  std::array<Frame, 64> block = {};
  for (std::size_t i = 0; i + 64 <= kFrames; i += 64) {
    ending.last = bench.exchange({&drive[i], 64}, block);
    if (ending.last.status != Status::kOk) {
      break;
    }
    ++ending.good_blocks;
    ending.response.insert(ending.response.end(), block.begin(), block.end());
  }
  EXPECT_LE(bench.dac().max_amplitude, static_cast<std::uint32_t>(kAmplitude));
  EXPECT_LE(bench.dac().max_step, static_cast<std::uint32_t>(kStep));
  return ending;
}

TEST(SimFaults, LostBlockLeavesAGap) {
  SimBench bench;
  ASSERT_EQ(bench.configure(with(FaultKind::kLostBlock)), Status::kOk);
  const Ending ending = until_stopped(bench);
  EXPECT_EQ(ending.last.status, Status::kLostBlock);
  EXPECT_EQ(ending.good_blocks, kAt / 64);
  EXPECT_EQ(ending.last.first_frame, 64 * (kAt / 64 + 1));
  EXPECT_FALSE(bench.running());
  EXPECT_EQ(bench.dac().last, 0);
  // Both blocks, the ramp, and the pipeline.
  EXPECT_GT(bench.dac().frames, 64 * (kAt / 64 + 2) + 37);
  EXPECT_LE(bench.dac().frames, 64 * (kAt / 64 + 2) + kMaxRampFrames + 37);
  EXPECT_EQ(bench.clock_frames(), bench.dac().frames);
  // Once only.
  EXPECT_EQ(until_stopped(bench).last.status, Status::kOk);
}

TEST(SimFaults, LateBlockIsLate) {
  SimBench bench;
  ASSERT_EQ(bench.configure(with(FaultKind::kLateBlock)), Status::kOk);
  const Ending ending = until_stopped(bench);
  EXPECT_EQ(ending.last.status, Status::kLateBlock);
  EXPECT_EQ(ending.good_blocks, kAt / 64);
  EXPECT_FALSE(bench.running());
  EXPECT_EQ(bench.dac().last, 0);
  EXPECT_GT(bench.clock_frames(), 64 * (kAt / 64 + 2) + 37);
  EXPECT_EQ(until_stopped(bench).last.status, Status::kOk);
}

TEST(SimFaults, LostAndLateComeAtTheirFrame) {
  for (const FaultKind kind : {FaultKind::kLostBlock, FaultKind::kLateBlock}) {
    for (const std::uint64_t at : {0U, 63U, 64U, 127U, 128U}) {
      SimBench bench;
      BenchSettings settings;
      settings.fault = {kind, at};
      ASSERT_EQ(bench.configure(settings), Status::kOk);
      EXPECT_EQ(until_stopped(bench).good_blocks, at / 64) << at;
    }
  }
}

// The response before a lost block is that of a sound bench.
TEST(SimFaults, NothingShowsBeforeALostBlock) {
  SimBench sound;
  SimBench faulty;
  ASSERT_EQ(sound.configure({}), Status::kOk);
  ASSERT_EQ(faulty.configure(with(FaultKind::kLostBlock)), Status::kOk);
  const Ending all = until_stopped(sound);
  const Ending some = until_stopped(faulty);
  EXPECT_EQ(all.good_blocks, static_cast<std::uint64_t>(kFrames) / 64);
  sound.stop();
  for (std::size_t i = 0; i < some.response.size(); ++i) {
    EXPECT_EQ(some.response[i].reference, all.response[i].reference);
    EXPECT_EQ(some.response[i].device, all.response[i].device);
  }
}

TEST(SimFaults, RefusesAnUnknownKind) {
  BenchSettings settings;
  settings.fault.kind = static_cast<FaultKind>(kFaultKinds);
  SimBench bench;
  EXPECT_EQ(bench.configure(settings), Status::kInvalidArgument);
}

}  // namespace
}  // namespace emax::test
