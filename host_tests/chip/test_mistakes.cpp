// Each wrong use in images/mistakes.cpp and images/h743_mistakes.cpp is found, and nothing else is.
#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include "chip/images/h743_mistakes.hpp"
#include "chip/images/mistakes.hpp"
#include "chip/virtual_board.hpp"

namespace emax::chip {
namespace {

#define EMAX_ROW(name) #name,
const char* const kMistakes[] = {EMAX_CHIP_MISTAKES(EMAX_ROW)};
const char* const kH743Mistakes[] = {EMAX_H743_MISTAKES(EMAX_ROW)};

using Exceptions = std::map<std::string, std::set<std::string>>;

/// What is found where that is not only the one finding of the same name: a converter whose data
/// nobody takes overruns.
const Exceptions kFindings = {
    {"nothing", {}},
    {"dac_by_half_words", {"wrong_width"}},
    {"adc_dma_one_shot", {"adc_dma_one_shot", "adc_overrun"}},
    {"dma_not_circular", {"dma_not_circular", "adc_overrun"}},
    {"dma_no_request_chosen", {"dma_no_request_chosen", "adc_overrun"}},
    {"dma_nothing_to_transfer", {"dma_nothing_to_transfer", "adc_overrun", "dac_underrun"}},
    {"dma_unreachable", {"dma_unreachable", "adc_overrun"}},
    {"flash_old_error_flags", {"flash_old_error_flags", "flash_not_programming"}},
};
const Exceptions kH743Findings = {
    {"nothing", {}},
    {"cached_with_protection", {}},
    // At scale 3 the flash memory is slower, too.
    {"too_fast_for_voltage", {"too_fast_for_voltage", "too_few_wait_states"}},
    {"dma_memory_without_clock", {"memory_clock_off", "adc_overrun", "dac_underrun"}},
    // Two samples in one word: the upper half is no part of the register.
    {"dma_packs", {"dma_packs", "reserved_bit_written"}},
    {"dma_burst_and_threshold", {"dma_burst_and_threshold", "adc_overrun"}},
    {"dma_unreachable", {"dma_unreachable", "adc_overrun"}},
    {"dma_not_circular", {"dma_not_circular", "adc_overrun"}},
    {"dma_no_request_chosen", {"dma_no_request_chosen", "adc_overrun"}},
    {"adc_dma_one_shot", {"adc_dma_one_shot", "adc_overrun"}},
    {"dac_by_half_words", {"wrong_width"}},
    {"flash_old_error_flags", {"flash_old_error_flags", "flash_not_programming"}},
};

std::set<std::string> expected_findings(const Exceptions& exceptions, const std::string& name) {
  const auto found = exceptions.find(name);
  return found != exceptions.end() ? found->second : std::set<std::string>{name};
}

template <typename Board>
std::set<std::string> found_by(Board& board, std::uint32_t number, double time_s) {
  std::memcpy(board.chip.flash.bytes() + (board.chip.symbol("chosen") - kFlashBase), &number, 4);
  board.chip.power_on();
  board.chip.run_for(time_s);
  std::set<std::string> found;
  for (const Finding& finding : board.chip.findings.all()) {
    found.insert(finding.what);
  }
  return found;
}

class Mistakes : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Mistakes, IsFoundAndNothingElseIs) {
  Wire wire;
  VirtualBoard board(EMAX_CHIP_IMAGES "/mistakes.elf", wire);
  EXPECT_EQ(found_by(board, GetParam(), 0.05), expected_findings(kFindings, kMistakes[GetParam()]))
      << board.chip.findings.text();
}

INSTANTIATE_TEST_SUITE_P(Chip, Mistakes,
                         testing::Range(0U, static_cast<std::uint32_t>(std::size(kMistakes))),
                         [](const auto& number) { return std::string(kMistakes[number.param]); });

class H743Mistakes : public testing::TestWithParam<std::uint32_t> {};

TEST_P(H743Mistakes, IsFoundAndNothingElseIs) {
  Wire wire;
  VirtualH743 board(EMAX_CHIP_IMAGES "/h743_mistakes.elf", wire);
  board.chip.adc.family().linear_cycles = 2000;  // The time of it is not what is tested here.
  EXPECT_EQ(found_by(board, GetParam(), 0.01),
            expected_findings(kH743Findings, kH743Mistakes[GetParam()]))
      << board.chip.findings.text();
}

INSTANTIATE_TEST_SUITE_P(Chip, H743Mistakes,
                         testing::Range(0U, static_cast<std::uint32_t>(std::size(kH743Mistakes))),
                         [](const auto& number) {
                           return std::string(kH743Mistakes[number.param]);
                         });

}  // namespace
}  // namespace emax::chip
