// A pattern of signs with memory of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "emax/base/signs.hpp"

namespace emax::test {

class SignPattern {
 public:
  explicit SignPattern(std::size_t cells) : words_(sign_words(cells)), cells_(cells) {
    for (std::size_t i = 0; i < cells; ++i) {
      view().set(i, true);
    }
  }
  /// @param[in] signs Numbers above or below 0.
  explicit SignPattern(const std::vector<int>& signs) : SignPattern(signs.size()) {
    for (std::size_t i = 0; i < cells_; ++i) {
      view().set(i, signs[i] > 0);
    }
  }

  Signs view() const { return Signs(Span<std::uint32_t>(words_.data(), words_.size()), cells_); }
  std::size_t size() const { return cells_; }

 private:
  mutable std::vector<std::uint32_t> words_;
  std::size_t cells_;
};

template <typename Random>
SignPattern random_signs(std::size_t cells, Random& random) {
  SignPattern signs(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    signs.view().set(i, random() % 2 == 0);
  }
  return signs;
}

}  // namespace emax::test
