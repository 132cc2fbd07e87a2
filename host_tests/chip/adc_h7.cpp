#include "chip/adc_h7.hpp"

#include "chip/stm32h743_registers.hpp"

namespace emax::chip {
namespace {

constexpr std::uint32_t kCfgr = 0x0C, kCfgr2 = 0x10, kSqr1 = 0x30, kOfr1 = 0x60, kOfr4 = 0x6C;
constexpr std::uint32_t kMega = 1'000'000, kLeast_hz = 120'000;

}  // namespace

AdcFamilyH7::AdcFamilyH7() {
  converter = h743::adc_registers();
  common = h743::adc_common_registers();
  dma_request = 9;
  slave_request = 10;
  difsel = 0xC0;
  calfact = 0xC4;
  kept_control = 0x70010300;  // And BOOST, and the kind of calibration.
  regulator_start_s = 10e-6;
  calibration_cycles = 1280;
  linear_cycles = 165'010;
  preselects = true;
  wide = true;
  slave_slips = true;
  round_in_common = false;
  set_revision(Revision::kV);
}

// Revision V tells when its regulator is ready, and halves the clock.
void AdcFamilyH7::set_revision(Revision revision) {
  revision_ = revision;
  tells_regulator = revision == Revision::kV;
  clock_divider = revision == Revision::kV ? 2 : 1;
}

AdcSettings AdcFamilyH7::settings(std::uint32_t cfgr, std::uint32_t cfgr2, std::uint32_t sample,
                                  std::uint32_t) const {
  constexpr std::uint32_t kSample[] = {3, 5, 17, 33, 65, 129, 775, 1621};
  // 16, 14, 12, 10 bits, and 8 by two codes.
  constexpr unsigned kBits[] = {16, 14, 12, 10, 16, 14, 12, 8};
  AdcSettings read;
  read.bits = kBits[field(cfgr, 2, 3)];
  read.sample_half_cycles = kSample[sample];
  read.conversion_half_cycles = read.bits + 1;  // 8.5 cycles for 16 bits.
  if ((cfgr2 & 1) != 0) {
    read.ratio = field(cfgr2, 16, 10) + 1;
    read.right = field(cfgr2, 5, 4);
  }
  read.left = cfgr2 >> 28;
  read.dma = (cfgr & 1) != 0;
  read.dma_goes_round = (cfgr & 3) == 3;
  return read;
}

// BOOST says how fast the clock is: by steps of 6.25, 12.5, 25, 50 MHz, or of 20 and 36 MHz.
const char* AdcFamilyH7::clock_fault(std::uint32_t clock_hz, bool, std::uint32_t cr) const {
  const bool is_v = revision_ == Revision::kV;
  if (clock_hz > (is_v ? 50 : 36) * kMega) {
    return "adc_too_fast";
  }
  if (clock_hz < kLeast_hz) {
    return "adc_too_slow";
  }
  const std::uint32_t boost = is_v ? field(cr, 8, 2) : field(cr, 8, 1);
  const std::uint32_t most_hz = is_v ? 6'250'000U << boost : (boost == 0 ? 20 : 36) * kMega;
  return clock_hz > most_hz ? "adc_boost" : nullptr;
}

bool AdcFamilyH7::is_not_modelled(std::uint32_t offset, std::uint32_t value) const {
  const bool offset_on = offset >= kOfr1 && offset <= kOfr4 && (value & 0x03FFFFFF) != 0;
  const bool sequence = offset == kSqr1 && (value & 0xF) != 0;
  const bool continuous = offset == kCfgr && (value & 0x03016000) != 0;
  const bool filter = offset == kCfgr && (value & 3) == 2;  // To DFSDM.
  const bool by_trigger = offset == kCfgr2 && (value & 0x00007E02) != 0;
  return offset_on || sequence || continuous || filter || by_trigger;
}

}  // namespace emax::chip
