// Where the converters' registers of an STM32H743 are, as its fake answers for them.
#pragma once

#include <cstdint>

#include "emax/board/h743_chain.hpp"

namespace emax::test::chip {

inline constexpr const board::StreamSettings& kStream = board::kH743Stream;
inline constexpr std::uint64_t kCyclesPer_us = 400;
inline constexpr std::uint64_t kCyclesPerTick = 2;
inline constexpr double kFrame_us = 10.0;

inline constexpr std::uintptr_t kTimer = 0x40001000;
inline constexpr std::uintptr_t kAdc1 = 0x40022000;
inline constexpr std::uintptr_t kAdc2 = 0x40022100;
inline constexpr std::uintptr_t kDac = 0x40007400;
inline constexpr std::uintptr_t kDmaStatus = 0x40020000;
inline constexpr std::uintptr_t kDmaClear = 0x40020008;
inline constexpr std::uintptr_t kInputDma = 0x40020010;
inline constexpr std::uintptr_t kOutputDma = 0x40020028;
inline constexpr std::uintptr_t kMux = 0x40020800;
inline constexpr std::uint32_t kAdcRequest = 9;
inline constexpr std::uint32_t kDacRequest = 67;
// In the flags.
inline constexpr std::uint32_t kInputError = 1U << 3;
inline constexpr std::uint32_t kOutputHalf = 1U << 10;
inline constexpr std::uint32_t kOutputEnd = 1U << 11;
// In the control register.
inline constexpr std::uint32_t kHalfInterrupt = 1U << 3;
inline constexpr std::uint32_t kEndInterrupt = 1U << 4;
// 8 times 25 cycles of the ADC's 50 MHz.
inline constexpr std::uint64_t kConversionCycles = 8 * 25 * 8;
// Of the ADC's control register, what stays: with BOOST and the linear calibration. LDORDY.
inline constexpr std::uint32_t kControlStays = 0xF0010300;
inline constexpr std::uint32_t kRegulatorReady = 1U << 12;
inline constexpr bool kOverrunTells = false;
// Longer than the driver waits for a calibration.
inline constexpr std::uint64_t kSlowCalibration_us = 1'000'500;

}  // namespace emax::test::chip
