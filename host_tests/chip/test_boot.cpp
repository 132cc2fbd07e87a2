// Clock tree and console of a right image, and what happens when the hardware does not do its part.
#include <gtest/gtest.h>
#include <string>

#include "chip/virtual_board.hpp"

namespace emax::chip {
namespace {

/// Causes of a reset in RCC_CSR: brown-out and pin; pin; watchdog and pin.
constexpr std::uint32_t kPowerOn = 0x0C000000, kPin = 0x04000000, kWatchdog = 0x24000000;

class Boot : public testing::Test {
 protected:
  Boot() : board(EMAX_CHIP_IMAGES "/boot.elf", wire) {}

  void boot() {
    board.chip.power_on();
    ASSERT_TRUE(board.chip.run_until_text("\n", 1.0)) << board.chip.findings.text();
  }

  Wire wire;
  VirtualBoard board;
};

TEST_F(Boot, ReachesFullSpeedAndTellsItsId) {
  board.chip.set_unique_id({0x12345678, 0, 0});
  boot();
  EXPECT_EQ(board.chip.console.sent(), "id 12345678\n");
  EXPECT_EQ(board.chip.clocks.hclk_hz, 170'000'000U);
  EXPECT_EQ(board.chip.clocks.timer1_hz, 170'000'000U);
  EXPECT_EQ(board.chip.findings.text(), "");
  // The crystal's two milliseconds, and twelve characters at 115200 bit/s.
  EXPECT_NEAR(board.chip.now_s(), 2e-3 + 12 * 10 / 115200.0, 0.5e-3);
}

TEST_F(Boot, EchoesWithoutALoss) {
  boot();
  board.chip.console.take_sent();
  const std::string text = "The quick brown fox jumps over the lazy dog.";
  board.chip.console.send(text);
  EXPECT_TRUE(board.chip.run_until_text("dog.", 1.0));
  EXPECT_EQ(board.chip.console.sent(), text);
  EXPECT_EQ(board.chip.console.lost(), 0U);
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(Boot, NoiseOnTheLineIsAFlagThatIsCleared) {
  boot();
  board.chip.console.spoil_next(LineFault::kNoise);
  board.chip.console.send("ab");
  EXPECT_TRUE(board.chip.run_until_text("b", 1.0));
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(Boot, AnOverrunIsAFlagAndALostCharacter) {
  boot();
  // Nobody takes characters while the interrupt is away.
  board.chip.processor().nvic().enable(interrupt(91), false);
  board.chip.console.send("0123456789");
  board.chip.run_for(0.01);
  EXPECT_EQ(board.chip.console.lost(), 2U);
  board.chip.processor().nvic().enable(interrupt(91), true);
  EXPECT_TRUE(board.chip.run_until_text("01234567", 0.1));
  board.chip.run_for(0.01);
  EXPECT_EQ(board.chip.console.sent().find('8'), std::string::npos);
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(Boot, ADeadCrystalLeavesTheInternalClock) {
  board.chip.rcc.set_hse_dead(true);
  boot();
  EXPECT_EQ(board.chip.console.sent(), "no crystal\n");
  EXPECT_EQ(board.chip.clocks.hclk_hz, kHsi_hz);
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(Boot, AHeldFlagNeverComes) {
  board.chip.hold("RCC", "CR", 1U << 25, 0);
  boot();
  EXPECT_EQ(board.chip.console.sent(), "no crystal\n");
  EXPECT_THROW(board.chip.hold("RCC", "NO_SUCH", 1, 0), std::invalid_argument);
}

TEST_F(Boot, ACrystalThatStopsIsFoundUnlessSomebodyWatches) {
  boot();
  board.chip.rcc.set_hse_dead(true);
  EXPECT_TRUE(board.chip.findings.has("clock_lost"));
}

TEST_F(Boot, ResetsAreToldApart) {
  board.chip.power_on();
  EXPECT_EQ(board.chip.rcc.bus_read(0x94, 4), kPowerOn);
  board.chip.reset_pin();
  EXPECT_EQ(board.chip.rcc.bus_read(0x94, 4), kPowerOn | kPin);
  board.chip.rcc.bus_write(0x94, 4, 1U << 23);
  board.chip.reset_pin();
  EXPECT_EQ(board.chip.rcc.bus_read(0x94, 4), kPin);
}

TEST_F(Boot, TheWatchdogBitesAfterItsPeriodAndIsRemembered) {
  boot();
  Iwdg& watchdog = board.chip.watchdog;
  watchdog.bus_write(0x00, 4, 0xCCCC);
  watchdog.bus_write(0x00, 4, 0x5555);
  watchdog.bus_write(0x04, 4, 3);    // By 32.
  watchdog.bus_write(0x08, 4, 999);  // 1000 turns of a millisecond.
  board.chip.run_for(0.01);
  EXPECT_EQ(watchdog.bus_read(0x0C, 4), 0U);
  watchdog.bus_write(0x00, 4, 0xAAAA);
  const double kicked_s = board.chip.now_s();
  EXPECT_TRUE(board.chip.run_until([&] { return board.chip.resets() == 2; }, 2.0));
  EXPECT_NEAR(board.chip.now_s() - kicked_s, 1.0, 2e-4);
  EXPECT_EQ(board.chip.rcc.bus_read(0x94, 4) & kWatchdog, kWatchdog);
  EXPECT_EQ(board.chip.findings.text(), "");
}

}  // namespace
}  // namespace emax::chip
