// The STM32H743 as a NUCLEO-H743ZI2 carries it: peripherals, memories with their clocks, wiring.
#pragma once

#include <memory>
#include <vector>

#include "chip/adc_h7.hpp"
#include "chip/dac.hpp"
#include "chip/dma_streams.hpp"
#include "chip/flash_h7.hpp"
#include "chip/gpio.hpp"
#include "chip/iwdg.hpp"
#include "chip/pwr_h7.hpp"
#include "chip/rcc_h7.hpp"
#include "chip/stm32.hpp"
#include "chip/timer.hpp"

namespace emax::chip {

/// Found here, beside what the parts find: "memory_clock_off", "dma_cacheable_memory".
class Stm32h743 final : public Stm32 {
 public:
  explicit Stm32h743(Pins& pins);

  /// Of the silicon; V if nobody says so.
  void set_revision(Revision revision);

  RccH7 rcc;
  PwrH7 pwr;
  FlashH7 flash;
  std::vector<std::unique_ptr<Gpio>> ports;  ///< A to K.
  Timer tim2, tim6, tim7;
  Uart console;
  Iwdg watchdog;
  Dmamux dmamux;
  DmaStreams dma1, dma2;
  DmaRequests requests;

 private:
  AdcFamilyH7 family_;

 public:
  AdcPair adc;
  Dac dac;

 private:
  class Syscfg final : public RegisterBlock {
   public:
    Syscfg(Context context, Stm32h743& chip);

   private:
    void on_write(std::uint32_t offset, std::uint32_t value) override;
    Stm32h743& chip_;
  };
  class Dbgmcu final : public RegisterBlock {
   public:
    explicit Dbgmcu(Context context);
    std::uint32_t id_code;

   private:
    std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  };
  struct Ram {
    const char* name;
    std::uint32_t base;
    std::vector<std::uint8_t> bytes;
    bool by_dma;
    int clock_bit;  ///< Of AHB2ENR; below zero: always on.
    Gate gate;
  };

  Rcc& reset_control() override { return rcc; }
  Flash& program_memory() override { return flash; }
  Uart& line() override { return console; }
  std::uint32_t read(std::uint32_t address, unsigned bytes) override;
  void write(std::uint32_t address, unsigned bytes, std::uint32_t value) override;
  std::uint8_t* dma_memory(std::uint32_t address, std::uint32_t bytes) override;
  const char* dma_objection(std::uint32_t address, std::uint32_t bytes) override;
  void power_lost() override { pwr.forget_supply(); }

  /// The bytes of a memory with a clock; null and a finding while that is off.
  std::uint8_t* clocked(const Memory& memory, std::uint32_t address, bool writes);
  void wire();
  void map();
  void attach_clocks();
  void show_memories();

  Pins& pins_;
  Revision revision_ = Revision::kV;
  Syscfg syscfg_;
  Plain exti_;
  Dbgmcu dbgmcu_;
  std::vector<Ram> rams_;
};

}  // namespace emax::chip
