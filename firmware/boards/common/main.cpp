// The product: the instrument behind the console of a board.
#include <cstdint>

#include "emax/app/base/in_place.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/board/board.hpp"
#include "emax/board/stack_mark.hpp"
#include "emax/board/startup.hpp"

namespace emax::board {
namespace {

app::MemoryUse memory_use() noexcept {
  const Span<const std::uint32_t> words = stack();
  return {static_cast<std::uint32_t>(static_bytes()),
          static_cast<std::uint32_t>(words.size() * sizeof(std::uint32_t)),
          static_cast<std::uint32_t>(used_stack_bytes(words))};
}

[[noreturn]] void run() noexcept {
  static app::InPlace<app::Instrument> instrument_memory;
  (void)start_board();  // A bench that is not there answers so to whoever starts a sweep.
  app::Board board = about();
  board.memory_use = memory_use;
  app::Instrument& instrument = instrument_memory.make(ports(), board);
  instrument.start();
  for (;;) {
    instrument.poll();
    if (!instrument.is_busy() && !instrument.wants_to_write()) {
      rest();
    }
  }
}

}  // namespace
}  // namespace emax::board

extern "C" int main() { emax::board::run(); }
