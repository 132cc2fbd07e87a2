// What the image to be flashed does with its time and its converters: loopback, digits, counts of
// instructions, rest.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

#include "chip/counts.hpp"
#include "chip/real_image.hpp"

namespace emax::chip {
namespace {

/// What the program hands over to the stream and gets from it, seen at the call of `do_exchange()`.
class ExchangeRecord {
 public:
  ExchangeRecord(Tested::Chip& chip, std::uint32_t start, std::uint32_t exchange)
      : chip_(chip), start_(start), exchange_(exchange) {}

  void on_block(std::uint32_t address) {
    if (address == start_) {
      drive.clear();
      response.clear();
      response_at_ = 0;
    } else if (address == exchange_) {
      record();
    }
  }

  std::vector<std::int32_t> drive;
  std::vector<std::array<std::int32_t, 2>> response;
  std::uint32_t stated_latency = 0;

 private:
  static constexpr std::uint32_t kBlockFrames = 64;
  std::int32_t word(std::uint32_t address) {
    return static_cast<std::int32_t>(chip_.ram_word(address));
  }
  // Armv7 procedure call standard: r0 the result's place, r1 the stream, r2 and r3 the drive, the
  // response on the stack.
  void record() {
    const Engine& engine = chip_.processor().engine();
    if (response_at_ != 0) {
      for (std::uint32_t i = 0; i < kBlockFrames; ++i) {
        response.push_back({word(response_at_ + 8 * i), word(response_at_ + 8 * i + 4)});
      }
    }
    const std::uint32_t drive_at = engine.get(UC_ARM_REG_R2);
    ASSERT_EQ(engine.get(UC_ARM_REG_R3), kBlockFrames);
    for (std::uint32_t i = 0; i < kBlockFrames; ++i) {
      drive.push_back(word(drive_at + 4 * i));
    }
    response_at_ = chip_.ram_word(engine.get(UC_ARM_REG_SP));
    // Behind the table of functions and three numbers of 8 bytes: the block's frames, the latency.
    const std::uint32_t format_at = engine.get(UC_ARM_REG_R1) + 8;
    ASSERT_EQ(chip_.ram_word(format_at + 24), kBlockFrames);
    stated_latency = chip_.ram_word(format_at + 28);
  }

  Tested::Chip& chip_;
  const std::uint32_t start_, exchange_;
  std::uint32_t response_at_ = 0;
};

/// A wire from the drive to both inputs, and the noise of converters: without any, a sweep takes a
/// channel for stuck.
class NoisyWire final : public BenchInVolts {
 public:
  static constexpr double kNoise_v = 0.5e-3;
  sim::BenchVolts step(double drive_v) override { return {drive_v + noise(), drive_v + noise()}; }
  void set_period(double) override {}

