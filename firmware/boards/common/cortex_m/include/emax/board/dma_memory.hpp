// Memory that the program shares with DMA.
#pragma once

#include <cstdint>

namespace emax::board {

/// Of a variable, as a channel of DMA takes it.
inline std::uint32_t dma_address(const volatile std::uint32_t* memory) noexcept {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(memory));
}

/// What was written to memory is there before anything else happens.
inline void finish_writes() noexcept { asm volatile("dsb" ::: "memory"); }

}  // namespace emax::board
