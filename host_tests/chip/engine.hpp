// The emulator of the processor's instructions, libunicorn, behind a few functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <unicorn/unicorn.h>
#include <vector>

namespace emax::chip {

/// Memory is protected in units of this many bytes.
inline constexpr std::uint32_t kGranule = 4096;

/// What the engine tells while it runs.
class EngineClient {
 public:
  /// Before a block of instructions. @returns False to stop in front of it.
  virtual bool on_block(std::uint32_t address, std::uint32_t bytes) = 0;
  virtual std::uint32_t read_register(std::uint32_t address, unsigned bytes) = 0;
  virtual void write_register(std::uint32_t address, unsigned bytes, std::uint32_t value) = 0;

 protected:
  ~EngineClient() = default;
};

enum class Core { kCortexM4, kCortexM7 };

/// Why the engine stands.
enum class EngineStop {
  kBlock,      ///< on_block() answered false.
  kSleep,      ///< Behind a WFI.
  kException,  ///< SVC, BKPT, return from an exception, undefined: see exception().
  kRead,       ///< Access to memory that is not there or not permitted: see fault_address().
  kWrite,
  kFetch,
  kUndefined,  ///< Or WFE, which the emulator does not do.
};

/// Memory, registers and execution. Knows no interrupts, no system control space, no time.
class Engine {
 public:
  Engine(Core core, EngineClient& client);
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Memory of the caller's. @param[in] permissions As of UC_PROT_READ and the like.
  void map_memory(std::uint32_t address, std::size_t bytes, std::uint32_t permissions,
                  std::uint8_t* memory);
  /// Addresses whose accesses go to the client.
  void map_registers(std::uint32_t address, std::size_t bytes);
  /// Changes what may be done with a granule of mapped memory. Not while the engine runs.
  /// @returns False where no memory is.
  bool protect(std::uint32_t address, std::uint32_t permissions);

  /// The same for all memories; @p permissions tells from an address and what its memory permits.
  void protect_all(const std::function<std::uint32_t(std::uint32_t, std::uint32_t)>& permissions);
  /// Takes a memory away, so that accesses go to the client, or gives it back. Not while the engine
  /// runs.
  void hide(std::uint32_t address, bool hidden);

  /// Reads all code anew, after somebody has changed it from outside. Not while the engine runs.
  void forget_code();

  std::uint32_t get(int register_id) const;
  void set(int register_id, std::uint32_t value);
  double get_double(int register_id) const;

  /// Runs from the address of an instruction.
  EngineStop run(std::uint32_t address);
  std::uint32_t exception() const { return exception_; }
  std::uint32_t fault_address() const { return fault_address_; }
  /// Where the engine stands: where to go on after kBlock or kSleep, and after an SVC; the value of
  /// the return after an exception; else the start of the block.
  std::uint32_t pc() const { return pc_; }

 private:
  struct Closer {
    void operator()(uc_engine* engine) const { uc_close(engine); }
  };
  static void block_hook(uc_engine* engine, std::uint64_t address, std::uint32_t bytes, void* self);
  static void interrupt_hook(uc_engine* engine, std::uint32_t number, void* self);
  static bool invalid_hook(uc_engine* engine, uc_mem_type type, std::uint64_t address, int bytes,
                           std::int64_t value, void* self);

  struct Memory {
    std::uint32_t address;
    std::uint8_t* bytes;
    std::vector<std::uint32_t> permissions;  ///< Of each granule.
    std::uint32_t otherwise;                 ///< Without the protection unit.
    bool hidden;
  };
  /// One range of registers; the emulator tells offsets only.
  struct Range {
    Engine* engine;
    std::uint32_t base;
  };
  static std::uint64_t read_hook(uc_engine* engine, std::uint64_t offset, unsigned bytes,
                                 void* range);
  static void write_hook(uc_engine* engine, std::uint64_t offset, unsigned bytes,
                         std::uint64_t value, void* range);

  EngineClient& client_;
  std::unique_ptr<uc_engine, Closer> engine_;
  std::vector<std::unique_ptr<Range>> ranges_;
  std::vector<Memory> memories_;
  bool stopped_ = false;
  bool excepted_ = false;
  std::uint32_t exception_ = 0;
  std::uint32_t fault_address_ = 0;
  std::uint32_t pc_ = 0;
};

}  // namespace emax::chip
