// The contract of the store, checked once for all boards.
#include "emax/hal/store.hpp"

#include <algorithm>
#include <array>

namespace emax::hal {
namespace {

constexpr bool usable(const StoreFormat& format) {
  return format.slot_count >= 1 && format.unit_bytes >= 1 && format.unit_bytes <= kMaxUnitBytes &&
         format.slot_bytes >= format.unit_bytes && format.slot_bytes % format.unit_bytes == 0;
}

using Unit = std::array<std::uint8_t, kMaxUnitBytes>;

}  // namespace

Status Store::read(std::uint32_t slot, std::uint32_t offset, Span<std::uint8_t> bytes) noexcept {
  if (!holds(slot, bytes.size()) || offset > format_.slot_bytes - bytes.size()) {
    return Status::kInvalidArgument;
  }
  if (bytes.empty()) {
    return Status::kOk;
  }
  return do_read(slot, offset, bytes) == Status::kOk ? Status::kOk : Status::kHardwareFault;
}

Status Store::write(std::uint32_t slot, Span<const std::uint8_t> bytes) noexcept {
  if (!holds(slot, bytes.size())) {
    return Status::kInvalidArgument;
  }
  if (!usable(format_) || do_erase(slot) != Status::kOk) {
    return Status::kHardwareFault;
  }
  const Status programmed = program(slot, bytes);
  return do_finish(slot, programmed == Status::kOk ? verify(slot, bytes) : programmed);
}

bool Store::holds(std::uint32_t slot, std::size_t bytes) const noexcept {
  return slot < format_.slot_count && bytes <= format_.slot_bytes;
}

Status Store::program(std::uint32_t slot, Span<const std::uint8_t> bytes) noexcept {
  Unit unit;
  const Span<const std::uint8_t> filled = Span<const std::uint8_t>(unit).first(format_.unit_bytes);
  for (std::uint32_t offset = 0; offset < bytes.size(); offset += format_.unit_bytes) {
    const std::size_t count = std::min<std::size_t>(bytes.size() - offset, format_.unit_bytes);
    unit.fill(kErasedByte);
    std::copy_n(bytes.data() + offset, count, unit.data());
    if (do_program(slot, offset, filled) != Status::kOk) {
      return Status::kHardwareFault;
    }
  }
  return Status::kOk;
}

Status Store::verify(std::uint32_t slot, Span<const std::uint8_t> bytes) noexcept {
  Unit unit;
  const Span<std::uint8_t> found = Span<std::uint8_t>(unit).first(format_.unit_bytes);
  for (std::uint32_t offset = 0; offset < format_.slot_bytes; offset += format_.unit_bytes) {
    if (do_read(slot, offset, found) != Status::kOk) {
      return Status::kHardwareFault;
    }
    for (std::uint32_t i = 0; i < format_.unit_bytes; ++i) {
      const std::size_t at = std::size_t{offset} + i;
      if (unit[i] != (at < bytes.size() ? bytes[at] : kErasedByte)) {
        return Status::kHardwareFault;
      }
    }
  }
  return Status::kOk;
}

}  // namespace emax::hal
