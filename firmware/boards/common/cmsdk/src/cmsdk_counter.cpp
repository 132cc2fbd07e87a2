// A timer of the Cortex-M System Design Kit, of 32 bits: an instruction takes 64 ns of the
// emulator's time, a tick 40 ns.
#include "emax/board/instruction_counter.hpp"
#include "emax/board/registers.hpp"

namespace emax::cost {
namespace {

constexpr std::uintptr_t kTimer0 = 0x40000000;
constexpr std::uintptr_t kControl = kTimer0 + 0x00;
constexpr std::uintptr_t kValue = kTimer0 + 0x04;
constexpr std::uintptr_t kReload = kTimer0 + 0x08;
constexpr std::uint32_t kEnable = 1;
constexpr std::uint32_t kMaxCount = 0xFFFFFFFF;

constexpr std::uint64_t kTickNanoseconds = 40;
constexpr std::uint64_t kInstructionNanoseconds = 64;

}  // namespace

void start_counter() noexcept {
  board::reg(kReload) = kMaxCount;
  board::reg(kValue) = kMaxCount;
  board::reg(kControl) = kEnable;
}

Ticks now() noexcept {
  asm volatile("" ::: "memory");
  const std::uint32_t value = kMaxCount - board::reg(kValue);
  asm volatile("" ::: "memory");
  return value;
}

Ticks passed(Ticks from, Ticks to) noexcept { return static_cast<std::uint32_t>(to - from); }

std::uint64_t instructions_of(Ticks ticks) noexcept {
  return (ticks * kTickNanoseconds + kInstructionNanoseconds / 2) / kInstructionNanoseconds;
}

}  // namespace emax::cost
