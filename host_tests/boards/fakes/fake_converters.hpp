// The converters of an STM32 in the time of its processor, the output wired to both inputs. It
// knows what the stream's driver asks of them, and no more: whether that is right use of the chip
// is not judged here. Which chip, chain_facts.hpp says.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <map>
#include <unordered_map>
#include <utility>

#include "emax/board/converter_words.hpp"
#include "emax/board/dma_memory.hpp"
#include "emax/board/registers.hpp"
#include "emax/hal/word.hpp"

#include "chain_facts.hpp"
#include "hal/stream_conformance.hpp"

namespace emax::test {

class FakeConverters final : public FakeChip {
 public:
  static constexpr std::uint64_t kCyclesPer_us = chip::kCyclesPer_us;

  /// @param[in] is_dac_ahead The DAC asks for its first value before the first trigger.
  /// @param[in] is_dma_ahead Its output has fetched, and counted, one more from memory.
  FakeConverters(StreamFault fault, std::uint64_t at_frame, bool is_dac_ahead = false,
                 bool is_dma_ahead = false)
      : fault_(fault),
        at_frame_(at_frame),
        is_dac_ahead_(is_dac_ahead),
        is_dma_ahead_(is_dma_ahead) {}

  /// An access takes this long: more makes a long run short.
  void set_access_cycles(std::uint64_t cycles) { access_cycles_ = cycles; }
  /// The handler of the output's DMA.
  void set_output_interrupt(std::function<void()> handler) { handler_ = std::move(handler); }

  const DriveProbe& drive() const { return drive_; }
  double now_s() const { return static_cast<double>(cycles_) / (1e6 * double{kCyclesPer_us}); }
  /// Results are as those of converters with some noise: within 8 codes of 16 bits.
  void set_noisy(bool is_noisy) { is_noisy_ = is_noisy; }
  /// The program does something else.
  void spend_us(std::uint64_t us) { pass(us * kCyclesPer_us); }
  /// Nothing that takes time ever ends, or no trigger comes any more.
  void hold_calibration(bool held) { is_calibration_held_ = held; }
  void stop_triggers() { are_triggers_dead_ = true; }
  /// From now on the ADCs take every second trigger only.
  void halve_inputs() { are_inputs_halved_ = true; }
  void stop_output_dma() { is_output_dma_dead_ = true; }
  void hold_regulator(bool held) { is_regulator_held_ = held; }
  /// What a result takes, as on a chip whose ADCs' clock is another one.
  void set_conversion_us(std::uint64_t us) { conversion_cycles_ = us * kCyclesPer_us; }
  /// A calibration has begun while the converters asked for DMA, which spoils it.
  bool calibrates_with_dma() const { return calibrates_with_dma_; }
  void set_underrun() { registers_[chip::kDac + 0x34] |= 1U << 13; }
  void set_overrun() { registers_[chip::kAdc2] |= 1U << 4; }

  std::uint32_t read(std::uintptr_t address, unsigned /*bytes*/) override {
    pass(access_cycles_);
    if (address == 0x40000024) {
      return static_cast<std::uint32_t>(cycles_ / kCyclesPer_us);
    }
    const bool is_control = address == chip::kAdc1 + 0x08 || address == chip::kAdc2 + 0x08;
    if (is_control && cycles_ >= calibrated_at_ && !is_calibration_held_) {
      registers_[address] &= ~(1U << 31);
    }
    if (address == 0xE0001004) {
      return static_cast<std::uint32_t>(cycles_);
    }
    if ((address == chip::kAdc1 || address == chip::kAdc2) && !is_regulator_held_ &&
        (registers_[address + 0x08] & 1U << 28) != 0) {
      return registers_[address] | chip::kRegulatorReady;
    }
    return registers_[address];
  }

  void write(std::uintptr_t address, std::uint32_t value) override {
    pass(access_cycles_);
    switch (address) {
      case chip::kDmaClear:
        registers_[chip::kDmaStatus] &= ~value;
        return;
      case chip::kTimer:
        if ((value & 1U) != 0 && (registers_[address] & 1U) == 0) {
          next_trigger_ = cycles_ + frame_cycles();
        }
        break;
      case chip::kDac + 0x0C:
        registers_[address] = value;
        if ((registers_[chip::kDac] & 2U) == 0) {
          put_out(value, false);
        }
        return;
      case chip::kDac + 0x34:
        registers_[address] &= ~value;
        return;
      case chip::kDac:
        control_dac(value);
        return;
      case chip::kAdc1 + 0x08:
      case chip::kAdc2 + 0x08:
        control_adc(address - 0x08, value);
        return;
      case chip::kAdc1:
      case chip::kAdc2:
        registers_[address] &= ~value;
        return;
      case chip::kInputDma:
      case chip::kOutputDma:
        if ((value & 1U) != 0 && (registers_[address] & 1U) == 0) {
          sizes_[address] = registers_[address + 4];
          if (address == chip::kOutputDma && is_dma_ahead_) {
            prefetched_ = *next_of(address);
          }
        }
        break;
      default:
        break;
    }
    registers_[address] = value;
  }

