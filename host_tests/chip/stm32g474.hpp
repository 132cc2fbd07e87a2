// The STM32G474 as a NUCLEO-G474RE carries it: peripherals, memories, wiring.
#pragma once

#include <memory>
#include <vector>

#include "chip/adc_g4.hpp"
#include "chip/dac.hpp"
#include "chip/dma_channels.hpp"
#include "chip/flash_g4.hpp"
#include "chip/gpio.hpp"
#include "chip/iwdg.hpp"
#include "chip/pwr_g4.hpp"
#include "chip/rcc_g4.hpp"
#include "chip/stm32.hpp"
#include "chip/timer.hpp"

namespace emax::chip {

class Stm32g474 final : public Stm32 {
 public:
  static constexpr std::uint32_t kRamBase = 0x20000000;
  static constexpr std::uint32_t kRamBytes = 0x20000;

  explicit Stm32g474(Pins& pins);

  RccG4 rcc;
  PwrG4 pwr;
  FlashG4 flash;
  std::vector<std::unique_ptr<Gpio>> ports;  ///< A to G.
  Timer tim2, tim6, tim7;
  Uart console;
  Iwdg watchdog;
  Dmamux dmamux;
  DmaChannels dma1, dma2;
  DmaRequests requests;

 private:
  AdcFamilyG4 family_;

 public:
  AdcPair adc;
  Dac dac;

 private:
  Rcc& reset_control() override { return rcc; }
  Flash& program_memory() override { return flash; }
  Uart& line() override { return console; }
  void wire();
  void map();
  void attach_clocks();

  Pins& pins_;
  Plain syscfg_, exti_, dbgmcu_;
  std::vector<std::uint8_t> ram_;
};

}  // namespace emax::chip
