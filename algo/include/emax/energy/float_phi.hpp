// The kernel Phi on a grid of cells in single precision, for a signal that changes a little at a
// time.
#pragma once

#include <cstddef>
#include <type_traits>

#include "emax/base/float_complex.hpp"
#include "emax/base/signs.hpp"
#include "emax/base/span.hpp"
#include "emax/energy/phi_operator.hpp"
#include "emax/model/modal_model.hpp"

namespace emax {

/// `PhiOperator` in `float`, divided by its largest diagonal so that no sensitivity leaves the
/// range of `float`, and with a table by which a stretch of cells that turns is added to a product.
///
/// For searching only: its products are good to 1e-5 of the largest element where few modes cancel,
/// and to some 1e-3 for filters of order 15. IEEE single precision, so the bits are the same on
/// every target. 1.2 KiB; refers to nothing.
class FloatPhi {
 public:
  /// Takes the numbers of an operator and its model.
  void set(const ModalModel& model, const PhiOperator& phi) noexcept;

  std::size_t cells() const noexcept { return cells_; }
  /// What the operator was divided by, in (V/(m/s^2))^2 s.
  double scale() const noexcept { return scale_; }

  /// Fills some of the table for `add_stretch()`: at a distance of d cells behind an edge, the
  /// product of a signal that is 1 behind the edge and -1 before it, in an endless record.
  ///
  /// @param[in]     phi   The operator of `set()`.
  /// @param[in]     begin The first distance, which follows those that are filled.
  /// @param[in]     end   Behind the last one, at most `cells()`.
  /// @param[in,out] table `cells()` numbers.
  void fill_table(const PhiOperator& phi, std::size_t begin, std::size_t end,
                  Span<float> table) noexcept;

  /// product = Phi signs, by one forward and one backward recursion.
  void multiply(Signs signs, Span<float> product) const noexcept;
  /// The same for a signal with any values.
  void multiply(Span<const float> signal, Span<float> product) const noexcept;

  /// What signals have left in the modes' outputs at T, to be taken away from a product together.
  struct End {
    FloatComplex output[kMaxModes];
  };

  /// Adds to a product what it gains when the cells from `begin` to before `end` rise by 2 `sign`,
  /// as in an endless record, and to `at_end` what they leave at T. Three sums per cell of the
  /// grid.
  void add_stretch(std::size_t begin, std::size_t end, float sign, Span<const float> table,
                   Span<float> product, End& at_end) const noexcept;

  /// Adds to a product what it lacks because the record ends at T: a recursion back from there,
  /// mode by mode as far as it is more than rounding.
  void add_end(const End& at_end, Span<float> product) const noexcept;

  /// The energies of the pulses of 1, 2, ... cells that begin at a cell, not above their limits:
  /// the bits of `pulse()`, all for little more than one of them costs.
  ///
  /// @param[out] energies At most kMaxPulse of them; 0 for a pulse that ends after T.
  void fill_pulses(std::size_t cell, Span<float> energies) const noexcept;

  /// As those of `PhiOperator`.
  static constexpr std::size_t kMaxPulse = PhiOperator::kMaxPulse;
  float pulse(std::size_t cell, std::size_t width) const noexcept;
  float pulse_limit(std::size_t width) const noexcept { return pulse_limit_[width - 1]; }
  /// The greatest `pulse_limit()` per cell of the pulse.
  float greatest_limit_per_cell() const noexcept { return greatest_limit_per_cell_; }

 private:
  template <typename Signal>
  void apply(Signal signal, Span<float> product) const noexcept;
  static constexpr std::size_t kPlaces = kMaxModes + 2;  // Two that are nothing follow the modes.
  static constexpr std::size_t kPairs = kMaxModes * (kMaxModes + 1) / 2;

  FloatComplex left_at_end(std::size_t mode, std::size_t begin, std::size_t end) const noexcept;
  std::size_t fill_left(std::size_t cell,
                        FloatComplex (&left)[kMaxPulse][kMaxModes]) const noexcept;
  float form(const FloatComplex* at_end) const noexcept;
  void fill_back(const FloatComplex* at_end, FloatComplex* back) const noexcept;

  FloatComplex step_[kPlaces] = {};
  FloatComplex correlation_[kPlaces] = {};
  FloatComplex end_[kPlaces] = {};
  FloatComplex gramian_[kPairs] = {};  // Of pairs i <= j, as in the model
  FloatComplex conjugate_gramian_[kPairs] = {};
  float endless_pulse_[kMaxPulse] = {};
  float pulse_limit_[kMaxPulse] = {};
  float greatest_limit_per_cell_ = 0.0F;
  float endless_diagonal_ = 0.0F;
  double scale_ = 0.0;
  double edge_ = 0.0;  // Of the table, as far as it is filled.
  std::size_t cells_ = 0;
  std::size_t count_ = 0;
};

static_assert(std::is_trivially_copyable_v<FloatPhi>);

}  // namespace emax
