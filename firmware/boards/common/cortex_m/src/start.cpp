// The first instructions of a Cortex-M, its faults, and its reset.
#include <algorithm>
#include <array>
#include <cstdint>

#include "emax/board/cortex_m.hpp"
#include "emax/board/fault_report.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/reset_cause.hpp"
#include "emax/board/stack_mark.hpp"
#include "emax/board/startup.hpp"

namespace emax::board {
namespace {

// System control block, Armv7-M Architecture Reference Manual B3.2.
constexpr std::uintptr_t kIcsr = 0xE000ED04;
constexpr std::uintptr_t kVtor = 0xE000ED08;
constexpr std::uintptr_t kAircr = 0xE000ED0C;
constexpr std::uintptr_t kCcr = 0xE000ED14;
constexpr std::uintptr_t kShcsr = 0xE000ED24;
constexpr std::uintptr_t kCfsr = 0xE000ED28;
constexpr std::uintptr_t kHfsr = 0xE000ED2C;
constexpr std::uintptr_t kMmfar = 0xE000ED34;
constexpr std::uintptr_t kBfar = 0xE000ED38;

constexpr std::uint32_t kDivideByZeroTrap = 1U << 4;
constexpr std::uint32_t kUsageBusMemoryFaults = 7U << 16;
constexpr std::uint32_t kResetRequest = 0x05FA0004;

// Memory protection unit, B3.5.
constexpr std::uintptr_t kMpuControl = 0xE000ED94;
constexpr std::uintptr_t kMpuBase = 0xE000ED9C;
constexpr std::uintptr_t kMpuSize = 0xE000EDA0;
constexpr std::uint32_t kMpuEnable = 1U << 0;
constexpr std::uint32_t kMpuDefaultMap = 1U << 2;
constexpr std::uint32_t kMpuBaseValid = 1U << 4;
// Log2 of the size less one, and the access: none and never executed, or reading and executing.
// Code is normal memory, as without the unit: a Cortex-M7 caches it, and takes it where it is not
// aligned.
constexpr std::uint32_t kWriteThrough = 1U << 17;
constexpr std::uint32_t kGuardRegion = (11U << 1) | (1U << 28) | 1U;
constexpr std::uint32_t kCodeRegion = (17U << 1) | (6U << 24) | kWriteThrough | 1U;
static_assert(kGuardBytes == 1U << 12);

constexpr std::uint32_t kExceptionMask = 0x1FF;
constexpr std::uint32_t kMemManage = 4;

constexpr std::size_t kFrameWords = 8;
constexpr std::size_t kFrameLr = 5;
constexpr std::size_t kFramePc = 6;
constexpr std::size_t kFrameStatus = 7;

std::uint32_t active_exception() noexcept { return reg(kIcsr) & kExceptionMask; }

const char* name_of_exception(std::uint32_t number) noexcept {
  constexpr const char* kNames[] = {"NMI", "HardFault", "MemManage", "BusFault", "UsageFault"};
  if (number == kMemManage && is_in_stack_guard(reg(kMmfar))) {
    return "stack overflow";
  }
  return number >= 2 && number <= 6 ? kNames[number - 2] : "unexpected interrupt";
}

// What the processor has put on the stack, if it could.
bool holds_frame(const std::uint32_t* frame) noexcept {
  const auto at = reinterpret_cast<std::uintptr_t>(frame);
  const auto begin = reinterpret_cast<std::uintptr_t>(stack().begin());
  const auto end = reinterpret_cast<std::uintptr_t>(stack().end());
  return at >= begin && at + kFrameWords * sizeof(std::uint32_t) <= end;
}

void report_frame(const char* kind, const std::uint32_t* frame) noexcept {
  std::array<std::uint32_t, kFrameWords> stacked = {};
  if (holds_frame(frame)) {
    std::copy_n(frame, kFrameWords, stacked.begin());
  }
  const FaultNumber numbers[] = {
      {"exception", active_exception()},
      {"pc", stacked[kFramePc]},
      {"lr", stacked[kFrameLr]},
      {"psr", stacked[kFrameStatus]},
      {"sp", static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(frame))},
      {"cfsr", reg(kCfsr)},
      {"hfsr", reg(kHfsr)},
      {"mmfar", reg(kMmfar)},
      {"bfar", reg(kBfar)},
  };
  report_fault(kind, numbers);
}

// Nobody touches what is below the stack, and nobody writes to the code: where it is RAM that would
// go unnoticed, and so would a write through a null pointer.
void guard_memory() noexcept {
  const auto limit = reinterpret_cast<std::uintptr_t>(stack().begin());
  reg(kMpuBase) = (limit - kGuardBytes) | kMpuBaseValid | 0;
  reg(kMpuSize) = kGuardRegion;
  reg(kMpuBase) = reinterpret_cast<std::uintptr_t>(&vectors) | kMpuBaseValid | 1;
  reg(kMpuSize) = kCodeRegion;
  reg(kMpuControl) = kMpuEnable | kMpuDefaultMap;
  asm volatile("dsb\nisb" ::: "memory");
}

}  // namespace

extern "C" {

// Called from assembler.
void run_on_cortex_m();
void end_in_fault(const std::uint32_t* frame);
void end_in_reset(const std::uint32_t* frame);

[[gnu::naked]] void start() {
  asm volatile(
      "ldr r0, =0xE000ED88\n"  // CPACR: full access to the floating point unit.
      "ldr r1, [r0]\n"
      "orr r1, r1, #0xF00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "b run_on_cortex_m\n");
}

[[gnu::naked]] void on_fault() {
  asm volatile(
      "mrs r0, msp\n"
      "ldr r1, =fault_stack_top\n"
      "msr msp, r1\n"
      "b end_in_fault\n");
}

[[gnu::naked]] void on_watchdog() {
  asm volatile(
      "mrs r0, msp\n"
      "ldr r1, =fault_stack_top\n"
      "msr msp, r1\n"
      "b end_in_reset\n");
}

void run_on_cortex_m() {
  reg(kVtor) = reinterpret_cast<std::uintptr_t>(&vectors);
  reg(kShcsr) |= kUsageBusMemoryFaults;
  reg(kCcr) |= kDivideByZeroTrap;
  guard_memory();
  run_program();
}

void end_in_fault(const std::uint32_t* frame) {
  report_frame(name_of_exception(active_exception()), frame);
  stop(kFaultStatus);
}

void end_in_reset(const std::uint32_t* frame) {
  report_frame("watchdog", frame);
  remember_watchdog_reset();
  reset();
}
}

void set_memory_region(std::uint32_t number, std::uintptr_t base,
                       std::uint32_t attributes) noexcept {
  constexpr std::uint32_t kRegionEnable = 1U << 0;
  asm volatile("dsb" ::: "memory");
  reg(kMpuBase) = base | kMpuBaseValid | number;
  reg(kMpuSize) = attributes | kRegionEnable;
  asm volatile("dsb\nisb" ::: "memory");
}

void reset() noexcept {
  asm volatile("dsb" ::: "memory");
  reg(kAircr) = kResetRequest;
  asm volatile("dsb" ::: "memory");
  for (;;) {
  }
}

}  // namespace emax::board
