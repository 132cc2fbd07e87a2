// A sample of a converter as a word, and what it is in volts.
#pragma once

#include <cstdint>
#include <limits>

namespace emax::hal {

/// A sample as a signed word, left-justified: full scale is 2^31 and zero volts are 0, whatever the
/// converter's width. A converter of b bits leaves the lowest 32 - b bits of an input word zero,
/// and takes its drive from the highest b bits.
using Word = std::int32_t;

/// From zero volts to full scale.
inline constexpr double kWordsPerFullScale = 2147483648.0;
inline constexpr Word kGreatestWord = std::numeric_limits<Word>::max();

/// @param[in] full_scale_v Of the converter, greater than 0.
constexpr double volts_per_word(double full_scale_v) noexcept {
  return full_scale_v / kWordsPerFullScale;
}

/// @param[in] full_scale_v Of the converter, greater than 0.
constexpr double words_per_volt(double full_scale_v) noexcept {
  return kWordsPerFullScale / full_scale_v;
}

/// The nearest word to a number of words, away from zero in the middle of two; kGreatestWord for
/// what is above it.
///
/// @param[in] words At least -2^31.
constexpr Word nearest_word(double words) noexcept {
  // A conversion drops what follows the point.
  const double word = words < 0.0 ? words - 0.5 : words + 0.5;
  return word < static_cast<double>(kGreatestWord) ? static_cast<Word>(word) : kGreatestWord;
}

/// The greatest word that is not above this voltage, for limits; kGreatestWord from full scale on.
///
/// @param[in] volts        At least -`full_scale_v`.
/// @param[in] full_scale_v Of the converter, greater than 0.
Word greatest_word_within(double volts, double full_scale_v) noexcept;

}  // namespace emax::hal
