// Numbered records that survive a power cut: two copies each, with a checksum.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/hal/store.hpp"

namespace emax::app {

/// What `RecordStore::read()` answers.
struct StoredRecord {
  Status status = Status::kNothingStored;
  std::size_t bytes = 0;  ///< Of the record; 0 unless kOk.
  /// A copy is not whole, and was written once. With kOk, this may be the record before the newest
  /// one; with kNothingStored or kHardwareFault, there was a record.
  bool is_damaged = false;
};

/// Keeps record n in the slots 2n and 2n + 1 of a store.
///
/// A copy is a header (mark, number of the record, generation, size), the bytes, and the CRC-32 of
/// both, in little endian. A write goes to the copy that is not the newest whole one, so a power
/// cut at any moment leaves the record of before or the new one, never a mixture, and both copies
/// wear alike. Read is the newest copy whose checksum holds; a copy that the memory cannot read is
/// not whole. If damage strikes the newest copy, the one before it is read, and the answer says so:
/// as one damaged bit may be that of the number which tells older from newer, it says so whichever
/// copy is damaged, and until the next write.
///
/// Holds nothing but the reference: no state that could disagree with the memory. A read and a
/// write both go through both copies first, a read then once more through the one that counts.
class RecordStore {
 public:
  static constexpr std::size_t kHeaderBytes = 16;
  static constexpr std::size_t kChecksumBytes = 4;
  /// What a copy takes beside the bytes of its record.
  static constexpr std::size_t kFrameBytes = kHeaderBytes + kChecksumBytes;

  /// The store outlives this object.
  constexpr explicit RecordStore(hal::Store& store) noexcept : store_(store) {}

  /// Records are numbered from 0 to this less 1.
  std::uint32_t count() const noexcept { return store_.format().slot_count / 2; }
  /// @returns The most bytes that a record may have.
  std::size_t capacity() const noexcept;

  /// @param[in]  number Of the record.
  /// @param[out] bytes  May be larger than the record. Anything may be in it unless kOk.
  /// @returns
  /// * kOk: The front of `bytes` holds the record.
  /// * kInvalidArgument: No such number.
  /// * kNothingStored: Neither copy is whole: nothing was ever written, or nothing is left of it.
  /// * kBufferTooSmall: The record has more bytes than that.
  /// * kHardwareFault: Neither copy can be read at all.
  StoredRecord read(std::uint32_t number, Span<std::uint8_t> bytes) const noexcept;

  /// Replaces a record.
  ///
  /// @param[in]     number Of the record.
  /// @param[in,out] frame  The record, behind kHeaderBytes and before kChecksumBytes of room, which
  ///                       are filled: what the memory takes in one piece. `record_in()` finds the
  ///                       record's place.
  /// @returns
  /// * kOk: Written, and it reads back as it should.
  /// * kInvalidArgument: No such number, a frame without room, or more than a slot holds. Nothing
  ///   has changed.
  /// * kHardwareFault: The memory failed. The record of before is as whole as it was.
  Status write(std::uint32_t number, Span<std::uint8_t> frame) noexcept;

  /// @returns The part of such a frame that is the record's. The frame has kFrameBytes or more.
  static constexpr Span<std::uint8_t> record_in(Span<std::uint8_t> frame) noexcept {
    return frame.from(kHeaderBytes).first(frame.size() - kFrameBytes);
  }

 private:
  /// What is known of one copy.
  struct Copy {
    bool can_be_read = false;
    bool is_whole = false;
    bool is_blank = false;
    std::uint32_t generation = 0;
    std::size_t bytes = 0;
  };
  /// Both copies of a record, and which one counts.
  struct Copies {
    bool can_be_read = false;
    bool is_any_whole = false;
    bool is_any_damaged = false;
    std::uint32_t newest_slot = 0;
    Copy newest;
  };

  Copy examine(std::uint32_t slot) const noexcept;
  Copies examine_both(std::uint32_t number) const noexcept;

  hal::Store& store_;
};

}  // namespace emax::app
