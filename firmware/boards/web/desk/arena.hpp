// The memory of the module that reads tables and compares: a fixed piece, begun anew by each call.
#pragma once

#include <cstddef>

namespace emax::web {

inline constexpr std::size_t kArenaBytes = std::size_t{48} << 20;

/// Forgets all that was taken; nothing may still refer to it.
void clear_arena() noexcept;

/// @returns Memory that stays until `clear_arena()`. Never null: without room the module ends.
void* take_from_arena(std::size_t size) noexcept;

}  // namespace emax::web
