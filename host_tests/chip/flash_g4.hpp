// The flash memory of the STM32G4: wait states, keys, pages, double words, caches.
#pragma once

#include "chip/flash.hpp"

namespace emax::chip {

inline constexpr std::uint32_t kBankBytes = 0x40000;
inline constexpr std::uint32_t kPageBytes = 2048;

/// Found here: "flash_wrong_key", "flash_locked", "flash_busy", "flash_nothing_to_erase",
/// "flash_own_bank", "flash_old_error_flags", "flash_not_programming", "flash_word_order",
/// "flash_not_erased", "flash_data_cache_on", "cache_reset_while_on", "option_bytes_written",
/// "wrong_width".
class FlashG4 final : public Flash {
 public:
  FlashG4(Context context, Clocks& clocks);

  void write_array(std::uint32_t address, unsigned bytes, std::uint32_t value) override;
  /// Test: an option byte that is not as needed.
  void set_dual_bank(bool dual) { dual_bank_ = dual; }

 private:
  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;
  void begin_operation() override;
  void end_operation(bool fails) override;
  bool is_busy() const override { return (stored(0x10) & 1U << 16) != 0; }
  void note_broken(std::uint32_t address) override;

  void write_key(std::uint32_t value);
  void write_access(std::uint32_t value);
  void write_control(std::uint32_t value);
  void start_erase();
  void take_word(std::uint32_t address, std::uint32_t value);
  void refuse(const char* what, std::uint32_t flags, std::uint32_t value);

  bool dual_bank_ = true;
  unsigned keys_ = 0;                     ///< Given so far; 3: a wrong one, locked until reset.
  std::uint32_t first_word_address_ = 0;  ///< Zero: none.
  std::uint32_t first_word_ = 0;
};

}  // namespace emax::chip
