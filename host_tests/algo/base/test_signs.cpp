// Runs of equal signs, against a look at each cell.
#include <cstdint>
#include <gtest/gtest.h>
#include <random>

#include "emax/base/signs.hpp"

namespace emax {
namespace {

constexpr std::size_t kMostCells = 100;  // Four words.

/// Runs of 1 to 80 cells, so that some fill whole words. What lies beyond the last cell is random.
void set_random_runs(Signs signs, std::mt19937_64& random) {
  bool positive = random() % 2 == 0;
  for (std::size_t i = 0; i < signs.size(); positive = !positive) {
    for (std::uint64_t left = 1 + random() % (random() % 80 + 1); left != 0 && i < signs.size();
         --left, ++i) {
      signs.set(i, positive);
    }
  }
}

TEST(Signs, RunsEndWhereTheSignChanges) {
  std::mt19937_64 random(17);
  for (std::size_t cells = 1; cells <= kMostCells; ++cells) {
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::uint32_t words[sign_words(kMostCells)];
      for (std::uint32_t& word : words) {
        word = static_cast<std::uint32_t>(random());
      }
      const Signs signs(Span<std::uint32_t>(words), cells);
      set_random_runs(signs, random);
      for (std::size_t i = 0; i < cells; ++i) {
        std::size_t begin = i;
        while (begin != 0 && signs.is_positive(begin - 1) == signs.is_positive(i)) {
          --begin;
        }
        std::size_t end = i + 1;
        while (end != cells && signs.is_positive(end) == signs.is_positive(i)) {
          ++end;
        }
        ASSERT_EQ(signs.run_begin(i), begin) << "cell " << i << " of " << cells;
        ASSERT_EQ(signs.run_end(i), end) << "cell " << i << " of " << cells;
      }
    }
  }
}

TEST(Signs, DifferencesAreFoundWhereTheyAre) {
  std::mt19937_64 random(18);
  for (std::size_t cells = 1; cells <= kMostCells; ++cells) {
    std::uint32_t words[sign_words(kMostCells)];
    std::uint32_t other_words[sign_words(kMostCells)];
    for (std::size_t i = 0; i < sign_words(kMostCells); ++i) {
      words[i] = static_cast<std::uint32_t>(random());
      other_words[i] = static_cast<std::uint32_t>(random());
    }
    const Signs signs(Span<std::uint32_t>(words), cells);
    const Signs other(Span<std::uint32_t>(other_words), cells);
    set_random_runs(signs, random);
    set_random_runs(other, random);
    for (std::size_t i = 0; i <= cells; ++i) {
      std::size_t differs = i;
      while (differs != cells && signs.is_positive(differs) == other.is_positive(differs)) {
        ++differs;
      }
      std::size_t agrees = i;
      while (agrees != cells && signs.is_positive(agrees) != other.is_positive(agrees)) {
        ++agrees;
      }
      ASSERT_EQ(signs.first_difference(other, i), differs) << "cell " << i << " of " << cells;
      ASSERT_EQ(signs.first_agreement(other, i), agrees) << "cell " << i << " of " << cells;
    }
  }
}

}  // namespace
}  // namespace emax
