#include "chip/adc_g4.hpp"

#include "chip/stm32g474_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCfgr = 0x0C, kCfgr2 = 0x10, kSqr1 = 0x30, kOfr1 = 0x60, kOfr4 = 0x6C;
constexpr std::uint32_t kMostAlone_hz = 60'000'000, kMostTogether_hz = 52'000'000;
constexpr std::uint32_t kLeast_hz = 140'000;

}  // namespace

AdcFamilyG4::AdcFamilyG4() {
  converter = g474::adc_registers();
  common = g474::adc_common_registers();
  dma_request = 5;
  slave_request = 36;
  difsel = 0xB0;
  calfact = 0xB4;
  first_result_is_wrong = true;
}

AdcSettings AdcFamilyG4::settings(std::uint32_t cfgr, std::uint32_t cfgr2, std::uint32_t sample,
                                  std::uint32_t smpr1) const {
  constexpr std::uint32_t kSample[] = {5, 13, 25, 49, 95, 185, 495, 1281};
  constexpr std::uint32_t kConversion[] = {25, 21, 17, 13};
  const unsigned resolution = field(cfgr, 3, 2);
  AdcSettings read;
  // SMPPLUS makes 3.5 cycles of 2.5.
  read.sample_half_cycles = kSample[sample] + (sample == 0 ? smpr1 >> 31 << 1 : 0);
  read.conversion_half_cycles = kConversion[resolution];
  read.bits = 12 - 2 * resolution;
  if ((cfgr2 & 1) != 0) {
    read.ratio = 2U << field(cfgr2, 2, 3);
    read.right = field(cfgr2, 5, 4);
  } else if ((cfgr >> 15 & 1) != 0) {
    read.left = 16 - read.bits;
  }
  read.dma = (cfgr & 1) != 0;
  read.dma_goes_round = (cfgr & 2) != 0;
  return read;
}

const char* AdcFamilyG4::clock_fault(std::uint32_t clock_hz, bool pair, std::uint32_t) const {
  return clock_hz > (pair ? kMostTogether_hz : kMostAlone_hz) ? "adc_too_fast"
         : clock_hz < kLeast_hz                               ? "adc_too_slow"
                                                              : nullptr;
}

bool AdcFamilyG4::is_not_modelled(std::uint32_t offset, std::uint32_t value) const {
  const bool offset_on = offset >= kOfr1 && offset <= kOfr4 && value >> 31 != 0;
  const bool sequence = offset == kSqr1 && (value & 0xF) != 0;
  const bool continuous = offset == kCfgr && (value & 0x03016000) != 0;
  const bool by_trigger = offset == kCfgr2 && (value & 0x0E010602) != 0;
  return offset_on || sequence || continuous || by_trigger;
}

}  // namespace emax::chip
