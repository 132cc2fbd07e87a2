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
