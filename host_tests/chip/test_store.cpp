// Flash: erasing, programming, error correction, and the power cut at each operation.
#include <gtest/gtest.h>
#include <string>

#include "chip/virtual_board.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kPage = kFlashBase + kBankBytes;
constexpr unsigned kOperations = 9;  // One erasure, eight doublewords.

class Store : public testing::Test {
 protected:
  Store() : board(EMAX_CHIP_IMAGES "/store.elf", wire) {}

  std::string boot() {
    board.chip.console.take_sent();
    board.chip.power_on();
    board.chip.run_until_text("ed\n", 1.0);
    return board.chip.console.take_sent();
  }

  Wire wire;
  VirtualBoard board;
};

TEST_F(Store, KeepsWhatWasProgrammed) {
  EXPECT_EQ(boot(), "empty\nstored\n");
  EXPECT_EQ(board.chip.flash.operations(), kOperations);
  EXPECT_EQ(board.chip.ram_word(kPage + 8), 1U);
  EXPECT_EQ(board.chip.ram_word(kPage + 12), ~1U);
  EXPECT_TRUE(board.chip.flash.is_erased(kPage + 64, kPageBytes - 64));
  EXPECT_EQ(boot(), "full\nstored\n");
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(Store, TakesItsTime) {
  boot();
  // 22 ms to erase, 85 us for each doubleword; the rest is crystal, console and code.
  EXPECT_GT(board.chip.now_s(), 22e-3 + 8 * 85e-6);
  EXPECT_LT(board.chip.now_s(), 30e-3);
}

TEST_F(Store, APowerCutWithinAnOperationTearsIt) {
  for (unsigned operation = 0; operation < kOperations; ++operation) {
    board.chip.flash.cut_power_at(operation, PowerCut::kWithin);
    boot();
    ASSERT_TRUE(board.chip.power_failed()) << operation;
    const std::string after = boot();
    ASSERT_FALSE(board.chip.power_failed());
    // What had been there before the first erasure is torn, too.
    EXPECT_EQ(after, "torn\nstored\n") << operation;
  }
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(Store, APowerCutBesideAnOperationTearsNothing) {
  EXPECT_EQ(boot(), "empty\nstored\n");
  board.chip.flash.cut_power_at(0, PowerCut::kBefore);
  boot();
  ASSERT_TRUE(board.chip.power_failed());
  board.chip.flash.cut_power_at(0, PowerCut::kAfter);
  EXPECT_EQ(boot(), "full\n");
  ASSERT_TRUE(board.chip.power_failed());
  EXPECT_EQ(boot(), "empty\nstored\n");
  EXPECT_EQ(board.chip.findings.text(), "");
}

TEST_F(Store, BytesThatCannotBeCorrectedAreANonMaskableInterrupt) {
  EXPECT_EQ(boot(), "empty\nstored\n");
  board.chip.flash.break_bytes(kPage + 16);
  EXPECT_EQ(boot(), "torn\nstored\n");
  EXPECT_EQ(board.chip.word_at("uncorrectable"), 2U);  // Both words were read.
}

TEST_F(Store, AFlagThatNeverFallsIsWaitedForWithinBounds) {
  board.chip.hold("FLASH", "SR", 1U << 16, 1U << 16);
  EXPECT_EQ(boot(), "empty\nfailed\n");
}

}  // namespace
}  // namespace emax::chip
