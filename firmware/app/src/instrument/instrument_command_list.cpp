// The command table for people who read: apart from the rest, so that a board does not hold its
// texts.
#include "instrument_table.hpp"

namespace emax::app {

Span<const scpi::Command<Instrument>> Instrument::commands() noexcept {
  return Span<const scpi::Command<Instrument>>(kCommands.rows);
}

}  // namespace emax::app
