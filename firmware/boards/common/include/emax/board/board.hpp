// What a board hands over to whatever runs on it. Each board defines these functions, and those
// marked "Of the board" in fault_report.hpp and startup.hpp.
#pragma once

#include "emax/app/instrument/instrument.hpp"
#include "emax/base/status.hpp"

namespace emax::board {

/// Starts clock, console and analog side. Once, first of all.
///
/// @returns kOk, or why the analog side cannot work; console, clock and store do in any case.
Status start_board() noexcept;

/// What the instrument gets of the board; all of it lives as long as the program.
const app::Ports& ports() noexcept;

/// Name and serial number, the bench's defaults, and what a simulated bench was built from. After
/// `start_board()`; `memory_use` is left to the image.
const app::Board& about() noexcept;

/// For a program that has nothing to do: may wait for an interrupt, for a tenth of a second at
/// most. Does not wait once a byte has come in.
void rest() noexcept;

/// @returns True if all that was written to the console has gone out.
bool console_sent() noexcept;

}  // namespace emax::board