 private:
  double noise() {
    state_ = state_ * 1664525U + 1013904223U;
    return kNoise_v * (state_ / 2147483648.0 - 1.0);
  }
  std::uint32_t state_ = 1;
};

class Loopback : public RealImage {
 protected:
  void SetUp() override {
    RealImage::SetUp();
    if (!IsSkipped()) {
      put_on_bench(wire);
    }
  }
  NoisyWire wire;
};

// Both inputs see the drive, and the result of an input is 16 times the DAC's code: the response to
// frame n is that of frame n + latency, for each n, and of no other one.
TEST_F(Loopback, TakesTheLatencyThatIsStated) {
  boot();
  ExchangeRecord record(board->chip, function("Stm32Stream8do_start"),
                        function("Stm32Stream11do_exchange"));
  board->chip.processor().watch_with(
      [&](std::uint32_t address, std::uint32_t) { record.on_block(address); });
  ask("SENS:REF:SENS 1.02;GAIN 1;:SENS:DEV:GAIN 1;:SOUR:LEV 1;:SENS:SWE:FREQ 500,1000,2000;*OPC?");
  board->chip.console.send("INIT\n");
  ASSERT_TRUE(board->chip.run_until([&] { return driving_v() > 0.3; }, 2.0)) << ask("SYST:ERR?");
  board->chip.run_for(0.2);
  board->chip.processor().watch_with({});

  const auto is_latency = [&record](std::size_t latency) {
    for (std::size_t n = 0; n + latency < record.response.size(); ++n) {
      const double code = std::floor(record.drive[n] / 1048576.0);  // Of 12 bits.
      for (const std::int32_t response : record.response[n + latency]) {
        if (std::fabs(response / 65536.0 - 16.0 * code) > 16.0) {  // The noise, and rounding.
          return false;
        }
      }
    }
    return true;
  };
  ASSERT_GT(record.response.size(), 8000U);
  std::vector<std::size_t> found;
  for (std::size_t latency = 0; latency < 2048; ++latency) {
    if (is_latency(latency)) {
      found.push_back(latency);
    }
  }
  EXPECT_EQ(found, std::vector<std::size_t>{record.stated_latency});
  EXPECT_EQ(record.stated_latency, 513U);
}

// What the board's page asks for before a bench is connected, with the image as it is flashed: the
// latency is longer than a period of the lowest frequency.
TEST_F(Loopback, IsMeasuredByItsCommand) {
  boot();
  const std::vector<double> found = numbers(ask("DIAG:LOOP?", 10.0));
  EXPECT_EQ(ask("SYST:ERR?"), "0,\"No error\"");
  ASSERT_EQ(found.size(), 11U);
  EXPECT_NEAR(found[0], 513.0, 0.05);
  EXPECT_NEAR(found[1], 0.0, 1e-3);
  EXPECT_NEAR(found[3], 1.0, 1e-3);
  EXPECT_NEAR(found[4], 1.0, 1e-3);
  EXPECT_NEAR(found[5], 1.0, 1e-4);
  EXPECT_NEAR(found[6], 0.0, 1e-8);
  EXPECT_NEAR(found[7], NoisyWire::kNoise_v / std::sqrt(3.0), 0.1 * NoisyWire::kNoise_v);
  EXPECT_EQ(found[10], 0.0);
}

class Counts : public Loopback {
 protected:
  /// From the first character to the wait behind the answer.
  std::uint64_t of(const std::string& command) {
    ask("");
    board->chip.run_for(0.01);
    const std::uint64_t before = board->chip.processor().instructions();
    ask(command + (command.find('?') == std::string::npos ? ";*OPC?" : ""), 20.0);
    board->chip.run_for(0.001);
    return board->chip.processor().instructions() - before;
  }
  void add(const std::string& what, double count) { rows_.emplace_back(what, std::round(count)); }
  void count_sweep() {
    WorkCounter counter(board->chip, function("Stm32Stream14wait_for_block"),
                        function("Stm32Stream11do_exchange"));
    board->chip.processor().watch_with([&](std::uint32_t address, std::uint32_t instructions) {
      counter.on_block(address, instructions);
    });
    ask("INIT;*OPC?", 10.0);
    board->chip.processor().watch_with({});
    add("sweep, one frame with its drivers, in the mean", counter.per_frame());
    add("the same in the dearest block of 64", counter.per_frame_at_most());
  }
  void compare() {
    const auto recorded = table_rows(Tested::kCountsTable);
    std::string fresh;
    bool same = recorded.size() == rows_.size() + 1;  // And the head.
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto& [what, count] = rows_[i];
      fresh += "| " + what + " | " + grouped(static_cast<std::uint64_t>(count)) + " | " +
               time_of(count / (Tested::kCpu_hz / 1e6)) + " |\n";
      same = same && recorded[i + 1].first == what &&
             std::fabs(recorded[i + 1].second - count) <= 0.1 * count;
    }
    EXPECT_TRUE(same) << "the rows of \"" << Tested::kCountsTable
                      << "\" in firmware/README.md should be:\n"
                      << fresh;
  }

