// The clock tree of the NUCLEO-G474RE over fake registers: the order of its steps, and that it
// ends at a clock that works, whatever does not start.
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <string>

#include "emax/board/g474.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/stm32_clocks.hpp"
#include "emax/board/timebase.hpp"

namespace emax::test {
namespace {

/// Clocks that may fail, and a list of what was wrong in the order of their use.
class FakeClocks final : public FakeChip {
 public:
  bool has_crystal = true;
  bool has_pll = true;
  bool has_wait_states = true;
  std::string wrong;

  /// The crystal stops: the chip goes on with the internal oscillator, and the PLL is off.
  void lose_crystal() {
    has_crystal = false;
    registers_[kControl] &= ~(kCrystalOn | kPllOn);
    registers_[kConfiguration] &= ~3U;
    registers_[kConfiguration] |= 1U;
    registers_[board::kRcc + 0x1C] |= 1U << 8;
  }

  double mhz() {
    return sysclk_mhz() / ((registers_[kConfiguration] & 0xF0U) == 0x80U ? 2.0 : 1.0);
  }
  bool is_crystal_watched() { return (registers_[kControl] & 1U << 19) != 0; }
  /// What a count of the timebase takes.
  double count_us() { return (registers_[board::kTimebase + 0x28] + 1.0) / mhz(); }

  std::uint32_t read(std::uintptr_t address, unsigned /*bytes*/) override {
    cycles_ += 100;
    switch (address) {
      case 0x40000024:
        return static_cast<std::uint32_t>(cycles_ / (registers_[board::kTimebase + 0x28] + 1));
      case kControl:
        return registers_[kControl] | 1U << 10 |
               (has_crystal && (registers_[kControl] & kCrystalOn) != 0 ? 1U << 17 : 0) |
               (has_pll && (registers_[kControl] & kPllOn) != 0 ? 1U << 25 : 0);
      case kConfiguration:
        return registers_[kConfiguration] | (registers_[kConfiguration] & 3U) << 2U;
      case board::kFlash:
        return has_wait_states ? registers_[address] : registers_[address] & ~0xFU;
      default:
        return registers_[address];
    }
  }

  void write(std::uintptr_t address, std::uint32_t value) override {
    const std::uint32_t before = registers_[address];
    if (address == kPllConfiguration && (registers_[kControl] & kPllOn) != 0) {
      wrong += "PLL changed while on;";
    }
    if (address == board::kRcc + 0x20) {
      registers_[board::kRcc + 0x1C] &= ~value;
      return;
    }
    registers_[address] = value & ~read_only(address);
    if (address == kConfiguration && (value & 3U) == 3U && (before & 3U) != 3U) {
      look_before_speed();
    }
    if (address == kConfiguration && mhz() > 100.0 && (before & 3U) != 3U) {
      wrong += "all the way in one step;";
    }
  }

 private:
  static constexpr std::uintptr_t kControl = board::kRcc;
  static constexpr std::uintptr_t kConfiguration = board::kRcc + 0x08;
  static constexpr std::uintptr_t kPllConfiguration = board::kRcc + 0x0C;
  static constexpr std::uint32_t kCrystalOn = 1U << 16;
  static constexpr std::uint32_t kPllOn = 1U << 24;

  static constexpr std::uint32_t read_only(std::uintptr_t address) {
    if (address == kControl) {
      return 1U << 10 | 1U << 17 | 1U << 25;
    }
    return address == kConfiguration ? 0xC : 0;
  }

  double pll_mhz() {
    const std::uint32_t value = registers_[kPllConfiguration];
    const double source = (value & 3U) == 3U ? 24.0 : (value & 3U) == 2U ? 16.0 : 0.0;
    const double input = source / ((value >> 4U & 0xFU) + 1);
    const double vco = input * (value >> 8U & 0x7FU);
    if (input < 2.66 || input > 16.0 || vco < 96.0 || vco > 344.0) {
      wrong += "PLL outside its ranges;";
    }
    return vco / (2.0 * ((value >> 25U & 3U) + 1.0));
  }
  double sysclk_mhz() { return (registers_[kConfiguration] & 3U) == 3U ? pll_mhz() : 16.0; }

  void look_before_speed() {
    if ((registers_[board::kFlash] & 0xFU) < 4) {
      wrong += "too few wait states;";
    }
    if ((registers_[board::kPower + 0x80] & 1U << 8) != 0) {
      wrong += "no boost;";
    }
    if ((registers_[kPllConfiguration] & 1U << 24) == 0) {
      wrong += "PLL output off;";
    }
  }

  std::map<std::uintptr_t, std::uint32_t> registers_ = {{board::kRcc, 0x500},
                                                        {board::kRcc + 0x08, 1},
                                                        {board::kPower + 0x80, 1U << 8},
                                                        {board::kFlash, 0x40600}};
  std::uint64_t cycles_ = 0;
};

TEST(G474Clocks, GoTo170MegahertzFromTheCrystal) {
  FakeClocks chip;
  const board::Clocks clocks = board::start_clocks();
  EXPECT_EQ(chip.wrong, "");
  EXPECT_EQ(clocks.hz, 170'000'000U);
  EXPECT_TRUE(clocks.is_exact);
  EXPECT_EQ(chip.mhz(), 170.0);
  EXPECT_EQ(chip.count_us(), 1.0);
  EXPECT_TRUE(chip.is_crystal_watched());
}

TEST(G474Clocks, GoThereWithoutTheCrystalTooAndSaySo) {
  FakeClocks chip;
  chip.has_crystal = false;
  const board::Clocks clocks = board::start_clocks();
  EXPECT_EQ(chip.wrong, "");
  EXPECT_EQ(clocks.hz, 170'000'000U);
  EXPECT_FALSE(clocks.is_exact);
  EXPECT_EQ(chip.mhz(), 170.0);
  EXPECT_EQ(chip.count_us(), 1.0);
  EXPECT_FALSE(chip.is_crystal_watched());
}

TEST(G474Clocks, StayAt16MegahertzWithoutPllOrWaitStates) {
  for (const bool has_pll : {false, true}) {
    FakeClocks chip;
    chip.has_pll = has_pll;
    chip.has_wait_states = !has_pll;
    const board::Clocks clocks = board::start_clocks();
    EXPECT_EQ(chip.wrong, "");
    EXPECT_EQ(clocks.hz, 16'000'000U);
    EXPECT_FALSE(clocks.is_exact);
    EXPECT_EQ(chip.mhz(), 16.0);
    EXPECT_EQ(chip.count_us(), 1.0);
  }
}

TEST(G474Clocks, GoOnWhenTheCrystalStops) {
  FakeClocks chip;
  EXPECT_TRUE(board::start_clocks().is_exact);
  EXPECT_FALSE(board::take_crystal_lost());
  chip.lose_crystal();
  EXPECT_TRUE(board::take_crystal_lost());
  EXPECT_FALSE(board::take_crystal_lost());
  const board::Clocks clocks = board::restart_clocks();
  EXPECT_EQ(chip.wrong, "");
  EXPECT_EQ(clocks.hz, 170'000'000U);
  EXPECT_FALSE(clocks.is_exact);
  EXPECT_EQ(chip.mhz(), 170.0);
  EXPECT_EQ(chip.count_us(), 1.0);
}

}  // namespace
}  // namespace emax::test
