// How much a board keeps: the records of the instrument, each twice.
#pragma once

#include <cstdint>

#include "emax/app/store/record_store.hpp"
#include "emax/app/store/saved_state.hpp"
#include "emax/hal/store.hpp"

namespace emax::board {

inline constexpr std::uint32_t kUnitBytes = 8;
inline constexpr std::uint32_t kSlotBytes =
    (app::kMaxSavedSettingsBytes + app::RecordStore::kFrameBytes + kUnitBytes - 1) / kUnitBytes *
    kUnitBytes;
static_assert(kSlotBytes >= app::kSavedIdentificationBytes + app::RecordStore::kFrameBytes);

inline constexpr hal::StoreFormat kStoreFormat = {2 * app::kSavedRecords, kSlotBytes, kUnitBytes};

}  // namespace emax::board