 private:
  std::vector<std::pair<std::string, double>> rows_;
};

// Within 10 %, as the other counts of that page: another release of the compiler may differ.
TEST_F(Counts, AreThoseOfTheTable) {
  Tested::prepare_to_count(board->chip);
  boot();
  ask("SENS:REF:SENS 1.02;GAIN 1;:SENS:DEV:GAIN 1;:SOUR:LEV 1;:SENS:SWE:FREQ 500,1000,2000;*OPC?");
  count_sweep();
  EXPECT_EQ(error(), 0);
  for (const char* const command :
       {"*IDN?", "SYST:ERR?", "SENS:SWE:FREQ?", "FETC:FRES?", "*TST?", "DIAG:CONV?", "*SAV 1",
        "CALC:MOD 1.037,4073,0.3182;:CALC:ENER?"}) {
    add("`" + std::string(command) + "`", static_cast<double>(of(command)));
  }
  const std::uint64_t before = board->chip.processor().instructions();
  board->chip.run_for(1.0);
  add("a second at rest", static_cast<double>(board->chip.processor().instructions() - before));
  compare();
}

/// A dialogue as the board's page prints it: "> " stands before what is typed, and its answer
/// follows, in one line or in several that belong together; "(" begins what is done by hand.
class Dialogue : public Loopback {
 protected:
  struct Turn {
    std::string typed;
    std::string answer;
  };
  static std::vector<Turn> turns() {
    std::ifstream file(EMAX_CHIP_BOARD_README);
    std::vector<Turn> turns;
    bool inside = false;
    for (std::string line; std::getline(file, line);) {
      inside = inside ? line != "<!-- end of dialogue -->" : line == "<!-- dialogue -->";
      if (!inside || line.empty() || line[0] == '<' || line[0] == '`') {
        continue;
      }
      if (line.rfind("> ", 0) == 0) {
        turns.push_back({line.substr(2), ""});
      } else if (line[0] == '(') {
        turns.push_back({line, ""});
      } else if (!turns.empty()) {
        turns.back().answer += line;
      }
    }
    return turns;
  }
};

/// Numbers as far as a reader looks at them; words to the letter.
bool is_alike(const std::string& answer, const std::string& printed) {
  const auto fields = [](const std::string& text) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) {
      parts.push_back(part);
    }
    return parts;
  };
  const auto is_near = [](const std::string& a, const std::string& b) {
    char* end = nullptr;
    const double number = std::strtod(b.c_str(), &end);
    const bool is_number = end != b.c_str() && *end == '\0';
    return a == b || (is_number && std::fabs(std::strtod(a.c_str(), nullptr) - number) <=
                                       1e-5 * std::fabs(number));
  };
  const std::vector<std::string> got = fields(answer), wanted = fields(printed);
  return got.size() == wanted.size() && std::equal(got.begin(), got.end(), wanted.begin(), is_near);
}

TEST_F(Dialogue, OfTheReadmeIsWhatTheBoardAnswers) {
  boot();
  std::size_t answers = 0;
  for (const Turn& turn : turns()) {
    if (turn.typed[0] == '(') {
      ASSERT_NE(turn.typed.find("unplug"), std::string::npos) << turn.typed;
      boot();
      continue;
    }
    const bool is_query = turn.typed.find('?') != std::string::npos;
    const std::string answer = ask(turn.typed, is_query ? 60.0 : 0.1);
    EXPECT_TRUE(is_alike(answer, turn.answer)) << turn.typed << "\n" << answer;
    answers += is_query ? 1 : 0;
  }
  EXPECT_GE(answers, 8U);
  EXPECT_EQ(board->chip.findings.text(), "");
}

