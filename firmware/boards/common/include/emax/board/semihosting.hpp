// What test images ask of the emulator, or the debugger, that runs them. Without one, each call is
// a fault: no product has them.
#pragma once

#include <cstddef>

#include "emax/base/span.hpp"

namespace emax::board {

/// Reads the arguments that the image was given, with single blanks between them.
///
/// @returns The number of characters; 0 if there are none, or if there is too little room.
std::size_t read_command_line(Span<char> text) noexcept;

/// Prints on the emulator's own console, its standard error, not on that of the board.
///
/// @param[in] text Ends with a zero.
void tell_emulator(const char* text) noexcept;

/// Ends the emulation with this exit status, 0 to 255.
[[noreturn]] void end_emulation(int status) noexcept;

}  // namespace emax::board
