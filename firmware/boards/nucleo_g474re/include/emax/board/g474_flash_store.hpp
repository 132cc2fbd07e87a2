// A store in the second bank of an STM32G474's flash memory.
#pragma once

#include <atomic>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/board/store_format.hpp"
#include "emax/hal/store.hpp"

namespace emax::board {

inline constexpr std::uint32_t kFlashPageBytes = 2048;
inline constexpr std::uint32_t kFlashPagesPerBank = 128;
inline constexpr std::uint32_t kPagesPerSlot =
    (kStoreFormat.slot_bytes + kFlashPageBytes - 1) / kFlashPageBytes;
/// The records have the last pages of bank 2: memory.ld leaves them free.
inline constexpr std::uint32_t kFirstRecordPage =
    kFlashPagesPerBank - kStoreFormat.slot_count * kPagesPerSlot;
static_assert(kPagesPerSlot > 1 || kFirstRecordPage == 118,
              "with a board's capacities as in memory.ld");
static_assert(kStoreFormat.unit_bytes == 8, "the memory programs double words");

/// A slot is a page of bank 2, or more where one is too small; code runs on in bank 1 while a page
/// is erased, for 25 ms, or programmed. What a power cut has left half programmed, the memory
/// cannot correct: it raises the interrupt that cannot be masked, and the read is a fault.
class G474FlashStore final : public hal::Store {
 public:
  constexpr G474FlashStore() noexcept : Store(kStoreFormat) {}

  /// In the interrupt that cannot be masked. @returns True if it came of a read of this store,
  /// which is a fault now. Clears the flag.
  bool take_read_error() noexcept;

 private:
  Status do_read(std::uint32_t slot, std::uint32_t offset,
                 Span<std::uint8_t> bytes) noexcept override;
  Status do_erase(std::uint32_t slot) noexcept override;
  Status do_program(std::uint32_t slot, std::uint32_t offset,
                    Span<const std::uint8_t> unit) noexcept override;

  std::atomic<bool> is_reading_ = false;
  std::atomic<bool> has_read_error_ = false;
};

}  // namespace emax::board
