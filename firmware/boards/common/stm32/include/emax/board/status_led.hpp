// What the one LED of a board says.
#pragma once

#include <cstdint>

namespace emax::board {

enum class LedState : std::uint8_t {
  kReady,          ///< A short flash every two seconds.
  kDriving,        ///< Even, once a second: the stream runs, and the shaker may move.
  kCannotMeasure,  ///< Fast, five times a second: no crystal, or no watchdog.
  kFault,          ///< Steady: the program has stopped.
};

/// @param[in] tick Tenths of a second since any moment.
/// @returns Whether the LED is on.
bool is_led_on(LedState state, std::uint32_t tick) noexcept;

}  // namespace emax::board
