// The two last sectors of an STM32H743's flash memory, which have the records.
#pragma once

#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/board/log_store.hpp"
#include "emax/board/store_format.hpp"

namespace emax::board {

inline constexpr std::uint32_t kH743SectorBytes = 128 * 1024;
inline constexpr std::uint32_t kH743UnitBytes = 32;
inline constexpr hal::StoreFormat kH743StoreFormat = store_format(kH743UnitBytes);

/// Sectors 6 and 7 of bank 2; code runs on in bank 1 while one is erased, for a second or two, or a
/// unit is programmed. What a power cut has left half programmed, the memory cannot correct: a read
/// of it is a bus fault, which is caught here and told. The memory must not be cached.
class H743Sectors final : public SectorPair {
 public:
  constexpr H743Sectors() noexcept = default;

  Status read_sector(std::uint32_t sector, std::uint32_t offset,
                     Span<std::uint8_t> bytes) noexcept override;
  Status erase_sector(std::uint32_t sector) noexcept override;
  Status program_unit(std::uint32_t sector, std::uint32_t offset,
                      Span<const std::uint8_t> unit) noexcept override;
};

}  // namespace emax::board
