// The registers that the test images of the STM32H743 use, and the shortest right way to use them.
#pragma once

#include "chip/images/access.hpp"

namespace image {

constexpr Word kRcc = 0x58024400, kPwr = 0x58024800, kFlash = 0x52002000, kSyscfg = 0x58000400;
constexpr Word kGpioA = 0x58020000, kGpioD = 0x58020C00, kIwdg = 0x58004800;
constexpr Word kTim6 = 0x40001000, kUart = 0x40004800, kDac = 0x40007400;
constexpr Word kDma1 = 0x40020000, kDmamux = 0x40020800;
constexpr Word kAdc1 = 0x40022000, kAdc2 = 0x40022100, kAdc12 = 0x40022300;
constexpr Word kRccCr = kRcc, kRccCfgr = kRcc + 0x10, kPllckselr = kRcc + 0x28;
constexpr Word kPllcfgr = kRcc + 0x2C, kPll1divr = kRcc + 0x30;
constexpr Word kAhb1 = kRcc + 0xD8, kAhb2 = kRcc + 0xDC, kAhb4 = kRcc + 0xE0;
constexpr Word kApb1 = kRcc + 0xE8, kApb4 = kRcc + 0xF4;
constexpr Word kSram1Clock = 1U << 29;

/// What the clock tree's registers are set to; a mistake is one of these, or one step, wrong.
struct Tree {
  Word supply = 2;  ///< LDOEN; zero: nothing is written.
  Word scale = 3;   ///< VOS; zero: as after reset.
  Word bypass = 1U << 18;
  Word pll_range = 3 << 2;
  Word multiplier = 100, divider = 2;
  Word outputs = 0x01FF0000;
  Word flash = 2 | 2 << 4;
};

inline bool supply_on(const Tree& tree) {
  if (tree.supply != 0) {
    reg(kPwr + 0x0C) = (reg(kPwr + 0x0C) & ~7U) | tree.supply;
    if (!wait(kPwr + 0x04, 1U << 13, 1U << 13)) {
      return false;
    }
  }
  if (tree.scale != 0) {
    reg(kPwr + 0x18) = tree.scale << 14;
  }
  return wait(kPwr + 0x18, 1U << 13, 1U << 13);
}

inline bool pll_on(const Tree& tree) {
  reg(kRccCr) = reg(kRccCr) | tree.bypass;
  reg(kRccCr) = reg(kRccCr) | 1U << 16;
  if (!wait(kRccCr, 1U << 17, 1U << 17)) {
    return false;
  }
  reg(kPllckselr) = 0x02020000 | 1 << 4 | 2;
  reg(kPllcfgr) = tree.outputs | tree.pll_range;
  reg(kPll1divr) = (tree.multiplier - 1) | (tree.divider - 1) << 9 | 1 << 16 | 1 << 24;
  reg(kRccCr) = reg(kRccCr) | 1U << 24;
  return wait(kRccCr, 1U << 25, 1U << 25);
}

/// From HSI to 400 MHz by the probe's 8 MHz.
inline bool clock_400(const Tree& tree = Tree{}) {
  if (!supply_on(tree) || !pll_on(tree)) {
    return false;
  }
  reg(kRcc + 0x18) = 8 | 4 << 4;
  reg(kRcc + 0x1C) = 4 << 4 | 4 << 8;
  reg(kRcc + 0x20) = 4 << 4;
  reg(kFlash) = tree.flash;
  if (!wait(kFlash, 0x3F, tree.flash)) {
    return false;
  }
  reg(kRccCfgr) = 3;
  return wait(kRccCfgr, 7 << 3, 3 << 3);
}

inline void uart_on(Word baud_rate_register = 868) {
  clock_on(kAhb4, 1U << 3);
  reg(kGpioD) = (reg(kGpioD) & ~0xF0000U) | 0xA0000;
  reg(kGpioD + 0x24) = 0x77;
  clock_on(kApb1, 1U << 18);
  reg(kUart + 0x0C) = baud_rate_register;
  reg(kUart) = 1U << 29 | 0xD;
}

inline void put(char character) {
  wait(kUart + 0x1C, 1U << 7, 1U << 7);
  reg(kUart + 0x28) = static_cast<Word>(character);
}
inline void print(const char* text) {
  for (; *text != '\0'; ++text) {
    put(*text);
  }
}

/// Caches on, as they must be: cleared first.
inline void data_cache_on(bool clears = true) {
  for (Word set = 0; clears && set < 128; ++set) {
    for (Word way = 0; way < 4; ++way) {
      reg(0xE000EF60) = set << 5 | way << 30;
    }
  }
  reg(0xE000ED14) = reg(0xE000ED14) | 1U << 16;
  asm volatile("dsb\nisb" ::: "memory");
}
/// SRAM1 as normal memory that is not cached, shareable, for reading and writing.
inline void mpu_on() {
  reg(0xE000ED98) = 0;
  reg(0xE000ED9C) = 0x30000000;
  reg(0xE000EDA0) = 1U << 28 | 3U << 24 | 1U << 19 | 1U << 18 | 16U << 1 | 1;
  reg(0xE000ED94) = 5;
  asm volatile("dsb\nisb" ::: "memory");
}

constexpr unsigned kRing = 256;
constexpr Word kMemoryWords = 2U << 13, kPeripheralWords = 2U << 11;
constexpr Word kRound = 1U << 8 | 1U << 10;  ///< Circular, the memory's address steps.

/// What the stream's registers are set to; a mistake is one of these, or one step, wrong.
struct Stream {
  Word adc_clock = 3U << 16;  ///< HCLK/4, which the chip halves.
  Word pair = 6 | 2U << 14;
  Word adc1_channel = 15, adc2_channel = 10;
  Word preselected1 = 1U << 15, preselected2 = 1U << 10;
  Word sample = 3;                                 ///< 16.5 cycles.
  Word oversampling = 1 | 3 << 5 | (8 - 1) << 16;  ///< The mean of eight.
  Word adc_trigger = 1U << 31 | 13U << 5 | 1U << 10 | 3;
  Word keeps_new_data = 1U << 12;  ///< OVRMOD
  Word adc2_dma = 0;               ///< The slave asks for DMA of its own.
  Word adc_register = kAdc12 + 0x0C;
  Word boost = 3U << 8;
  Word calibration = 1U << 16;  ///< Linear, too.
  Word adc_request = 9, dac_request = 67;
  Word adc_dma = kRound | kPeripheralWords | kMemoryWords;
  Word dac_dma = kRound | kPeripheralWords | kMemoryWords | 1U << 6;
  Word adc_fifo = 0x21, dac_fifo = 0x21;  ///< Direct.
  Word adc_buffer = 0, dac_buffer = 0;
  Word frames = kRing;
  Word dac_mode = 0;
  Word turn = 2000;
  bool waits_for_regulator = true;
};

inline bool adc_supply(Word adc, const Stream& stream) {
  reg(adc + 8) = 0;
  reg(adc + 8) = 1U << 28 | stream.boost;
  return !stream.waits_for_regulator || wait(adc, 1U << 12, 1U << 12);
}
inline bool adc_calibrate(Word adc, const Stream& stream) {
  reg(adc + 8) = 1U << 28 | stream.boost | stream.calibration | 1U << 31;
  return wait(adc + 8, 1U << 31, 0);
}
inline bool adc_enable(Word adc, const Stream& stream) {
  reg(adc) = 1;
  reg(adc + 8) = 1U << 28 | stream.boost | 1;
  return wait(adc, 1, 1);
}
inline void adc_settings(Word adc, Word channel, Word preselected, const Stream& stream) {
  reg(adc + 0x1C) = preselected;
  reg(adc + 0x18) = stream.sample << (3 * (channel - 10));
  reg(adc + 0x10) = stream.oversampling;
  reg(adc + 0x30) = channel << 6;
}

inline bool adc_on(const Stream& stream) {
  reg(kAdc12 + 8) = stream.adc_clock;
  if (!adc_supply(kAdc1, stream) || !adc_supply(kAdc2, stream) || !adc_calibrate(kAdc1, stream) ||
      !adc_calibrate(kAdc2, stream)) {
    return false;
  }
  delay(200);
  reg(kAdc12 + 8) = stream.adc_clock | stream.pair;
  if (!adc_enable(kAdc2, stream) || !adc_enable(kAdc1, stream)) {
    return false;
  }
  adc_settings(kAdc1, stream.adc1_channel, stream.preselected1, stream);
  adc_settings(kAdc2, stream.adc2_channel, stream.preselected2, stream);
  reg(kAdc1 + 0x0C) = stream.adc_trigger | stream.keeps_new_data;
  reg(kAdc2 + 0x0C) = 1U << 31 | stream.keeps_new_data | stream.adc2_dma;
  return true;
}

inline void dma_on(unsigned number, Word request, Word settings, Word fifo, Word peripheral,
                   Word memory, Word items) {
  const Word base = kDma1 + 0x10 + 0x18 * number;
  reg(kDmamux + 4 * number) = request;
  reg(base + 0x04) = items;
  reg(base + 0x08) = peripheral;
  reg(base + 0x0C) = memory;
  reg(base + 0x14) = fifo & ~0x38U;
  reg(base) = settings;
  asm volatile("dsb" ::: "memory");
  reg(base) = settings | 1;
}

inline void stream_clocks() {
  clock_on(kAhb4, 1 | 1U << 2);
  clock_on(kAhb1, 1 | 1U << 5);
  clock_on(kApb1, 1U << 4 | 1U << 29);
}

/// The output at rest, in the middle of its range, before there are triggers.
inline void dac_at_rest(const Stream& stream) {
  reg(kDac + 0x3C) = stream.dac_mode;
  reg(kDac + 0x0C) = 0x8000;
  reg(kDac) = 1;
}

/// The pair on the trigger of TIM6, by DMA into one ring; the DAC by DMA from another.
inline bool stream_on(const Stream& stream) {
  stream_clocks();
  dac_at_rest(stream);
  if (!adc_on(stream)) {
    return false;
  }
  dma_on(0, stream.adc_request, stream.adc_dma, stream.adc_fifo, stream.adc_register,
         stream.adc_buffer, stream.frames);
  dma_on(1, stream.dac_request, stream.dac_dma, stream.dac_fifo, kDac + 0x0C, stream.dac_buffer,
         stream.frames);
  reg(kDac) = 1 | 5 << 2 | 1 << 1 | 1 << 12;
  reg(kAdc1 + 8) = 1U << 28 | stream.boost | 4;
  reg(kTim6 + 0x2C) = stream.turn - 1;
  reg(kTim6 + 4) = 2 << 4;
  reg(kTim6) = 1;
  return true;
}

/// The first sector of the second bank.
constexpr Word kSector = 0x08100000;
constexpr Word kBank2 = kFlash + 0x100;
constexpr Word kWidest = 3 << 4;  ///< PSIZE

inline void flash_unlock() {
  reg(kBank2 + 0x04) = 0x45670123;
  reg(kBank2 + 0x04) = 0xCDEF89AB;
}
inline bool flash_wait() { return wait(kBank2 + 0x10, 4, 0); }
inline bool flash_erase(unsigned sector) {
  reg(kBank2 + 0x14) = 0x0FEF0000;
  reg(kBank2 + 0x0C) = kWidest | sector << 8 | 4;
  reg(kBank2 + 0x0C) = kWidest | sector << 8 | 4 | 1U << 7;
  const bool done = flash_wait();
  reg(kBank2 + 0x0C) = kWidest;
  return done;
}
/// Eight words that begin with this one, each one more than the one before.
inline bool flash_program(Word address, Word first) {
  reg(kBank2 + 0x14) = 0x0FEF0000;
  reg(kBank2 + 0x0C) = kWidest | 2;
  for (Word i = 0; i < 8; ++i) {
    reg(address + 4 * i) = first + i;
  }
  asm volatile("dsb" ::: "memory");
  const bool done = flash_wait();
  reg(kBank2 + 0x0C) = kWidest;
  return done;
}

}  // namespace image
