// The STM32G474 as a NUCLEO-G474RE carries it: processor, memories, peripherals, wiring.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "chip/adc.hpp"
#include "chip/clocks.hpp"
#include "chip/dac.hpp"
#include "chip/dma.hpp"
#include "chip/elf.hpp"
#include "chip/events.hpp"
#include "chip/findings.hpp"
#include "chip/flash.hpp"
#include "chip/gpio.hpp"
#include "chip/iwdg.hpp"
#include "chip/lpuart.hpp"
#include "chip/processor.hpp"
#include "chip/pwr.hpp"
#include "chip/rcc.hpp"
#include "chip/register_block.hpp"
#include "chip/timer.hpp"

namespace emax::chip {

/// The analog world at the pins.
class Pins {
 public:
  /// The drive pin has changed; not a number when the converter's output is off.
  virtual void drive(Time at, double pin_v) = 0;
  /// The trigger of both converters, after the drive pin has changed.
  virtual void trigger(Time at, double period_s) = 0;
  virtual double reference_pin_v() = 0;
  virtual double device_pin_v() = 0;

 protected:
  ~Pins() = default;
};

/// Found here, beside what the parts find:
/// "not_modelled" for peripherals that are there but not in this model.
class Stm32g474 final : private Bus, private DmaBus {
 public:
  static constexpr std::uint32_t kRamBase = 0x20000000;
  static constexpr std::uint32_t kRamBytes = 0x20000;

  explicit Stm32g474(Pins& pins);

  /// Puts a program into flash, as a probe does. The power is off afterwards.
  void load(const Elf& elf);
  /// Switches on: RAM has no meaning, reset by power.
  void power_on();
  /// The button, or a probe.
  void reset_pin() { restart(kPinReset, false); }

  Halt run_for(double time_s);
  /// Runs until this holds, looking every so often. @returns False when the time is over, the
  /// processor has locked up or the power has failed.
  bool run_until(const std::function<bool()>& condition, double most_s, double look_every_s = 1e-4);
  /// Until this text has been sent. What has been sent stays in `console.sent()`.
  bool run_until_text(const std::string& text, double most_s);

  double now_s() const { return seconds(events.now()); }
  bool power_failed() const { return power_failed_; }
  unsigned resets() const { return resets_; }
  Halt last_halt() const { return last_halt_; }

  std::uint32_t ram_word(std::uint32_t address);
  /// A variable of the program, by its name in the file. @throws std::out_of_range
  std::uint32_t symbol(const std::string& name) const { return symbols_.at(name); }
  std::uint32_t word_at(const std::string& name) { return ram_word(symbol(name)); }
  /// The block with this name, such as "DMA1". @throws std::out_of_range
  RegisterBlock& block(const std::string& name) { return *by_name_.at(name); }
  /// A test's hand on a flag: "RCC", "CR", bits, and what they read. Stays through resets.
  void hold(const std::string& name, const std::string& register_name, std::uint32_t bits,
            std::uint32_t value) {
    block(name).hold(register_name, bits, value);
  }
  void set_unique_id(const std::array<std::uint32_t, 3>& id) { unique_id_ = id; }

  Events events;
  Findings findings;

 private:
  Processor processor_;
  Wires wires_;
  Context context_;

 public:
  Clocks clocks;
  Rcc rcc;
  Pwr pwr;
  Flash flash;
  std::vector<std::unique_ptr<Gpio>> ports;  ///< A to G.
  Timer tim2, tim6, tim7;
  Lpuart console;
  Iwdg watchdog;
  Dmamux dmamux;
  Dma dma1, dma2;
  DmaRequests requests;
  AdcPair adc;
  Dac dac;
  Processor& processor() { return processor_; }

 private:
  /// Registers that only keep what is written.
  class Plain final : public RegisterBlock {
   public:
    using RegisterBlock::RegisterBlock;
  };

  std::uint32_t read(std::uint32_t address, unsigned bytes) override;
  void write(std::uint32_t address, unsigned bytes, std::uint32_t value) override;
  std::uint8_t* memory(std::uint32_t address, std::size_t bytes) override;
  std::uint8_t* dma_memory(std::uint32_t address, std::uint32_t bytes) override;
  bool is_register(std::uint32_t address) override { return block_at(address) != nullptr; }

  void wire();
  void map();
  void place(std::uint32_t base, std::uint32_t bytes, RegisterBlock& block);
  void attach_clocks();
  RegisterBlock* block_at(std::uint32_t address, std::uint32_t* offset = nullptr);
  bool read_constant(std::uint32_t address, unsigned bytes, std::uint32_t& value) const;
  void restart(std::uint32_t cause, bool power_lost);

  struct Place {
    std::uint32_t base;
    std::uint32_t bytes;
    RegisterBlock* block;
  };

  Pins& pins_;
  Plain syscfg_, exti_, dbgmcu_;
  std::vector<std::uint8_t> ram_;
  std::vector<Place> places_;
  std::map<std::string, RegisterBlock*> by_name_;
  std::map<std::string, std::uint32_t> symbols_;
  std::array<std::uint32_t, 3> unique_id_ = {0x00320047, 0x5130500A, 0x20383957};
  bool restart_asked_ = false;
  std::uint32_t restart_cause_ = 0;
  bool power_failed_ = false;
  unsigned resets_ = 0;
  Halt last_halt_ = Halt::kTime;
};

}  // namespace emax::chip
