// Slots in memory that is erased in large sectors only: a log of copies in two of these.
#pragma once

#include <array>
#include <cstdint>

#include "emax/app/base/crc32.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/store.hpp"

namespace emax::board {

/// Two sectors of the same size, 0 and 1. The board bounds every wait.
class SectorPair {
 public:
  SectorPair(const SectorPair&) = delete;
  SectorPair& operator=(const SectorPair&) = delete;

  /// @returns kOk, or kHardwareFault where the memory cannot correct what it reads.
  virtual Status read_sector(std::uint32_t sector, std::uint32_t offset,
                             Span<std::uint8_t> bytes) noexcept = 0;

  /// Sets all of a sector to kErasedByte. @returns kOk or kHardwareFault.
  virtual Status erase_sector(std::uint32_t sector) noexcept = 0;

  /// Programs one whole unit, once between two erasures. @returns kOk or kHardwareFault.
  virtual Status program_unit(std::uint32_t sector, std::uint32_t offset,
                              Span<const std::uint8_t> unit) noexcept = 0;

 protected:
  constexpr SectorPair() noexcept = default;
  ~SectorPair() = default;
};

/// A write appends a copy of its slot to the active sector; the newest copy that was finished
/// counts. When the sector is full, the copies that count go over to the other one, the spare,
/// which was erased before. A write never erases.
///
/// A copy is a head, the slot's bytes, and two equal tails, all in whole units. The head says that
/// the place is used, the first tail that the copy is finished; each label has a CRC-32 of its own,
/// and a tail one of the bytes. So a power cut leaves the slot as it was before or as it is after
/// the write. One damaged unit costs its own slot at most, and not the others: a label that is
/// lost has another one beside it, and of damaged bytes `read()` says kHardwareFault until the slot
/// is written again, instead of answering the copy before. What is needed of which sector follows
/// from the copies alone: a copy keeps its number when it moves, so one that exists twice may go.
class LogStore final : public hal::Store {
 public:
  static constexpr std::uint32_t kMaxSlots = 16;

  /// @param[in] format       kMaxSlots slots at most.
  /// @param[in] sector_bytes Room for more copies than there are slots, `places()`.
  /// @param[in] memory       Outlives this object.
  constexpr LogStore(const hal::StoreFormat& format, std::uint32_t sector_bytes,
                     SectorPair& memory) noexcept
      : Store(format), sector_bytes_(sector_bytes), memory_(memory) {}

  /// At power on: looks through both sectors, ends what a power cut has interrupted, and erases
  /// ahead. Until then nothing is read or written.
  ///
  /// @returns
  /// * kOk: Ready, and the spare sector is erased.
  /// * kHardwareFault: No such format, or the memory failed. What can be read is read; writes go on
  ///   as far as there is room.
  Status start() noexcept;

  /// @returns True if the spare sector waits for its erasure, as it does from a move on.
  bool wants_erase() const noexcept;

  /// Erases the spare sector if it has to be: when nobody waits for anything, as this takes as long
  /// as the memory's erasure. @returns kOk, or kHardwareFault if it is not erased now.
  Status erase_ahead() noexcept;

  /// @returns How many copies a sector has room for. With as many as slots there is no log.
  std::uint32_t places() const noexcept;

  /// @returns How many writes there is room for without `erase_ahead()`, or more.
  std::uint32_t free_writes() const noexcept;

 private:
  static constexpr std::uint32_t kLabelBytes = 24;

  /// Before or behind the bytes of a copy.
  struct Label {
    std::uint32_t slot = 0;
    std::uint32_t number = 0;  ///< Of the copy: higher is newer.
    std::uint32_t bytes = 0;   ///< Programmed, from the slot's front on.
    std::uint32_t crc = 0;     ///< Of these.
  };
  enum class Found : std::uint8_t { kErased, kDamaged, kWhole };
  struct Copy {
    std::uint32_t number = 0;  ///< 0: there is none.
    std::uint32_t place = 0;
    std::uint32_t bytes = 0;
    bool is_damaged = false;
  };
  struct Sector {
    std::uint32_t next = 0;  ///< Place of the next copy; `places()` if there is none.
    std::array<Copy, kMaxSlots> newest = {};
  };
  /// The copy that a write is at.
  struct Open {
    bool is_open = false;
    std::uint32_t place = 0;
    Label label;
    app::Crc32 crc;
  };

  Status do_read(std::uint32_t slot, std::uint32_t offset,
                 Span<std::uint8_t> bytes) noexcept override;
  Status do_erase(std::uint32_t slot) noexcept override;
  Status do_program(std::uint32_t slot, std::uint32_t offset,
                    Span<const std::uint8_t> unit) noexcept override;
  Status do_finish(std::uint32_t slot, Status so_far) noexcept override;

  bool is_usable() const noexcept;
  std::uint32_t in_units(std::uint32_t bytes) const noexcept;
  std::uint32_t place_bytes() const noexcept;
  std::uint32_t head_at(std::uint32_t place) const noexcept { return place * place_bytes(); }
  std::uint32_t bytes_at(std::uint32_t place) const noexcept;
  std::uint32_t tail_at(std::uint32_t place, unsigned which) const noexcept;
  std::uint32_t spare() const noexcept { return active_ ^ 1U; }
  bool is_blank(std::uint32_t sector) const noexcept { return sectors_[sector].next == 0; }

  Found read_label(std::uint32_t sector, std::uint32_t offset, std::uint32_t mark,
                   Label& label) noexcept;
  Status write_label(std::uint32_t sector, std::uint32_t offset, std::uint32_t mark,
                     const Label& label) noexcept;
  Found read_tail(std::uint32_t sector, std::uint32_t place, Label& label) noexcept;
  Status write_tails(std::uint32_t sector, std::uint32_t place, const Label& label) noexcept;
  bool holds(std::uint32_t sector, std::uint32_t place, const Label& label) noexcept;
  Status read_copy(std::uint32_t sector, const Copy& copy, std::uint32_t offset,
                   Span<std::uint8_t> bytes) noexcept;
  bool is_erased_from(std::uint32_t sector, std::uint32_t offset) noexcept;

  void look_through(std::uint32_t sector) noexcept;
  bool look_at(std::uint32_t sector, std::uint32_t place) noexcept;
  bool is_needed(std::uint32_t sector, std::uint32_t slot) const noexcept;
  bool is_needed(std::uint32_t sector) const noexcept;
  std::uint32_t choose_active() const noexcept;
  Status move_to(std::uint32_t sector) noexcept;
  Status move_copy(std::uint32_t slot, std::uint32_t to) noexcept;
  Status copy_bytes(std::uint32_t from, std::uint32_t from_offset, std::uint32_t to,
                    std::uint32_t to_offset, std::uint32_t bytes) noexcept;

  const std::uint32_t sector_bytes_;
  SectorPair& memory_;
  std::array<Sector, 2> sectors_ = {};
  std::uint32_t active_ = 0;
  std::uint32_t last_number_ = 0;
  bool is_started_ = false;
  Open open_;
};

}  // namespace emax::board
