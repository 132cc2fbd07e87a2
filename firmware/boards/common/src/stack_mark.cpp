// Marks on the stack.
#include "emax/board/stack_mark.hpp"

#include <algorithm>

namespace emax::board {

void mark_stack(Span<std::uint32_t> words) noexcept {
  std::fill(words.begin(), words.end(), kStackMark);
}

std::size_t used_stack_bytes(Span<const std::uint32_t> words) noexcept {
  const auto* used = std::find_if(words.begin(), words.end(),
                                  [](std::uint32_t word) { return word != kStackMark; });
  return static_cast<std::size_t>(words.end() - used) * sizeof(std::uint32_t);
}

}  // namespace emax::board
