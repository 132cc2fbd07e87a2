// Wrong uses of the STM32H743, one at a time: the test puts the number of one into `chosen`.
#include "chip/images/h743_mistakes.hpp"

#include "chip/images/h743.hpp"

using namespace image;

extern "C" {
extern const volatile Word chosen;
[[gnu::used, gnu::section(".rodata.chosen")]] const volatile Word chosen = 0;
[[gnu::section(".dma"), gnu::aligned(32)]] Word drive[kRing];
[[gnu::section(".dma"), gnu::aligned(32)]] Word response[kRing];
alignas(32) Word in_dtcm[kRing];
}

namespace {

Word address_of(const Word* words) { return reinterpret_cast<Word>(words); }

Stream usual() {
  Stream stream;
  stream.adc_buffer = address_of(response);
  stream.dac_buffer = address_of(drive);
  return stream;
}
void sram_on() {
  clock_on(kAhb2, kSram1Clock);
  for (Word& word : drive) {
    word = 0x8000;
  }
}
void run(const Stream& stream) {
  clock_400();
  sram_on();
  stream_on(stream);
}

void nothing() { run(usual()); }

// --- Supply and clock tree

void supply_not_set() { reg(kPwr + 0x18) = 3 << 14; }
void supply_wrong() { reg(kPwr + 0x0C) = 1; }
void supply_set_twice() {
  clock_400();
  reg(kPwr + 0x0C) = 4;
}
void too_fast_for_voltage() {
  Tree tree;
  tree.scale = 0;
  clock_400(tree);
}
void too_few_wait_states() {
  Tree tree;
  tree.flash = 1 | 2 << 4;
  clock_400(tree);
}
void flash_write_delay() {
  Tree tree;
  tree.flash = 2 | 1 << 4;
  clock_400(tree);
}
void hse_not_bypassed() {
  Tree tree;
  tree.bypass = 0;
  clock_400(tree);
}
void pll_range_wrong() {
  Tree tree;
  tree.pll_range = 1 << 2;
  clock_400(tree);
}
void pll_input_out_of_range() {
  Tree tree;
  tree.pll_range = 3 << 2 | 2;  // The narrow oscillator takes 2 MHz at most.
  tree.multiplier = 50;
  supply_on(tree);
  pll_on(tree);
}
void vco_out_of_range() {
  Tree tree;
  tree.multiplier = 150;
  tree.divider = 4;
  supply_on(tree);
  pll_on(tree);
}
void pll_output_divider() {
  Tree tree;
  tree.divider = 3;
  supply_on(tree);
  pll_on(tree);
}
void pll_output_off() {
  Tree tree;
  tree.outputs = 0x01FE0000;
  clock_400(tree);
}
void pll_changed_while_on() {
  clock_400();
  reg(kPll1divr) = 0x01010280;
}
void overdrive_not_allowed() {
  clock_on(kApb4, 2);
  reg(kSyscfg + 0x2C) = 1;  // At scale 3.
}
void backup_domain_locked() { reg(kRcc + 0x70) = 1; }

// --- Memories, caches

void memory_clock_off() { response[0] = 1; }
void clock_enable_not_read_back() {
  reg(kAhb2) = reg(kAhb2) | kSram1Clock;
  response[0] = 1;
}
void cache_not_invalidated() { data_cache_on(false); }
void dma_cacheable_memory() {
  data_cache_on();
  run(usual());
}
void cached_with_protection() {  // Right: the buffers are not cacheable.
  mpu_on();
  data_cache_on();
  run(usual());
}

// --- DMA

void dma_unreachable() {
  Stream stream = usual();
  stream.adc_buffer = address_of(in_dtcm);
  run(stream);
}
void dma_memory_without_clock() {
  clock_400();
  stream_on(usual());
}
void dma_packs() {
  Stream stream = usual();
  stream.dac_fifo = 0x27;
  stream.dac_dma = kRound | kPeripheralWords | 1U << 13 | 1U << 6;
  clock_400();
  sram_on();
  for (Word& word : drive) {
    word = 0x80008000;  // Two samples of 16 bits.
  }
  stream_on(stream);
}
void dma_memory_size_ignored() {
  Stream stream = usual();
  stream.adc_dma = kRound | kPeripheralWords | 1U << 13;
  run(stream);
}
void dma_burst_in_direct_mode() {
  Stream stream = usual();
  stream.adc_dma |= 1U << 23;
  run(stream);
}
void dma_burst_and_threshold() {
  Stream stream = usual();
  stream.adc_dma |= 1U << 23;  // Four words, where the FIFO lets go of two.
  stream.adc_fifo = 0x25;
  run(stream);
}
void dma_burst_misaligned() {
  Stream stream = usual();
  stream.adc_dma |= 1U << 23;
  stream.adc_fifo = 0x27;
  stream.adc_buffer += 4;
  stream.frames = kRing - 4;
  run(stream);
}
void dma_count_not_multiple() {
  Stream stream = usual();
  stream.adc_dma |= 1U << 23;
  stream.adc_fifo = 0x27;
  stream.frames = kRing - 2;
  run(stream);
}
void dma_not_circular() {
  Stream stream = usual();
  stream.adc_dma &= ~(1U << 8);
  run(stream);
}
void dma_old_flags() {
  run(usual());
  wait(kDma1, 1U << 5, 1U << 5);
  reg(kDma1 + 0x10) = usual().adc_dma;
  reg(kDma1 + 0x10) = usual().adc_dma | 1;
}
void dma_without_trbuff() {
  clock_400();
  sram_on();
  clock_on(kAhb1, 1);
  uart_on();
  dma_on(2, 46, 1U << 10 | 1U << 6, 0, kUart + 0x28, address_of(drive), 4);
}
void dma_setting_while_enabled() {
  run(usual());
  reg(kDma1 + 0x1C) = 0x30001000;
}
void dma_no_request_chosen() {
  Stream stream = usual();
  stream.adc_request = 0;
  run(stream);
}

// --- Converters

void adc_slave_may_slip() {
  Stream stream = usual();
  stream.keeps_new_data = 0;
  run(stream);
}
void adc_channel_not_preselected() {
  Stream stream = usual();
  stream.preselected2 = 0;
  run(stream);
}
void adc_boost() {
  Stream stream = usual();
  stream.boost = 1U << 8;
  run(stream);
}
void adc_not_linear() {
  Stream stream = usual();
  stream.calibration = 0;
  run(stream);
}
void adc_regulator_too_soon() {
  Stream stream = usual();
  stream.waits_for_regulator = false;
  run(stream);
}
void adc_too_fast() {
  Stream stream = usual();
  stream.adc_clock = 1U << 16;
  run(stream);
}
void adc_trigger_during_conversion() {
  Stream stream = usual();
  stream.oversampling = 1 | 4 << 5 | (16 - 1) << 16;
  run(stream);
}
void adc_oversampling_overflow() {
  Stream stream = usual();
  stream.oversampling = 1 | 2 << 5 | (8 - 1) << 16;
  run(stream);
}
void adc_dma_one_shot() {
  Stream stream = usual();
  stream.adc_trigger &= ~2U;
  run(stream);
}
void dac_by_half_words() {
  Stream stream = usual();
  stream.dac_dma = kRound | 1U << 11 | 1U << 13 | 1U << 6;
  run(stream);
}
void dac_output_before_first_trigger() {
  clock_400();
  stream_clocks();
  reg(kDac) = 5 << 2 | 1 << 1;
  reg(kDac + 0x0C) = 0x8000;
  reg(kDac) = 5 << 2 | 1 << 1 | 1;
}

// --- Console, watchdog, processor

void uart_baud_rate() {
  clock_400();
  uart_on(256 * 868 & 0xFFFF);
}
void watchdog_locked() { reg(kIwdg + 4) = 6; }
void trace_locked() {
  reg(0xE000EDFC) = 1U << 24;
  reg(0xE0001000) = 1;
}
void vectors_misaligned() { reg(0xE000ED08) = 0x08000200; }

// --- Flash

void flash_wrong_key() { reg(kBank2 + 4) = 0x45670124; }
void flash_locked() { reg(kBank2 + 0x0C) = 2; }
void flash_own_bank() {
  reg(kFlash + 4) = 0x45670123;
  reg(kFlash + 4) = 0xCDEF89AB;
  reg(kFlash + 0x0C) = kWidest | 4 | 1U << 7;
}
void flash_nothing_to_erase() {
  flash_unlock();
  reg(kBank2 + 0x0C) = kWidest | 1U << 7;
}
void flash_not_programming() {
  flash_unlock();
  reg(kSector) = 1;
}
void flash_word_order() {
  flash_unlock();
  reg(kBank2 + 0x0C) = kWidest | 2;
  reg(kSector) = 1;
  reg(kSector + 32) = 1;
}
void flash_word_twice() {
  flash_unlock();
  reg(kBank2 + 0x0C) = kWidest | 2;
  reg(kSector) = 1;
  reg(kSector) = 2;
}
void flash_word_incomplete() {
  flash_unlock();
  reg(kBank2 + 0x0C) = kWidest | 2;
  reg(kSector) = 1;
  reg(kSector + 4) = 2;
  reg(kBank2 + 0x0C) = kWidest;
}
void flash_not_erased() {
  flash_unlock();
  flash_program(kSector, 1);
  flash_program(kSector, 2);
}
void flash_busy() {
  flash_unlock();
  reg(kBank2 + 0x0C) = kWidest | 2;
  for (Word i = 0; i < 16; ++i) {
    reg(kSector + 4 * i) = i;
  }
}
void flash_old_error_flags() {
  flash_unlock();
  reg(kSector) = 1;  // Not programming: an error of sequence.
  reg(kBank2 + 0x0C) = kWidest | 2;
  reg(kSector) = 1;
}
void option_bytes_written() { reg(kFlash + 8) = 0x08192A3B; }

using Mistake = void (*)();

#define EMAX_ROW(name) name,
constexpr Mistake kMistakes[] = {EMAX_H743_MISTAKES(EMAX_ROW)};

}  // namespace

extern "C" int main() {
  kMistakes[chosen]();
  return 0;
}
