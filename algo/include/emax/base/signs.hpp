// A pattern of signs, one bit for each cell.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"

namespace emax {

/// The number of 32-bit words that a pattern of `cells` signs takes.
constexpr std::size_t sign_words(std::size_t cells) noexcept { return (cells + 31) / 32; }

/// A view of a pattern of signs +1 and -1 in memory that somebody else owns. Memory of zeros is a
/// pattern of -1.
class Signs {
 public:
  /// Of a word.
  static constexpr std::size_t kBits = 32;

  /// @param[in] words At least `sign_words(cells)` of them.
  constexpr Signs(Span<std::uint32_t> words, std::size_t cells) noexcept
      : words_(words.data()), size_(cells) {}

  constexpr std::size_t size() const noexcept { return size_; }

  bool is_positive(std::size_t cell) const noexcept {
    return (words_[cell / kBits] >> (cell % kBits) & 1U) != 0;
  }
  /// @returns +1 or -1.
  double operator[](std::size_t cell) const noexcept { return is_positive(cell) ? 1.0 : -1.0; }

  /// The first cell after the run of equal signs that begins at a cell.
  std::size_t run_end(std::size_t cell) const noexcept {
    const std::uint32_t sign = is_positive(cell) ? ~std::uint32_t{0} : 0;
    std::size_t word = cell / kBits;
    std::uint32_t other = (words_[word] ^ sign) & (~std::uint32_t{0} << (cell % kBits));
    while (other == 0) {
      if (++word == sign_words(size_)) {
        return size_;
      }
      other = words_[word] ^ sign;
    }
    const std::size_t end = kBits * word + static_cast<std::size_t>(__builtin_ctz(other));
    return end < size_ ? end : size_;
  }
  /// The first cell of the run of equal signs that ends with a cell.
  std::size_t run_begin(std::size_t cell) const noexcept {
    const std::uint32_t sign = is_positive(cell) ? ~std::uint32_t{0} : 0;
    std::size_t word = cell / kBits;
    std::uint32_t other = (words_[word] ^ sign) & (~std::uint32_t{0} >> (kBits - 1 - cell % kBits));
    while (other == 0) {
      if (word == 0) {
        return 0;
      }
      --word;
      other = words_[word] ^ sign;
    }
    return kBits * (word + 1) - static_cast<std::size_t>(__builtin_clz(other));
  }

  void set(std::size_t cell, bool positive) const noexcept {
    const std::uint32_t bit = std::uint32_t{1} << (cell % kBits);
    std::uint32_t& word = words_[cell / kBits];
    word = positive ? word | bit : word & ~bit;
  }
  void turn(std::size_t cell) const noexcept {
    words_[cell / kBits] ^= std::uint32_t{1} << (cell % kBits);
  }
  /// 32 signs at once, the cell of the lowest number in the lowest bit. In the last word, bits
  /// beyond the pattern may be anything.
  std::uint32_t word(std::size_t index) const noexcept { return words_[index]; }
  void set_word(std::size_t index, std::uint32_t signs) const noexcept { words_[index] = signs; }

  /// The first cell from `cell` on whose sign differs from that of another pattern of the same
  /// size, or `size()`.
  std::size_t first_difference(Signs other, std::size_t cell) const noexcept {
    return first_of(other, cell, 0);
  }
  /// The first cell from `cell` on with the sign of another pattern of the same size, or `size()`.
  std::size_t first_agreement(Signs other, std::size_t cell) const noexcept {
    return first_of(other, cell, ~std::uint32_t{0});
  }
  /// Takes the signs of a pattern of the same size.
  void copy(Signs other) const noexcept {
    for (std::size_t i = 0; i < sign_words(size_); ++i) {
      words_[i] = other.words_[i];
    }
  }

 private:
  /// The first cell where the two signs differ, all answers turned by `turned`.
  std::size_t first_of(Signs other, std::size_t cell, std::uint32_t turned) const noexcept {
    if (cell >= size_) {
      return size_;
    }
    std::size_t index = cell / kBits;
    std::uint32_t found =
        (words_[index] ^ other.words_[index] ^ turned) & (~std::uint32_t{0} << (cell % kBits));
    while (found == 0) {
      if (++index == sign_words(size_)) {
        return size_;
      }
      found = words_[index] ^ other.words_[index] ^ turned;
    }
    const std::size_t first = kBits * index + static_cast<std::size_t>(__builtin_ctz(found));
    return first < size_ ? first : size_;
  }

  std::uint32_t* words_;
  std::size_t size_;
};

}  // namespace emax
