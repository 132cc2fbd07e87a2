// Interrupts that interrupt one another, each of which alone would fit: the stack gate must refuse
// it.
extern "C" {
int main();
void bad_interrupt();
void worse_interrupt();
}

namespace {

void take_stack() {
  volatile char bytes[5000];
  for (volatile char& byte : bytes) {
    byte = 1;
  }
}

}  // namespace

#if defined(__riscv)
[[gnu::interrupt("machine"), gnu::aligned(4)]] void bad_interrupt() {
  unsigned cause = 0;
  asm volatile("csrr %0, mepc\n\tcsrsi mstatus, 8" : "=r"(cause));
  take_stack();
  asm volatile("csrci mstatus, 8\n\tcsrw mepc, %0" : : "r"(cause));
}
void worse_interrupt() {}

int main() {
  asm volatile("la t0, bad_interrupt\n\tcsrw mtvec, t0" : : : "t0");
  for (;;) {
  }
}
#else
void bad_interrupt() { take_stack(); }
void worse_interrupt() { take_stack(); }

int main() {
  *reinterpret_cast<volatile unsigned char*>(0xE000E400) = 0x80;
  for (;;) {
  }
}

// Two interrupts, behind the stack, the reset and 14 exceptions.
using Handler = void (*)();
extern "C" {
extern const Handler vectors[18];
const Handler vectors[18] = {nullptr, nullptr, nullptr, nullptr, nullptr,       nullptr,
                             nullptr, nullptr, nullptr, nullptr, nullptr,       nullptr,
                             nullptr, nullptr, nullptr, nullptr, bad_interrupt, worse_interrupt};
}
#endif
