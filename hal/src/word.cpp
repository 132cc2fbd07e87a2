// Rounding down to a word.
#include "emax/hal/word.hpp"

#include "emax/base/elementary.hpp"

namespace emax::hal {

Word greatest_word_within(double volts, double full_scale_v) noexcept {
  const double word = floor(volts / full_scale_v * kWordsPerFullScale);
  return word < static_cast<double>(kGreatestWord) ? static_cast<Word>(word) : kGreatestWord;
}

}  // namespace emax::hal
