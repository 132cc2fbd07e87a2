// ADC1 and ADC2 of the STM32H743: 16 bits, sums of any number, linear calibration, preselection.
#pragma once

#include "chip/adc.hpp"
#include "chip/rcc_h7.hpp"

namespace emax::chip {

class AdcFamilyH7 final : public AdcFamily {
 public:
  AdcFamilyH7();
  void set_revision(Revision revision);
  AdcSettings settings(std::uint32_t cfgr, std::uint32_t cfgr2, std::uint32_t sample,
                       std::uint32_t smpr1) const override;
  const char* clock_fault(std::uint32_t clock_hz, bool pair, std::uint32_t cr) const override;
  bool is_not_modelled(std::uint32_t offset, std::uint32_t value) const override;

 private:
  Revision revision_ = Revision::kV;
};

}  // namespace emax::chip
