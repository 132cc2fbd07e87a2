// The triangle inequalities that unit vectors violate most.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"

namespace emax {

/// An inequality of the cells i < j < k, of one of the four kinds in `kTriangleSigns`.
struct ViolatedTriangle {
  double violation = 0.0;  // By how much the sum of the three signed products is above 1.
  std::uint16_t i = 0;
  std::uint16_t j = 0;
  std::uint16_t k = 0;
  std::uint8_t kind = 0;
};

/// Looks at all triangles and keeps the most violated ones, in a heap with the least violated of
/// them on top. 16 KiB.
class ViolatedTriangles {
 public:
  /// 2 per cell, at most 1024.
  static constexpr std::size_t most(std::size_t cells) noexcept {
    return 2 * cells < kRoom ? 2 * cells : kRoom;
  }

  /// @param[in] products Of the vectors of each pair of cells, above the diagonal of a square
  ///                     matrix of `cells` rows.
  void search(const double* products, std::size_t cells) noexcept;

  /// At most `most(cells)`, in the order of the heap.
  Span<const ViolatedTriangle> found() const noexcept { return {heap_, count_}; }

 private:
  static constexpr std::size_t kRoom = 1024;
  static constexpr double kLeastViolation = 0.01;

  /// The rows of two cells, and the products of a third one with both.
  struct Pair {
    std::size_t i;
    std::size_t j;
    const double* from_i;
    const double* from_j;
  };

  bool has_violated(const Pair& pair, std::size_t first, std::size_t last) const noexcept;
  void keep_violated(const Pair& pair, std::size_t first, std::size_t last) noexcept;
  void keep(const ViolatedTriangle& triangle) noexcept;
  void rise(const ViolatedTriangle& triangle) noexcept;
  void replace_least(const ViolatedTriangle& triangle) noexcept;

  ViolatedTriangle heap_[kRoom];
  std::size_t count_ = 0;
  std::size_t limit_ = 0;
  double least_ = kLeastViolation;  // What a triangle has to be above.
};

}  // namespace emax
