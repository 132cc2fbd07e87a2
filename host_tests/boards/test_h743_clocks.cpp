// The clock tree of the NUCLEO-H743ZI2 over fake registers: the order of its steps, and that it
// ends at a clock that works, whatever does not start.
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <string>

#include "emax/board/h743.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/stm32_clocks.hpp"
#include "emax/board/timebase.hpp"

namespace emax::test {
namespace {

/// What does not come.
enum class Missing { kNothing, kSupply, kVoltage, kCrystal, kPll, kWaitStates };

/// Clocks that may fail, and a list of what was wrong in the order of their use.
class FakeClocks final : public FakeChip {
 public:
  explicit FakeClocks(Missing missing = Missing::kNothing) : missing_(missing) {}
  std::string wrong;

  /// The crystal's clock stops: the chip goes on with the internal oscillator, and the PLL is off.
  void lose_crystal() {
    missing_ = Missing::kCrystal;
    registers_[kControl] &= ~(kCrystalOn | kPllOn);
    registers_[kConfiguration] &= ~7U;
    registers_[board::kRcc + 0x64] |= 1U << 10;
  }

  double processor_mhz() { return (registers_[kConfiguration] & 7U) == 3U ? pll_mhz() : 64.0; }
  double bus_mhz() { return processor_mhz() / ((registers_[kDomain1] & 0xFU) == 8U ? 2.0 : 1.0); }
  double peripherals_mhz() {
    return bus_mhz() / ((registers_[kDomain2] >> 4U & 7U) == 4U ? 2.0 : 1.0);
  }
  double timers_mhz() {
    const bool is_divided = (registers_[kDomain2] >> 4U & 7U) == 4U;
    return peripherals_mhz() * (is_divided ? 2.0 : 1.0);
  }
  bool is_crystal_watched() { return (registers_[kControl] & 1U << 19) != 0; }
  std::uint32_t value_of(std::uintptr_t address) { return registers_[address]; }
  /// What a count of the timebase takes.
  double count_us() { return (registers_[board::kTimebase + 0x28] + 1.0) / timers_mhz(); }

  std::uint32_t read(std::uintptr_t address, unsigned /*bytes*/) override {
    cycles_ += 100;
    const std::uint32_t value = registers_[address];
    switch (address) {
      case 0x40000024:
        return static_cast<std::uint32_t>(cycles_ / (registers_[board::kTimebase + 0x28] + 1));
      case kControl:
        return value | 1U << 2 |
               (missing_ != Missing::kCrystal && (value & kCrystalOn) != 0 ? 1U << 17 : 0) |
               (missing_ != Missing::kPll && (value & kPllOn) != 0 ? 1U << 25 : 0);
      case kConfiguration:
        return value | (value & 7U) << 3U;
      case board::kPower + 0x04:
        return missing_ != Missing::kSupply ? 1U << 13 : 0;
      case board::kPower + 0x18:
        return value | (missing_ != Missing::kVoltage ? 1U << 13 : 0);
      case board::kFlash:
        return missing_ == Missing::kWaitStates ? value & ~7U : value;
      default:
        return value;
    }
  }

  void write(std::uintptr_t address, std::uint32_t value) override {
    const std::uint32_t before = registers_[address];
    const bool is_pll_on = (registers_[kControl] & kPllOn) != 0;
    if (address >= board::kRcc + 0x28 && address <= board::kRcc + 0x34 && is_pll_on) {
      wrong += "PLL changed while on;";
    }
    if (address == kControl && ((value ^ before) & 1U << 18) != 0 && (before & kCrystalOn) != 0) {
      wrong += "bypass changed while on;";
    }
    if (address == kControl && (value & ~before & kCrystalOn) != 0 && (value & 1U << 18) == 0) {
      wrong += "a crystal, where there is a clock;";
    }
    if (address == board::kPower + 0x0C) {
      wrong += ++supply_writes_ > 1 ? "supply written twice;" : "";
    }
    if (address == board::kPower + 0x18 && (registers_[board::kPower + 0x0C] & 7U) != 2U) {
      wrong += "voltage before the supply;";
    }
    if (address == board::kRcc + 0x68) {
      registers_[board::kRcc + 0x64] &= ~value;
      return;
    }
    registers_[address] = value & ~read_only(address);
    look();
  }

 private:
  static constexpr std::uintptr_t kControl = board::kRcc;
  static constexpr std::uintptr_t kConfiguration = board::kRcc + 0x10;
  static constexpr std::uintptr_t kDomain1 = board::kRcc + 0x18;
  static constexpr std::uintptr_t kDomain2 = board::kRcc + 0x1C;
  static constexpr std::uint32_t kCrystalOn = 1U << 16;
  static constexpr std::uint32_t kPllOn = 1U << 24;

  static constexpr std::uint32_t read_only(std::uintptr_t address) {
    switch (address) {
      case kControl:
        return 1U << 2 | 1U << 17 | 1U << 25;
      case kConfiguration:
        return 7U << 3;
      case board::kPower + 0x18:
        return 1U << 13;
      default:
        return 0;
    }
  }

