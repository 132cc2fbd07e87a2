// Frames, checks and alternates the copies of records.
#include "emax/app/store/record_store.hpp"

#include <algorithm>
#include <array>

#include "emax/app/base/crc32.hpp"

namespace emax::app {
namespace {

using Header = std::array<std::uint8_t, RecordStore::kHeaderBytes>;
using Checksum = std::array<std::uint8_t, RecordStore::kChecksumBytes>;

// "emx1": what this is, and the version of the frame.
constexpr std::uint32_t kMark = 0x31786D65;
constexpr std::size_t kMarkAt = 0;
constexpr std::size_t kNumberAt = 4;
constexpr std::size_t kGenerationAt = 8;
constexpr std::size_t kSizeAt = 12;
constexpr std::size_t kPieceBytes = 64;

void put(std::uint32_t value, std::uint8_t* to) noexcept {
  for (unsigned i = 0; i < 4; ++i) {
    to[i] = static_cast<std::uint8_t>(value >> (8U * i));
  }
}

std::uint32_t taken(const std::uint8_t* from) noexcept {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) {
    value |= std::uint32_t{from[i]} << (8U * i);
  }
  return value;
}

// Right also where the count has gone round.
bool is_newer(std::uint32_t generation, std::uint32_t than) noexcept {
  return generation != than && generation - than < 0x80000000;
}

// Never written. Memory that nobody has erased yet may hold zeros.
bool is_blank(const Header& header) noexcept {
  return (header[0] == hal::kErasedByte || header[0] == 0) &&
         std::all_of(header.begin(), header.end(),
                     [&header](std::uint8_t byte) { return byte == header[0]; });
}

}  // namespace

std::size_t RecordStore::capacity() const noexcept {
  const std::size_t slot = store_.format().slot_bytes;
  return slot > kFrameBytes ? slot - kFrameBytes : 0;
}

RecordStore::Copy RecordStore::examine(std::uint32_t slot) const noexcept {
  Copy copy;
  Header header;
  if (store_.read(slot, header) != Status::kOk) {
    return copy;
  }
  copy.can_be_read = true;
  copy.is_blank = is_blank(header);
  copy.generation = taken(&header[kGenerationAt]);
  copy.bytes = taken(&header[kSizeAt]);
  if (taken(&header[kMarkAt]) != kMark || taken(&header[kNumberAt]) != slot / 2 ||
      copy.bytes > capacity()) {
    return copy;
  }
  Crc32 crc;
  crc.add(header);
  auto offset = static_cast<std::uint32_t>(kHeaderBytes);
  for (std::size_t left = copy.bytes; left > 0;) {
    std::array<std::uint8_t, kPieceBytes> room;
    const Span<std::uint8_t> piece = Span<std::uint8_t>(room).first(std::min(left, kPieceBytes));
    if (store_.read(slot, offset, piece) != Status::kOk) {
      copy.can_be_read = false;
      return copy;
    }
    crc.add(piece);
    offset += static_cast<std::uint32_t>(piece.size());
    left -= piece.size();
  }
  Checksum checksum;
  copy.can_be_read = store_.read(slot, offset, checksum) == Status::kOk;
  copy.is_whole = copy.can_be_read && taken(checksum.data()) == crc.value();
  return copy;
}

RecordStore::Copies RecordStore::examine_both(std::uint32_t number) const noexcept {
  const Copy first = examine(2 * number);
  const Copy second = examine(2 * number + 1);
  Copies copies;
  copies.can_be_read = first.can_be_read || second.can_be_read;
  copies.is_any_whole = first.is_whole || second.is_whole;
  copies.is_any_damaged =
      !(first.is_whole || first.is_blank) || !(second.is_whole || second.is_blank);
  const bool is_second =
      second.is_whole && (!first.is_whole || is_newer(second.generation, first.generation));
  copies.newest_slot = 2 * number + (is_second ? 1 : 0);
  copies.newest = is_second ? second : first;
  return copies;
}

StoredRecord RecordStore::read(std::uint32_t number, Span<std::uint8_t> bytes) const noexcept {
  if (number >= count()) {
    return {Status::kInvalidArgument};
  }
  const Copies copies = examine_both(number);
  if (!copies.is_any_whole) {
    return {copies.can_be_read ? Status::kNothingStored : Status::kHardwareFault, 0,
            copies.is_any_damaged};
  }
  const std::size_t size = copies.newest.bytes;
  if (size > bytes.size()) {
    return {Status::kBufferTooSmall};
  }
  if (store_.read(copies.newest_slot, kHeaderBytes, bytes.first(size)) != Status::kOk) {
    return {Status::kHardwareFault};
  }
  return {Status::kOk, size, copies.is_any_damaged};
}

Status RecordStore::write(std::uint32_t number, Span<std::uint8_t> frame) noexcept {
  if (number >= count() || frame.size() < kFrameBytes ||
      frame.size() > store_.format().slot_bytes) {
    return Status::kInvalidArgument;
  }
  const Copies copies = examine_both(number);
  const std::uint32_t slot = copies.is_any_whole ? copies.newest_slot ^ 1U : 2 * number;
  const std::uint32_t generation = copies.is_any_whole ? copies.newest.generation + 1 : 0;
  put(kMark, frame.data() + kMarkAt);
  put(number, frame.data() + kNumberAt);
  put(generation, frame.data() + kGenerationAt);
  put(static_cast<std::uint32_t>(frame.size() - kFrameBytes), frame.data() + kSizeAt);
  const std::size_t checksum_at = frame.size() - kChecksumBytes;
  Crc32 crc;
  crc.add(frame.first(checksum_at));
  put(crc.value(), frame.data() + checksum_at);
  const Status status = store_.write(slot, frame);
  if (status == Status::kOk && copies.is_any_damaged && !copies.is_any_whole) {
    // There is nothing left that it could be older than.
    (void)store_.write(slot ^ 1U, {});
  }
  return status;
}

}  // namespace emax::app
