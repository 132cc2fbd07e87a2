// Erases a page of the second bank, programs it and reads it back, also after a power cut.
#include "chip/images/registers.hpp"

using namespace image;

extern "C" {
volatile Word uncorrectable;

void on_nmi() {
  if ((reg(kFlash + 0x18) & 1U << 31) != 0) {
    uncorrectable = uncorrectable + 1;
    reg(kFlash + 0x18) = 1U << 31;
  }
}

int main() {
  if (!clock_170()) {
    return 1;
  }
  uart_on();
  Word sum = 0;
  for (Word at = kPage; at < kPage + 64; at += 4) {
    sum += reg(at);
  }
  print(uncorrectable != 0 ? "torn\n" : sum == 0xFFFFFFF0 ? "empty\n" : "full\n");
  data_cache(false);
  flash_unlock();
  bool done = flash_erase(0);
  for (Word i = 0; i < 8; ++i) {
    done = done && flash_program(kPage + 8 * i, i, ~i);
  }
  data_cache(true);
  for (Word i = 0; i < 8; ++i) {
    done = done && reg(kPage + 8 * i) == i && reg(kPage + 8 * i + 4) == ~i;
  }
  print(done ? "stored\n" : "failed\n");
  return 0;
}
}
