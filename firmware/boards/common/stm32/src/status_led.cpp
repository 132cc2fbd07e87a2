// Patterns of tenths of a second.
#include "emax/board/status_led.hpp"

namespace emax::board {

bool is_led_on(LedState state, std::uint32_t tick) noexcept {
  switch (state) {
    case LedState::kReady:
      return tick % 20 == 0;
    case LedState::kDriving:
      return tick % 10 < 5;
    case LedState::kCannotMeasure:
      return tick % 2 == 0;
    case LedState::kFault:
      break;
  }
  return true;
}

}  // namespace emax::board
