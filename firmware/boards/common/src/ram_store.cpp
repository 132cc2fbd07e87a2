// Slots in RAM.
#include "emax/board/ram_store.hpp"

#include <algorithm>

namespace emax::board {

Status RamStore::do_read(std::uint32_t slot, std::uint32_t offset,
                         Span<std::uint8_t> bytes) noexcept {
  std::copy_n(from(slot, offset).begin(), bytes.size(), bytes.begin());
  return Status::kOk;
}

Status RamStore::do_erase(std::uint32_t slot) noexcept {
  std::fill_n(from(slot, 0).begin(), format().slot_bytes, hal::kErasedByte);
  return Status::kOk;
}

Status RamStore::do_program(std::uint32_t slot, std::uint32_t offset,
                            Span<const std::uint8_t> unit) noexcept {
  std::copy_n(unit.begin(), unit.size(), from(slot, offset).begin());
  return Status::kOk;
}

}  // namespace emax::board
