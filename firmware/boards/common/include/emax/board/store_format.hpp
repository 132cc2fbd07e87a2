// How much a board keeps: the records of the instrument, each twice.
#pragma once

#include <cstdint>

#include "emax/app/store/record_store.hpp"
#include "emax/app/store/saved_state.hpp"
#include "emax/hal/store.hpp"

namespace emax::board {

inline constexpr std::uint32_t kRecordBytes =
    app::kMaxSavedSettingsBytes + app::RecordStore::kFrameBytes;
static_assert(kRecordBytes >= app::kSavedIdentificationBytes + app::RecordStore::kFrameBytes);

/// @param[in] unit_bytes What the board's memory programs at once.
constexpr hal::StoreFormat store_format(std::uint32_t unit_bytes) noexcept {
  return {2 * app::kSavedRecords, (kRecordBytes + unit_bytes - 1) / unit_bytes * unit_bytes,
          unit_bytes};
}

/// Of boards that program double words, or whose memory takes anything.
inline constexpr hal::StoreFormat kStoreFormat = store_format(8);

}  // namespace emax::board
