// The analog side of a NUCLEO-H743ZI2, as its drivers need it.
#pragma once

#include <cstdint>

#include "emax/board/h743.hpp"
#include "emax/board/stm32_stream.hpp"

namespace emax::board {

/// What the timers count at full speed: twice what their bus does.
inline constexpr std::uint32_t kH743Timers_hz = 200'000'000;

/// @param[in] clock CCR: where the ADCs' clock comes from.
/// @param[in] boost CR: what its frequency asks for.
/// @param[in] is_powered ISR: the regulator is ready, where it tells.
///
/// Results are means of 8 conversions of 16 bits (7), their sum shifted by three. PA3 is the
/// reference, PC0 the device. 16.5 cycles to sample (3): 8 times 25 cycles are 4 us at 50 MHz, or 8
/// us at 25 MHz, of the 10 us of a frame.
constexpr AdcPairSettings h743_inputs(std::uint32_t clock, std::uint32_t boost,
                                      std::uint32_t is_powered) noexcept {
  // The injected queue is off, as after a reset, and a result that was not fetched gives way to the
  // next one (12): with the queue of two results that this switches off, those of both ADCs shift
  // against each other.
  constexpr std::uint32_t kBoth = 1U << 31 | 1U << 12;
  // TIM6 (13), its rising edge (1), DMA that goes round (3).
  constexpr std::uint32_t kMaster = 13U << 5 | 1U << 10 | 3U << 0;
  return {
      {kAdc1, 15, kBoth | kMaster, 0x18, 3U << (3 * (15 - 10)), 1U << 15},
      {kAdc2, 10, kBoth, 0x18, 3U << (3 * (10 - 10)), 1U << 10},
      kAdcCommon,
      clock,
      // Both at once (6), results together by DMA as one word (2).
      6U << 0 | 2U << 14,
      kBoth,
      1U << 0 | 3U << 5 | 7U << 16,
      1U << 28 | boost,
      // The offset (31) and the linearity (16), which takes the longest.
      1U << 31 | 1U << 16,
      is_powered,
      // With results that give way an overrun says nothing: the frames are counted.
      0,
      1'000'000,
      9,
  };
}

/// Revision V: a quarter of the bus clock and in step with it (3), 50 MHz, which the chip may halve
/// again. BOOST 3 is for more than 25 MHz; at 25 MHz it is more than the chip needs.
inline constexpr AdcPairSettings kH743Inputs = h743_inputs(3U << 16, 3U << 8, 1U << 12);

/// Revision Y and before, whose ADCs take 36 MHz at most, have one bit of BOOST, and do not tell
/// about the regulator: half (1) of the internal oscillator's 64 MHz, which D3CCIPR must choose.
inline constexpr AdcPairSettings kH743InputsOfRevisionY = h743_inputs(1U << 18, 1U << 8, 0);

// Round and round (8), memory goes on (10), words of 32 bits on both sides (11, 13): with 16 in
// memory two of them go into one word of the DAC. Without the streams' FIFO, as after a reset.
inline constexpr std::uint32_t kH743Ring = 1U << 8 | 1U << 10 | 2U << 11 | 2U << 13;

/// TIM6 triggers (13 for the ADCs, 5 for the DAC). DMA1's stream 0 has the inputs, which ask as
/// number 9, and stream 1 the output, which asks as number 67 and has the highest priority.
inline constexpr StreamSettings kH743Stream = {
    10,
    kH743Timers_hz,
    kH743Inputs,
    {kDma1 + 0x10, kDmamux + 0x00, 9, kDma1 + 0x00, kDma1 + 0x08, 0x3D, 1U << 4, 1U << 5,
     1U << 2 | 1U << 3, kH743Ring | 2U << 16, 1U << 3 | 1U << 4},
    {kDac1, kTim6, 5},
    {kDma1 + 0x28, kDmamux + 0x04, 67, kDma1 + 0x00, kDma1 + 0x08, 0x3D << 6U, 1U << 10, 1U << 11,
     1U << 8 | 1U << 9, kH743Ring | 3U << 16 | 1U << 6, 1U << 3 | 1U << 4},
};
static_assert(kH743Stream.timer_hz % 1'000'000 == 0);

}  // namespace emax::board
