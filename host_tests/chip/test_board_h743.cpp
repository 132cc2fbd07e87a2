// What only the board with the STM32H743 has to show: both revisions of the silicon, and either
// reading of how its converters' clock is made.
#include <gtest/gtest.h>

#include "chip/real_image.hpp"

namespace emax::chip {
namespace {

/// Measures, and nothing is used wrongly.
class H743Image : public RealImage {
 protected:
  void measures() {
    boot();
    EXPECT_EQ(ask("*TST?"), "0");
    ask("SENS:SWE:FREQ 500,1000,2000;*OPC?");
    EXPECT_EQ(ask("INIT;*OPC?", 30.0), "1");
    EXPECT_EQ(error(), 0);
    EXPECT_EQ(numbers(ask("FETC:FRES?")).size(), 1U + 3 * 5);
    EXPECT_EQ(board->chip.findings.text(), "");
  }
};

TEST_F(H743Image, MeasuresOnRevisionY) {
  board->chip.set_revision(Revision::kY);
  measures();
}

TEST_F(H743Image, MeasuresWhetherTheClockIsHalvedOrNot) {
  board->chip.adc.family().clock_divider = 1;
  measures();
}

// 8 conversions of 25 cycles each, of 25 MHz, of 50 MHz should the chip not halve its clock, or of
// the older silicon's 32 MHz. The program sees the end by looking, some hundredths of a microsecond
// late.
TEST_F(H743Image, TellsHowLongAResultTakes) {
  constexpr double kLook_s = 0.2e-6;
  boot();
  EXPECT_NEAR(numbers(ask("DIAG:CONV?")).at(0), 8.0e-6, kLook_s);
  board->chip.adc.family().clock_divider = 1;
  EXPECT_NEAR(numbers(ask("DIAG:CONV?")).at(0), 4.0e-6, kLook_s);
  EXPECT_EQ(error(), 0);
  EXPECT_EQ(board->chip.findings.text(), "");
}

TEST_F(H743Image, TellsHowLongAResultTakesOnRevisionY) {
  board->chip.set_revision(Revision::kY);
  boot();
  EXPECT_NEAR(numbers(ask("DIAG:CONV?")).at(0), 200.0 / 32e6, 0.2e-6);
  EXPECT_EQ(board->chip.findings.text(), "");
}

TEST_F(H743Image, WithoutItsCrystalItDoesNotTellHowLongAResultTakes) {
  board->chip.rcc.set_hse_dead(true);
  board->chip.power_on();
  ASSERT_TRUE(answers(1.0));
  EXPECT_EQ(ask("DIAG:CONV?"), "9.91E37");
}

// A bank that is swapped in by an option byte holds the program: nothing is written then.
TEST_F(H743Image, WritesNothingWhenTheBanksAreSwapped) {
  board->chip.flash.set_swapped(true);
  boot();
  ask("*SAV 1;*OPC?");
  EXPECT_EQ(board->chip.flash.operations(), 0U);
  EXPECT_NE(error(), 0);
}

}  // namespace
}  // namespace emax::chip
