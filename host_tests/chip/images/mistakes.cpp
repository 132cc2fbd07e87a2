// Wrong uses of the chip, one at a time: the test puts the number of one into `chosen` in flash.
#include "chip/images/mistakes.hpp"

#include "chip/images/registers.hpp"

using namespace image;

extern "C" {
extern const volatile Word chosen;
[[gnu::used, gnu::section(".rodata.chosen")]] const volatile Word chosen = 0;
Word drive[kRing];
Word response[kRing];

void on_tim7() {}  // Does not clear its flag.
void on_dma() { reg(kDma1 + 4) = 0xF; }
}

namespace {

Stream usual() {
  Stream stream;
  stream.adc_buffer = reinterpret_cast<Word>(response);
  stream.dac_buffer = reinterpret_cast<Word>(drive);
  return stream;
}

void nothing() {}

// --- Any register

void clock_off() { reg(kTim6 + 0x2C) = 99; }
void clock_enable_not_read_back() {
  reg(kApb1) = reg(kApb1) | 1U << 4;
  reg(kTim6 + 0x2C) = 99;
}
void reserved_bit_written() {
  clock_on(kApb1, 1U << 4);
  reg(kTim6) = 1U << 4;
}
void no_such_register() {
  clock_on(kAhb2, 1);
  reg(kGpioA + 0x3C) = 1;
}
void wrong_width() {
  clock_on(kAhb2, 1U << 16);
  half(kDac + 0x0C) = 0x8000;
}
void read_only_register_written() {
  clock_on(kAhb1, 1);
  reg(kDma1) = 0;
}
void held_in_reset() {
  clock_on(kApb1, 1U << 4);
  reg(kRcc + 0x38) = 1U << 4;
  reg(kTim6 + 0x2C) = 99;
}

// --- Clock tree

void start_crystal() {
  reg(kRccCr) = reg(kRccCr) | 1U << 16;
  wait(kRccCr, 1U << 17, 1U << 17);
}
void start_pll(Word settings) {
  reg(kRccPllcfgr) = settings;
  reg(kRccCr) = reg(kRccCr) | 1U << 24;
  wait(kRccCr, 1U << 25, 1U << 25);
}
void use_pll(Word prescaler) {
  reg(kRccCfgr) = prescaler << 4 | 3;
  wait(kRccCfgr, 3 << 2, 3 << 2);
}
constexpr Word kFull = 3 | 5 << 4 | 85 << 8 | 1 << 24;

void pll_changed_while_on() {
  start_crystal();
  start_pll(kFull);
  reg(kRccPllcfgr) = kFull | 1 << 25;
}
void pll_without_source() { reg(kRccPllcfgr) = kFull, reg(kRccCr) = reg(kRccCr) | 1U << 24; }
void vco_out_of_range() {
  start_crystal();
  start_pll(3 | 5 << 4 | 127 << 8 | 1 << 24);
}
void pll_input_out_of_range() {
  start_crystal();
  start_pll(3 | 0 << 4 | 14 << 8 | 1 << 24);
}
void too_few_wait_states() {
  clock_on(kApb1, 1U << 28);
  reg(kPwr + 0x80) = 0;
  reg(kFlash) = 0x40703;
  start_crystal();
  start_pll(kFull);
  use_pll(8);
  delay(100);
  reg(kRccCfgr) = 3;
}
void too_fast_for_voltage() {
  reg(kFlash) = 0x40706;
  start_crystal();
  start_pll(kFull);
  use_pll(8);
}
void clock_step_too_big() {
  clock_on(kApb1, 1U << 28);
  reg(kPwr + 0x80) = 0;
  reg(kFlash) = 0x40704;
  start_crystal();
  start_pll(kFull);
  use_pll(0);
}
void switch_to_dead_clock() { reg(kRccCfgr) = 2; }
void pll_output_off() {
  start_crystal();
  start_pll(kFull & ~(1U << 24));
  reg(kRccCfgr) = 8 << 4 | 3;
}
void clock_source_switched_off() {
  clock_170();
  reg(kRccCr) = reg(kRccCr) & ~(1U << 16);
}

// --- Console

void uart_baud_rate() {
  clock_170();
  uart_on(170000000 / 115200);
}
void uart_setting_while_enabled() {
  clock_170();
  uart_on();
  reg(kLpuart + 0x0C) = 377000;
}
void uart_transmitter_off() {
  clock_170();
  uart_on();
  reg(kLpuart) = 1U << 29 | 5;
  reg(kLpuart + 0x28) = 'x';
}
void uart_data_overwritten() {
  clock_170();
  uart_on();
  for (int i = 0; i < 12; ++i) {
    reg(kLpuart + 0x28) = 'x';
  }
}
void uart_pin_not_connected() {
  clock_170();
  uart_on();
  reg(kGpioA + 0x20) = 0x7700;
  put('x');
}

// --- Watchdog

void watchdog_locked() { reg(kIwdg + 4) = 6; }
void watchdog_updating() {
  reg(kIwdg) = 0xCCCC;
  reg(kIwdg) = 0x5555;
  reg(kIwdg + 4) = 6;
  reg(kIwdg + 4) = 5;
}
void watchdog_wrong_key() { reg(kIwdg) = 0x1234; }

// --- Converters and DMA

void run(const Stream& stream) {
  clock_170();
  stream_on(stream);
}
void adc_regulator_too_soon() {
  Stream stream = usual();
  stream.regulator_turns = 10;
  run(stream);
}
void adc_regulator_off() {
  clock_170();
  stream_clocks();
  adc_supply(kAdc1);
  delay(2000);
  reg(kAdc1 + 8) = 1U << 31;
}
void adc_not_calibrated() {
  Stream stream = usual();
  stream.calibrated = false;
  run(stream);
}
void adc_calibration_while_enabled() {
  Stream stream = usual();
  clock_170();
  stream_clocks();
  adc_on(stream);
  reg(kAdc1 + 8) = 1U << 28 | 1U << 31;
}
void adc_calibration_with_dma() {
  clock_170();
  stream_clocks();
  reg(kAdc12 + 8) = 3U << 16 | 6 | 2U << 14 | 1U << 13;
  adc_supply(kAdc1);
  delay(2000);
  adc_calibrate(kAdc1);
}
void adc_busy_calibrating() {
  clock_170();
  stream_clocks();
  reg(kAdc12 + 8) = 3U << 16;
  adc_supply(kAdc1);
  delay(2000);
  reg(kAdc1 + 8) = 1U << 28 | 1U << 31;
  reg(kAdc1 + 8) = 1U << 28 | 1;
}
void adc_start_before_ready() {
  Stream stream = usual();
  clock_170();
  stream_clocks();
  stream.waits_for_ready = false;
  adc_on(stream);
  reg(kAdc1 + 8) = 1U << 28 | 4;
}
void adc_slave_not_ready() {
  Stream stream = usual();
  clock_170();
  stream_clocks();
  adc_on(stream);
  reg(kAdc2 + 8) = 1U << 28 | 2;
  delay(500);
  reg(kAdc1 + 8) = 1U << 28 | 4;
}
void adc_no_clock() {
  clock_170();
  stream_clocks();
  reg(kAdc12 + 8) = 0;
  adc_supply(kAdc1);
  delay(2000);
  reg(kAdc1 + 8) = 1U << 28 | 1U << 31;
}
void adc_too_fast() {
  Stream stream = usual();
  stream.adc_clock = 1U << 16;
  run(stream);
}
void adc_same_channel() {
  Stream stream = usual();
  stream.adc2_channel = 1;
  run(stream);
}
void adc_pair_differs() {
  Stream stream = usual();
  stream.adc2_sample = 1;
  run(stream);
}
void adc_channel_not_connected() {
  Stream stream = usual();
  stream.adc2_channel = 3;
  run(stream);
}
void adc_pin_not_analog() {
  Stream stream = usual();
  clock_170();
  stream_clocks();
  reg(kGpioA) = reg(kGpioA) & ~0xFU;
  stream_on(stream);
}
void adc_trigger_during_conversion() {
  Stream stream = usual();
  stream.turn = 900;
  run(stream);
}
void adc_oversampling_overflow() {
  Stream stream = usual();
  stream.oversampling = 1 | 4 << 2;
  stream.turn = 3400;
  run(stream);
}
void adc_setting_while_started() {
  run(usual());
  reg(kAdc1 + 0x14) = 0;
}
void adc_common_while_enabled() {
  run(usual());
  reg(kAdc12 + 8) = 0;
}
void adc_dma_one_shot() {
  Stream stream = usual();
  stream.pair = 6 | 2U << 14;
  run(stream);
}
void adc_overrun() {
  Stream stream = usual();
  stream.pair = 6;
  run(stream);
}
void dma_not_circular() {
  Stream stream = usual();
  stream.adc_dma &= ~(1U << 5);
  run(stream);
}
void dma_no_request_chosen() {
  Stream stream = usual();
  stream.adc_request = 0;
  run(stream);
}
void dma_nothing_to_transfer() {
  Stream stream = usual();
  stream.frames = 0;
  run(stream);
}
void dma_unreachable() {
  Stream stream = usual();
  stream.adc_buffer = 0x10000000;
  run(stream);
}
void dma_misaligned() {
  Stream stream = usual();
  stream.adc_buffer += 2;
  run(stream);
}
void dma_setting_while_enabled() {
  run(usual());
  reg(kDma1 + 0x0C) = 8;
}
void dac_hfsel() {
  Stream stream = usual();
  stream.dac_mode = 0;
  run(stream);
}
void dac_mode_while_enabled() {
  run(usual());
  reg(kDac + 0x3C) = 2U << 14 | 2;
}
void dac_output_before_first_trigger() {
  clock_170();
  stream_clocks();
  reg(kDac + 0x3C) = 2U << 14;
  reg(kDac) = 7 << 2 | 1 << 1;
  reg(kDac + 0x0C) = 0x8000;
  reg(kDac) = 7 << 2 | 1 << 1 | 1;
}
void dac_pin_not_analog() {
  clock_170();
  stream_clocks();
  reg(kGpioA) = reg(kGpioA) & ~(3U << 8);
  dac_at_rest(usual());
}
void dac_underrun() {
  Stream stream = usual();
  stream.dac_request = 8;
  run(stream);
}
void dac_by_half_words() {
  Stream stream = usual();
  stream.dac_dma = 1U << 4 | 1U << 5 | 1U << 7 | 1U << 8 | 1U << 10;
  run(stream);
}

// --- Flash

void ready_to_store() {
  clock_170();
  data_cache(false);
  flash_unlock();
}
void flash_wrong_key() { reg(kFlash + 8) = 0x45670124; }
void flash_locked() { reg(kFlash + 0x14) = 1; }
void flash_old_error_flags() {
  ready_to_store();
  reg(kPage) = 1;  // Not programming: an error of sequence.
  reg(kFlash + 0x14) = 1;
}
void flash_not_erased() {
  ready_to_store();
  flash_program(kPage, 1, 2);
  flash_program(kPage, 3, 4);
}
void flash_word_order() {
  ready_to_store();
  reg(kFlash + 0x14) = 1;
  reg(kPage + 4) = 1;
}
void flash_data_cache_on() {
  clock_170();
  flash_unlock();
  flash_program(kPage, 1, 2);
}
void flash_own_bank() {
  ready_to_store();
  reg(kFlash + 0x14) = 100 << 3 | 2;
  reg(kFlash + 0x14) = 1U << 16 | 100 << 3 | 2;
}
void flash_nothing_to_erase() {
  ready_to_store();
  reg(kFlash + 0x14) = 1U << 16;
}
void flash_not_programming() {
  ready_to_store();
  reg(kPage) = 1;
}
void flash_busy() {
  ready_to_store();
  reg(kFlash + 0x14) = 1;
  reg(kPage) = 1;
  reg(kPage + 4) = 2;
  reg(kPage + 8) = 3;
}
void option_bytes_written() { reg(kFlash + 0x20) = 0xFFEFF8AA; }
void cache_reset_while_on() {
  reg(kFlash) = 0x40600;
  reg(kFlash) = 0x40600 | 1U << 12;
}

// --- Processor

void fpu_off() {
  reg(0xE000ED88) = 0;
  asm volatile("vmov.f32 s0, #1.0\nb 1f\n1: nop\nb 2f\n2: nop" ::: "s0");
}
void interrupt_without_handler() { interrupt_on(90); }
void flag_not_cleared() {
  clock_on(kApb1, 1U << 5);
  reg(kTim7 + 0x2C) = 100;
  reg(kTim7 + 0x0C) = 1;
  reg(kTim7) = 1;
  interrupt_on(55);
}
void vectors_misaligned() { reg(0xE000ED08) = 0x08000080; }
void trace_off() { reg(0xE0001000) = 1; }
void bad_read() {
  const Word value = reg(0x60000000);
  static_cast<void>(value);
}
void not_modelled() { reg(0x40013000) = 1; }

using Mistake = void (*)();

#define EMAX_ROW(name) name,
constexpr Mistake kMistakes[] = {EMAX_CHIP_MISTAKES(EMAX_ROW)};

}  // namespace

extern "C" int main() {
  for (Word& word : drive) {
    word = 0x8000;
  }
  kMistakes[chosen]();
  return 0;
}
