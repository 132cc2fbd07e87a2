// Vectors and start of the test images; an image defines the handlers that it has.
#include "chip/images/access.hpp"

extern "C" {
extern image::Word stack_top[], data_begin[], data_end[], data_load[], bss_begin[], bss_end[];
int main();
void start();
void on_fault();
[[gnu::weak]] void on_nmi() { on_fault(); }
[[gnu::weak]] void on_mem_manage() { on_fault(); }
[[gnu::weak]] void on_bus_fault() { on_fault(); }
[[gnu::weak]] void on_systick() { on_fault(); }
[[gnu::weak]] void on_dma() { on_fault(); }
[[gnu::weak]] void on_tim6() { on_fault(); }
[[gnu::weak]] void on_tim7() { on_fault(); }
[[gnu::weak]] void on_tim2() { on_fault(); }
[[gnu::weak]] void on_lpuart() { on_fault(); }
[[gnu::weak]] void on_usart3() { on_fault(); }

[[gnu::naked]] void start() {
  asm volatile(
      "ldr r0, =0xE000ED88\n"
      "ldr r1, [r0]\n"
      "orr r1, r1, #0xF00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "b begin\n");
}

void begin() {
  const image::Word* from = data_load;
  for (image::Word* at = data_begin; at != data_end; ++at) {
    *at = *from++;
  }
  for (image::Word* at = bss_begin; at != bss_end; ++at) {
    *at = 0;
  }
  main();
  for (;;) {
    asm volatile("wfi");
  }
}

void on_fault() {
  for (;;) {
    asm volatile("bkpt 1");
  }
}
}

using Handler = void (*)();

struct Vectors {
  image::Word* stack;
  Handler start;
  Handler exceptions[14];
  Handler interrupts[150];  // As many as the greater chip has.
};

constexpr Vectors table() {
  Vectors vectors = {};
  vectors.stack = stack_top;
  vectors.start = start;
  for (Handler& handler : vectors.exceptions) {
    handler = on_fault;
  }
  for (Handler& handler : vectors.interrupts) {
    handler = on_fault;
  }
  vectors.exceptions[0] = on_nmi;
  vectors.exceptions[2] = on_mem_manage;
  vectors.exceptions[3] = on_bus_fault;
  vectors.exceptions[13] = on_systick;
  vectors.interrupts[11] = on_dma;
  vectors.interrupts[28] = on_tim2;
  vectors.interrupts[39] = on_usart3;
  vectors.interrupts[54] = on_tim6;
  vectors.interrupts[55] = on_tim7;
  vectors.interrupts[91] = on_lpuart;
  return vectors;
}

[[gnu::section(".vectors"), gnu::used]] constexpr Vectors kVectors = table();
