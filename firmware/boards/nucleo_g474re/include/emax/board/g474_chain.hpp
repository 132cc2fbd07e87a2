// The analog side of a NUCLEO-G474RE, as its drivers need it.
#pragma once

#include <cstdint>

#include "emax/board/g474.hpp"
#include "emax/board/stm32_stream.hpp"

namespace emax::board {

/// Results are means of 32 conversions of 12 bits. PA0 is the reference, PA1 the device.
inline constexpr AdcPairSettings kG474Inputs = {
    // The injected queue is off, as after a reset. Only the master needs the trigger: TIM6 (13),
    // its
    // rising edge (1). 12.5 cycles to sample (2): 32 times 25 cycles are 18.8 us of the 20 us of a
    // frame.
    {kAdc1, 1, 1U << 31 | 13U << 5 | 1U << 10, 0x14, 2U << (3 * 1), 0},
    {kAdc2, 2, 1U << 31, 0x14, 2U << (3 * 2), 0},
    kAdcCommon,
    // A quarter of the bus clock and in step with it (3): 42.5 MHz.
    3U << 16,
    // Both at once (6), results together by DMA (2) that goes round (1).
    6U << 0 | 1U << 13 | 2U << 14,
    1U << 31,
    // 32 conversions (4), their sum shifted by one.
    1U << 0 | 4U << 2 | 1U << 5,
    1U << 28,
    1U << 31,
    0,
    1U << 4,
    5'000,
    0,
};

// Round and round (5), memory goes on (7), words of 32 bits on both sides (8, 10): with 16 bits the
// DAC takes nothing. The output's priority is the highest (12).
inline constexpr std::uint32_t kG474Ring = 1U << 5 | 1U << 7 | 2U << 8 | 2U << 10;

/// TIM6 triggers (13 for the ADCs, 7 for the DAC). DMA1's channel 1 has the inputs, which ask as
/// number 5, and channel 2 the output, which asks as number 6.
inline constexpr StreamSettings kG474Stream = {
    20,
    EMAX_BOARD_CLOCK_HZ,
    kG474Inputs,
    {kDma1 + 0x08, kDmamux + 0x00, 5, kDma1 + 0x00, kDma1 + 0x04, 0x0F, 1U << 2, 1U << 1, 1U << 3,
     kG474Ring | 2U << 12, 1U << 1 | 1U << 2},
    {kDac1, kTim6, 7},
    {kDma1 + 0x1C, kDmamux + 0x04, 6, kDma1 + 0x00, kDma1 + 0x04, 0xF0, 1U << 6, 1U << 5, 1U << 7,
     kG474Ring | 3U << 12 | 1U << 4, 1U << 1 | 1U << 2},
};
static_assert(kG474Stream.timer_hz % 1'000'000 == 0);

}  // namespace emax::board