 private:
  void pass(std::uint64_t cycles) {
    const std::uint64_t until = cycles_ + cycles;
    while (runs() && next_trigger_ <= until) {
      cycles_ = std::max(cycles_, next_trigger_);
      finish_conversion();
      trigger();
      next_trigger_ += frame_cycles();
    }
    cycles_ = std::max(cycles_, until);
    finish_conversion();
    if (is_interrupt_pending_ && !is_in_interrupt_ && handler_) {
      is_interrupt_pending_ = false;
      is_in_interrupt_ = true;
      handler_();
      is_in_interrupt_ = false;
    }
  }

  std::uint64_t frame_cycles() {
    return (registers_[chip::kTimer + 0x2C] + std::uint64_t{1}) * chip::kCyclesPerTick;
  }
  bool runs() { return (registers_[chip::kTimer] & 1U) != 0 && !are_triggers_dead_; }
  bool is_triggered() { return (registers_[chip::kAdc1 + 0x0C] & 3U << 10) != 0; }
  bool is_on(std::uintptr_t channel) { return (registers_[channel] & 1U) != 0; }

  void trigger() {
    registers_[chip::kTimer + 0x10] |= 1U;
    strike();
    if ((registers_[chip::kDac] & 3U) == 3U) {
      put_out(registers_[chip::kDac + 0x0C], true);
      fetch();
    }
    ++triggers_;
    const bool listens =
        lost_frames_ == 0 && !is_deaf_ && !(are_inputs_halved_ && triggers_ % 2 == 0);
    lost_frames_ -= lost_frames_ > 0 ? 1 : 0;
    if (listens && is_triggered() && (registers_[chip::kAdc1 + 0x08] & 4U) != 0) {
      conversion_end_ = cycles_ + conversion_cycles_;
      converted_ = registers_[chip::kDac + 0x2C] << 4U;
    }
  }

  // One fault, once.
  void strike() {
    if (drive_.frames < at_frame_) {
      return;
    }
    if (fault_ == StreamFault::kLostBlock) {
      lost_frames_ = 64;
    } else if (fault_ == StreamFault::kLateBlock) {
      is_deaf_ = true;
    } else if (fault_ == StreamFault::kHardwareFault) {
      registers_[chip::kDmaStatus] |= chip::kInputError;
    } else {
      return;
    }
    fault_ = StreamFault::kNone;
  }

  void finish_conversion() {
    if (conversion_end_ == 0 || cycles_ < conversion_end_) {
      return;
    }
    conversion_end_ = 0;
    if (!is_triggered()) {
      registers_[chip::kAdc1] |= 1U << 2;
      registers_[chip::kAdc1 + 0x08] &= ~4U;
      return;
    }
    if (is_on(chip::kInputDma) && registers_[chip::kMux] == chip::kAdcRequest) {
      const std::uint32_t device = with_noise(converted_);
      *next_of(chip::kInputDma) = device << 16U | with_noise(converted_);
    }
  }

  std::uint32_t with_noise(std::uint32_t code) {
    if (!is_noisy_) {
      return code;
    }
    noise_ = noise_ * 1664525U + 1013904223U;  // A generator of Numerical Recipes.
    const std::uint32_t above = code + (noise_ >> 28U);
    return std::clamp(above, 8U, 65535U + 8U) - 8U;
  }

  void fetch() {
    const bool asks = (registers_[chip::kDac] & 1U << 12) != 0;
    if (asks && is_on(chip::kOutputDma) && !is_output_dma_dead_ &&
        registers_[chip::kMux + 4] == chip::kDacRequest) {
      const std::uint32_t next = *next_of(chip::kOutputDma);
      registers_[chip::kDac + 0x0C] = is_dma_ahead_ ? std::exchange(prefetched_, next) : next;
    }
  }

  volatile std::uint32_t* next_of(std::uintptr_t channel) {
    std::uint32_t& left = registers_[channel + 4];
    const std::uint32_t size = sizes_[channel];
    volatile std::uint32_t* at = dma_memory(registers_[channel + 0x0C]) + (size - left);
    --left;
    if (channel == chip::kOutputDma && (left == size / 2 || left == 0)) {
      const bool is_end = left == 0;
      registers_[chip::kDmaStatus] |= is_end ? chip::kOutputEnd : chip::kOutputHalf;
      is_interrupt_pending_ =
          (registers_[channel] & (is_end ? chip::kEndInterrupt : chip::kHalfInterrupt)) != 0;
    }
    left = left == 0 ? size : left;
    return at;
  }

