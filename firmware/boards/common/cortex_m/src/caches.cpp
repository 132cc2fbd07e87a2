// From anything in them to nothing, and on (Armv7-M Architecture Reference Manual, B2.2.7, B3.2.8).
#include "emax/board/caches.hpp"

#include <cstdint>

#include "emax/board/registers.hpp"

namespace emax::board {
namespace {

constexpr std::uintptr_t kConfiguration = 0xE000ED14;
constexpr std::uintptr_t kInvalidateInstructions = 0xE000EF50;
constexpr std::uintptr_t kInvalidateLine = 0xE000EF60;
constexpr std::uint32_t kDataCache = 1U << 16;
constexpr std::uint32_t kInstructionCache = 1U << 17;

// 16 KiB: four ways of 128 lines of 32 bytes.
constexpr std::uint32_t kWays = 4;
constexpr std::uint32_t kLines = 128;
constexpr unsigned kWayAt = 30;
constexpr unsigned kLineAt = 5;

void finish() noexcept { asm volatile("dsb\nisb" ::: "memory"); }

}  // namespace

void start_caches() noexcept {
  finish();
  reg(kInvalidateInstructions) = 0;
  for (std::uint32_t way = 0; way < kWays; ++way) {
    for (std::uint32_t line = 0; line < kLines; ++line) {
      reg(kInvalidateLine) = way << kWayAt | line << kLineAt;
    }
  }
  finish();
  reg(kConfiguration) |= kInstructionCache | kDataCache;
  finish();
}

}  // namespace emax::board
