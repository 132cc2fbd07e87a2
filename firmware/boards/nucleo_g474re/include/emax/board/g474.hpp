// Where the peripherals of an STM32G474 are.
#pragma once

#include <cstdint>

namespace emax::board {

inline constexpr std::uintptr_t kTim6 = 0x40001000;
inline constexpr std::uintptr_t kTim7 = 0x40001400;
inline constexpr std::uintptr_t kWatchdog = 0x40003000;
inline constexpr std::uintptr_t kPower = 0x40007000;
inline constexpr std::uintptr_t kLpuart1 = 0x40008000;
inline constexpr std::uintptr_t kDma1 = 0x40020000;
inline constexpr std::uintptr_t kDmamux = 0x40020800;
inline constexpr std::uintptr_t kRcc = 0x40021000;
inline constexpr std::uintptr_t kFlash = 0x40022000;
inline constexpr std::uintptr_t kGpioA = 0x48000000;
inline constexpr std::uintptr_t kAdc1 = 0x50000000;
inline constexpr std::uintptr_t kAdc2 = 0x50000100;
inline constexpr std::uintptr_t kAdcCommon = 0x50000300;
inline constexpr std::uintptr_t kDac1 = 0x50000800;
inline constexpr std::uintptr_t kDebug = 0xE0042000;

inline constexpr std::uintptr_t kUniqueId = 0x1FFF7590;  ///< Three words.
inline constexpr std::uintptr_t kFlashBank2 = 0x08040000;

inline constexpr unsigned kDma1Channel2Interrupt = 12;
inline constexpr unsigned kLpuart1Interrupt = 91;

}  // namespace emax::board
