// The instrument's hardware in a browser.
#include "ports.hpp"

#include <algorithm>

namespace emax::web {

Status PageStore::do_erase(std::uint32_t slot) noexcept {
  std::uint8_t erased[hal::kMaxUnitBytes];
  std::fill_n(erased, sizeof(erased), hal::kErasedByte);
  for (std::uint32_t offset = 0; offset < format().slot_bytes;) {
    const std::uint32_t left = format().slot_bytes - offset;
    const std::uint32_t count = std::min<std::uint32_t>(left, sizeof(erased));
    emax_store_write(at(slot, offset), erased, count);
    offset += count;
  }
  return Status::kOk;
}

}  // namespace emax::web
