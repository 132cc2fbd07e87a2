// The boards whose images are tested, and what a test must know of each. EMAX_CHIP_TESTED names
// one.
#pragma once

#include <cstdint>
#include <vector>

#include "chip/virtual_board.hpp"

namespace emax::chip {

/// These bits of a register read so for ever.
struct HeldFlag {
  const char* block;
  const char* register_name;
  std::uint32_t bits;
  std::uint32_t value;
};

struct NucleoG474re {
  using Chip = Stm32g474;
  static constexpr const char* kName = "nucleo_g474re";
  static constexpr const char* kPreset = "nucleo-g474re";
  static constexpr std::uint32_t kCpu_hz = 170'000'000;
  static constexpr unsigned kConsoleInterrupt = 91;
  static constexpr unsigned kLeastMistakes = 25;  ///< Planted in its drivers.
  static constexpr double kLatencyFrames = 513.0;
  /// At 50 kS/s the images of a drive of 5 kHz begin at 45 kHz: a filter for 100 kS/s would let
  /// 1e-3 of it through to the reference.
  static constexpr double kReconstruction_hz = 12500.0;
  static constexpr const char* kCountsTable = "board counts";
  static void prepare(Chip&) {}
  static void prepare_to_count(Chip&) {}
  static bool led(const Chip& chip) { return chip.ports[0]->output(5); }
  static std::vector<HeldFlag> flags() {
    return {{"RCC", "CR", 1U << 17, 0},
            {"RCC", "CR", 1U << 25, 0},
            {"RCC", "CFGR", 0xC, 4},
            {"FLASH", "ACR", 0xF, 0},
            {"FLASH", "SR", 1U << 16, 1U << 16},
            {"ADC1", "CR", 1U << 31, 1U << 31},
            {"ADC2", "CR", 1U << 31, 1U << 31},
            {"ADC1", "ISR", 1, 0},
            {"ADC2", "ISR", 1, 0},
            {"ADC1", "CR", 1U << 2, 1U << 2},
            {"DAC1", "SR", 1U << 11, 0},
            {"DMA1", "ISR", 0xFF, 0}};
  }
};

struct NucleoH743zi2 {
  using Chip = Stm32h743;
  static constexpr const char* kName = "nucleo_h743zi2";
  static constexpr const char* kPreset = "nucleo-h743zi2";
  static constexpr std::uint32_t kCpu_hz = 400'000'000;
  static constexpr unsigned kConsoleInterrupt = 39;
  static constexpr unsigned kLeastMistakes = 15;
  static constexpr double kLatencyFrames = 513.0;
  static constexpr double kReconstruction_hz = 25000.0;  // At 100 kS/s.
  static constexpr const char* kCountsTable = "board counts of the other board";
  static constexpr const char* kReportTable = "report of the other board";
  /// What takes long is polled for, and costs a test real time: sectors, and linear calibration.
  static void prepare(Chip& chip) {
    chip.flash.set_erase_time(2e-3);
    chip.adc.family().linear_cycles = 5000;
  }
  /// With the times of the chip.
  static void prepare_to_count(Chip& chip) {
    chip.flash.set_erase_time(1.0);
    chip.adc.family().linear_cycles = 165'010;
  }
  static bool led(const Chip& chip) { return chip.ports[1]->output(0); }
  static std::vector<HeldFlag> flags() {
    return {{"PWR", "CSR1", 1U << 13, 0},
            {"PWR", "D3CR", 1U << 13, 0},
            {"RCC", "CR", 1U << 17, 0},
            {"RCC", "CR", 1U << 25, 0},
            {"RCC", "CFGR", 0x38, 0},
            {"FLASH", "ACR", 0xF, 7},
            {"FLASH", "SR2", 5, 5},
            {"ADC1", "ISR", 1U << 12, 0},
            {"ADC1", "CR", 1U << 31, 1U << 31},
            {"ADC2", "CR", 1U << 31, 1U << 31},
            {"ADC1", "ISR", 1, 0},
            {"ADC2", "ISR", 1, 0},
            {"ADC1", "CR", 1U << 2, 1U << 2},
            {"DMA1", "LISR", 0x0F7D, 0}};
  }
};

using Tested = EMAX_CHIP_TESTED;
using TestedBoard = VirtualBoardOf<Tested::Chip>;

}  // namespace emax::chip
