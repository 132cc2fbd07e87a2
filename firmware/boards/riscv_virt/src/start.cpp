// The first instructions of a RISC-V core, its faults and its interrupts.
#include <cstddef>
#include <cstdint>

#include "emax/board/fault_report.hpp"
#include "emax/board/riscv.hpp"
#include "emax/board/stack_mark.hpp"
#include "emax/board/startup.hpp"

namespace emax::board {

extern "C" {

// Called from assembler, or by the reset.
void start();
void on_trap();
void run_on_riscv();
void end_in_fault(std::uint32_t sp, std::uint32_t ra);
void serve_interrupt();
}

namespace {

constexpr std::uint32_t kMachineInterrupts = 1U << 3;
constexpr std::uint32_t kExternalInterrupts = 1U << 11;

// Physical memory protection: locked regions, so that they bind machine mode too, of a power of two
// at their natural alignment; without access, and for reading and executing.
constexpr std::uint32_t kGuardRegion = 0x98;
constexpr std::uint32_t kCodeRegion = 0x9D;
constexpr std::uint32_t kCodeBytes = 256 * 1024;

constexpr std::uint32_t kStoreAccess = 7;

const char* name_of_cause(std::uint32_t cause, std::uint32_t value) noexcept {
  if (cause == kStoreAccess && is_in_stack_guard(value)) {
    return "stack overflow";
  }
  constexpr const char* kNames[] = {
      "misaligned instruction", "instruction access", "illegal instruction", "breakpoint",
      "misaligned load",        "load access",        "misaligned store",    "store access"};
  return cause < 8 ? kNames[cause] : "trap";
}

constexpr std::uintptr_t region(std::uintptr_t begin, std::uintptr_t bytes) {
  return begin >> 2U | (bytes / 8 - 1);
}

// Nobody touches what is below the stack, and nobody writes to the code: it is RAM, so that would
// go unnoticed.
void guard_memory() noexcept {
  const auto limit = reinterpret_cast<std::uintptr_t>(stack().begin());
  const auto code = reinterpret_cast<std::uintptr_t>(&start);
  asm volatile("csrw pmpaddr0, %0" ::"r"(region(limit - kGuardBytes, kGuardBytes)));
  asm volatile("csrw pmpaddr1, %0" ::"r"(region(code, kCodeBytes)));
  asm volatile("csrw pmpcfg0, %0" ::"r"(kCodeRegion << 8U | kGuardRegion));
}

}  // namespace

extern "C" {

[[gnu::naked, gnu::section(".start")]] void start() {
  asm volatile(
      ".option push\n"
      ".option norelax\n"
      "la gp, __global_pointer$\n"
      ".option pop\n"
      "la sp, stack_top\n"
      "la t0, on_trap\n"
      "csrw mtvec, t0\n"
      "li t0, 0x2000\n"  // mstatus.FS: the floating point unit.
      "csrs mstatus, t0\n"
      "csrw fcsr, zero\n"
      "j run_on_riscv\n");
}

// A fault goes to a stack of its own, as the other one may be what has failed.
[[gnu::naked, gnu::aligned(4)]] void on_trap() {
  asm volatile(
      "csrw mscratch, t0\n"
      "csrr t0, mcause\n"
      "bgez t0, 1f\n"
      "csrr t0, mscratch\n"
      "j serve_interrupt\n"
      "1:\n"
      "mv a0, sp\n"
      "mv a1, ra\n"
      "la sp, fault_stack_top\n"
      "j end_in_fault\n");
}

void run_on_riscv() {
  guard_memory();
  run_program();
}

void end_in_fault(std::uint32_t sp, std::uint32_t ra) {
  std::uint32_t cause = 0;
  std::uint32_t pc = 0;
  std::uint32_t value = 0;
  std::uint32_t status = 0;
  asm volatile("csrr %0, mcause" : "=r"(cause));
  asm volatile("csrr %0, mepc" : "=r"(pc));
  asm volatile("csrr %0, mtval" : "=r"(value));
  asm volatile("csrr %0, mstatus" : "=r"(status));
  const FaultNumber numbers[] = {{"mcause", cause}, {"pc", pc},       {"ra", ra},
                                 {"sp", sp},        {"mtval", value}, {"mstatus", status}};
  report_fault(name_of_cause(cause, value), numbers);
  stop(kFaultStatus);
}

[[gnu::interrupt("machine")]] void serve_interrupt() { on_external_interrupt(); }
}

void enable_external_interrupts() noexcept {
  asm volatile("csrs mie, %0" ::"r"(kExternalInterrupts));
  asm volatile("csrs mstatus, %0" ::"r"(kMachineInterrupts));
}

}  // namespace emax::board
