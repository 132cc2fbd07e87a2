// Small records that survive a power cut, in slots of non-volatile memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax::hal {

/// The greatest program unit that a store may have.
inline constexpr std::size_t kMaxUnitBytes = 256;
/// What erased memory reads as.
inline constexpr std::uint8_t kErasedByte = 0xFF;

/// What a store is built for. Constant for the life of the object.
struct StoreFormat {
  std::uint32_t slot_count = 0;
  std::uint32_t slot_bytes = 0;  ///< A multiple of the unit. A slot can be erased by itself.
  /// What is programmed at once, 1 to kMaxUnitBytes. Each unit once between two erasures.
  std::uint32_t unit_bytes = 0;
};

/// Slots of raw bytes. A power cut during a write may leave anything in that slot: a caller that
/// must keep either the old or the new record writes them to two slots in turn, with a checksum.
///
/// The board bounds every wait on hardware. `write()` needs kMaxUnitBytes of stack.
class Store {
 public:
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  const StoreFormat& format() const noexcept { return format_; }

  /// Reads from a slot.
  ///
  /// @param[in]  offset At which byte of the slot to begin.
  /// @param[out] bytes  At most what the slot has from there on. What was never written since the
  ///                    slot was erased reads as kErasedByte.
  /// @returns
  /// * kOk: `bytes` is filled.
  /// * kInvalidArgument: No such slot, or it ends before that. `bytes` is untouched.
  /// * kHardwareFault: The memory does not answer, or what it answers cannot be corrected. `bytes`
  ///   is not to be used.
  Status read(std::uint32_t slot, std::uint32_t offset, Span<std::uint8_t> bytes) noexcept;
  /// The same from the front of the slot.
  Status read(std::uint32_t slot, Span<std::uint8_t> bytes) noexcept {
    return read(slot, 0, bytes);
  }

  /// Erases a slot, programs its front unit by unit in ascending order, and reads it back. The rest
  /// of the slot is erased; no bytes at all only erase it.
  ///
  /// A power cut on the way may leave anything in this slot, and never touches another one.
  ///
  /// @returns
  /// * kOk: Written, and reads back as it should.
  /// * kInvalidArgument: No such slot, or more bytes than it has. Nothing has changed.
  /// * kHardwareFault: The memory failed, reads back otherwise, or states a format outside its
  ///   ranges. The slot may hold anything.
  Status write(std::uint32_t slot, Span<const std::uint8_t> bytes) noexcept;

 protected:
  constexpr explicit Store(const StoreFormat& format) noexcept : format_(format) {}
  ~Store() = default;

 private:
  /// Reads from `offset` on, within the slot. @returns kOk or kHardwareFault.
  virtual Status do_read(std::uint32_t slot, std::uint32_t offset,
                         Span<std::uint8_t> bytes) noexcept = 0;

  /// Sets all of a slot to kErasedByte. @returns kOk or kHardwareFault.
  virtual Status do_erase(std::uint32_t slot) noexcept = 0;

  /// Programs one whole unit that is erased; `offset` is a multiple of the unit.
  /// @returns kOk or kHardwareFault.
  virtual Status do_program(std::uint32_t slot, std::uint32_t offset,
                            Span<const std::uint8_t> unit) noexcept = 0;

  /// Ends a write whose slot was erased, well or not. A store that keeps the bytes of before until
  /// then lets the new ones count here.
  ///
  /// @param[in] so_far kOk if all units are programmed and read back as they should.
  /// @returns How the write ends.
  //  Never inlined on a guess, which would hide from the proof of the stack where it is called.
  [[gnu::noinline]] virtual Status do_finish(std::uint32_t /*slot*/, Status so_far) noexcept {
    return so_far;
  }

  bool holds(std::uint32_t slot, std::size_t bytes) const noexcept;
  Status program(std::uint32_t slot, Span<const std::uint8_t> bytes) noexcept;
  Status verify(std::uint32_t slot, Span<const std::uint8_t> bytes) noexcept;

  const StoreFormat format_;
};

}  // namespace emax::hal
