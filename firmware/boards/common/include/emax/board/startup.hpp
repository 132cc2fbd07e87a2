// From the reset to main(), as far as it is the same on every processor.
#pragma once

#include <cstddef>

namespace emax::board {

/// Fills .data, clears .bss, marks the stack below the caller, runs main(), and stops should that
/// return. The stack, and the floating point unit if there is one, are ready.
[[noreturn]] void run_program() noexcept;

/// @returns What the image takes of the RAM, without the stack.
std::size_t static_bytes() noexcept;

/// Of the board, or of its core: starts it anew, as its reset button would.
[[noreturn]] void reset() noexcept;

}  // namespace emax::board
