// The virtual STM32H743: clock tree, supply, memories, streams with FIFO, dual conversions, flash.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <string>

#include "chip/virtual_board.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kRing = 256;

class H743Stream : public testing::Test {
 protected:
  H743Stream() : board(EMAX_CHIP_IMAGES "/h743_stream.elf", wire) {
    board.chip.adc.family().linear_cycles = 2000;
  }
  /// Changes a constant of the image.
  void set(const std::string& name, std::uint32_t value) {
    std::memcpy(board.chip.flash.bytes() + (board.chip.symbol(name) - kFlashBase), &value, 4);
  }
  void start() {
    board.chip.power_on();
    ASSERT_TRUE(board.chip.run_until_text("streams\n", 1.0)) << board.chip.findings.text();
  }
  std::uint32_t response(std::uint32_t i) {
    return board.chip.ram_word(board.chip.symbol("response") + 4 * (i % kRing));
  }
  /// Drive code c of frame i is 1024 + 7 i of 4096; sixteen bits of it come back a frame later.
  static double expected(std::uint32_t i) { return 16.0 * (1024.0 + 7.0 * ((i - 1) % kRing)); }

  Wire wire;
  VirtualH743 board;
};

TEST_F(H743Stream, ReachesItsClocksAndTellsItsId) {
  board.chip.set_unique_id({0x12345678, 0, 0});
  start();
  EXPECT_EQ(board.chip.console.sent(), "id 12345678\nstreams\n");
  EXPECT_EQ(board.chip.clocks.cpu_hz, 400'000'000U);
  EXPECT_EQ(board.chip.clocks.hclk_hz, 200'000'000U);
  EXPECT_EQ(board.chip.clocks.pclk1_hz, 100'000'000U);
  EXPECT_EQ(board.chip.clocks.timer1_hz, 200'000'000U);
  EXPECT_EQ(board.chip.adc.clock_hz(), 25'000'000U);
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Stream, TheRingComesBackOneFrameLater) {
  start();
  const std::uint64_t before = board.chip.adc.conversions();
  board.chip.run_for(0.02);
  EXPECT_NEAR(static_cast<double>(board.chip.adc.conversions() - before), 2000.0, 1.0);
  for (std::uint32_t i = 1; i <= kRing; ++i) {
    // A voltage that lies on a code's edge may be rounded to either side.
    EXPECT_NEAR(response(i) & 0xFFFF, expected(i), 1.0) << i;
    EXPECT_EQ(response(i) >> 16, response(i) & 0xFFFF) << i;
  }
  EXPECT_NEAR(board.chip.word_at("halves") + board.chip.word_at("wholes"), 2000 * 2 / kRing, 2);
  EXPECT_EQ(board.chip.findings.text(), "");
}

// FIFO with the same sizes changes nothing but when memory is read and written.
TEST_F(H743Stream, AFifoOfEqualSizesMovesTheSame) {
  set("fifo", 0x27);  // Full.
  start();
  board.chip.run_for(0.02);
  for (std::uint32_t i = 1; i <= kRing; ++i) {
    EXPECT_NEAR(response(i) & 0xFFFF, expected(i), 1.0) << i;
  }
  EXPECT_EQ(board.chip.findings.text(), "");
}

// Halves of the pair's word go to memory one behind the other: little endian, it is the same word.
TEST_F(H743Stream, AFifoUnpacksAWordIntoHalves) {
  set("fifo", 0x25);
  set("adc_memory_size", 1);
  start();
  board.chip.run_for(0.02);
  for (std::uint32_t i = 1; i <= kRing; ++i) {
    EXPECT_NEAR(response(i) & 0xFFFF, expected(i), 1.0) << i;
    EXPECT_EQ(response(i) >> 16, response(i) & 0xFFFF) << i;
  }
  EXPECT_EQ(board.chip.findings.text(), "");
}

// Two items of 16 bits make one word of the register: the words of this image, halves or not. A
// ring of samples of 16 bits would lose each second one.
TEST_F(H743Stream, AFifoPacksTwoItemsIntoOneRegister) {
  set("fifo", 0x25);
  set("dac_memory_size", 1);
  start();
  board.chip.run_for(0.02);
  EXPECT_TRUE(board.chip.findings.has("dma_packs"));
  for (std::uint32_t i = 1; i <= kRing; ++i) {
    EXPECT_NEAR(response(i) & 0xFFFF, expected(i), 1.0) << i;
  }
}

TEST_F(H743Stream, TheSlavesDataSlipWhenOldDataAreKept) {
  set("keeps_new_data", 0);
  start();
  board.chip.run_for(0.005);
  EXPECT_TRUE(board.chip.findings.has("adc_slave_may_slip"));
  EXPECT_EQ(response(7) >> 16, response(7) & 0xFFFF);
  board.chip.run_for(0.02);
  for (std::uint32_t i = 2; i <= kRing; ++i) {
    EXPECT_NEAR(response(i) & 0xFFFF, expected(i), 1.0) << i;
    EXPECT_NEAR(response(i) >> 16, expected(i - 1), 1.0) << i;  // One frame late.
  }
}

