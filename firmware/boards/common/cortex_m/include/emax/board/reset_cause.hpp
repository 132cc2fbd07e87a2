// What one run of the program leaves to the next, where no register tells the cause of a reset.
#pragma once

namespace emax::board {

/// Before the watchdog's reset.
void remember_watchdog_reset() noexcept;

/// @returns Whether that came before this run. Forgets it.
bool take_watchdog_reset() noexcept;

}  // namespace emax::board
