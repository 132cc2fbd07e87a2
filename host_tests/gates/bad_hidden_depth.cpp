// Keeps the stack pointer in memory, as every address of a local variable may be. That must not
// pass for a change to another stack: what comes after it adds to what was there, and the stack
// gate must refuse it.
extern "C" int main();

namespace {

volatile unsigned kept = 0;

[[gnu::noinline]] int take_the_rest() {
  volatile char bytes[5000];
  for (volatile char& byte : bytes) {
    byte = 1;
  }
  return bytes[1];
}

}  // namespace

int main() {
  volatile char bytes[5000];
  bytes[0] = 1;
#if defined(__riscv)
  asm volatile("sw sp, 0(%0)" : : "r"(&kept) : "memory");
#else
  asm volatile("str.w sp, [%0]" : : "r"(&kept) : "memory");
#endif
  return take_the_rest() + bytes[0] + static_cast<int>(kept);
}
