// Phi x by one forward and one backward recursion over the cells.
#include "emax/phi_operator.hpp"

#include "emax/complex_exp.hpp"
#include "emax/elementary.hpp"

namespace emax {

// Notation, h being the width of a cell. R(t) = integral of k(s + t) k(s) over s >= 0 is
// Re sum C_m e^(p_m t), C being the model's correlation. Integrated over two cells at a distance of
// d >= 1 cells this is Re sum C ((e^(ph) - 1)/p)^2 e^(p h (d - 1)); over one cell with itself,
// 2 Re sum C (e^(ph) - 1 - ph)/p^2. A cell leaves r (e^(ph) - 1)/p e^(p (T - end of cell)) in mode
// m at T.

Status PhiOperator::set(const ModalModel& model, double duration_s, std::size_t cells) noexcept {
  if (!(duration_s > 0.0) || !is_finite(duration_s) || cells == 0) {
    return Status::kInvalidArgument;
  }
  if (cells > kMaxCells) {
    return Status::kTooManyCells;
  }
  cells_ = cells;
  duration_s_ = duration_s;
  count_ = model.modes().size();
  endless_diagonal_ = 0.0;
  const double h = duration_s / static_cast<double>(cells);
  for (std::size_t m = 0; m < count_; ++m) {
    const Mode mode = model.modes()[m];
    for (std::size_t n = 0; n < count_; ++n) {
      gramian_[m][n] = model.gramian(m, n);
      conjugate_gramian_[m][n] = model.conjugate_gramian(m, n);
    }
    const Complex z = h * mode.pole;
    const Complex width = h * phi1(z);
    pole_h_[m] = z;
    step_[m] = exp(z);
    end_[m] = mode.residue * width;
    correlation_[m] = model.correlation(m) * width * width;
    endless_diagonal_ += 2.0 * h * h * real_of_product(model.correlation(m), phi2(z));
    if (m == 0) {
      diagonal_limit_ = endless_diagonal_;
    }
  }
  if (model.criterion() == Criterion::kIntegralSquareError) {
    diagonal_limit_ = endless_diagonal_;
  }
  return Status::kOk;
}

Complex PhiOperator::held_after_end(std::size_t mode, const Complex* state) const noexcept {
  Complex sum;
  for (std::size_t n = 0; n < count_; ++n) {
    sum = sum + gramian_[mode][n] * state[n] + conjugate_gramian_[mode][n] * conj(state[n]);
  }
  return 0.5 * sum;
}

void PhiOperator::multiply(Span<const std::int8_t> signs, Span<double> product) const noexcept {
  Complex state[kMaxModes];
  for (std::size_t i = 0; i < cells_; ++i) {
    double sum = endless_diagonal_ * signs[i];
    for (std::size_t m = 0; m < count_; ++m) {
      sum += real_of_product(correlation_[m], state[m]);
      state[m] = step_[m] * state[m];
      state[m].re += signs[i];
    }
    product[i] = sum;
  }
  Complex at_end[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    at_end[m] = end_[m] * state[m];
  }
  // Going back from T, one complex number per mode carries both what comes from later cells and
  // what is missing because the record ends at T.
  Complex back[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    back[m] = end_[m] * held_after_end(m, at_end);
  }
  for (std::size_t i = cells_; i-- > 0;) {
    double sum = product[i];
    for (std::size_t m = 0; m < count_; ++m) {
      sum += back[m].re;
      back[m] = step_[m] * back[m] + static_cast<double>(signs[i]) * correlation_[m];
    }
    product[i] = sum;
  }
}

void PhiOperator::add_column(std::size_t cell, double scale, Span<double> product) const noexcept {
  product[cell] += scale * endless_diagonal_;
  Complex forward[kMaxModes];
  Complex at_end[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    forward[m] = scale * correlation_[m];
    at_end[m] = scale * end_[m];
  }
  for (std::size_t i = cell + 1; i < cells_; ++i) {
    double sum = 0.0;
    for (std::size_t m = 0; m < count_; ++m) {
      sum += forward[m].re;
      forward[m] = step_[m] * forward[m];
      at_end[m] = step_[m] * at_end[m];
    }
    product[i] += sum;
  }
  Complex back[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    back[m] = end_[m] * held_after_end(m, at_end);
  }
  for (std::size_t i = cells_; i-- > 0;) {
    double sum = 0.0;
    for (std::size_t m = 0; m < count_; ++m) {
      sum += back[m].re;
      back[m] = step_[m] * back[m];
      if (i == cell) {
        back[m] = back[m] + scale * correlation_[m];
      }
    }
    product[i] += sum;
  }
}

double PhiOperator::diagonal(std::size_t cell) const noexcept {
  const double cells_after = static_cast<double>(cells_ - 1 - cell);
  Complex at_end[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    at_end[m] = end_[m] * exp(cells_after * pole_h_[m]);
  }
  double sum = endless_diagonal_;
  for (std::size_t m = 0; m < count_; ++m) {
    sum += real_of_product(at_end[m], held_after_end(m, at_end));
  }
  return sum;
}

}  // namespace emax
