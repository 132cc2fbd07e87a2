// The caches of a Cortex-M7.
#pragma once

namespace emax::board {

/// Once, with nothing in them yet: both on. What DMA or a flash memory's programming changes must
/// be in a region that is not cached, before.
void start_caches() noexcept;

}  // namespace emax::board
