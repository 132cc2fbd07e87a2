// The driver of an STM32's converters, run on the PC over the fake registers of one chip: it keeps
// the contract of an analog stream, and tells what goes wrong with the hardware within two blocks.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <gtest/gtest.h>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "emax/app/base/in_place.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/board/stm32_stream.hpp"

#include "boards/fakes/fake_converters.hpp"
#include "hal/stream_conformance.hpp"
#include "support/manual_clock.hpp"
#include "support/memory_byte_stream.hpp"

namespace emax::test {
namespace {

using board::kBlockFrames;
using board::kRingFrames;
using board::Stm32Stream;
using hal::Exchange;
using hal::Frame;
using hal::Word;

/// A chip and the driver on it, with the drive parked as the board does first of all.
class Bench {
 public:
  Bench(StreamFault fault, std::uint64_t at_frame, bool is_dac_ahead = false,
        bool is_dma_ahead = false)
      : chip_(std::make_unique<FakeConverters>(fault, at_frame, is_dac_ahead, is_dma_ahead)),
        stream_(std::make_unique<Stm32Stream>(chip::kStream)) {
    stream_->park(0);
    stream_->set_clock_exact(true);
    chip_->set_output_interrupt([stream = stream_.get()] { stream->on_output_interrupt(); });
  }

  Stm32Stream& stream() { return *stream_; }
  FakeConverters& chip() { return *chip_; }
  DriveProbe drive() const { return chip_->drive(); }
  double now_s() const { return chip_->now_s(); }

 private:
  std::unique_ptr<FakeConverters> chip_;
  std::unique_ptr<Stm32Stream> stream_;
};

TEST(Stm32Stream, KeepsTheContract) {
  for (const bool is_dac_ahead : {false, true}) {
    for (const bool is_dma_ahead : {false, true}) {
      const auto make = [=](StreamFault fault, std::uint64_t at_frame) {
        return Bench(fault, at_frame, is_dac_ahead, is_dma_ahead);
      };
      EXPECT_EQ(names_of(violated_clauses(make)), "none") << is_dac_ahead << is_dma_ahead;
    }
  }
}

TEST(Stm32Stream, StatesWhatTheBoardIs) {
  Bench bench(StreamFault::kNone, 0);
  const hal::StreamFormat& format = bench.stream().format();
  EXPECT_EQ(format.sample_rate_hz, 1e6 / chip::kFrame_us);
  EXPECT_EQ(format.drive_full_scale_v, 1.65);
  EXPECT_EQ(format.input_full_scale_v, 1.65);
  EXPECT_EQ(format.block_frames, 64U);
  // Eight blocks, and the value that the DAC holds.
  EXPECT_EQ(format.latency_frames, 513U);
}

/// A stream that runs with the drive at a quarter of full scale.
class RunningStream : public testing::Test {
 protected:
  static constexpr Word kDrive = std::int32_t{1} << 29;
  static constexpr hal::DriveLimits kLimits = {kDrive, kDrive / 256};

  void SetUp() override {
    ASSERT_EQ(stream().start(kLimits), Status::kOk);
    for (int block = 0; block < 20; ++block) {
      ASSERT_EQ(exchange().status, Status::kOk);
    }
    ASSERT_EQ(bench.drive().last, kDrive);
  }

  Exchange exchange() {
    std::array<Word, kBlockFrames> drive;
    for (Word& word : drive) {
      last_word = std::min(last_word + kLimits.step_per_frame, kDrive);
      word = last_word;
    }
    std::array<Frame, kBlockFrames> response;
    return stream().exchange(drive, response);
  }

  /// Exchanges until a fault. @returns It, and expects it within two blocks and the drive at zero
  /// within 256 frames after.
  Status fault() {
    const std::uint64_t begin = bench.drive().frames;
    Status status = Status::kOk;
    for (int block = 0; block < 4 && status == Status::kOk; ++block) {
      status = exchange().status;
    }
    const std::uint64_t frames = bench.drive().frames - begin;
    EXPECT_LE(frames, 2 * kBlockFrames + hal::kMaxRampFrames);
    EXPECT_EQ(bench.drive().last, 0);
    EXPECT_TRUE(stream().drive_is_at_zero());
    EXPECT_LE(bench.drive().max_step, static_cast<std::uint32_t>(kLimits.step_per_frame));
    return status;
  }

  Stm32Stream& stream() { return bench.stream(); }
  FakeConverters& chip() { return bench.chip(); }

