// What of an STM32H743's memory is cached.
#pragma once

namespace emax::board {

/// Regions of the memory protection unit, and then the caches: SRAM1, which DMA works on, and bank
/// 2 of the flash memory, which has the records, are not cached; where nothing answers, nothing is
/// read ahead. The clock of SRAM1 is on.
void start_memory() noexcept;

}  // namespace emax::board
