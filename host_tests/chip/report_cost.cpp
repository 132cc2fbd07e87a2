// Counts the instructions and the time of a whole default report on the image to be flashed: the
// sweep, the evaluation stage by stage, the text. Takes minutes.
#include <cstdint>
#include <cstdio>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "chip/counts.hpp"
#include "chip/real_image.hpp"

namespace emax::chip {
namespace {

constexpr double kLook_s = 0.02;
constexpr double kMost_s = 3600.0;
constexpr std::size_t kLengthDigits = 5;

struct Stage {
  std::string name;
  std::uint64_t instructions;
  double time_s;
};

class WholeReport : public RealImage {
 protected:
  std::uint64_t instructions() const { return board->chip.processor().instructions(); }
  double now_s() const { return board->chip.now_s(); }

  /// What runs, and until a look sees another stage or the end.
  Stage run_stage() {
    const std::uint64_t instructions_before = instructions();
    const double begin_s = now_s();
    const std::string name = stage();
    while (stage() == name && now_s() - begin_s < kMost_s) {
      board->chip.run_for(kLook_s);
    }
    std::printf("%s %.1f s\n", name.c_str(), now_s() - begin_s);
    std::fflush(stdout);
    return {name, instructions() - instructions_before, now_s() - begin_s};
  }

  /// A block of a stated length, with the line feed behind it.
  std::string block(const std::string& query) {
    board->chip.console.take_sent();
    board->chip.console.send(query + "\n");
    std::size_t whole = 0;
    const bool is_whole = board->chip.run_until(
        [&] {
          const std::string& sent = board->chip.console.sent();
          if (whole == 0 && sent.size() > 2 + kLengthDigits) {
            whole = 2 + kLengthDigits + std::stoul(sent.substr(2, kLengthDigits)) + 1;
          }
          return whole != 0 && sent.size() == whole;
        },
        60.0);
    const std::string text = board->chip.console.take_sent();
    EXPECT_TRUE(is_whole && text.rfind("#5", 0) == 0) << text.substr(0, 10);
    return is_whole ? text.substr(2 + kLengthDigits) : "";
  }

  /// The rows of the table, which are printed to be put there where one is off by more than 10 %.
  void print() {
    Stage sum = {"all of it", 0, 0.0};
    for (const Stage& one : stages) {
      sum.instructions += one.instructions;
      sum.time_s += one.time_s;
    }
    stages.push_back(sum);
    const auto recorded = table_rows(Tested::kReportTable);
    bool same = recorded.size() == stages.size() + 1;  // And the head.
    for (std::size_t i = 0; i < stages.size(); ++i) {
      const auto& [name, instructions, time_s] = stages[i];
      std::printf("| %s | %s | %s |\n", name.c_str(), grouped(instructions).c_str(),
                  time_of(time_s * 1e6).c_str());
      const auto count = static_cast<double>(instructions);
      same = same && recorded[i + 1].first == name &&
             std::fabs(recorded[i + 1].second - count) <= 0.1 * count;
    }
    EXPECT_TRUE(same) << "\"" << Tested::kReportTable << "\" in firmware/README.md has other rows";
  }

  std::string stage() {
    const std::string progress = ask("SYST:PROG?");
    const std::size_t begin = progress.find('"'), end = progress.rfind('"');
    return begin < end ? progress.substr(begin + 1, end - begin - 1) : progress;
  }
  std::vector<Stage> stages;
};

TEST_F(WholeReport, ByDefault) {
  Tested::prepare_to_count(board->chip);
  boot();
  ask("*RST;*OPC?");
  WorkCounter work(board->chip, function("Stm32Stream14wait_for_block"),
                   function("Stm32Stream11do_exchange"));
  board->chip.processor().watch_with(
      [&](std::uint32_t address, std::uint32_t count) { work.on_block(address, count); });
  board->chip.console.send("INIT;*WAI;:INIT:REP\n");
  board->chip.run_for(0.005);
  ASSERT_EQ(stage(), "sweep");
  stages.push_back(run_stage());
  board->chip.processor().watch_with({});
  stages.front() = {"sweep of 42 frequencies, without its waits", work.total(),
                    stages.front().time_s};
  while (stage() != "idle" && now_s() < kMost_s) {
    stages.push_back(run_stage());
  }
  const std::vector<double> fit = numbers(ask("CALC:IDEN?"));
  ASSERT_EQ(fit.size(), 8U);
  const sim::BenchTruth& truth = bench.bench().truth();
  EXPECT_NEAR(fit[1], truth.device.natural_frequency_hz, 4.0 * fit[4]);
  EXPECT_NEAR(fit[2], truth.device.damping, 4.0 * fit[5]);
  const std::uint64_t before = instructions();
  const double asked_s = now_s();
  const std::string report = block("CALC:REP?");
  stages.push_back({"its text, over the console", instructions() - before, now_s() - asked_s});
  std::printf("%s\n", report.c_str());
  EXPECT_EQ(ask("SYST:ERR?"), "0,\"No error\"");
  EXPECT_EQ(board->chip.findings.text(), "");
  print();
}

}  // namespace
}  // namespace emax::chip
