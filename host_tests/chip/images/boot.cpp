// Clock tree, unique ID, and a console that sends back what it gets.
#include "chip/images/registers.hpp"

using namespace image;

namespace {

volatile Word overruns;

void print_hex(Word value) {
  for (int shift = 28; shift >= 0; shift -= 4) {
    put("0123456789ABCDEF"[value >> shift & 0xF]);
  }
}

}  // namespace

extern "C" void on_lpuart() {
  const Word flags = reg(kLpuart + 0x1C);
  if ((flags & 0xF) != 0) {
    overruns = overruns + 1;
    reg(kLpuart + 0x20) = flags & 0xF;
  }
  if ((flags & 1U << 5) != 0) {
    put(static_cast<char>(reg(kLpuart + 0x24)));
  }
}

extern "C" int main() {
  if (!clock_170()) {
    uart_on(256ULL * 16000000 / 115200);
    print("no crystal\n");
    return 1;
  }
  uart_on();
  print("id ");
  print_hex(reg(0x1FFF7590));
  print("\n");
  interrupt_on(91);
  reg(kLpuart) = reg(kLpuart) | 1U << 5;
  return 0;
}
