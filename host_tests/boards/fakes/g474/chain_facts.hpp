// Where the converters' registers of an STM32G474 are, as its fake answers for them.
#pragma once

#include <cstdint>

#include "emax/board/g474_chain.hpp"

namespace emax::test::chip {

inline constexpr const board::StreamSettings& kStream = board::kG474Stream;
inline constexpr std::uint64_t kCyclesPer_us = 170;
inline constexpr std::uint64_t kCyclesPerTick = 1;
inline constexpr double kFrame_us = 20.0;

inline constexpr std::uintptr_t kTimer = 0x40001000;
inline constexpr std::uintptr_t kAdc1 = 0x50000000;
inline constexpr std::uintptr_t kAdc2 = 0x50000100;
inline constexpr std::uintptr_t kDac = 0x50000800;
inline constexpr std::uintptr_t kDmaStatus = 0x40020000;
inline constexpr std::uintptr_t kDmaClear = 0x40020004;
inline constexpr std::uintptr_t kInputDma = 0x40020008;
inline constexpr std::uintptr_t kOutputDma = 0x4002001C;
inline constexpr std::uintptr_t kMux = 0x40020800;
inline constexpr std::uint32_t kAdcRequest = 5;
inline constexpr std::uint32_t kDacRequest = 6;
// In the flags.
inline constexpr std::uint32_t kInputError = 1U << 3;
inline constexpr std::uint32_t kOutputHalf = 1U << 6;
inline constexpr std::uint32_t kOutputEnd = 1U << 5;
// In the control register.
inline constexpr std::uint32_t kHalfInterrupt = 1U << 2;
inline constexpr std::uint32_t kEndInterrupt = 1U << 1;
// 32 times 25 cycles of the ADC's clock, each of four.
inline constexpr std::uint64_t kConversionCycles = 32 * 25 * 4;
// Of the ADC's control register, what stays, and its regulator's flag.
inline constexpr std::uint32_t kControlStays = 0xF0000000;
inline constexpr std::uint32_t kRegulatorReady = 0;
inline constexpr bool kOverrunTells = true;
// Longer than the driver waits for a calibration.
inline constexpr std::uint64_t kSlowCalibration_us = 5'500;

}  // namespace emax::test::chip