// The other way around the slip: each converter's own register by a stream of its own.
TEST_F(H743Stream, TwoStreamsKeepThePairTogether) {
  set("two_streams", 1);
  set("keeps_new_data", 0);
  start();
  board.chip.run_for(0.025);
  const std::uint32_t slave = board.chip.symbol("response_of_slave");
  for (std::uint32_t i = 1; i <= kRing; ++i) {
    EXPECT_NEAR(response(i), expected(i), 1.0) << i;
    EXPECT_EQ(board.chip.ram_word(slave + 4 * (i % kRing)), response(i)) << i;
  }
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Stream, WithTheCacheOnBuffersMustNotBeCacheable) {
  set("cached", 1);
  start();
  board.chip.run_for(0.01);
  EXPECT_TRUE(board.chip.processor().system().is_cached(0x24000000));
  EXPECT_FALSE(board.chip.processor().system().is_cached(0x30000000));
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Stream, ADeadClockOfTheProbeLeavesTheInternalOne) {
  board.chip.rcc.set_hse_dead(true);
  board.chip.power_on();
  EXPECT_TRUE(board.chip.run_until_text("no clock\n", 1.0));
  EXPECT_EQ(board.chip.clocks.cpu_hz, 64'000'000U);
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Stream, TheSupplyIsChosenOnceForAsLongAsThereIsPower) {
  start();
  board.chip.reset_pin();
  EXPECT_EQ(board.chip.pwr.bus_read(0x0C, 4) & 7, 2U);
  EXPECT_EQ(board.chip.pwr.bus_read(0x04, 4) & 1U << 13, 1U << 13);
  board.chip.power_on();
  EXPECT_EQ(board.chip.pwr.bus_read(0x0C, 4) & 7, 6U);
  EXPECT_EQ(board.chip.pwr.bus_read(0x04, 4) & 1U << 13, 0U);
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Stream, MemoryWithAClockIsGoneAfterAReset) {
  start();
  const std::uint32_t drive = board.chip.symbol("drive");
  EXPECT_EQ(board.chip.ram_word(drive), 1024U << 4);
  board.chip.reset_pin();
  EXPECT_EQ(board.chip.ram_word(drive), 1024U << 4);  // What it holds stays.
  board.chip.console.take_sent();
  EXPECT_TRUE(board.chip.run_until_text("streams\n", 1.0));
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Stream, ResetsAreToldApart) {
  board.chip.power_on();
  EXPECT_EQ(board.chip.rcc.bus_read(0xD0, 4), 0x00FA0000U);
  board.chip.rcc.bus_write(0xD0, 4, 1U << 16);
  EXPECT_EQ(board.chip.rcc.bus_read(0xD0, 4), 0U);
  board.chip.watchdog.bus_write(0x00, 4, 0xCCCC);  // 0.5 s.
  EXPECT_TRUE(board.chip.run_until([&] { return board.chip.resets() == 2; }, 1.0, 0.01));
  EXPECT_TRUE(board.chip.was_reset_by_watchdog());
  EXPECT_EQ(board.chip.rcc.bus_read(0xD0, 4), 0x045A0000U);
}

TEST_F(H743Stream, EchoesWithoutALoss) {
  start();
  board.chip.console.take_sent();
  const std::string text = "The quick brown fox jumps over the lazy dog.";
  board.chip.console.send(text);
  EXPECT_TRUE(board.chip.run_until_text("dog.", 1.0));
  EXPECT_EQ(board.chip.console.sent(), text);
  EXPECT_EQ(board.chip.findings.text(), "");
}

// At 25 MHz: 165010 cycles for each converter, one after the other.
TEST_F(H743Stream, LinearCalibrationTakesItsTime) {
  VirtualH743 fresh(EMAX_CHIP_IMAGES "/h743_stream.elf", wire);
  fresh.chip.power_on();
  ASSERT_TRUE(fresh.chip.run_until_text("\n", 0.1));
  const double before_s = fresh.chip.now_s();
  ASSERT_TRUE(fresh.chip.run_until_text("streams\n", 1.0));
  // And eight characters of console, of which most go out by themselves.
  EXPECT_NEAR(fresh.chip.now_s() - before_s, 2 * 165010 / 25e6, 1.0e-3);
}

TEST_F(H743Stream, RevisionYHasAnotherNumberAndNoHalvedClock) {
  board.chip.set_revision(Revision::kY);
  board.chip.power_on();
  EXPECT_EQ(board.chip.block("DBGMCU").bus_read(0, 4), 0x10036450U);
  // This image waits for LDORDY, which only revision V has.
  EXPECT_TRUE(board.chip.run_until_text("dead\n", 1.0));
  EXPECT_EQ(board.chip.adc.clock_hz(), 50'000'000U);
  EXPECT_EQ(board.chip.findings.text(), "");
}

