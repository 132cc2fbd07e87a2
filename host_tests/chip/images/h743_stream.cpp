// Clock tree, unique ID, and drive and response by DMA in two rings of SRAM1.
#include "chip/images/h743.hpp"

using namespace image;

extern "C" {
[[gnu::section(".dma")]] Word drive[kRing];
[[gnu::section(".dma")]] Word response[kRing];
[[gnu::section(".dma")]] Word response_of_slave[kRing];
/// What a test changes before the power comes: OVRMOD, both FIFOs, the sizes of the memory's items,
/// the data cache, a stream for each converter.
extern const volatile Word keeps_new_data, fifo, adc_memory_size, dac_memory_size, cached,
    two_streams;
[[gnu::used, gnu::section(".rodata.a")]] const volatile Word keeps_new_data = 1U << 12;
[[gnu::used, gnu::section(".rodata.b")]] const volatile Word fifo = 0;
[[gnu::used, gnu::section(".rodata.c")]] const volatile Word adc_memory_size = 2;
[[gnu::used, gnu::section(".rodata.d")]] const volatile Word dac_memory_size = 2;
[[gnu::used, gnu::section(".rodata.e")]] const volatile Word cached = 0;
[[gnu::used, gnu::section(".rodata.f")]] const volatile Word two_streams = 0;
volatile Word halves;
volatile Word wholes;

void on_dma() {
  const Word flags = reg(kDma1);
  reg(kDma1 + 8) = flags & 0x3D;
  halves = halves + (flags >> 4 & 1);
  wholes = wholes + (flags >> 5 & 1);
}

void on_usart3() {
  const Word flags = reg(kUart + 0x1C);
  if ((flags & 0xF) != 0) {
    reg(kUart + 0x20) = flags & 0xF;
  }
  if ((flags & 1U << 5) != 0) {
    put(static_cast<char>(reg(kUart + 0x24)));
  }
}

int main() {
  if (!clock_400()) {
    uart_on(64000000 / 115200);
    print("no clock\n");
    return 1;
  }
  uart_on();
  print("id ");
  for (int shift = 28; shift >= 0; shift -= 4) {
    put("0123456789ABCDEF"[reg(0x1FF1E800) >> shift & 0xF]);
  }
  print("\n");
  clock_on(kAhb2, kSram1Clock);
  for (unsigned i = 0; i < kRing; ++i) {
    drive[i] = (1024 + 7 * i) << 4;
  }
  if (cached != 0) {
    mpu_on();
    data_cache_on();
  }
  Stream stream;
  stream.keeps_new_data = keeps_new_data;
  stream.adc_fifo = stream.dac_fifo = fifo;
  stream.adc_dma = kRound | kPeripheralWords | adc_memory_size << 13 | 0x1C;
  stream.dac_dma = kRound | kPeripheralWords | dac_memory_size << 13 | 1U << 6;
  stream.adc_buffer = reinterpret_cast<Word>(response);
  stream.dac_buffer = reinterpret_cast<Word>(drive);
  if (two_streams != 0) {
    clock_on(kAhb1, 1);
    stream.pair = 6;
    stream.adc_register = kAdc1 + 0x40;
    stream.adc2_dma = 3;
    dma_on(2, 10, stream.adc_dma, 0, kAdc2 + 0x40, reinterpret_cast<Word>(response_of_slave),
           kRing);
  }
  interrupt_on(11);
  print(stream_on(stream) ? "streams\n" : "dead\n");
  interrupt_on(39);
  reg(kUart) = reg(kUart) | 1U << 5;
  return 0;
}
}
