// The registers that the test images of the STM32G474 use, and the shortest right way to use them.
#pragma once

#include "chip/images/access.hpp"

namespace image {

constexpr Word kRcc = 0x40021000, kPwr = 0x40007000, kFlash = 0x40022000, kGpioA = 0x48000000;
constexpr Word kTim2 = 0x40000000, kTim6 = 0x40001000, kTim7 = 0x40001400, kIwdg = 0x40003000;
constexpr Word kLpuart = 0x40008000, kDma1 = 0x40020000, kDmamux = 0x40020800;
constexpr Word kAdc1 = 0x50000000, kAdc2 = 0x50000100, kAdc12 = 0x50000300, kDac = 0x50000800;
constexpr Word kRccCr = kRcc + 0x00, kRccCfgr = kRcc + 0x08, kRccPllcfgr = kRcc + 0x0C;
constexpr Word kAhb1 = kRcc + 0x48, kAhb2 = kRcc + 0x4C, kApb1 = kRcc + 0x58, kApb1b = kRcc + 0x5C;

/// From HSI to 170 MHz by the crystal.
inline bool clock_170() {
  clock_on(kApb1, 1U << 28);
  reg(kPwr + 0x80) = 0;
  reg(kFlash) = 0x40704;
  if (!wait(kFlash, 0xF, 4)) {
    return false;
  }
  reg(kRccCr) = reg(kRccCr) | 1U << 16;
  if (!wait(kRccCr, 1U << 17, 1U << 17)) {
    return false;
  }
  reg(kRccPllcfgr) = 3 | 5 << 4 | 85 << 8 | 1 << 24;
  reg(kRccCr) = reg(kRccCr) | 1U << 24;
  if (!wait(kRccCr, 1U << 25, 1U << 25)) {
    return false;
  }
  reg(kRccCfgr) = 8 << 4 | 3;
  if (!wait(kRccCfgr, 3 << 2, 3 << 2)) {
    return false;
  }
  delay(100);
  reg(kRccCfgr) = 3;
  return true;
}

inline void uart_on(Word baud_rate_register = 377778) {
  clock_on(kAhb2, 1);
  reg(kGpioA) = (reg(kGpioA) & ~0xF0U) | 0xA0;
  reg(kGpioA + 0x20) = 0xCC00;
  clock_on(kApb1b, 1);
  reg(kLpuart + 0x0C) = baud_rate_register;
  reg(kLpuart) = 1U << 29 | 0xD;
}

inline void put(char character) {
  wait(kLpuart + 0x1C, 1U << 7, 1U << 7);
  reg(kLpuart + 0x28) = static_cast<Word>(character);
}
inline void print(const char* text) {
  for (; *text != '\0'; ++text) {
    put(*text);
  }
}

constexpr unsigned kRing = 256;

/// What the stream's registers are set to; a mistake is one of these, or one step, wrong.
struct Stream {
  Word adc_clock = 3U << 16;  ///< HCLK/4.
  Word pair = 6 | 2U << 14 | 1U << 13;
  Word adc1_channel = 1, adc2_channel = 2;
  Word adc1_sample = 2, adc2_sample = 2;  ///< 12.5 cycles.
  Word oversampling = 1 | 3 << 2;         ///< Sixteen, no shift.
  Word adc_trigger = 1U << 31 | 13U << 5 | 1U << 10;
  Word adc_request = 5, dac_request = 6;
  Word adc_dma = 1U << 5 | 1U << 7 | 2U << 8 | 2U << 10;
  Word dac_dma = 1U << 4 | 1U << 5 | 1U << 7 | 2U << 8 | 2U << 10;
  Word adc_buffer = 0, dac_buffer = 0;
  Word frames = kRing;
  Word dac_mode = 2U << 14;
  Word turn = 1700;
  unsigned regulator_turns = 1500;
  unsigned pause_turns = 20;
  bool calibrated = true;
  bool waits_for_ready = true;
};

inline void adc_supply(Word adc) {
  reg(adc + 8) = 0;
  reg(adc + 8) = 1U << 28;
}

inline bool adc_calibrate(Word adc) {
  reg(adc + 8) = 1U << 28 | 1U << 31;
  return wait(adc + 8, 1U << 31, 0);
}

inline bool adc_enable(Word adc, bool waits) {
  reg(adc) = 1;
  reg(adc + 8) = 1U << 28 | 1;
  return !waits || wait(adc, 1, 1);
}

inline void adc_settings(Word adc, Word channel, Word sample, Word oversampling) {
  reg(adc + 0x14) = sample << (3 * channel);
  reg(adc + 0x10) = oversampling;
  reg(adc + 0x30) = channel << 6;
}

inline bool adc_on(const Stream& stream) {
  reg(kAdc12 + 8) = stream.adc_clock;
  adc_supply(kAdc1);
  adc_supply(kAdc2);
  delay(stream.regulator_turns);
  if (stream.calibrated && (!adc_calibrate(kAdc1) || !adc_calibrate(kAdc2))) {
    return false;
  }
  delay(stream.pause_turns);
  reg(kAdc12 + 8) = stream.adc_clock | stream.pair;
  if (!adc_enable(kAdc2, stream.waits_for_ready) || !adc_enable(kAdc1, stream.waits_for_ready)) {
    return false;
  }
  adc_settings(kAdc1, stream.adc1_channel, stream.adc1_sample, stream.oversampling);
  adc_settings(kAdc2, stream.adc2_channel, stream.adc2_sample, stream.oversampling);
  reg(kAdc1 + 0x0C) = stream.adc_trigger;
  return true;
}

inline void dma_on(unsigned channel, Word request, Word settings, Word peripheral, Word memory,
                   Word items) {
  const Word base = kDma1 + 8 + 20 * channel;
  reg(kDmamux + 4 * channel) = request;
  reg(base + 4) = items;
  reg(base + 8) = peripheral;
  reg(base + 12) = memory;
  reg(base) = settings;
  asm volatile("dsb" ::: "memory");
  reg(base) = settings | 1;
}

/// The output at rest, in the middle of its range, before there are triggers.
inline void dac_at_rest(const Stream& stream) {
  reg(kDac + 0x3C) = stream.dac_mode;
  reg(kDac + 0x0C) = 0x8000;
  reg(kDac) = 1;
}

inline void stream_clocks() {
  clock_on(kAhb2, 1 | 1U << 13 | 1U << 16);
  clock_on(kAhb1, 7);
  clock_on(kApb1, 1U << 4);
}

/// The pair on the trigger of TIM6, by DMA into one ring; the DAC by DMA from another.
inline bool stream_on(const Stream& stream) {
  stream_clocks();
  dac_at_rest(stream);
  if (!adc_on(stream)) {
    return false;
  }
  dma_on(0, stream.adc_request, stream.adc_dma, kAdc12 + 0x0C, stream.adc_buffer, stream.frames);
  dma_on(1, stream.dac_request, stream.dac_dma, kDac + 0x0C, stream.dac_buffer, stream.frames);
  reg(kDac) = 1 | 7 << 2 | 1 << 1 | 1 << 12;
  reg(kAdc1 + 8) = 1U << 28 | 4;
  reg(kTim6 + 0x2C) = stream.turn - 1;
  reg(kTim6 + 4) = 2 << 4;
  reg(kTim6) = 1;
  return true;
}

constexpr Word kPage = 0x08040000;

inline void flash_unlock() {
  reg(kFlash + 8) = 0x45670123;
  reg(kFlash + 8) = 0xCDEF89AB;
}
inline bool flash_wait() { return wait(kFlash + 0x10, 1U << 16, 0); }
inline void data_cache(bool on) {
  const Word others = reg(kFlash) & ~(1U << 10);
  reg(kFlash) = others;
  if (on) {
    reg(kFlash) = others | 1U << 12;
    reg(kFlash) = others | 1U << 10;
  }
}
/// A page of the second bank.
inline bool flash_erase(unsigned page) {
  reg(kFlash + 0x10) = 0xC3FA;
  reg(kFlash + 0x14) = 1U << 11 | page << 3 | 2;
  reg(kFlash + 0x14) = 1U << 16 | 1U << 11 | page << 3 | 2;
  const bool done = flash_wait();
  reg(kFlash + 0x14) = 0;
  return done;
}
inline bool flash_program(Word address, Word low, Word high) {
  reg(kFlash + 0x10) = 0xC3FA;
  reg(kFlash + 0x14) = 1;
  reg(address) = low;
  reg(address + 4) = high;
  const bool done = flash_wait();
  reg(kFlash + 0x14) = 0;
  return done;
}

}  // namespace image