class H743Store : public testing::Test {
 protected:
  static constexpr std::uint32_t kSector = kFlashBase + FlashH7::kBankBytes;
  static constexpr unsigned kOperations = 5;  // One erasure, four words.

  H743Store() : board(EMAX_CHIP_IMAGES "/h743_store.elf", wire) {
    board.chip.flash.set_erase_time(1e-3);
  }
  std::string boot() {
    board.chip.console.take_sent();
    board.chip.power_on();
    board.chip.run_until([&] { return board.chip.console.sent().find("end\n") < 100; }, 0.05);
    return board.chip.console.take_sent();
  }

  Wire wire;
  VirtualH743 board;
};

TEST_F(H743Store, KeepsWhatWasProgrammed) {
  EXPECT_EQ(boot(), "empty\nstored\nend\n");
  EXPECT_EQ(board.chip.flash.operations(), kOperations);
  EXPECT_EQ(board.chip.ram_word(kSector + 4 * 31), 31U);
  EXPECT_TRUE(board.chip.flash.is_erased(kSector + 128, FlashH7::kSectorBytes - 128));
  EXPECT_EQ(boot(), "full\nstored\nend\n");
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Store, APowerCutWithinAnOperationTearsIt) {
  EXPECT_EQ(boot(), "empty\nstored\nend\n");
  for (unsigned operation = 0; operation < kOperations; ++operation) {
    board.chip.flash.cut_power_at(operation, PowerCut::kWithin);
    boot();
    ASSERT_TRUE(board.chip.power_failed()) << operation;
    const std::string after = boot();
    ASSERT_FALSE(board.chip.power_failed());
    EXPECT_EQ(after, "torn\nstored\nend\n") << operation;
  }
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Store, APowerCutBesideAnOperationTearsNothing) {
  EXPECT_EQ(boot(), "empty\nstored\nend\n");
  board.chip.flash.cut_power_at(0, PowerCut::kBefore);
  boot();
  ASSERT_TRUE(board.chip.power_failed());
  board.chip.flash.cut_power_at(0, PowerCut::kAfter);
  EXPECT_EQ(boot(), "full\n");
  ASSERT_TRUE(board.chip.power_failed());
  EXPECT_EQ(boot(), "empty\nstored\nend\n");
}

// The image ignores such an error while it looks for it, and takes another one as a fault.
TEST_F(H743Store, BytesThatCannotBeCorrectedAreAnErrorOfTheBus) {
  EXPECT_EQ(boot(), "empty\nstored\nend\n");
  board.chip.flash.break_bytes(kSector + 64);
  EXPECT_EQ(boot(), "torn\nstored\nend\n");
  EXPECT_EQ(board.chip.word_at("bus_faults"), 0U);
}

TEST_F(H743Store, AnErrorOfTheBusIsAFaultForWhoDoesNotIgnoreIt) {
  board.chip.console.take_sent();
  board.chip.power_on();
  ASSERT_TRUE(
      board.chip.run_until([&] { return board.chip.flash.operations() == kOperations; }, 0.05));
  board.chip.flash.break_bytes(kSector + 4 * 64);  // What the image reads last.
  board.chip.run_for(0.01);
  EXPECT_EQ(board.chip.word_at("bus_faults"), 1U);
  EXPECT_NE(board.chip.console.sent().find("fault\n"), std::string::npos);
  EXPECT_EQ(board.chip.flash.bus_read(0x160, 4), 4U * 64 / 32);  // The word that failed.
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(H743Store, AWordProgrammedTwiceCannotBeCorrected) {
  board.chip.power_on();
  FlashH7& flash = board.chip.flash;
  flash.bus_write(0x104, 4, 0x45670123);
  flash.bus_write(0x104, 4, 0xCDEF89AB);
  flash.bus_write(0x10C, 4, 3 << 4 | 2);
  for (const std::uint32_t value : {0xFFFF0000U, 0x0000FFFFU}) {
    for (std::uint32_t i = 0; i < 8; ++i) {
      flash.write_array(kSector + 4 * i, 4, value);
    }
    board.chip.events.pass(ticks(1e-3));
    board.chip.events.run_due();
  }
  EXPECT_TRUE(board.chip.findings.has("flash_not_erased"));
  EXPECT_EQ(flash.read_array(kSector, 4), 0U);
  EXPECT_EQ(flash.bus_read(0x110, 4) & 1U << 26, 1U << 26);
}

TEST_F(H743Store, AFlagThatNeverFallsIsWaitedForWithinBounds) {
  board.chip.hold("FLASH", "SR2", 4, 4);
  board.chip.console.take_sent();
  board.chip.power_on();
  EXPECT_TRUE(board.chip.run_until_text("failed\n", 0.1));
}

}  // namespace
}  // namespace emax::chip
