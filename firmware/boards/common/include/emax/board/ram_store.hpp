// A store in memory that nothing initialises: a stand-in for flash where a machine has none.
#pragma once

#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/hal/store.hpp"

namespace emax::board {

/// What it holds survives a reset, as long as startup leaves the memory alone; it does not survive
/// the loss of power, after which it holds anything.
class RamStore final : public hal::Store {
 public:
  /// @param[in] memory slot_count times slot_bytes, which the object refers to for its life.
  constexpr RamStore(const hal::StoreFormat& format, Span<std::uint8_t> memory) noexcept
      : Store(format), memory_(memory) {}

 private:
  Status do_read(std::uint32_t slot, std::uint32_t offset,
                 Span<std::uint8_t> bytes) noexcept override;
  Status do_erase(std::uint32_t slot) noexcept override;
  Status do_program(std::uint32_t slot, std::uint32_t offset,
                    Span<const std::uint8_t> unit) noexcept override;

  Span<std::uint8_t> from(std::uint32_t slot, std::uint32_t offset) const noexcept {
    return memory_.from(std::size_t{slot} * format().slot_bytes + offset);
  }

  const Span<std::uint8_t> memory_;
};

}  // namespace emax::board
