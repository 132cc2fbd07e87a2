// Drive and response by DMA in two rings; the drive is a pattern that never repeats within a ring.
#include "chip/images/registers.hpp"

using namespace image;

extern "C" {
Word drive[kRing];
Word response[kRing];
volatile Word halves;
volatile Word wholes;
volatile Word errors;

void on_dma() {
  const Word flags = reg(kDma1);
  reg(kDma1 + 4) = flags & 0xF;
  halves = halves + (flags >> 2 & 1);
  wholes = wholes + (flags >> 1 & 1);
  errors = errors + (flags >> 3 & 1);
}

int main() {
  if (!clock_170()) {
    return 1;
  }
  uart_on();
  for (unsigned i = 0; i < kRing; ++i) {
    drive[i] = (1024 + 7 * i) << 4;
  }
  Stream stream;
  stream.adc_dma |= 0xE;
  stream.adc_buffer = reinterpret_cast<Word>(response);
  stream.dac_buffer = reinterpret_cast<Word>(drive);
  interrupt_on(11);
  print(stream_on(stream) ? "streams\n" : "dead\n");
  return 0;
}
}
