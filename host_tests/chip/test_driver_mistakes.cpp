// The image to be flashed with one deliberate mistake in a driver: each is found.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <regex>
#include <string>
#include <utility>

#include "chip/tested_board.hpp"

namespace emax::chip {
namespace {

namespace fs = std::filesystem;

const char* const kPatches[] = {EMAX_CHIP_PATCHES};
const fs::path kFolder = EMAX_CHIP_PATCH_FOLDER;
/// More than enough for each: a boot, the first turn of the rings, a save.
constexpr double kMost_s = 0.5;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What stands before the difference.
struct Mistake {
  std::string words;
  std::string shown_by;
  std::string finding;
  std::string source;
};

Mistake read_mistake(const std::string& name) {
  const std::string text = text_of(kFolder / (name + ".patch"));
  const std::regex form(
      R"((.*)\nShown by: (boot|sweep|save|overrun)\nFinding: (\w+)\n(?:Compiled in: .*\n)?--- a/(.*)\n)");
  std::smatch parts;
  EXPECT_TRUE(std::regex_search(text, parts, form, std::regex_constants::match_continuous)) << name;
  return parts.empty() ? Mistake{} : Mistake{parts[1], parts[2], parts[3], parts[4]};
}

/// What the program says, and its exit status. Both streams.
std::pair<int, std::string> output_of(const std::string& command) {
  std::string text;
  std::FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> part;
  for (std::size_t count = 0; (count = std::fread(part.data(), 1, part.size(), pipe)) > 0;) {
    text.append(part.data(), count);
  }
  return {pclose(pipe), text};
}

std::pair<int, std::string> build(const fs::path& patch, const fs::path& image) {
  return output_of(EMAX_CHIP_PATCHER " '" + patch.string() + "' '" EMAX_CHIP_TREE "' '" +
                   image.string() + "'");
}

void overrun(Tested::Chip& chip) {
  chip.processor().nvic().enable(interrupt(Tested::kConsoleInterrupt), false);
  chip.console.send("*IDN?*IDN?*IDN?*IDN?");  // More than 16 bytes, the largest FIFO.
  chip.run_for(0.01);
  chip.processor().nvic().enable(interrupt(Tested::kConsoleInterrupt), true);
}

/// Boots and does what shows the mistake, until the finding is there.
std::string findings_of(const fs::path& image, const Mistake& mistake) {
  // A sweep comes after a self test, so that the converters start a second time.
  static const std::map<std::string, std::string> kCommands = {
      {"boot", "*IDN?\n"}, {"overrun", ""}, {"save", "*SAV 1\n"}, {"sweep", "*TST?\nINIT\n"}};
  Wire wire;
  TestedBoard board(image.string(), wire);
  Tested::prepare(board.chip);
  const auto found = [&] { return board.chip.findings.has(mistake.finding); };
  board.chip.power_on();
  if (!board.chip.run_until(found, 0.02)) {
    if (mistake.shown_by == "overrun") {
      overrun(board.chip);
    }
    board.chip.console.send(kCommands.at(mistake.shown_by));
    board.chip.run_until(found, mistake.finding.empty() ? 0.1 : kMost_s);
  }
  return board.chip.findings.text();
}

class DriverMistakes : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!fs::exists(EMAX_CHIP_IMAGE)) {
      GTEST_SKIP() << "no " EMAX_CHIP_IMAGE "; build it: cmake --workflow --preset "
                   << Tested::kPreset;
    }
  }
};

TEST_P(DriverMistakes, AreFound) {
  const Mistake mistake = read_mistake(GetParam());
  const fs::path image = fs::path(EMAX_CHIP_IMAGES) / (std::string(GetParam()) + ".elf");
  const auto [status, words] = build(kFolder / (std::string(GetParam()) + ".patch"), image);
  ASSERT_EQ(status, 0) << words;
  const std::string findings = findings_of(image, mistake);
  EXPECT_EQ(findings.find(mistake.finding + " "), findings.find(mistake.finding)) << findings;
  EXPECT_NE(findings.find(mistake.finding), std::string::npos) << mistake.words << "\n" << findings;
}

INSTANTIATE_TEST_SUITE_P(Chip, DriverMistakes, testing::ValuesIn(kPatches),
                         [](const auto& patch) { return std::string(patch.param); });

class DriverWithoutMistake : public DriverMistakes {};

// The same work with the drivers as they are: what is found above comes of the mistakes.
TEST_P(DriverWithoutMistake, GivesNoFinding) {
  EXPECT_EQ(findings_of(EMAX_CHIP_IMAGE, {"", GetParam(), "", ""}), "");
}

INSTANTIATE_TEST_SUITE_P(Chip, DriverWithoutMistake,
                         testing::Values("boot", "overrun", "save", "sweep"),
                         [](const auto& work) { return std::string(work.param); });

TEST(DriverMistakePatch, ThatNoLongerAppliesSaysSo) {
  const fs::path patch = fs::path(EMAX_CHIP_IMAGES) / "outdated.patch";
  std::ofstream(patch)
      << "--- a/firmware/boards/common/main.cpp\n+++ b/firmware/boards/common/main.cpp\n"
         "@@ -1 +1 @@\n-a line that is not there\n+another one\n";
  const auto [status, words] = build(patch, fs::path(EMAX_CHIP_IMAGES) / "outdated.elf");
  EXPECT_NE(status, 0);
  EXPECT_NE(words.find("does not apply any more: firmware/boards/common/main.cpp has these lines 0 "
                       "times, not once.\na line that is not there\n"),
            std::string::npos)
      << words;
}

TEST(DriverMistakePatch, IsListedInTheReadme) {
  std::string rows;
  for (const char* const name : kPatches) {
    const Mistake mistake = read_mistake(name);
    rows += "| `" + std::string(name) + "` | `" + fs::path(mistake.source).filename().string() +
            "` | " + mistake.words + " | `" + mistake.finding + "` |\n";
  }
  EXPECT_GE(std::size(kPatches), Tested::kLeastMistakes);
  EXPECT_NE(text_of(kFolder.parent_path() / "README.md").find("\n" + rows + "\n"),
            std::string::npos)
      << "the table in host_tests/chip/README.md should have these rows:\n"
      << rows;
}

}  // namespace
}  // namespace emax::chip
