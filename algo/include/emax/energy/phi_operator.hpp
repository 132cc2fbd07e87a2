// The kernel Phi on a grid of cells, applied to a signal without storing it.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/capacity.hpp"
#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// Phi of paper equation (5) for signals that are constant on each of N equal cells of [0, T]:
/// E = x' Phi x, exact for such signals (no sampling of y).
///
/// Phi is a Toeplitz matrix (what an endless record would give) minus what the output still holds
/// after T, a form of the modes' states at T. Both are sums over modes of decaying exponentials of
/// the distance between cells, so one forward and one backward recursion apply Phi to a signal.
/// 0.7 KiB, whatever the number of cells, as it refers to the model; so it is made anew where it is
/// needed, which costs less than a product with 20 cells. Errors are of the order of rounding
/// relative to the endless record's energy.
class PhiOperator {
 public:
  /// Prepares for `cells` cells on [0, `duration_s`].
  ///
  /// @param[in] model Outlives the use of this object and stays as it is meanwhile.
  /// @returns
  /// * kOk: Ready.
  /// * kInvalidArgument: Duration not above 0 or not finite, or no cell.
  /// * kTooManyCells: More than kMaxCells.
  Status set(const ModalModel& model, double duration_s, std::size_t cells) noexcept;
  Status set(ModalModel&& model, double duration_s, std::size_t cells) = delete;

  std::size_t cells() const noexcept { return cells_; }
  double duration_s() const noexcept { return duration_s_; }

  /// What the operator is made of, mode by mode: the factor of one cell's width, e^(p h).
  Complex step(std::size_t mode) const noexcept { return step_[mode]; }
  /// The Toeplitz part at a distance of d >= 1 cells is Re sum correlation step^(d - 1).
  Complex correlation(std::size_t mode) const noexcept { return correlation_[mode]; }
  /// What the last cell leaves in the mode's output at T.
  Complex end(std::size_t mode) const noexcept { return end_[mode]; }
  /// The diagonal of the Toeplitz part.
  double endless_diagonal() const noexcept { return endless_diagonal_; }
  /// The energy of a pulse in an endless record, 1 <= width <= kMaxPulse.
  double endless_pulse(std::size_t width) const noexcept { return endless_pulse_[width - 1]; }

  /// product = Phi signs; both have `cells()` elements.
  /// Two complex products and two complex sums per mode, cell and direction.
  void multiply(Signs signs, Span<double> product) const noexcept;

  /// The same for a signal with any values.
  void multiply(Span<const double> signal, Span<double> product) const noexcept;

  /// product += scale * (column `cell` of Phi). Half the cost of `multiply()`.
  void add_column(std::size_t cell, double scale, Span<double> product) const noexcept;

  /// Phi(cell, cell): a product with the Gramian.
  double diagonal(std::size_t cell) const noexcept { return pulse(cell, 1); }

  /// The longest pulse, in cells, that `pulse()` and `pulse_limit()` know.
  static constexpr std::size_t kMaxPulse = 8;

  /// The energy of a signal that is 1 on `width` cells from `cell` on and 0 elsewhere: a product
  /// with the Gramian. 1 <= width <= kMaxPulse, and the pulse ends at T or before.
  double pulse(std::size_t cell, std::size_t width) const noexcept;

  /// No pulse of that width has more energy than this, which is what it has in an endless record;
  /// for the energy difference, at the sensor's output alone. Free of charge.
  double pulse_limit(std::size_t width) const noexcept { return pulse_limit_[width - 1]; }

  /// The greatest of the `pulse_limit()`s.
  double greatest_pulse_limit() const noexcept { return greatest_pulse_limit_; }

  /// No element of the diagonal is larger than this, which is that of an endless record; for the
  /// energy difference, that of the sensor alone. Free of charge.
  double diagonal_limit() const noexcept { return diagonal_limit_; }

 private:
  template <typename Signal>
  void apply(Signal signal, Span<double> product) const noexcept;
  static constexpr std::size_t kPlaces = kMaxModes + 1;  // One that is nothing follows the modes.

  void fill_pulses(std::size_t modes_of_limit) noexcept;

  const ModalModel* model_ = nullptr;
  Complex step_[kPlaces] = {};         // e^(p h)
  Complex correlation_[kPlaces] = {};  // the Toeplitz part at distance d >= 1 is Re sum
                                       // correlation step^(d - 1)
  Complex end_[kPlaces] = {};          // response of the last cell's mode at T
  double endless_pulse_[kMaxPulse] = {};
  double pulse_limit_[kMaxPulse] = {};
  double greatest_pulse_limit_ = 0.0;
  double endless_diagonal_ = 0.0;
  double diagonal_limit_ = 0.0;
  double duration_s_ = 0.0;
  std::size_t cells_ = 0;
  std::size_t count_ = 0;
};

static_assert(std::is_trivially_copyable_v<PhiOperator>);

}  // namespace emax
