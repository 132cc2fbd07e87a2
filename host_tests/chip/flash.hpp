// The flash memory: wait states, keys, erasing and programming with error correction, in two banks.
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "chip/clocks.hpp"
#include "chip/register_block.hpp"

namespace emax::chip {

inline constexpr std::uint32_t kFlashBase = 0x08000000;
inline constexpr std::uint32_t kBankBytes = 0x40000;
inline constexpr std::uint32_t kPageBytes = 2048;

/// What a cut of the power leaves behind.
enum class PowerCut {
  kBefore,  ///< The operation has not begun.
  kWithin,  ///< Some bits have changed; reading what it worked on is an error.
  kAfter,   ///< It is done, but nobody has been told.
};

/// Found here: "flash_wrong_key", "flash_locked", "flash_busy", "flash_nothing_to_erase",
/// "flash_own_bank", "flash_old_error_flags", "flash_not_programming", "flash_word_order",
/// "flash_not_erased", "flash_data_cache_on", "cache_reset_while_on", "option_bytes_written",
/// "wrong_width".
class Flash final : public RegisterBlock {
 public:
  Flash(Context context, Clocks& clocks);

  std::uint8_t* bytes() { return memory_.data(); }
  /// Reads and writes of the second bank's addresses by the program.
  std::uint32_t read_array(std::uint32_t address, unsigned bytes);
  void write_array(std::uint32_t address, unsigned bytes, std::uint32_t value);
  bool busy() const { return has(0x10, 1U << 16); }

  /// Test: erasing a page and programming eight bytes are operations, counted from the first.
  unsigned operations() const { return operations_; }
  /// Test: the power fails at this operation, counted from now on, 0 for the next.
  void cut_power_at(unsigned operation, PowerCut how);
  void on_power_cut(std::function<void()> action) { power_cut_ = std::move(action); }
  /// Test: eight bytes that cannot be corrected when they are read.
  void break_bytes(std::uint32_t address) { broken_.insert(index_of(address)); }
  /// Test: after the next operation, an error that is none of the program's (OPERR).
  void fail_next_operation() { fail_next_ = true; }
  void set_dual_bank(bool dual) { dual_bank_ = dual; }
  bool is_erased(std::uint32_t address, std::uint32_t bytes) const;

 private:
  static constexpr unsigned kNoCut = ~0U;

  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;

  static std::uint32_t index_of(std::uint32_t address) { return (address - kFlashBase) / 8; }
  void write_key(std::uint32_t value);
  void write_access(std::uint32_t value);
  void write_control(std::uint32_t value);
  void start_erase();
  void take_word(std::uint32_t address, std::uint32_t value);
  void operate(Time duration, const std::function<void()>& whole,
               const std::function<void()>& half);
  void refuse(const char* what, std::uint32_t flags, std::uint32_t value);
  void wait_while_busy();
  void note_broken(std::uint32_t address);

  Clocks& clocks_;
  std::vector<std::uint8_t> memory_;
  std::set<std::uint32_t> broken_;  ///< Indexes of eight bytes.
  std::function<void()> power_cut_;
  unsigned operations_ = 0;
  unsigned until_cut_ = kNoCut;
  PowerCut cut_ = PowerCut::kBefore;
  bool fail_next_ = false;
  bool dual_bank_ = true;
  unsigned keys_ = 0;  ///< Given so far; 3: a wrong one, locked until reset.
  Time done_at_ = 0;
  std::uint32_t first_word_address_ = 0;  ///< Zero: none.
  std::uint32_t first_word_ = 0;
};

}  // namespace emax::chip
