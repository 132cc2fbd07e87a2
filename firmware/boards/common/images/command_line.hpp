// The arguments of a test image.
#pragma once

#include <cstddef>

#include "emax/base/span.hpp"

namespace emax::board {

inline constexpr std::size_t kCommandLineRoom = 400;

/// The words of a text, parted by single blanks.
class Words {
 public:
  constexpr explicit Words(Span<const char> text) noexcept : rest_(text) {}

  bool done() const noexcept { return rest_.empty(); }

  /// @returns The next word; an empty one if there is none.
  Span<const char> next() noexcept;

  /// @returns The last word, after which it is `done()`.
  Span<const char> last() noexcept;

 private:
  Span<const char> rest_;
};

/// @param[in] name Ends with a zero.
bool is(Span<const char> word, const char* name) noexcept;

}  // namespace emax::board
