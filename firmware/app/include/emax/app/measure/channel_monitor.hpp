// Watches the words of one channel: full scale, the same word over and over, the converter's step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/hal/analog_stream.hpp"

namespace emax::app {

/// Takes the words of one channel one by one; a few integer operations each. 32 bytes.
class ChannelMonitor {
 public:
  void add(hal::Word word) noexcept {
    all_bits_ |= static_cast<std::uint32_t>(word);
    if (word >= kFullScale || word <= -kFullScale) {
      rails_ |= word > 0 ? 1U : 2U;
      ++full_scale_words_;
      equal_words_ = 0;
    } else if (word != last_) {
      equal_words_ = 0;
    } else {
      ++equal_words_;
    }
    last_ = word;
  }

  /// Words at full scale since the last `clear_full_scale()`.
  std::uint32_t full_scale_words() const noexcept { return full_scale_words_; }
  void clear_full_scale() noexcept { full_scale_words_ = 0; }

  /// @returns Whether full scale was reached, and of one sign only, since `clear_rails()`: by an
  /// offset, and not by a swing.
  bool is_at_one_rail() const noexcept { return rails_ == 1U || rails_ == 2U; }
  void clear_rails() noexcept { rails_ = 0; }

  /// How many words in a row were the same as the one before them, full scale apart.
  std::uint64_t equal_words() const noexcept { return equal_words_; }
  void clear_equal_words() noexcept { equal_words_ = 0; }

  /// @returns The step of the converter as a fraction of full scale: the lowest bit that any word
  /// had set. Words are left-justified.
  double step() const noexcept;

 private:
  /// One in 2048 below 2^31: the largest word of a converter of 12 bits or more.
  static constexpr hal::Word kFullScale = 0x7FF00000;

  std::uint64_t equal_words_ = 0;
  std::uint32_t full_scale_words_ = 0;
  std::uint32_t all_bits_ = 0;
  std::uint32_t rails_ = 0;
  hal::Word last_ = 0;
};

static_assert(std::is_trivially_copyable_v<ChannelMonitor>);

}  // namespace emax::app
