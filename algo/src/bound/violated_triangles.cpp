// All triangles in blocks, most of which one comparison rules out, and a heap.
#include "violated_triangles.hpp"

#include "emax/base/elementary.hpp"

namespace emax {

void ViolatedTriangles::search(const double* products, std::size_t cells) noexcept {
  constexpr std::size_t kBlock = 16;
  count_ = 0;
  for (std::size_t i = 0; i + 2 < cells; ++i) {
    for (std::size_t j = i + 1; j + 1 < cells; ++j) {
      const Pair pair = {i, j, products + i * cells, products + j * cells};
      for (std::size_t first = j + 1; first < cells; first += kBlock) {
        const std::size_t last = first + kBlock < cells ? first + kBlock : cells;
        if (has_violated(pair, first, last)) {
          keep_violated(pair, first, last);
        }
      }
    }
  }
}

// The largest of the four is |ij - jk| + ... in closed form: kinds 1 and 2 are ik - 1 + |ij - jk|,
// kinds 0 and 3 are -ik - 1 + |ij + jk|.
bool ViolatedTriangles::has_violated(const Pair& pair, std::size_t first,
                                     std::size_t last) const noexcept {
  const double ij = pair.from_i[pair.j];
  double largest = -1.0;
  for (std::size_t k = first; k < last; ++k) {
    const double difference = abs(ij - pair.from_j[k]) + pair.from_i[k];
    const double sum = abs(ij + pair.from_j[k]) - pair.from_i[k];
    const double both = difference > sum ? difference : sum;
    largest = both > largest ? both : largest;
  }
  return largest - 1.0 > least_;
}

void ViolatedTriangles::keep_violated(const Pair& pair, std::size_t first,
                                      std::size_t last) noexcept {
  const double ij = pair.from_i[pair.j];
  for (std::size_t k = first; k < last; ++k) {
    for (std::size_t kind = 0; kind < 4; ++kind) {
      const std::int8_t* const signs = kTriangleSigns[kind];
      const double violation =
          signs[0] * ij + signs[1] * pair.from_j[k] + signs[2] * pair.from_i[k] - 1.0;
      if (violation > least_) {
        keep({violation, static_cast<std::uint16_t>(pair.i), static_cast<std::uint16_t>(pair.j),
              static_cast<std::uint16_t>(k), static_cast<std::uint8_t>(kind)});
      }
    }
  }
}

void ViolatedTriangles::keep(const ViolatedTriangle& triangle) noexcept {
  if (count_ < heap_.size()) {
    rise(triangle);
  } else {
    replace_least(triangle);
  }
  least_ = count_ == heap_.size() ? heap_[0].violation : least_;
}

// From a new place at the end of the heap.
void ViolatedTriangles::rise(const ViolatedTriangle& triangle) noexcept {
  std::size_t at = count_++;
  while (at > 0 && triangle.violation < heap_[(at - 1) / 2].violation) {
    heap_[at] = heap_[(at - 1) / 2];
    at = (at - 1) / 2;
  }
  heap_[at] = triangle;
}

// The top goes, and the triangle sinks from there.
void ViolatedTriangles::replace_least(const ViolatedTriangle& triangle) noexcept {
  std::size_t at = 0;
  for (std::size_t child = 1; child < count_; child = 2 * at + 1) {
    if (child + 1 < count_ && heap_[child + 1].violation < heap_[child].violation) {
      ++child;
    }
    if (!(heap_[child].violation < triangle.violation)) {
      break;
    }
    heap_[at] = heap_[child];
    at = child;
  }
  heap_[at] = triangle;
}

}  // namespace emax