  void control_dac(std::uint32_t value) {
    const bool begins = (value & 1U << 12) != 0 && (registers_[chip::kDac] & 1U << 12) == 0;
    registers_[chip::kDac] = value;
    if (begins && is_dac_ahead_) {
      fetch();
    }
    if ((value & 2U) == 0) {
      put_out(registers_[chip::kDac + 0x0C], false);
    }
  }

  void put_out(std::uint32_t left_justified, bool is_frame) {
    registers_[chip::kDac + 0x2C] = left_justified >> 4U & 0xFFFU;
    // While it is off, the resistors outside keep the pin at zero volts of drive.
    const bool is_on = (registers_[chip::kDac] & 1U) != 0;
    const hal::Word word = is_on ? board::word_of_dac(registers_[chip::kDac + 0x2C]) : 0;
    if (is_frame || word != drive_.last) {
      const std::int64_t step = std::abs(std::int64_t{word} - std::int64_t{drive_.last});
      // 12 bits cannot tell -2^31 from the word above it, which is the least within any limits.
      const std::int64_t amplitude =
          std::min(std::abs(std::int64_t{word}), std::int64_t{hal::kGreatestWord});
      drive_.max_amplitude = std::max(drive_.max_amplitude, static_cast<std::uint32_t>(amplitude));
      drive_.max_step = std::max(drive_.max_step, static_cast<std::uint32_t>(step));
      drive_.frames_since_nonzero = word == 0 ? drive_.frames_since_nonzero + 1 : 0;
      drive_.last = word;
      ++drive_.frames;
    }
  }

  void control_adc(std::uintptr_t adc, std::uint32_t value) {
    std::uint32_t& control = registers_[adc + 0x08];
    const std::uint32_t keeps = control & 0x7U;
    control = (value & chip::kControlStays) | keeps | (value & 0x5U);
    if ((value & 4U) != 0 && adc == chip::kAdc1 && !is_triggered()) {
      conversion_end_ = cycles_ + conversion_cycles_;
    }
    if ((value & 1U << 31) != 0) {
      calibrates_with_dma_ |=
          ((registers_[adc + 0x0C] & 3U) | (registers_[kCommonControl] & 3U << 14)) != 0;
      calibrated_at_ = cycles_ + (refuses_start() ? chip::kSlowCalibration_us * kCyclesPer_us : 0);
    }
    if ((value & 1U) != 0) {
      registers_[adc] |= 1U;
    }
    if ((value & 1U << 4) != 0) {
      control &= ~(1U << 4 | 1U << 2);
    }
    if ((value & 1U << 1) != 0) {
      control &= ~3U;
      is_deaf_ = false;
    }
  }

  bool refuses_start() {
    const bool refuses = fault_ == StreamFault::kStartFault;
    fault_ = refuses ? StreamFault::kNone : fault_;
    return refuses;
  }

  static constexpr std::uintptr_t kCommonControl = chip::kAdc1 + 0x308;
  std::unordered_map<std::uintptr_t, std::uint32_t> registers_;
  std::map<std::uintptr_t, std::uint32_t> sizes_;
  std::function<void()> handler_;
  StreamFault fault_;
  std::uint64_t at_frame_;
  bool is_dac_ahead_;
  bool is_dma_ahead_;
  std::uint32_t prefetched_ = 0;
  std::uint64_t conversion_cycles_ = chip::kConversionCycles;
  DriveProbe drive_;
  std::uint64_t access_cycles_ = 8;
  std::uint64_t cycles_ = 1;
  std::uint64_t next_trigger_ = 0;
  std::uint64_t conversion_end_ = 0;
  std::uint64_t triggers_ = 0;
  std::uint32_t converted_ = 0;
  std::uint32_t lost_frames_ = 0;
  std::uint32_t noise_ = 1;
  bool is_deaf_ = false;
  bool is_noisy_ = false;
  bool is_calibration_held_ = false;
  bool calibrates_with_dma_ = false;
  bool is_regulator_held_ = false;
  std::uint64_t calibrated_at_ = 0;
  bool are_triggers_dead_ = false;
  bool are_inputs_halved_ = false;
  bool is_output_dma_dead_ = false;
  bool is_interrupt_pending_ = false;
  bool is_in_interrupt_ = false;
};

}  // namespace emax::test
