// Grows the stack by what a register holds, behind the compiler's back: the stack gate must refuse
// it.
extern "C" int main();

namespace {

volatile int amount = 64;

}  // namespace

int main() {
  int by = amount;
  asm volatile("sub sp, sp, %0\n\tadd sp, sp, %0" : "+r"(by) : : "memory");
  return by;
}
