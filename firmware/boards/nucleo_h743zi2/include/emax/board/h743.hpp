// Where the peripherals of an STM32H743 are.
#pragma once

#include <cstdint>

namespace emax::board {

inline constexpr std::uintptr_t kTim6 = 0x40001000;
inline constexpr std::uintptr_t kTim7 = 0x40001400;
inline constexpr std::uintptr_t kUsart3 = 0x40004800;
inline constexpr std::uintptr_t kDac1 = 0x40007400;
inline constexpr std::uintptr_t kDma1 = 0x40020000;
inline constexpr std::uintptr_t kDmamux = 0x40020800;
inline constexpr std::uintptr_t kAdc1 = 0x40022000;
inline constexpr std::uintptr_t kAdc2 = 0x40022100;
inline constexpr std::uintptr_t kAdcCommon = 0x40022300;
inline constexpr std::uintptr_t kFlash = 0x52002000;
inline constexpr std::uintptr_t kGpioA = 0x58020000;
inline constexpr std::uintptr_t kGpioB = 0x58020400;
inline constexpr std::uintptr_t kGpioC = 0x58020800;
inline constexpr std::uintptr_t kGpioD = 0x58020C00;
inline constexpr std::uintptr_t kGpioE = 0x58021000;
inline constexpr std::uintptr_t kRcc = 0x58024400;
inline constexpr std::uintptr_t kPower = 0x58024800;
inline constexpr std::uintptr_t kWatchdog = 0x58004800;
inline constexpr std::uintptr_t kDebug = 0x5C001000;

inline constexpr std::uintptr_t kUniqueId = 0x1FF1E800;  ///< Three words.
inline constexpr std::uintptr_t kFlashBank2 = 0x08100000;
inline constexpr std::uintptr_t kSram1 = 0x30000000;

inline constexpr unsigned kDma1Stream1Interrupt = 12;
inline constexpr unsigned kUsart3Interrupt = 39;

}  // namespace emax::board
