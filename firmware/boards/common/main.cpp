// The product: the instrument behind the console of a board.
#include <cstdint>

#include "emax/app/base/in_place.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/board/board.hpp"
#include "emax/board/stack_mark.hpp"
#include "emax/board/startup.hpp"
#include "emax/sim/sim_bench.hpp"

namespace emax::board {
namespace {

app::MemoryUse memory_use() noexcept {
  const Span<const std::uint32_t> words = stack();
  return {static_cast<std::uint32_t>(static_bytes()),
          static_cast<std::uint32_t>(words.size() * sizeof(std::uint32_t)),
          static_cast<std::uint32_t>(used_stack_bytes(words))};
}

[[noreturn]] void run() noexcept {
  static app::SimulatedBench simulated;
  static app::InPlace<app::Instrument> instrument_memory;
  Board& hardware = board();
  (void)hardware.start();  // A bench that is not there answers so to whoever starts a sweep.
  const sim::Device& device = hardware.stream().settings().device;
  simulated = {hardware.stream().settings().seed,
               {device.sensitivity, device.natural_frequency_hz, device.damping}};
  const app::Ports ports = {hardware.stream(), hardware.console(), hardware.clock(),
                            &hardware.watchdog(), &hardware.store()};
  app::Board about;
  about.name = EMAX_BOARD_NAME;
  about.simulated = &simulated;
  about.memory_use = memory_use;
  app::Instrument& instrument = instrument_memory.make(ports, about);
  instrument.start();
  for (;;) {
    instrument.poll();
  }
}

}  // namespace
}  // namespace emax::board

extern "C" int main() { emax::board::run(); }
