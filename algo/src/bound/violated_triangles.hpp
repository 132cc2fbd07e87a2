// The triangle inequalities that unit vectors violate most.
#pragma once

#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/bound/energy_certificate.hpp"

namespace emax {

/// Looks at all triangles and keeps the most violated ones, in a heap with the least violated of
/// them on top.
class ViolatedTriangles {
 public:
  /// @param[in] heap Room for as many as are wanted; not empty.
  /// @param[in] least What a violation has to be above.
  ViolatedTriangles(Span<ViolatedTriangle> heap, double least) noexcept
      : heap_(heap), least_(least) {}

  /// @param[in] products Of the vectors of each pair of cells, above the diagonal of a square
  ///                     matrix of `cells` rows.
  void search(const double* products, std::size_t cells) noexcept;

  /// In the order of the heap.
  Span<const ViolatedTriangle> found() const noexcept { return {heap_.data(), count_}; }

 private:
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

  Span<ViolatedTriangle> heap_;
  std::size_t count_ = 0;
  double least_;
};

}  // namespace emax
