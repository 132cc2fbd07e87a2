// Priorities, nesting, floating point in handlers, SysTick, the cycle counter, a stack guard.
#include "chip/images/registers.hpp"

using namespace image;

extern "C" {
Word order[32];
volatile Word entries;
volatile float scale = 1.5F;
volatile Word sum_is_right;
volatile Word guard_address;
volatile Word cycles;
volatile Word tim2_time;

static void note(Word what) {
  order[entries] = what;
  entries = entries + 1;
}

static void pend(unsigned number) { reg(0xE000E200 + 4 * (number / 32)) = 1U << number % 32; }

void on_tim7() {  // Lowest priority.
  note(1);
  scale = scale * 2.0F;
  pend(54);
  note(2);
}

void on_tim6() {  // Higher: interrupts the one above.
  note(3);
  scale = scale * 0.5F;
  pend(91);  // Highest.
  pend(11);  // The same priority as this: waits.
  note(4);
}
void on_lpuart() { note(5); }
void on_dma() { note(6); }
void on_systick() {
  note(7);
  reg(0xE000E010) = 0;
}
void on_tim2() {
  note(8);
  reg(kTim2 + 0x10) = 0;
}

void on_mem_manage() {
  guard_address = reg(0xE000ED34);
  asm volatile("bkpt 2");
}

// The model takes interrupts between blocks: a call ends one.
[[gnu::noinline]] static Word float_sum() {
  asm volatile("");
  float sum = 0.0F;
  for (int i = 0; i < 3000; ++i) {
    sum += static_cast<float>(i % 7);
  }
  return static_cast<Word>(sum);
}

int main() {
  interrupt_on(11);
  interrupt_on(28);
  interrupt_on(54);
  interrupt_on(55);
  interrupt_on(91);
  // Of 54, 55, 11 and 91.
  *reinterpret_cast<volatile unsigned char*>(0xE000E436) = 0x80;
  *reinterpret_cast<volatile unsigned char*>(0xE000E437) = 0xC0;
  *reinterpret_cast<volatile unsigned char*>(0xE000E40B) = 0x80;
  *reinterpret_cast<volatile unsigned char*>(0xE000E45B) = 0x40;
  reg(0xE000EDFC) = 1U << 24;
  reg(0xE0001004) = 0;
  reg(0xE0001000) = reg(0xE0001000) | 1;
  reg(0xE000E014) = 999;
  reg(0xE000E018) = 0;
  reg(0xE000E010) = 7;
  const Word first = float_sum();
  pend(55);
  const Word second = float_sum();
  sum_is_right = first == second && first == 8994;
  cycles = reg(0xE0001004);

  clock_on(kApb1, 1);
  reg(kTim2 + 0x28) = 15;  // 1 MHz from the 16 MHz after reset.
  reg(kTim2 + 0x2C) = 499;
  reg(kTim2 + 0x14) = 1;
  reg(kTim2 + 0x10) = 0;
  reg(kTim2 + 0x0C) = 1;
  reg(kTim2) = 1;
  asm volatile("wfi");
  tim2_time = reg(kTim2 + 0x24);

  reg(0xE000ED24) = 1U << 16;
  // Nobody touches the 4 KiB below the memory's second half.
  reg(0xE000ED9C) = 0x20010000 | 0x10;
  reg(0xE000EDA0) = 11U << 1 | 1U << 28 | 1;
  reg(0xE000ED94) = 5;
  asm volatile("dsb\nisb");
  reg(0x20010010) = 1;
  return 0;
}
}
