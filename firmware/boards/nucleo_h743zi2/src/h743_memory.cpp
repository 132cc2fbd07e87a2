// The memory map as the processor's caches see it.
#include "emax/board/h743_memory.hpp"

#include <cstdint>

#include "emax/board/caches.hpp"
#include "emax/board/cortex_m.hpp"
#include "emax/board/h743.hpp"

namespace emax::board {
namespace {

// Armv7-M Architecture Reference Manual, B3.5.9: never executed (28), access of all (24, 3) or of
// none, type (19), shared (18), cached (17), buffered (16), log2 of the size less one (1).
constexpr std::uint32_t kNeverExecuted = 1U << 28;
constexpr std::uint32_t kForAll = 3U << 24;
constexpr std::uint32_t kNormalNotCached = 1U << 19 | 1U << 18;
constexpr std::uint32_t kDevice = 1U << 18 | 1U << 16;
constexpr std::uint32_t size_of(unsigned log2) noexcept { return (log2 - 1) << 1U; }

constexpr std::uintptr_t kExternal1 = 0x60000000;
constexpr std::uintptr_t kExternal2 = 0x80000000;

}  // namespace

void start_memory() noexcept {
  // 128 KiB.
  set_memory_region(2, kSram1, kNeverExecuted | kForAll | kNormalNotCached | size_of(17));
  // 1 MiB. As a device it is not read ahead either, which could find what cannot be corrected.
  set_memory_region(3, kFlashBank2, kNeverExecuted | kForAll | kDevice | size_of(20));
  // Twice 512 MiB, where a board could have external memory: this one has none.
  set_memory_region(4, kExternal1, kNeverExecuted | size_of(29));
  set_memory_region(5, kExternal2, kNeverExecuted | size_of(29));
  start_caches();
}

}  // namespace emax::board
