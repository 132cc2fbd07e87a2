// All exceptions but the one that cannot be masked.
#pragma once

namespace emax::board {

/// Until `unmask_faults()` no interrupt comes and a fault of the bus can be let pass.
inline void mask_faults() noexcept { asm volatile("cpsid f\ndsb\nisb" ::: "memory"); }
inline void unmask_faults() noexcept { asm volatile("dsb\ncpsie f\nisb" ::: "memory"); }

}  // namespace emax::board
