// The line about a fault, and what happens in which order. This file is the board.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>

#include "emax/board/fault_report.hpp"

namespace {

using emax::Span;
using emax::board::FaultNumber;
using emax::board::format_fault_line;
using emax::board::report_fault;

std::string events;
bool is_faulting_on_the_way = false;

std::string line_of(const char* kind, bool is_at_zero, Span<const FaultNumber> numbers) {
  std::array<char, emax::board::kFaultLineRoom> text = {};
  return {text.data(), format_fault_line(kind, is_at_zero, numbers, text)};
}

}  // namespace

bool emax::board::lead_drive_to_zero() noexcept {
  events += "drive;";
  if (is_faulting_on_the_way) {
    report_fault("second", {});
    report_fault("third", {});
  }
  return true;
}

void emax::board::write_polled(Span<const char> text) noexcept {
  events.append(text.data(), text.size());
}

namespace {

TEST(FaultReport, IsOneLineOfNumbers) {
  const FaultNumber numbers[] = {{"pc", 0x00001234}, {"lr", 0xFFFFFFF9}, {"sp", 0}};
  EXPECT_EQ(line_of("BusFault", true, numbers),
            "\nfault: BusFault, drive at zero, pc=0x00001234 lr=0xfffffff9 sp=0x00000000\n");
  EXPECT_EQ(line_of("trap", false, {}), "\nfault: trap, DRIVE NOT AT ZERO,\n");
}

TEST(FaultReport, LeavesOutWhatFindsNoRoom) {
  std::array<char, 12> text = {};
  text.fill('#');
  EXPECT_EQ(format_fault_line("BusFault", true, {}, Span<char>(text).first(11)), 11U);
  EXPECT_EQ(std::string(text.data(), text.size()), "\nfault: Bus#");
}

// The count of faults is that of a board, which no second test can reset: each has its process.
TEST(FaultReport, WatchdogAfterAFaultKnowsWhereTheDriveIs) {
  const auto fault_then_watchdog = [] {
    report_fault("BusFault", {});
    events.clear();
    report_fault("watchdog", {});
    std::fputs(events.c_str(), stderr);
    std::exit(0);
  };
  EXPECT_EXIT(fault_then_watchdog(), testing::ExitedWithCode(0),
              "^\nfault: watchdog, drive at zero,\n$");
}

TEST(FaultReport, DriveComesFirstAndOnlyOnce) {
  is_faulting_on_the_way = true;
  report_fault("first", {});
  EXPECT_EQ(events, "drive;\nfault: second, DRIVE NOT AT ZERO,\n\nfault: first, drive at zero,\n");
}

}  // namespace
