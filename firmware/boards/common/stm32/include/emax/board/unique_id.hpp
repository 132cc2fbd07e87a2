// The number that each STM32 has of its maker.
#pragma once

#include <array>
#include <cstdint>

namespace emax::board {

/// 24 hexadecimal digits and a zero at the end.
using UniqueIdText = std::array<char, 25>;

/// @param[in] address Of its three words, of which the first is shown first.
UniqueIdText read_unique_id(std::uintptr_t address) noexcept;

}  // namespace emax::board