/// The answers of the program on the PC, one for each line.
std::vector<std::string> answers_of_pc(const std::vector<std::string>& lines) {
  std::string script;
  for (const std::string& line : lines) {
    script += line + "\n";
  }
  const std::string command = "printf '" + script + "' | " EMAX_CHIP_PROGRAM " scpi";
  std::FILE* const pipe = popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> part;
  for (std::size_t count = 0; (count = std::fread(part.data(), 1, part.size(), pipe)) > 0;) {
    text.append(part.data(), count);
  }
  EXPECT_EQ(pclose(pipe), 0);
  std::vector<std::string> answers;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    answers.push_back(line);
  }
  return answers;
}

TEST_F(RealImage, AnswersHaveTheDigitsOfThePc) {
  const std::vector<std::string> lines = {"CALC:MOD 1.037,4073,0.3182,0.003,6,0.0004;*OPC?",
                                          "CALC:MOD?",
                                          "CALC:AERR?",
                                          "CALC:SETT?",
                                          "CALC:IMP? 0.00001,0.0001,0.001",
                                          "CALC:ENER:EVAL? 0.00068,0.00149",
                                          "CALC:ENER?",
                                          "CALC:ENER:ITER 3;STEP 2e-5;FPA?",
                                          "CALC:MCAR:TRI 1000;:CALC:MCAR?",
                                          "DIAG:RAND? 5",
                                          "SYST:ERR?"};
  const std::vector<std::string> expected = answers_of_pc(lines);
  ASSERT_EQ(expected.size(), lines.size());
  boot();
  std::size_t digits = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(ask(lines[i], 60.0), expected[i]) << lines[i];
    digits += expected[i].size();
  }
  EXPECT_EQ(expected.back(), "0,\"No error\"");
  EXPECT_GT(digits, 600U);
}

TEST_F(RealImage, AnIdleProgramSleepsAndIsAwakeAtOnce) {
  boot();
  ask("*IDN?");
  board->chip.run_for(0.2);
  const std::uint64_t before = board->chip.processor().instructions();
  board->chip.run_for(1.0);
  // Of 170 million cycles, or 400: ten ticks of the clock, and a look at everything after each.
  EXPECT_LT(board->chip.processor().instructions() - before, 20'000U);
  EXPECT_GT(board->chip.processor().instructions() - before, 1000U);
  // Both characters, and the answer's first one, take 87 us each.
  const double asked_s = board->chip.now_s();
  board->chip.console.send("*IDN?\n");
  ASSERT_TRUE(
      board->chip.run_until([&] { return !board->chip.console.sent().empty(); }, 1.0, 1e-5));
  EXPECT_LT(board->chip.now_s() - asked_s, 8 * 87e-6 + 1e-4);
  EXPECT_EQ(board->chip.findings.text(), "");
}

// A byte that comes between the last look at the console and the wait must not lie there until the
// next tick: at whatever moment around a tick it comes, the answer is there at once.
TEST_F(RealImage, NoByteIsSleptOver) {
  boot();
  ask("*IDN?");
  ASSERT_TRUE(board->chip.run_until([&] { return led_changes(0.01) > 0; }, 3.0));
  const std::uint64_t exceptions = board->chip.processor().exceptions();
  ASSERT_TRUE(board->chip.run_until(
      [&] { return board->chip.processor().exceptions() != exceptions; }, 0.2, 1e-7));
  const double tick_s = board->chip.now_s();
  for (int i = 1; i <= 60; ++i) {
    // So that the line feed, the last of four characters, arrives i/4 us behind a tick.
    const double arrival_s = tick_s + 0.1 * i + i * 0.25e-6 - 1e-6;
    board->chip.run_for(arrival_s - 4 * 10 / 115200.0 - board->chip.now_s());
    board->chip.console.take_sent();
    board->chip.console.send("*I?\n");
    board->chip.run_for(1e-3);
    const std::uint64_t instructions = board->chip.processor().instructions();
    board->chip.run_for(0.01);
    EXPECT_EQ(board->chip.processor().instructions(), instructions) << i;
  }
}

}  // namespace
}  // namespace emax::chip
