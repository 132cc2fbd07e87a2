// Semihosting calls: an instruction that the emulator knows, with a number and an address.
#include "emax/board/semihosting.hpp"

#include <cstdint>

#include "emax/board/fault_report.hpp"

namespace emax::board {
namespace {

constexpr std::uint32_t kWriteText = 0x04;
constexpr std::uint32_t kGetCommandLine = 0x15;
constexpr std::uint32_t kExitExtended = 0x20;
constexpr std::uint32_t kApplicationExit = 0x20026;

#if defined(__riscv)
std::uint32_t call(std::uint32_t operation, const volatile void* argument) noexcept {
  register std::uint32_t a0 asm("a0") = operation;
  register const volatile void* a1 asm("a1") = argument;
  // The three must be whole words next to one another, in one page.
  asm volatile(
      ".option push\n"
      ".option norvc\n"
      ".balign 16\n"
      "slli x0, x0, 0x1f\n"
      "ebreak\n"
      "srai x0, x0, 7\n"
      ".option pop"
      : "+r"(a0)
      : "r"(a1)
      : "memory");
  return a0;
}
#else
std::uint32_t call(std::uint32_t operation, const volatile void* argument) noexcept {
  register std::uint32_t r0 asm("r0") = operation;
  register const volatile void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}
#endif

}  // namespace

std::size_t read_command_line(Span<char> text) noexcept {
  struct {
    char* text;
    std::size_t size;
  } block = {text.data(), text.size()};
  return call(kGetCommandLine, &block) == 0 ? block.size : 0;
}

void tell_emulator(const char* text) noexcept { (void)call(kWriteText, text); }

void end_emulation(int status) noexcept {
  const std::uint32_t block[] = {kApplicationExit, static_cast<std::uint32_t>(status)};
  for (;;) {
    (void)call(kExitExtended, block);
  }
}

void stop(int status) noexcept { end_emulation(status); }

}  // namespace emax::board
