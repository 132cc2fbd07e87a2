// The registers of one peripheral, and what is wrong with an access to any of them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "chip/events.hpp"
#include "chip/findings.hpp"
#include "chip/nvic.hpp"

namespace emax::chip {

/// One row of a table of registers.
struct Register {
  const char* name;
  std::uint32_t offset;
  std::uint32_t reset;
  std::uint32_t exists;    ///< Bits that are there.
  std::uint32_t writable;  ///< Bits that a program may write; none: the register is to be read.
};
using Registers = std::vector<Register>;

/// The clock of a peripheral, which RCC switches.
struct Gate {
  bool on = true;
  bool in_reset = false;
  bool fresh = false;  ///< Switched on, and nothing has been read since.
};

/// Interrupts whose wires several sources share.
class Wires {
 public:
  explicit Wires(Nvic& nvic) : nvic_(nvic) {}
  /// @param[in] exception As in `Nvic`.
  void set(unsigned exception, const void* source, bool high);
  void clear();

 private:
  Nvic& nvic_;
  std::map<unsigned, std::map<const void*, bool>> high_;
};

inline constexpr unsigned interrupt(unsigned number) { return kFirstInterrupt + number; }

/// What all peripherals use.
struct Context {
  Events& events;
  Findings& findings;
  Wires& wires;
};

/// A peripheral: a table of registers and what they do.
///
/// Found here: "no_such_register", "wrong_width", "misaligned", "clock_off",
/// "clock_enable_not_read_back", "held_in_reset", "reserved_bit_written",
/// "read_only_register_written".
class RegisterBlock {
 public:
  RegisterBlock(Context context, std::string name, Registers registers);
  RegisterBlock(const RegisterBlock&) = delete;
  RegisterBlock& operator=(const RegisterBlock&) = delete;
  virtual ~RegisterBlock() = default;

  const std::string& name() const { return name_; }
  const Registers& registers() const { return registers_; }
  Gate& gate() { return gate_; }

  std::uint32_t bus_read(std::uint32_t offset, unsigned bytes);
  void bus_write(std::uint32_t offset, unsigned bytes, std::uint32_t value);
  /// All registers to their values after reset, and all that goes on ends.
  void reset();

  /// A test's hand on a flag: these bits read so until `release()`, whatever happens.
  void hold(const std::string& register_name, std::uint32_t bits, std::uint32_t value);
  void release() { held_.clear(); }

  std::uint32_t get(std::uint32_t offset) const;
  bool has(std::uint32_t offset, std::uint32_t bits) const { return (get(offset) & bits) == bits; }

 protected:
  /// What reading does, and what is computed then. The value is what `get()` says.
  virtual std::uint32_t on_read(std::uint32_t offset, std::uint32_t value);
  /// What writing does; by default the writable bits are stored.
  virtual void on_write(std::uint32_t offset, std::uint32_t value);
  virtual void on_reset() {}
  /// Widths that registers of this peripheral take, as a sum of 1, 2 and 4.
  virtual unsigned widths(std::uint32_t offset) const;

  void put(std::uint32_t offset, std::uint32_t value);
  void set_bits(std::uint32_t offset, std::uint32_t bits) { put(offset, stored(offset) | bits); }
  void clear_bits(std::uint32_t offset, std::uint32_t bits) { put(offset, stored(offset) & ~bits); }
  /// As stored, without what a test holds.
  std::uint32_t stored(std::uint32_t offset) const;
  /// What the writable bits make of a value.
  std::uint32_t masked(std::uint32_t offset, std::uint32_t value) const;
  void report(const std::string& what, std::uint32_t offset, std::uint32_t value = 0) const;

  Context context_;

 private:
  struct Held {
    std::uint32_t bits;
    std::uint32_t value;
  };
  const Register* row(std::uint32_t offset) const;
  bool reachable(std::uint32_t offset, unsigned bytes);
  std::string where(std::uint32_t offset) const;

  std::string name_;
  Registers registers_;
  std::array<std::int16_t, 256> index_ = {};
  std::vector<std::uint32_t> values_;
  std::map<std::uint32_t, Held> held_;
  Gate gate_;
};

/// Bits of a field.
constexpr std::uint32_t field(std::uint32_t value, unsigned first, unsigned width) {
  return value >> first & ((1U << width) - 1);
}

}  // namespace emax::chip
