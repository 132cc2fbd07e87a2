// Erases a sector of the second bank, programs it and reads it back, also after a power cut: what
// cannot be corrected is an error of the bus, which this program looks for in the flags.
#include "chip/images/h743.hpp"

using namespace image;

extern "C" {
volatile Word bus_faults;

[[gnu::used]] void on_bus_fault() {
  bus_faults = bus_faults + 1;
  reg(0xE000ED28) = 0xFF00;
}

/// A word with errors of the bus ignored, and whether it could not be corrected.
static bool is_torn(Word address, Word* word) {
  reg(0xE000ED14) = reg(0xE000ED14) | 1U << 8;
  asm volatile("cpsid f\ndsb" ::: "memory");
  *word = reg(address);
  asm volatile("dsb\ncpsie f" ::: "memory");
  reg(0xE000ED14) = reg(0xE000ED14) & ~(1U << 8);
  const bool torn = (reg(kBank2 + 0x10) & 1U << 26) != 0;
  reg(kBank2 + 0x14) = 1U << 26;
  return torn;
}

int main() {
  if (!clock_400()) {
    return 1;
  }
  uart_on();
  bool torn = false;
  Word all = ~0U;
  for (Word at = kSector; at < kSector + 4 * 32; at += 4) {
    Word word = 0;
    torn = is_torn(at, &word) || torn;
    all &= word;
  }
  print(torn ? "torn\n" : all == ~0U ? "empty\n" : "full\n");
  flash_unlock();
  bool done = flash_erase(0);
  for (Word i = 0; i < 4; ++i) {
    done = done && flash_program(kSector + 32 * i, 8 * i);
  }
  for (Word i = 0; i < 32; ++i) {
    done = done && reg(kSector + 4 * i) == i;
  }
  print(done ? "stored\n" : "failed\n");
  reg(0xE000ED24) = 1U << 17;
  const Word plain = reg(kSector + 4 * 64);
  static_cast<void>(plain);
  delay(10);  // The model takes the fault behind the block of instructions.
  print(bus_faults != 0 ? "fault\n" : "end\n");
  return 0;
}
}