  Bench bench{StreamFault::kNone, 0};
  Word last_word = 0;
};

TEST_F(RunningStream, TellsInputsThatTakeEverySecondTrigger) {
  chip().halve_inputs();
  EXPECT_EQ(fault(), Status::kLostBlock);
}

TEST_F(RunningStream, TellsAnOutputWhoseDmaHasStopped) {
  chip().stop_output_dma();
  EXPECT_EQ(fault(), Status::kHardwareFault);
}

TEST_F(RunningStream, TellsAnUnderrunOfTheDac) {
  chip().set_underrun();
  EXPECT_EQ(fault(), Status::kHardwareFault);
}

TEST_F(RunningStream, TellsAnOverrunOfAnAdc) {
  chip().set_overrun();
  if (chip::kOverrunTells) {
    EXPECT_EQ(fault(), Status::kLostBlock);
  } else {
    // Where results give way to the next ones, the frames are counted instead.
    EXPECT_EQ(exchange().status, Status::kOk);
  }
}

TEST_F(RunningStream, TellsALostCrystalAndRefusesToStartAgain) {
  stream().lose_clock();
  EXPECT_EQ(fault(), Status::kHardwareFault);
  EXPECT_EQ(stream().start(kLimits), Status::kHardwareFault);
  stream().set_clock_exact(true);
  EXPECT_EQ(stream().start(kLimits), Status::kOk);
}

TEST_F(RunningStream, LeadsTheDriveToZeroWithoutTriggers) {
  chip().stop_triggers();
  EXPECT_EQ(exchange().status, Status::kLateBlock);
  EXPECT_EQ(bench.drive().last, 0);
  EXPECT_LE(bench.drive().max_step, static_cast<std::uint32_t>(kLimits.step_per_frame));
}

TEST_F(RunningStream, TakesAPauseOfHalfARing) {
  // From the moment at which a block has come in: half a ring, less that block.
  chip().spend_us((kRingFrames / 2 - kBlockFrames) * std::uint64_t{chip::kStream.frame_us});
  for (int block = 0; block < 8; ++block) {
    EXPECT_EQ(exchange().status, Status::kOk) << block;
  }
}

TEST_F(RunningStream, HoldsTheDriveInALongerPauseAndTellsIt) {
  chip().spend_us(10 * kRingFrames * std::uint64_t{chip::kStream.frame_us});
  // No old values: the drive has not moved.
  EXPECT_EQ(bench.drive().last, kDrive);
  EXPECT_LE(bench.drive().max_step, static_cast<std::uint32_t>(kLimits.step_per_frame));
  EXPECT_EQ(exchange().status, Status::kLostBlock);
  EXPECT_TRUE(stream().drive_is_at_zero());
}

TEST_F(RunningStream, LeadsTheDriveToZeroWhateverRuns) {
  EXPECT_TRUE(stream().force_to_zero());
  EXPECT_FALSE(stream().running());
  EXPECT_EQ(bench.drive().last, 0);
  EXPECT_LE(bench.drive().max_step, static_cast<std::uint32_t>(kLimits.step_per_frame));
}

/// What the board's README says of a wire from the drive to both inputs.
TEST(Stm32Sweep, FindsTheReferenceItselfThroughAWire) {
  Bench bench(StreamFault::kNone, 0);
  bench.chip().set_access_cycles(FakeConverters::kCyclesPer_us);
  bench.chip().set_noisy(true);
  app::SweepSettings settings = app::default_sweep_settings();
  settings.drive_limit_v = 1.4;
  settings.skew_s = 0.0;
  settings.reference_gain = 1.0;
  MemoryByteStream console(1U << 20U);
  ManualClock clock;
  static app::InPlace<app::Instrument> memory;
  const app::Ports ports = {bench.stream(), console, clock, nullptr, nullptr};
  const app::Board board = {"test", "0", &settings, nullptr, nullptr};
  app::Instrument& instrument = memory.make(ports, board);
  instrument.start();
  console.send("SENS:REF:SENS 1.02;:SENS:SWE:FREQ 100,500,1000,2000,5000;:INIT;*OPC?\n");
  constexpr int kMostPolls = 200'000;
  std::string answers;
  for (int poll = 0; poll < kMostPolls && answers != "1\n"; ++poll) {
    clock.wait_us(1000);
    instrument.poll();
    answers += console.receive();
  }
  EXPECT_EQ(answers, "1\n");
  EXPECT_TRUE(bench.stream().drive_is_at_zero());
  console.send("SYST:ERR?;:FETC:FRES?\n");
  for (int poll = 0; poll < 1000; ++poll) {
    instrument.poll();
  }
  std::stringstream answer(console.receive());
  std::string error;
  std::getline(answer, error, ';');
  EXPECT_EQ(error, "0,\"No error\"");
  std::vector<double> values;
  for (std::string field; std::getline(answer, field, ',');) {
    values.push_back(std::strtod(field.c_str(), nullptr));
  }
  ASSERT_EQ(values.size(), 1U + 5U * 5U);
  for (std::size_t point = 0; point < 5; ++point) {
    // Noise of 8 of 20000 codes, over a hundred periods or more.
    EXPECT_NEAR(values[2 + 5 * point], 1.02, 1e-3) << point;
    EXPECT_NEAR(values[3 + 5 * point], 0.0, 0.05) << point;
  }
}

TEST(StreamStart, EndsWhenTheCalibrationNeverDoes) {
  Bench bench(StreamFault::kNone, 0);
  bench.chip().hold_calibration(true);
  EXPECT_EQ(bench.stream().start({1000, 1000}), Status::kHardwareFault);
  EXPECT_LT(bench.now_s(), 1.1);
  bench.chip().hold_calibration(false);
  EXPECT_EQ(bench.stream().start({1000, 1000}), Status::kOk);
}

TEST(StreamStart, CalibratesWithoutDmaAfterAStreamToo) {
  Bench bench(StreamFault::kNone, 0);
  for (int time = 0; time < 2; ++time) {
    ASSERT_EQ(bench.stream().start({1000, 1000}), Status::kOk);
    EXPECT_FALSE(bench.chip().calibrates_with_dma()) << time;
    bench.stream().stop();
  }
}

TEST(StreamStart, EndsWhenNoTriggerEverComes) {
  Bench bench(StreamFault::kNone, 0);
  bench.chip().stop_triggers();
  EXPECT_EQ(bench.stream().start({1000, 1000}), Status::kHardwareFault);
  EXPECT_LT(bench.now_s(), 0.05);
}

TEST(StreamStart, MeasuresAConversionWhereItsClockIsInDoubt) {
  Bench bench(StreamFault::kNone, 0);
  if (chip::kRegulatorReady == 0) {
    ASSERT_EQ(bench.stream().start({1000, 1000}), Status::kOk);
    EXPECT_EQ(bench.stream().conversion_cycles(), 0U);
    return;
  }
  // 4 us, or 8 should the chip halve its clock; a look at the flag takes some hundredths of one.
  for (const std::uint64_t us : {4U, 8U}) {
    bench.chip().set_conversion_us(us);
    ASSERT_EQ(bench.stream().start({1000, 1000}), Status::kOk);
    EXPECT_NEAR(static_cast<double>(bench.stream().conversion_cycles()), 400.0 * double(us), 40.0);
    bench.stream().stop();
  }
  // 16 us would be every second frame.
  bench.chip().set_conversion_us(16);
  EXPECT_EQ(bench.stream().start({1000, 1000}), Status::kHardwareFault);
  bench.chip().set_conversion_us(4);
  bench.chip().hold_regulator(true);
  EXPECT_EQ(bench.stream().start({1000, 1000}), Status::kHardwareFault);
  EXPECT_EQ(bench.stream().conversion_cycles(), 0U);
}

TEST(StreamStart, ChecksTheInputsWithoutAStream) {
  Bench bench(StreamFault::kNone, 0);
  EXPECT_EQ(bench.stream().check_inputs(), Status::kOk);
  EXPECT_FALSE(bench.stream().running());
  EXPECT_TRUE(bench.stream().drive_is_at_zero());
  bench.chip().hold_calibration(true);
  EXPECT_EQ(bench.stream().check_inputs(), Status::kHardwareFault);
  bench.chip().hold_calibration(false);
  EXPECT_EQ(bench.stream().check_inputs(), Status::kOk);
  EXPECT_EQ(bench.stream().start({1000, 1000}), Status::kOk);
}

TEST(StreamStart, NeedsTheCrystal) {
  Bench bench(StreamFault::kNone, 0);
  bench.stream().set_clock_exact(false);
  EXPECT_EQ(bench.stream().start({1000, 1000}), Status::kHardwareFault);
  EXPECT_TRUE(bench.stream().drive_is_at_zero());
}

}  // namespace
}  // namespace emax::test
