// Starts a GoogleTest image on an emulated Arm core; newlib's semihosting does the rest: arguments,
// files, exit.

#include <cstdint>
#include <sys/stat.h>

extern "C" {
extern const std::uint32_t emax_stack_top;
[[noreturn]] void _start();
[[noreturn]] void emax_reset();
[[noreturn]] void emax_fault();
int mkdir(const char* path, mode_t mode);
}

namespace {

// Armv7-M Architecture Reference Manual, B3.2.
constexpr std::uintptr_t kConfigurableFaultStatus = 0xe000ed28;
constexpr std::uintptr_t kCoprocessorAccess = 0xe000ed88;
constexpr std::uint32_t kFloatingPointFullAccess = 0xfU << 20U;

// Semihosting for AArch32 and AArch64, Arm IHI 0074.
constexpr std::uint32_t kWriteZeroTerminated = 0x04;
constexpr std::uint32_t kExitExtended = 0x20;
constexpr std::uint32_t kRunTimeError = 0x20023;

volatile std::uint32_t& system_register(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

void semihosting(std::uint32_t operation, const void* parameter) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = parameter;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

using Handler = void (*)();

struct VectorTable {
  const std::uint32_t* stack_top;
  Handler reset;
  Handler faults[5];
};

[[gnu::section(".vectors"), gnu::used]] constexpr VectorTable kVectors = {
    &emax_stack_top, emax_reset, {emax_fault, emax_fault, emax_fault, emax_fault, emax_fault}};

}  // namespace

void emax_reset() {
  system_register(kCoprocessorAccess) = kFloatingPointFullAccess;
  asm volatile("dsb\n isb" ::: "memory");
  _start();
}

// Needs nothing of the C library, which may be what is broken.
void emax_fault() {
  char text[] = "\nfault, configurable fault status 0x........\n";
  std::uint32_t status = system_register(kConfigurableFaultStatus);
  for (std::size_t i = sizeof text - 3; text[i] == '.'; --i) {
    text[i] = "0123456789abcdef"[status % 16];
    status /= 16;
  }
  semihosting(kWriteZeroTerminated, text);
  const std::uint32_t reason_and_status[] = {kRunTimeError, 1};
  semihosting(kExitExtended, reason_and_status);
  for (;;) {
  }
}

// GoogleTest can write its results into a new directory; newlib has no call for that, and nobody
// asks for it here.
int mkdir(const char* /*path*/, mode_t /*mode*/) { return -1; }
