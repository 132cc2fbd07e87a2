// The flash memory of the STM32H743: sectors of 128 KB, words of 32 bytes with error correction, a
// set of registers for each bank.
#pragma once

#include <array>
#include <functional>
#include <utility>

#include "chip/flash.hpp"

namespace emax::chip {

/// The program is in bank 1, and what it keeps in bank 2.
///
/// Found here: "flash_wrong_key", "flash_locked", "flash_busy", "flash_nothing_to_erase",
/// "flash_own_bank", "flash_old_error_flags", "flash_not_programming", "flash_word_order",
/// "flash_word_twice", "flash_word_incomplete", "flash_not_erased", "option_bytes_written".
class FlashH7 final : public Flash {
 public:
  static constexpr std::uint32_t kBankBytes = 0x100000, kSectorBytes = 0x20000, kWordBytes = 32;

  FlashH7(Context context, Clocks& clocks);

  void write_array(std::uint32_t address, unsigned bytes, std::uint32_t value) override;
  /// Hears of each read that ends in an error of the bus.
  void on_bus_error(std::function<void(std::uint32_t)> action) { bus_error_ = std::move(action); }
  /// Test: an option byte that is not as needed.
  void set_swapped(bool swapped) { swapped_ = swapped; }

 private:
  std::uint32_t on_read(std::uint32_t offset, std::uint32_t value) override;
  void on_write(std::uint32_t offset, std::uint32_t value) override;
  void on_reset() override;
  void begin_operation() override;
  void end_operation(bool fails) override;
  bool is_busy() const override;
  void note_broken(std::uint32_t address) override;

  void write_key(unsigned bank, std::uint32_t value);
  void write_control(unsigned bank, std::uint32_t value);
  void start_erase(std::uint32_t control);
  void refuse(const char* what, std::uint32_t flags, std::uint32_t value);
  void program_buffer();

  bool swapped_ = false;
  std::array<unsigned, 2> keys_ = {};  ///< Given so far; 3: a wrong one, locked until reset.
  std::function<void(std::uint32_t)> bus_error_;
  std::uint32_t buffer_begin_ = 0;
  std::uint32_t buffered_ = 0;  ///< A bit for each byte that is in the buffer.
  std::array<std::uint8_t, kWordBytes> buffer_ = {};
};

}  // namespace emax::chip
