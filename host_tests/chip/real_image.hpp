// The image to be flashed in the virtual chip, as the tests of it need it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "chip/tested_board.hpp"

namespace emax::chip {

constexpr double kMiddle_v = 1.65;
constexpr double kCode_v = 3.3 / 4096;
/// Of the board's defaults.
constexpr double kDriveLimit_v = 1.4;

inline std::vector<double> numbers(const std::string& text) {
  std::vector<double> values;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    values.push_back(std::strtod(part.c_str(), nullptr));
  }
  return values;
}

class RealImage : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::ifstream(EMAX_CHIP_IMAGE)) {
      GTEST_SKIP() << "no " EMAX_CHIP_IMAGE "; build it: cmake --workflow --preset "
                   << Tested::kPreset;
    }
    put_on_bench(bench);
  }

  // Nothing is used wrongly in any run; what a fault provokes is no use of the program's.
  void TearDown() override {
    if (board == nullptr) {
      return;
    }
    for (const Finding& finding : board->chip.findings.all()) {
      EXPECT_EQ(provoked.count(finding.what), 1U) << board->chip.findings.text();
    }
    EXPECT_LE(board->analog.greatest_excursion_v(), kDriveLimit_v + kCode_v);
  }

  /// A board of its own with what is connected to it.
  void put_on_bench(BenchInVolts& connected) {
    board = std::make_unique<TestedBoard>(EMAX_CHIP_IMAGE, connected);
    Tested::prepare(board->chip);
  }
  void boot() {
    board->chip.power_on();
    board->chip.run_for(0.02);
  }
  /// Characters that come while the image starts are lost: asks again until there is an answer.
  bool answers(double most_s) {
    const double end_s = board->chip.now_s() + most_s;
    while (board->chip.now_s() < end_s) {
      if (ask("*IDN?", 0.1).find("emax,") != std::string::npos) {
        return true;
      }
    }
    return false;
  }
  std::string ask(const std::string& question, double most_s = 5.0) {
    return board->ask(question, most_s);
  }
  /// The oldest error's number.
  int error() { return static_cast<int>(std::strtol(ask("SYST:ERR?").c_str(), nullptr, 10)); }
  /// The function whose mangled name contains this.
  std::uint32_t function(const std::string& part) {
    const Elf elf = read_elf(EMAX_CHIP_IMAGE);
    const auto found = std::find_if(elf.symbols.begin(), elf.symbols.end(), [&](const auto& entry) {
      return entry.first.find(part) != std::string::npos;
    });
    EXPECT_NE(found, elf.symbols.end()) << part;
    return found == elf.symbols.end() ? kFlashBase : found->second & ~1U;
  }
  /// Starts a sweep and lets it come so far that the drive is on.
  void start_sweep() {
    ask("SENS:SWE:FREQ 200,500,1000;*OPC?");
    board->chip.console.send("INIT\n");
    ASSERT_TRUE(board->chip.run_until([&] { return driving_v() > 0.1; }, 2.0));
  }
  double driving_v() const { return std::fabs(board->analog.drive_pin_v() - kMiddle_v); }
  /// When the drive pin was last away from the middle by more than a code.
  Time last_driven() const {
    Time last = 0;
    const auto& record = board->analog.drive_record();
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (std::fabs(record[i].pin_v - kMiddle_v) > kCode_v) {
        last = i + 1 < record.size() ? record[i + 1].at : board->chip.events.now();
      }
    }
    return last;
  }
  /// How often the LED goes on or off.
  unsigned led_changes(double time_s) {
    unsigned changes = 0;
    bool was_on = Tested::led(board->chip);
    for (double passed_s = 0.0; passed_s < time_s; passed_s += 0.01) {
      board->chip.run_for(0.01);
      changes += Tested::led(board->chip) != was_on ? 1U : 0U;
      was_on = Tested::led(board->chip);
    }
    return changes;
  }
  double frames(Time from, Time until) const {
    return seconds(until - from) / board->chip.tim6.period_s();
  }

  /// Both converters of these chips sample at the same instant.
  static sim::BenchSettings bench_settings() {
    sim::BenchSettings settings;
    settings.skew_s = 0.0;
    settings.shaker.reconstruction_hz = Tested::kReconstruction_hz;
    return settings;
  }

  /// Findings that come of what the test has done to the chip.
  std::set<std::string> provoked = {"adc_overrun", "dac_underrun"};
  SimulatedBench bench{bench_settings()};
  std::unique_ptr<TestedBoard> board;
};

}  // namespace emax::chip
