// In the place of the header of this name: memory that a fake DMA finds by a number of 32 bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace emax::test {

/// What has been handed to DMA; its number is the place in here plus 1, times 2^20.
inline std::vector<volatile std::uint32_t*>& dma_memories() {
  static std::vector<volatile std::uint32_t*> memories;
  return memories;
}

inline volatile std::uint32_t* dma_memory(std::uint32_t address) {
  return dma_memories().at((address >> 20U) - 1);
}

}  // namespace emax::test

namespace emax::board {

inline std::uint32_t dma_address(volatile std::uint32_t* memory) {
  auto& memories = test::dma_memories();
  std::size_t at = 0;
  while (at < memories.size() && memories[at] != memory) {
    ++at;
  }
  if (at == memories.size()) {
    memories.push_back(memory);
  }
  return static_cast<std::uint32_t>(at + 1) << 20U;
}

inline void finish_writes() noexcept {}

}  // namespace emax::board