  double pll_mhz() {
    const std::uint32_t source = registers_[board::kRcc + 0x28];
    const std::uint32_t dividers = registers_[board::kRcc + 0x30];
    const std::uint32_t configuration = registers_[board::kRcc + 0x2C];
    const double input = ((source & 3U) == 2U ? 8.0 : 64.0) / (source >> 4U & 0x3FU);
    const double vco = input * ((dividers & 0x1FFU) + 1);
    const bool is_range = input >= 8.0 && input <= 16.0 && (configuration >> 2U & 3U) == 3U;
    if (!is_range || (configuration & 2U) != 0 || vco < 192.0 || vco > 836.0) {
      wrong += "PLL outside its ranges;";
    }
    if ((configuration & 1U << 16) == 0) {
      wrong += "PLL output off;";
    }
    return vco / ((dividers >> 9U & 0x7FU) + 1.0);
  }

  // At any moment.
  void look() {
    if ((registers_[kConfiguration] & 7U) != 3U) {
      return;
    }
    const std::uint32_t access = registers_[board::kFlash];
    if (bus_mhz() > 185.0 && ((access & 0xFU) < 2 || (access >> 4U & 3U) != 2)) {
      wrong += "too few wait states;";
    }
    if ((registers_[board::kPower + 0x18] >> 14U) != 3U) {
      wrong += "too fast for the voltage;";
    }
    if (processor_mhz() > 400.0 || bus_mhz() > 200.0 || peripherals_mhz() > 100.0) {
      wrong += "too fast;";
    }
  }

  Missing missing_;
  int supply_writes_ = 0;
  // As a reset leaves them.
  std::map<std::uintptr_t, std::uint32_t> registers_ = {{board::kRcc, 0x83},
                                                        {board::kRcc + 0x28, 0x02020200},
                                                        {board::kRcc + 0x2C, 0x01FF0000},
                                                        {board::kRcc + 0x30, 0x01010280},
                                                        {board::kPower + 0x0C, 6},
                                                        {board::kPower + 0x18, 0x4000},
                                                        {board::kFlash, 0x37}};
  std::uint64_t cycles_ = 0;
};

TEST(H743Clocks, GoTo400MegahertzFromTheDebuggersClock) {
  FakeClocks chip;
  const board::Clocks clocks = board::start_clocks();
  EXPECT_EQ(chip.wrong, "");
  EXPECT_TRUE(clocks.is_exact);
  EXPECT_EQ(chip.processor_mhz(), 400.0);
  EXPECT_EQ(chip.bus_mhz(), 200.0);
  EXPECT_EQ(clocks.hz, 1e6 * chip.timers_mhz());
  EXPECT_EQ(clocks.console_hz, 1e6 * chip.peripherals_mhz());
  EXPECT_EQ(chip.count_us(), 1.0);
  EXPECT_TRUE(chip.is_crystal_watched());
  // The linear regulator alone, at scale 1.
  EXPECT_EQ(chip.value_of(board::kPower + 0x0C), 2U);
  EXPECT_EQ(chip.value_of(board::kPower + 0x18), 3U << 14);
  // SRAM1 has its clock.
  EXPECT_NE(chip.value_of(board::kRcc + 0xDC) & 1U << 29, 0U);
}

TEST(H743Clocks, LeaveTheSupplyAloneThatAResetHasLeft) {
  FakeClocks chip;
  chip.write(board::kPower + 0x0C, 2);
  EXPECT_TRUE(board::start_clocks().is_exact);
  EXPECT_EQ(chip.wrong, "");
}

TEST(H743Clocks, StayAt64MegahertzIfAnythingIsMissingAndSaySo) {
  for (const Missing missing : {Missing::kSupply, Missing::kVoltage, Missing::kCrystal,
                                Missing::kPll, Missing::kWaitStates}) {
    FakeClocks chip(missing);
    const board::Clocks clocks = board::start_clocks();
    EXPECT_EQ(chip.wrong, "") << static_cast<int>(missing);
    EXPECT_FALSE(clocks.is_exact);
    EXPECT_EQ(clocks.hz, 64'000'000U);
    EXPECT_EQ(clocks.console_hz, 64'000'000U);
    EXPECT_EQ(chip.processor_mhz(), 64.0);
    EXPECT_EQ(chip.timers_mhz(), 64.0);
    EXPECT_EQ(chip.count_us(), 1.0);
    EXPECT_FALSE(chip.is_crystal_watched());
  }
}

TEST(H743Clocks, GoOnWhenTheCrystalStops) {
  FakeClocks chip;
  EXPECT_TRUE(board::start_clocks().is_exact);
  EXPECT_FALSE(board::take_crystal_lost());
  chip.lose_crystal();
  EXPECT_TRUE(board::take_crystal_lost());
  EXPECT_FALSE(board::take_crystal_lost());
  const board::Clocks clocks = board::restart_clocks();
  EXPECT_EQ(chip.wrong, "");
  EXPECT_FALSE(clocks.is_exact);
  EXPECT_EQ(clocks.hz, 1e6 * chip.timers_mhz());
  EXPECT_EQ(clocks.console_hz, 1e6 * chip.peripherals_mhz());
  EXPECT_EQ(chip.count_us(), 1.0);
}

}  // namespace
}  // namespace emax::test
