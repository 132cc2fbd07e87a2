// How much of the stack has been used: startup marks it, and the marks that are left are counted.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"

namespace emax::board {

inline constexpr std::uint32_t kStackMark = 0xA5C35A3C;

/// Sets all words to kStackMark.
void mark_stack(Span<std::uint32_t> words) noexcept;

/// @param[in] words The stack, the word that is used last at the front.
/// @returns The bytes from the first word that is no mark to the end.
std::size_t used_stack_bytes(Span<const std::uint32_t> words) noexcept;

/// The stack of this board, of which the linker script says where it is.
Span<std::uint32_t> stack() noexcept;

/// Below the stack, without access for anybody: what overflows ends here.
inline constexpr std::uint32_t kGuardBytes = 4096;

/// @returns Whether this address is in there.
bool is_in_stack_guard(std::uintptr_t address) noexcept;

}  // namespace emax::board
