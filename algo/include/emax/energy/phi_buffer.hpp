// The kernel Phi on a grid of cells, stored in a buffer of fixed size.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// The number of doubles that the packed upper triangle of Phi takes.
constexpr std::size_t packed_size(std::size_t cells) noexcept { return cells * (cells + 1) / 2; }

/// A view of Phi, paper equation (5), as a symmetric matrix of exact integrals over pairs of cells,
/// E = x' Phi x; its upper triangle row by row in memory that somebody else owns.
class PhiMatrix {
 public:
  constexpr PhiMatrix(Span<const double> packed, std::size_t cells) noexcept
      : packed_(packed), cells_(cells) {}

  std::size_t cells() const noexcept { return cells_; }

  /// Phi(i, j), in either order.
  double at(std::size_t i, std::size_t j) const noexcept {
    return i <= j ? packed_[row(i) + j - i] : packed_[row(j) + i - j];
  }
  double diagonal(std::size_t cell) const noexcept { return packed_[row(cell)]; }

  /// product = Phi signs; both have `cells()` elements. cells^2 additions.
  void multiply(Signs signs, Span<double> product) const noexcept;

  /// product += scale * (column `cell` of Phi). cells multiplications.
  void add_column(std::size_t cell, double scale, Span<double> product) const noexcept;

 private:
  constexpr std::size_t row(std::size_t i) const noexcept {
    return i * cells_ - i * (i + 1) / 2 + i;
  }

  Span<const double> packed_;
  std::size_t cells_ = 0;
};

/// Fills the packed upper triangle of Phi for equal cells on [0, `duration_s`].
///
/// Phi(i, j) = Phi(i + 1, j + 1) + what the last stretch of one cell's width before T adds: one sum
/// over modes for each element, one product with the Gramian for each row.
///
/// @param[out] packed At least `packed_size(cells)` doubles.
/// @returns
/// * kOk: Filled.
/// * kInvalidArgument: Duration not above 0 or not finite, or no cell.
/// * kBufferTooSmall: `packed` does not hold the triangle; it is untouched.
Status fill_phi(const ModalModel& model, double duration_s, std::size_t cells,
                Span<double> packed) noexcept;

/// Memory for Phi of up to `kCells` cells: 8 bytes for each of kCells (kCells + 1) / 2 elements, 66
/// KiB for 128 cells.
template <std::size_t kCells>
class PhiBuffer {
 public:
  static constexpr std::size_t kCapacity = kCells;

  /// As `fill_phi()`; the matrix of before is lost only if the answer is kOk.
  Status fill(const ModalModel& model, double duration_s, std::size_t cells) noexcept {
    const Status status = fill_phi(model, duration_s, cells, packed_);
    if (status == Status::kOk) {
      cells_ = cells;
    }
    return status;
  }

  PhiMatrix matrix() const noexcept { return PhiMatrix(packed_, cells_); }

 private:
  double packed_[packed_size(kCells)] = {};
  std::size_t cells_ = 0;
};

static_assert(std::is_trivially_copyable_v<PhiBuffer<2>>);

}  // namespace emax
