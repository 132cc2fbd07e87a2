// The converters of the STM32G4: 12 bits, sums of powers of two.
#pragma once

#include "chip/adc.hpp"

namespace emax::chip {

class AdcFamilyG4 final : public AdcFamily {
 public:
  AdcFamilyG4();
  AdcSettings settings(std::uint32_t cfgr, std::uint32_t cfgr2, std::uint32_t sample,
                       std::uint32_t smpr1) const override;
  const char* clock_fault(std::uint32_t clock_hz, bool pair, std::uint32_t cr) const override;
  bool is_not_modelled(std::uint32_t offset, std::uint32_t value) const override;
};

}  // namespace emax::chip
