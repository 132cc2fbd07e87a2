// A Cortex-M with its interrupts, its system control space and its time, around the engine.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "chip/engine.hpp"
#include "chip/events.hpp"
#include "chip/findings.hpp"
#include "chip/nvic.hpp"
#include "chip/system_space.hpp"

namespace emax::chip {

/// Why run() came back.
enum class Halt {
  kTime,    ///< The time asked for has passed.
  kAsked,   ///< Somebody called halt().
  kLockup,  ///< A fault in the handler of a fault; only a reset helps.
  kBreak,   ///< A BKPT instruction.
  kAsleep,  ///< Sleeps, and nothing is due that could wake it, ever.
};

/// Peripherals, as the processor sees them.
class Bus {
 public:
  virtual std::uint32_t read(std::uint32_t address, unsigned bytes) = 0;
  virtual void write(std::uint32_t address, unsigned bytes, std::uint32_t value) = 0;
  /// Memory for stack frames and vectors. @returns Null where there is none.
  virtual std::uint8_t* memory(std::uint32_t address, std::size_t bytes) = 0;

 protected:
  ~Bus() = default;
};

/// Runs programs. Interrupts are taken between blocks of instructions, each instruction counts as
/// one cycle.
class Processor final : private EngineClient {
 public:
  /// @param[in] flash_bytes From 0x08000000 on, where programs run.
  Processor(Core core, std::uint32_t flash_bytes, Bus& bus, Events& events, Findings& findings);

  Engine& engine() { return engine_; }
  Nvic& nvic() { return nvic_; }
  SystemSpace& system() { return system_; }

  /// From the vectors at this address, as after any reset; time goes on.
  void reset(std::uint32_t vectors);
  /// How long a cycle is.
  void set_cycle(Time cycle) { cycle_ = cycle; }
  Halt run(Time until);
  /// Ends run() before the next block.
  void halt() { halt_ = true; }
  /// An access to data ends in an error of the bus, which is taken behind this block, or ignored by
  /// a handler that says so (CCR.BFHFNMIGN).
  void fail_access(std::uint32_t address);
  /// Does this between two blocks, before the next one runs.
  void between_blocks(std::function<void()> action) { between_ = std::move(action); }
  /// Lets time pass in which the processor does nothing, as while a bus keeps it waiting.
  void stall(Time delay);

  /// Tells a test of each block of instructions, before it runs: address and number of them.
  void watch_with(std::function<void(std::uint32_t, std::uint32_t)> watcher) {
    watcher_ = std::move(watcher);
  }

  std::uint32_t block() const { return block_; }
  std::uint64_t instructions() const { return instructions_; }
  std::uint64_t exceptions() const { return exceptions_; }
  /// Counts cycles while awake, as DWT_CYCCNT does.
  std::uint64_t cycles() const { return cycles_; }

 private:
  bool on_block(std::uint32_t address, std::uint32_t bytes) override;
  std::uint32_t read_register(std::uint32_t address, unsigned bytes) override;
  void write_register(std::uint32_t address, unsigned bytes, std::uint32_t value) override;

  ExceptionMasks masks() const;
  std::uint32_t count(std::uint32_t address, std::uint32_t bytes);
  bool must_stop();
  bool is_endless(std::uint32_t address);
  void spin();
  Halt sleep(Time until);
  void take_pending();
  void enter(unsigned exception);
  void leave(std::uint32_t exception_return);
  void on_stop(EngineStop why);
  void on_exception(std::uint32_t number);
  void fault(unsigned exception);
  void watch_floating_point();
  std::uint32_t load(std::uint32_t address);
  void store(std::uint32_t address, std::uint32_t value);

  const std::uint32_t flash_bytes_;
  Bus& bus_;
  Events& events_;
  Findings& findings_;
  Engine engine_;
  Nvic nvic_;
  SystemSpace system_;
  std::function<void(std::uint32_t, std::uint32_t)> watcher_;
  std::vector<std::uint8_t> counts_;  ///< Instructions of the block at each even address of flash.
  Time cycle_ = 1;
  Time until_ = 0;
  std::uint64_t instructions_ = 0;
  std::uint64_t exceptions_ = 0;
  std::uint64_t cycles_ = 0;
  std::uint32_t block_ = 0;
  std::uint32_t pc_ = 0;
  bool halt_ = false;
  bool asleep_ = false;
  bool event_ = false;
  bool locked_up_ = false;
  bool broke_ = false;
  std::function<void()> between_;
  bool access_failed_ = false;
  std::uint32_t failed_address_ = 0;
  unsigned last_left_ = 0;  ///< The exception left since which no other code has run.
  unsigned again_ = 0;
};

}  // namespace emax::chip
