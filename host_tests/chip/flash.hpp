// What all flash memories have: bytes, units with error correction, operations that take time, and
// the power that fails in them. Registers and rules are the chip's own.
#pragma once

#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "chip/clocks.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

inline constexpr std::uint32_t kFlashBase = 0x08000000;

/// What a cut of the power leaves behind.
enum class PowerCut {
  kBefore,  ///< The operation has not begun.
  kWithin,  ///< Some bits have changed; reading what it worked on is an error.
  kAfter,   ///< It is done, but nobody has been told.
};

/// Two banks; the program is in the first, and the second is written.
class Flash : public RegisterBlock {
 public:
  struct Layout {
    std::uint32_t bank_bytes;
    std::uint32_t erase_bytes;  ///< A page or a sector.
    std::uint32_t unit_bytes;   ///< What is programmed at once, with its error correction.
    double erase_time_s;
    double program_time_s;
  };

  const Layout& layout() const { return layout_; }
  std::uint8_t* bytes() { return memory_.data(); }
  /// Reads and writes of the second bank's addresses by the program.
  std::uint32_t read_array(std::uint32_t address, unsigned bytes);
  virtual void write_array(std::uint32_t address, unsigned bytes, std::uint32_t value) = 0;

  /// Test: erasing and programming a unit are operations, counted from the first.
  unsigned operations() const { return operations_; }
  /// Test: the power fails at this operation, counted from now on, 0 for the next.
  void cut_power_at(unsigned operation, PowerCut how);
  void on_power_cut(std::function<void()> action) { power_cut_ = std::move(action); }
  /// Test: a unit that cannot be corrected when it is read.
  void break_bytes(std::uint32_t address) { broken_.insert(index_of(address)); }
  /// Test: after the next operation, an error that is none of the program's (OPERR).
  void fail_next_operation() { fail_next_ = true; }
  /// Test: how long erasing takes; a program that polls costs the test real time.
  void set_erase_time(double time_s) { layout_.erase_time_s = time_s; }
  bool is_erased(std::uint32_t address, std::uint32_t bytes) const;

 protected:
  Flash(Context context, Clocks& clocks, Registers registers, const Layout& layout)
      : RegisterBlock(context, "FLASH", std::move(registers)),
        clocks_(clocks),
        layout_(layout),
        memory_(2 * layout.bank_bytes, 0xFF) {}

  std::uint32_t index_of(std::uint32_t address) const {
    return (address - kFlashBase) / layout_.unit_bytes;
  }
  bool is_broken(std::uint32_t address) const { return broken_.count(index_of(address)) != 0; }
  /// Erases the page or sector that begins here.
  void erase(std::uint32_t begin);
  /// Programs a unit.
  void program(std::uint32_t begin, std::vector<std::uint8_t> data);
  void break_unit(std::uint32_t address) { broken_.insert(index_of(address)); }
  std::uint8_t* at(std::uint32_t address) { return memory_.data() + (address - kFlashBase); }
  /// The bus keeps the processor waiting.
  void wait_while_busy();

  virtual void begin_operation() = 0;
  virtual void end_operation(bool fails) = 0;
  virtual bool is_busy() const = 0;
  /// Somebody reads a unit that cannot be corrected.
  virtual void note_broken(std::uint32_t address) = 0;

  Clocks& clocks_;

 private:
  static constexpr unsigned kNoCut = ~0U;
  void operate(Time duration, const std::function<void()>& whole,
               const std::function<void()>& half);
  void erase_units(std::uint32_t begin, std::uint32_t every);

  Layout layout_;
  std::vector<std::uint8_t> memory_;
  std::set<std::uint32_t> broken_;  ///< Indexes of units.
  std::function<void()> power_cut_;
  unsigned operations_ = 0;
  unsigned until_cut_ = kNoCut;
  PowerCut cut_ = PowerCut::kBefore;
  bool fail_next_ = false;
  Time done_at_ = 0;
};

}  // namespace emax::chip
