// Words and their comparison.
#include "command_line.hpp"

namespace emax::board {

Span<const char> Words::next() noexcept {
  std::size_t length = 0;
  while (length < rest_.size() && rest_[length] != ' ') {
    ++length;
  }
  const Span<const char> word = rest_.first(length);
  rest_ = rest_.from(length < rest_.size() ? length + 1 : length);
  return word;
}

Span<const char> Words::last() noexcept {
  Span<const char> word;
  while (!done()) {
    word = next();
  }
  return word;
}

bool is(Span<const char> word, const char* name) noexcept {
  for (const char character : word) {
    if (character != *name) {
      return false;
    }
    ++name;
  }
  return *name == '\0';
}

}  // namespace emax::board
