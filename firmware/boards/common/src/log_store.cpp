// Copies in the order of their writes, and which of them count.
#include "emax/board/log_store.hpp"

#include <algorithm>

namespace emax::board {
namespace {

// "log" and which label: what this is, and the version of it.
constexpr std::uint32_t kHead = 0x68676F6C;
constexpr std::uint32_t kTail = 0x74676F6C;

constexpr std::size_t kPieceBytes = 64;
constexpr std::uint32_t kWordBytes = 4;
constexpr std::uint32_t kChecksumAt = 20;

void put(std::uint32_t value, std::uint8_t* to) noexcept {
  for (unsigned i = 0; i < kWordBytes; ++i) {
    to[i] = static_cast<std::uint8_t>(value >> (8U * i));
  }
}

std::uint32_t taken(const std::uint8_t* from) noexcept {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < kWordBytes; ++i) {
    value |= std::uint32_t{from[i]} << (8U * i);
  }
  return value;
}

std::uint32_t checksum_of(Span<const std::uint8_t> bytes) noexcept {
  app::Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

bool is_erased(Span<const std::uint8_t> bytes) noexcept {
  return std::all_of(bytes.begin(), bytes.end(),
                     [](std::uint8_t byte) { return byte == hal::kErasedByte; });
}

}  // namespace

Status LogStore::start() noexcept {
  is_started_ = false;
  open_.is_open = false;
  if (!is_usable()) {
    return Status::kHardwareFault;
  }
  last_number_ = 0;
  look_through(0);
  look_through(1);
  active_ = choose_active();
  is_started_ = true;
  const Status moved = is_needed(spare()) ? move_to(active_) : Status::kOk;
  const Status erased = erase_ahead();
  return moved == Status::kOk ? erased : moved;
}

bool LogStore::wants_erase() const noexcept {
  return is_started_ && !is_blank(spare()) && !is_needed(spare());
}

Status LogStore::erase_ahead() noexcept {
  if (wants_erase()) {
    (void)memory_.erase_sector(spare());
    // What it says about itself is not asked: it is erased if it reads so.
    look_through(spare());
  }
  return is_started_ && is_blank(spare()) ? Status::kOk : Status::kHardwareFault;
}

std::uint32_t LogStore::places() const noexcept { return sector_bytes_ / place_bytes(); }

std::uint32_t LogStore::free_writes() const noexcept {
  const std::uint32_t here = places() - sectors_[active_].next;
  return is_blank(spare()) ? here + places() - format().slot_count : here;
}

bool LogStore::is_usable() const noexcept {
  return format().unit_bytes >= 1 && format().slot_count <= kMaxSlots &&
         places() > format().slot_count;
}

std::uint32_t LogStore::in_units(std::uint32_t bytes) const noexcept {
  const std::uint32_t unit = format().unit_bytes;
  return (bytes + unit - 1) / unit * unit;
}

std::uint32_t LogStore::place_bytes() const noexcept {
  return 3 * in_units(kLabelBytes) + format().slot_bytes;
}

std::uint32_t LogStore::bytes_at(std::uint32_t place) const noexcept {
  return head_at(place) + in_units(kLabelBytes);
}

std::uint32_t LogStore::tail_at(std::uint32_t place, unsigned which) const noexcept {
  return bytes_at(place) + format().slot_bytes + which * in_units(kLabelBytes);
}

LogStore::Found LogStore::read_label(std::uint32_t sector, std::uint32_t offset, std::uint32_t mark,
                                     Label& label) noexcept {
  std::array<std::uint8_t, kLabelBytes> bytes;
  if (memory_.read_sector(sector, offset, bytes) != Status::kOk) {
    return Found::kDamaged;
  }
  if (is_erased(bytes)) {
    return Found::kErased;
  }
  const Span<const std::uint8_t> all = bytes;
  label = {taken(&bytes[4]), taken(&bytes[8]), taken(&bytes[12]), taken(&bytes[16])};
  const bool is_whole = taken(bytes.data()) == mark &&
                        taken(&bytes[kChecksumAt]) == checksum_of(all.first(kChecksumAt)) &&
                        label.slot < format().slot_count && label.bytes <= format().slot_bytes;
  return is_whole ? Found::kWhole : Found::kDamaged;
}

Status LogStore::write_label(std::uint32_t sector, std::uint32_t offset, std::uint32_t mark,
                             const Label& label) noexcept {
  std::array<std::uint8_t, kLabelBytes> bytes;
  put(mark, bytes.data());
  put(label.slot, &bytes[4]);
  put(label.number, &bytes[8]);
  put(label.bytes, &bytes[12]);
  put(label.crc, &bytes[16]);
  const Span<const std::uint8_t> all = bytes;
  put(checksum_of(all.first(kChecksumAt)), &bytes[kChecksumAt]);
  std::array<std::uint8_t, hal::kMaxUnitBytes> unit;
  for (std::uint32_t at = 0; at < kLabelBytes; at += format().unit_bytes) {
    unit.fill(hal::kErasedByte);
    std::copy_n(&bytes[at], std::min(format().unit_bytes, kLabelBytes - at), unit.data());
    const Span<const std::uint8_t> filled =
        Span<const std::uint8_t>(unit).first(format().unit_bytes);
    if (memory_.program_unit(sector, offset + at, filled) != Status::kOk) {
      return Status::kHardwareFault;
    }
  }
  Label found;
  return read_label(sector, offset, mark, found) == Found::kWhole ? Status::kOk
                                                                  : Status::kHardwareFault;
}

// Either of both.
LogStore::Found LogStore::read_tail(std::uint32_t sector, std::uint32_t place,
                                    Label& label) noexcept {
  const Found first = read_label(sector, tail_at(place, 0), kTail, label);
  if (first == Found::kWhole) {
    return first;
  }
  const Found second = read_label(sector, tail_at(place, 1), kTail, label);
  return second == Found::kErased ? first : second;
}

Status LogStore::write_tails(std::uint32_t sector, std::uint32_t place,
                             const Label& label) noexcept {
  if (write_label(sector, tail_at(place, 0), kTail, label) != Status::kOk) {
    return Status::kHardwareFault;
  }
  return write_label(sector, tail_at(place, 1), kTail, label);
}

// Whether the bytes are what the label says.
bool LogStore::holds(std::uint32_t sector, std::uint32_t place, const Label& label) noexcept {
  app::Crc32 crc;
  std::array<std::uint8_t, kPieceBytes> room;
  for (std::uint32_t at = 0; at < label.bytes;) {
    const Span<std::uint8_t> piece =
        Span<std::uint8_t>(room).first(std::min<std::size_t>(label.bytes - at, kPieceBytes));
    if (memory_.read_sector(sector, bytes_at(place) + at, piece) != Status::kOk) {
      return false;
    }
    crc.add(piece);
    at += static_cast<std::uint32_t>(piece.size());
  }
  return crc.value() == label.crc;
}

bool LogStore::is_erased_from(std::uint32_t sector, std::uint32_t offset) noexcept {
  std::array<std::uint8_t, kPieceBytes> room;
  while (offset < sector_bytes_) {
    const Span<std::uint8_t> piece =
        Span<std::uint8_t>(room).first(std::min<std::size_t>(sector_bytes_ - offset, kPieceBytes));
    if (memory_.read_sector(sector, offset, piece) != Status::kOk || !is_erased(piece)) {
      return false;
    }
    offset += static_cast<std::uint32_t>(piece.size());
  }
  return true;
}

void LogStore::look_through(std::uint32_t sector) noexcept {
  Sector& found = sectors_[sector];
  found = {};
  for (std::uint32_t place = 0; place < places(); ++place) {
    if (look_at(sector, place)) {
      found.next = place + 1;
    }
  }
  // An erasure that was cut, or damage, where nothing was written: nothing can be written there.
  if (!is_erased_from(sector, head_at(found.next))) {
    found.next = places();
  }
}

// @returns Whether the place is used.
bool LogStore::look_at(std::uint32_t sector, std::uint32_t place) noexcept {
  Label head;
  Label tail;
  const Found begun = read_label(sector, head_at(place), kHead, head);
  const Found finished = read_tail(sector, place, tail);
  if (begun == Found::kWhole) {
    last_number_ = std::max(last_number_, head.number);
  }
  if (finished != Found::kWhole) {
    return begun != Found::kErased || finished != Found::kErased;
  }
  last_number_ = std::max(last_number_, tail.number);
  Copy& newest = sectors_[sector].newest[tail.slot];
  // The same number twice: a move that failed, and was tried again.
  if (tail.number >= newest.number) {
    const bool is_damaged = !holds(sector, place, tail);
    if (tail.number > newest.number || !is_damaged) {
      newest = {tail.number, place, tail.bytes, is_damaged};
    }
  }
  return true;
}

// Whether the other sector cannot stand in for this one.
bool LogStore::is_needed(std::uint32_t sector, std::uint32_t slot) const noexcept {
  const Copy& here = sectors_[sector].newest[slot];
  const Copy& there = sectors_[sector ^ 1U].newest[slot];
  if (here.number != there.number) {
    return here.number > there.number;
  }
  return here.number != 0 && there.is_damaged && !here.is_damaged;
}

bool LogStore::is_needed(std::uint32_t sector) const noexcept {
  for (std::uint32_t slot = 0; slot < format().slot_count; ++slot) {
    if (is_needed(sector, slot)) {
      return true;
    }
  }
  return false;
}

// The one that is needed; of two, or none, that with more room.
std::uint32_t LogStore::choose_active() const noexcept {
  if (is_needed(0) != is_needed(1)) {
    return is_needed(1) ? 1 : 0;
  }
  return sectors_[1].next < sectors_[0].next ? 1 : 0;
}

Status LogStore::move_to(std::uint32_t sector) noexcept {
  for (std::uint32_t slot = 0; slot < format().slot_count; ++slot) {
    if (is_needed(sector ^ 1U, slot) && move_copy(slot, sector) != Status::kOk) {
      return Status::kHardwareFault;
    }
  }
  active_ = sector;
  return Status::kOk;
}

Status LogStore::move_copy(std::uint32_t slot, std::uint32_t to) noexcept {
  const std::uint32_t from = to ^ 1U;
  const Copy copy = sectors_[from].newest[slot];
  Label label;
  if (sectors_[to].next >= places() || read_tail(from, copy.place, label) != Found::kWhole) {
    return Status::kHardwareFault;
  }
  const std::uint32_t place = sectors_[to].next++;
  if (write_label(to, head_at(place), kHead, label) != Status::kOk ||
      copy_bytes(from, bytes_at(copy.place), to, bytes_at(place), label.bytes) != Status::kOk) {
    return Status::kHardwareFault;
  }
  // Before it counts; one that is damaged goes on to say so.
  if (!copy.is_damaged && !holds(to, place, label)) {
    return Status::kHardwareFault;
  }
  if (write_tails(to, place, label) != Status::kOk) {
    return Status::kHardwareFault;
  }
  sectors_[to].newest[slot] = {copy.number, place, copy.bytes, copy.is_damaged};
  return Status::kOk;
}

// Units that cannot be read stay erased.
Status LogStore::copy_bytes(std::uint32_t from, std::uint32_t from_offset, std::uint32_t to,
                            std::uint32_t to_offset, std::uint32_t bytes) noexcept {
  std::array<std::uint8_t, hal::kMaxUnitBytes> room;
  const Span<std::uint8_t> unit = Span<std::uint8_t>(room).first(format().unit_bytes);
  for (std::uint32_t at = 0; at < bytes; at += format().unit_bytes) {
    if (memory_.read_sector(from, from_offset + at, unit) == Status::kOk &&
        memory_.program_unit(to, to_offset + at, unit) != Status::kOk) {
      return Status::kHardwareFault;
    }
  }
  return Status::kOk;
}

Status LogStore::do_read(std::uint32_t slot, std::uint32_t offset,
                         Span<std::uint8_t> bytes) noexcept {
  if (!is_started_) {
    return Status::kHardwareFault;
  }
  if (open_.is_open && open_.label.slot == slot) {
    // It must read back as it will be read, and be erased behind that.
    return memory_.read_sector(active_, bytes_at(open_.place) + offset, bytes);
  }
  const std::uint32_t sector = is_needed(spare(), slot) ? spare() : active_;
  const Copy& copy = sectors_[sector].newest[slot];
  return copy.is_damaged ? Status::kHardwareFault : read_copy(sector, copy, offset, bytes);
}

// Behind the bytes that were programmed the slot is erased, whatever the memory says there.
Status LogStore::read_copy(std::uint32_t sector, const Copy& copy, std::uint32_t offset,
                           Span<std::uint8_t> bytes) noexcept {
  const std::size_t there = copy.bytes > offset ? copy.bytes - offset : 0;
  const Span<std::uint8_t> front = bytes.first(std::min(there, bytes.size()));
  std::fill(bytes.begin() + front.size(), bytes.end(), hal::kErasedByte);
  return front.empty() ? Status::kOk
                       : memory_.read_sector(sector, bytes_at(copy.place) + offset, front);
}

// The copy before it counts until the new one is finished.
Status LogStore::do_erase(std::uint32_t slot) noexcept {
  open_.is_open = false;
  if (!is_started_) {
    return Status::kHardwareFault;
  }
  if (sectors_[active_].next >= places() && move_to(spare()) != Status::kOk) {
    return Status::kHardwareFault;
  }
  Sector& sector = sectors_[active_];
  if (sector.next >= places()) {
    return Status::kHardwareFault;
  }
  const std::uint32_t place = sector.next++;
  ++last_number_;
  open_ = {true, place, {slot, last_number_, 0, 0}, {}};
  const Status begun = write_label(active_, head_at(place), kHead, open_.label);
  open_.is_open = begun == Status::kOk;
  return begun;
}

Status LogStore::do_program(std::uint32_t slot, std::uint32_t offset,
                            Span<const std::uint8_t> unit) noexcept {
  if (!open_.is_open || open_.label.slot != slot || open_.label.bytes != offset) {
    return Status::kHardwareFault;
  }
  open_.crc.add(unit);
  open_.label.bytes += static_cast<std::uint32_t>(unit.size());
  return memory_.program_unit(active_, bytes_at(open_.place) + offset, unit);
}

Status LogStore::do_finish(std::uint32_t slot, Status so_far) noexcept {
  if (!open_.is_open) {
    return Status::kHardwareFault;
  }
  open_.is_open = false;
  if (so_far != Status::kOk) {
    return so_far;
  }
  open_.label.crc = open_.crc.value();
  const Status finished = write_tails(active_, open_.place, open_.label);
  // It counts from its first tail on, at the next power on in any case.
  Label tail;
  if (read_tail(active_, open_.place, tail) == Found::kWhole) {
    sectors_[active_].newest[slot] = {tail.number, open_.place, tail.bytes, false};
  }
  return finished;
}

}  // namespace emax::board
