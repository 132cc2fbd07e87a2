// Power control: the voltage range and its boost.
#pragma once

#include "chip/clocks.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

class PwrG4 final : public RegisterBlock {
 public:
  PwrG4(Context context, Clocks& clocks);

 private:
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;
  void update();

  Clocks& clocks_;
};

}  // namespace emax::chip
