// What the chips have in common: processor, memories, places of peripherals, power, resets, and the
// hooks of a test.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "chip/clocks.hpp"
#include "chip/dma.hpp"
#include "chip/elf.hpp"
#include "chip/events.hpp"
#include "chip/findings.hpp"
#include "chip/flash.hpp"
#include "chip/processor.hpp"
#include "chip/rcc.hpp"
#include "chip/register_block.hpp"
#include "chip/uart.hpp"

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
class Stm32 : private Bus, protected DmaBus {
 public:
  Stm32(const Stm32&) = delete;
  Stm32& operator=(const Stm32&) = delete;
  virtual ~Stm32() = default;

  /// Puts a program into flash, as a probe does. The power is off afterwards.
  void load(const Elf& elf);
  /// Switches on: RAM has no meaning, reset by power.
  void power_on();
  /// The button, or a probe.
  void reset_pin() { restart(reset_control().cause_bits().pin, false); }

  Halt run_for(double time_s);
  /// Runs until this holds, looking every so often. @returns False when the time is over, the
  /// processor has locked up or the power has failed.
  bool run_until(const std::function<bool()>& condition, double most_s, double look_every_s = 1e-4);
  /// Until this text has been sent. What has been sent stays in `console.sent()`.
  bool run_until_text(const std::string& text, double most_s);

  double now_s() const { return seconds(events.now()); }
  bool power_failed() const { return power_failed_; }
  unsigned resets() const { return resets_; }
  bool was_reset_by_watchdog() {
    const std::uint32_t bits = reset_control().cause_bits().watchdog;
    return (reset_control().causes() & bits) == bits;
  }
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
  Processor& processor() { return processor_; }

  Events events;
  Findings findings;

 protected:
  /// Registers that only keep what is written.
  class Plain final : public RegisterBlock {
   public:
    using RegisterBlock::RegisterBlock;
  };
  struct Memory {
    std::string name;
    std::uint32_t base;
    std::uint32_t bytes;
    std::uint8_t* data;
    bool by_dma;  ///< Reached by the controllers.
    Gate* gate;   ///< Its clock; null: always on.
  };
  struct Constants {
    std::uint32_t unique_id, flash_size;
  };

  Stm32(Core core, std::uint32_t start_hz, Clocks::Rule rule, std::uint32_t bank_bytes,
        const Constants& constants);
  virtual Rcc& reset_control() = 0;
  virtual Flash& program_memory() = 0;
  virtual Uart& line() = 0;

  std::uint32_t read(std::uint32_t address, unsigned bytes) override;
  void write(std::uint32_t address, unsigned bytes, std::uint32_t value) override;
  std::uint8_t* memory(std::uint32_t address, std::size_t bytes) override;
  std::uint8_t* dma_memory(std::uint32_t address, std::uint32_t bytes) override;
  const char* dma_objection(std::uint32_t, std::uint32_t) override { return nullptr; }
  bool is_register(std::uint32_t address) override { return block_at(address) != nullptr; }
  /// Before the blocks are reset for a start with new power.
  virtual void power_lost() {}

  void place(std::uint32_t base, std::uint32_t bytes, RegisterBlock& block);
  void place_memory(const Memory& memory) { memories_.push_back(memory); }
  /// Flash at its address: the first bank for the program to run from, the second behind its rules.
  void map_flash();
  const Memory* memory_at(std::uint32_t address, std::size_t bytes) const;
  RegisterBlock* block_at(std::uint32_t address, std::uint32_t* offset = nullptr);
  void restart_for(std::uint32_t cause);
  void fail_power();

  Processor processor_;
  Wires wires_;
  Context context_;

 public:
  Clocks clocks;

 protected:
  std::vector<Memory> memories_;
  /// Blocks that only power resets.
  std::vector<const RegisterBlock*> lasting_;

 private:
  void restart(std::uint32_t cause, bool power_lost);
  bool read_constant(std::uint32_t address, unsigned bytes, std::uint32_t& value);
  bool is_second_bank(std::uint32_t address);

  struct Place {
    std::uint32_t base;
    std::uint32_t bytes;
    RegisterBlock* block;
  };

  Constants constants_;
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
