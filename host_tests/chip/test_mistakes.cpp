// Each wrong use in images/mistakes.cpp is found, and nothing else is.
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <string>

#include "chip/images/mistakes.hpp"
#include "chip/virtual_board.hpp"

namespace emax::chip {
namespace {

#define EMAX_ROW(name) #name,
const char* const kMistakes[] = {EMAX_CHIP_MISTAKES(EMAX_ROW)};

/// What is found where that is not only the one finding of the same name: a converter whose data
/// nobody takes overruns.
const std::map<std::string, std::set<std::string>> kFindings = {
    {"nothing", {}},
    {"dac_by_half_words", {"wrong_width"}},
    {"adc_dma_one_shot", {"adc_dma_one_shot", "adc_overrun"}},
    {"dma_not_circular", {"dma_not_circular", "adc_overrun"}},
    {"dma_no_request_chosen", {"dma_no_request_chosen", "adc_overrun"}},
    {"dma_nothing_to_transfer", {"dma_nothing_to_transfer", "adc_overrun", "dac_underrun"}},
    {"dma_unreachable", {"dma_unreachable", "adc_overrun"}},
    {"flash_old_error_flags", {"flash_old_error_flags", "flash_not_programming"}},
};

std::set<std::string> expected_findings(const std::string& name) {
  const auto found = kFindings.find(name);
  return found != kFindings.end() ? found->second : std::set<std::string>{name};
}

class Mistakes : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Mistakes, IsFoundAndNothingElseIs) {
  Wire wire;
  VirtualBoard board(EMAX_CHIP_IMAGES "/mistakes.elf", wire);
  const std::uint32_t number = GetParam();
  std::memcpy(board.chip.flash.bytes() + (board.chip.symbol("chosen") - kFlashBase), &number, 4);
  board.chip.power_on();
  board.chip.run_for(0.05);

  std::set<std::string> found;
  for (const Finding& finding : board.chip.findings.all()) {
    found.insert(finding.what);
  }
  EXPECT_EQ(found, expected_findings(kMistakes[number])) << board.chip.findings.text();
}

INSTANTIATE_TEST_SUITE_P(Chip, Mistakes,
                         testing::Range(0U, static_cast<std::uint32_t>(sizeof kMistakes /
                                                                       sizeof kMistakes[0])),
                         [](const auto& number) { return std::string(kMistakes[number.param]); });

}  // namespace
}  // namespace emax::chip
