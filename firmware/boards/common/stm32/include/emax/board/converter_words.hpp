// What the converters of an STM32 take and give, as words.
#pragma once

#include <cstdint>

#include "emax/hal/analog_stream.hpp"
#include "emax/hal/word.hpp"

namespace emax::board {

/// The DAC's register for a left-justified value of 12 bits (DHR12L1) holds this for zero volts of
/// drive: half of the supply.
inline constexpr std::uint32_t kMidScale = 0x8000;

/// @returns What goes into DHR12L1 for this word: its highest 12 bits.
constexpr std::uint32_t dac_of_word(hal::Word word) noexcept {
  return ((static_cast<std::uint32_t>(word) ^ 0x80000000U) >> 16U) & 0xFFF0U;
}

/// @param[in] code What the DAC puts out (DOR1), 0 to 4095.
constexpr hal::Word word_of_dac(std::uint32_t code) noexcept {
  return static_cast<hal::Word>((code << 20U) ^ 0x80000000U);
}

/// @param[in] code A result of 16 bits, 0 to 65535.
constexpr hal::Word word_of_adc(std::uint32_t code) noexcept {
  return static_cast<hal::Word>((code << 16U) ^ 0x80000000U);
}

/// @param[in] both Results of both ADCs as their common register has them: the master's, which is
///                 the reference, in the lower half.
constexpr hal::Frame frame_of_adcs(std::uint32_t both) noexcept {
  return {word_of_adc(both & 0xFFFFU), word_of_adc(both >> 16U)};
}

/// @returns The step of a ramp from this word to zero: the permitted one, or, where the DAC has
///          rounded the word away from zero, as much more as kMaxRampFrames frames need.
constexpr hal::Word ramp_step(hal::Word from, hal::Word permitted_step) noexcept {
  constexpr auto kFrames = static_cast<std::int64_t>(hal::kMaxRampFrames);
  const std::int64_t distance = from < 0 ? -std::int64_t{from} : std::int64_t{from};
  const std::int64_t least = (distance + kFrames - 1) / kFrames;
  return least > permitted_step ? static_cast<hal::Word>(least) : permitted_step;
}

/// @param[in] step 1 or more.
/// @returns The next word on the way to zero.
constexpr hal::Word towards_zero(hal::Word word, hal::Word step) noexcept {
  if (word > 0) {
    return word > step ? word - step : 0;
  }
  return word < -step ? word + step : 0;
}

}  // namespace emax::board
