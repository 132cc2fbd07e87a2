// ADC pair and DAC by DMA in a loop of wire, and in the loop of the simulated bench.
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>

#include "chip/virtual_board.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kRing = 256;

class StreamTest : public testing::Test {
 protected:
  StreamTest() : board(EMAX_CHIP_IMAGES "/stream.elf", wire) {}

  void start() {
    board.chip.power_on();
    ASSERT_TRUE(board.chip.run_until_text("streams\n", 1.0)) << board.chip.findings.text();
  }
  std::uint32_t response(std::uint32_t i) {
    return board.chip.ram_word(board.chip.symbol("response") + 4 * (i % kRing));
  }

  Wire wire;
  VirtualBoard board;
};

// Drive code c of frame i is (1024 + 7 i); the pin's c/4096 of the reference gives a sum of 16 c.
// The DAC's holding register makes the response of drive frame i come in frame i + 1, and the
// middle of the range, put in first, in frame 0.
TEST_F(StreamTest, TheRingComesBackOneFrameLater) {
  start();
  const std::uint64_t before = board.chip.adc.conversions();
  board.chip.run_for(0.02);
  EXPECT_NEAR(static_cast<double>(board.chip.adc.conversions() - before), 2000.0, 1.0);
  for (std::uint32_t i = 1; i <= kRing; ++i) {
    const double expected = 16.0 * (1024.0 + 7.0 * (i - 1));
    // A sum that lies on a code's edge may be rounded to either side.
    EXPECT_NEAR(response(i) & 0xFFFF, expected, 1.0) << i;
    EXPECT_EQ(response(i) >> 16, response(i) & 0xFFFF) << i;
  }
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(StreamTest, InterruptsComeTwiceARing) {
  start();
  const std::uint32_t before = board.chip.word_at("halves") + board.chip.word_at("wholes");
  board.chip.run_for(10 * kRing * 1e-5);
  EXPECT_EQ(board.chip.word_at("halves") + board.chip.word_at("wholes") - before, 20U);
  EXPECT_EQ(board.chip.word_at("errors"), 0U);
}

TEST_F(StreamTest, TheDrivePinRestsInTheMiddleUntilTheFirstFrame) {
  start();
  ASSERT_GE(board.analog.drive_record().size(), 3U);
  const DriveSample& off = board.analog.drive_record()[0];
  const DriveSample& rest = board.analog.drive_record()[1];
  EXPECT_FALSE(off.on);
  EXPECT_EQ(off.pin_v, 1.65);
  EXPECT_TRUE(rest.on);
  EXPECT_EQ(rest.pin_v, 1.65);
  board.chip.run_for(0.01);
  // The pattern goes from 1024 to 1024 + 7*255 of 4096.
  EXPECT_NEAR(board.analog.greatest_excursion_v(), 1024 * 3.3 / 4096, 1e-12);
}

TEST_F(StreamTest, LostRequestsShiftTheRing) {
  start();
  board.chip.run_for(0.01);
  board.chip.requests.lose(board.chip.adc.dma_request(), 64);
  board.chip.run_for(0.01);
  EXPECT_NEAR(response(65) & 0xFFFF, 16.0 * (1024.0 + 7.0 * 128), 1.0);
}

TEST_F(StreamTest, AnErrorOnTheBusEndsTheChannelWithItsFlag) {
  start();
  board.chip.run_for(0.01);
  board.chip.dma1.fail_next(0);
  board.chip.run_for(0.01);
  EXPECT_EQ(board.chip.word_at("errors"), 1U);
  EXPECT_FALSE(board.chip.dma1.on(0));
  EXPECT_TRUE(board.chip.findings.has("adc_overrun"));
}

TEST_F(StreamTest, ADeadConverterEndsNothing) {
  start();
  board.chip.adc.set_dead(true);
  board.chip.run_for(1e-4);
  const std::uint64_t before = board.chip.adc.conversions();
  board.chip.run_for(0.01);
  EXPECT_EQ(board.chip.adc.conversions(), before);
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(StreamTest, AConverterWhoseFlagNeverComesIsGivenUp) {
  board.chip.hold("ADC2", "ISR", 1, 0);
  board.chip.power_on();
  EXPECT_TRUE(board.chip.run_until_text("dead\n", 1.0));
}

// The response to a drive held at rest is the bench's own noise and offset, whose truth is known.
TEST(SimulatedBenchTest, IsInTheLoop) {
  sim::BenchSettings settings;
  settings.noise_v = 0.0;
  settings.hum_v = 0.0;
  SimulatedBench bench(settings);
  VirtualBoard board(EMAX_CHIP_IMAGES "/stream.elf", bench);
  board.chip.power_on();
  ASSERT_TRUE(board.chip.run_until_text("streams\n", 1.0));
  board.chip.run_for(0.05);
  EXPECT_EQ(bench.status(), Status::kOk);
  EXPECT_EQ(bench.bench().clock_frames(), board.analog.steps());
  // The pattern's sawtooth of 0.7 V and 390 Hz moves the shaker: both inputs are away from rest.
  double sum = 0.0;
  for (std::uint32_t i = 0; i < kRing; ++i) {
    const std::uint32_t word = board.chip.ram_word(board.chip.symbol("response") + 4 * i);
    sum += std::fabs(static_cast<double>(word & 0xFFFF) - 32768.0);
  }
  EXPECT_GT(sum / kRing, 1000.0);
  EXPECT_EQ(board.chip.findings.text(), "");
}

}  // namespace
}  // namespace emax::chip
