// Phi x by one forward and one backward recursion over the cells.
#include "emax/energy/phi_operator.hpp"

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"

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
  model_ = &model;
  cells_ = cells;
  duration_s_ = duration_s;
  count_ = model.modes().size();
  endless_diagonal_ = 0.0;
  const double h = duration_s / static_cast<double>(cells);
  for (std::size_t m = 0; m < count_; ++m) {
    const Mode mode = model.modes()[m];
    const Complex z = h * mode.pole;
    const Complex width = h * phi1(z);
    step_[m] = exp(z);
    end_[m] = mode.residue * width;
    const Complex correlation = model.correlation(m);
    correlation_[m] = correlation * width * width;
    endless_diagonal_ += 2.0 * h * h * real_of_product(correlation, phi2(z));
    if (m == 0) {
      diagonal_limit_ = endless_diagonal_;
    }
  }
  if (model.feedthrough() != 0.0) {
    const double at_once = h * model.feedthrough() * model.feedthrough();
    endless_diagonal_ += at_once;
    diagonal_limit_ += at_once;
  }
  // Without a second mode the last one is taken together with one that is nothing.
  step_[count_] = {};
  end_[count_] = {};
  correlation_[count_] = {};
  const bool square = model.is_square();
  if (square) {
    diagonal_limit_ = endless_diagonal_;
  }
  fill_pulses(square ? count_ : 1);
  return Status::kOk;
}

/// Of a pulse of w cells: w times the diagonal of Phi's Toeplitz part and twice (w - d) times the
/// element at each distance d. The limit counts the first modes only.
void PhiOperator::fill_pulses(std::size_t modes_of_limit) noexcept {
  Complex term[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    term[m] = correlation_[m];
  }
  double rise = endless_diagonal_;
  double rise_of_limit = diagonal_limit_;
  double energy = 0.0;
  double limit = 0.0;
  greatest_pulse_limit_ = 0.0;
  for (std::size_t width = 1; width <= kMaxPulse; ++width) {
    energy += rise;
    limit += rise_of_limit;
    endless_pulse_[width - 1] = energy;
    pulse_limit_[width - 1] = limit;
    greatest_pulse_limit_ = limit > greatest_pulse_limit_ ? limit : greatest_pulse_limit_;
    for (std::size_t m = 0; m < count_; ++m) {
      rise += 2.0 * term[m].re;
      rise_of_limit += m < modes_of_limit ? 2.0 * term[m].re : 0.0;
      term[m] = step_[m] * term[m];
    }
  }
}

namespace {

/// The first cell after the stretch of one value that begins at a cell.
std::size_t stretch_end(Signs signs, std::size_t begin) noexcept { return signs.run_end(begin); }
std::size_t stretch_end(Span<const double>, std::size_t begin) noexcept { return begin + 1; }
/// The first cell of the stretch of one value that ends before a cell.
std::size_t stretch_begin(Signs signs, std::size_t end) noexcept {
  return signs.run_begin(end - 1);
}
std::size_t stretch_begin(Span<const double>, std::size_t end) noexcept { return end - 1; }

}  // namespace

// Two modes at a time, which with their states and factors fit into the registers of a processor,
// and stretch by stretch of equal signs, in which nothing has to be fetched but the product.
template <typename Signal>
void PhiOperator::apply(Signal signal, Span<double> product) const noexcept {
  for (std::size_t i = 0; i < cells_; ++i) {
    product[i] = endless_diagonal_ * signal[i];
  }
  Complex at_end[kPlaces];
  for (std::size_t m = 0; m < count_; m += 2) {
    const Complex step[2] = {step_[m], step_[m + 1]};
    const Complex correlation[2] = {correlation_[m], correlation_[m + 1]};
    Complex first;
    Complex second;
    for (std::size_t i = 0; i < cells_;) {
      const double value = signal[i];
      for (const std::size_t end = stretch_end(signal, i); i < end; ++i) {
        product[i] = product[i] + real_of_product(correlation[0], first) +
                     real_of_product(correlation[1], second);
        first = step[0] * first;
        second = step[1] * second;
        first.re += value;
        second.re += value;
      }
    }
    at_end[m] = end_[m] * first;
    at_end[m + 1] = end_[m + 1] * second;
  }
  // Going back from T, one complex number per mode carries both what comes from later cells and
  // what is missing because the record ends at T.
  Complex back[kPlaces];
  for (std::size_t m = 0; m < count_; ++m) {
    back[m] = end_[m] * model_->gramian_row(m, at_end);
  }
  for (std::size_t m = 0; m < count_; m += 2) {
    const Complex step[2] = {step_[m], step_[m + 1]};
    Complex first = back[m];
    Complex second = back[m + 1];
    for (std::size_t i = cells_; i != 0;) {
      const std::size_t begin = stretch_begin(signal, i);
      const double value = signal[begin];
      const Complex added[2] = {value * correlation_[m], value * correlation_[m + 1]};
      while (i != begin) {
        --i;
        product[i] = product[i] + first.re + second.re;
        first = step[0] * first + added[0];
        second = step[1] * second + added[1];
      }
    }
  }
}

void PhiOperator::multiply(Signs signs, Span<double> product) const noexcept {
  apply(signs, product);
}

void PhiOperator::multiply(Span<const double> signal, Span<double> product) const noexcept {
  apply(signal, product);
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
    back[m] = end_[m] * model_->gramian_row(m, at_end);
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

double PhiOperator::pulse(std::size_t cell, std::size_t width) const noexcept {
  const std::size_t cells_after = cells_ - width - cell;
  Complex at_end[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    Complex sum{1.0, 0.0};
    for (std::size_t i = 1; i < width; ++i) {
      sum = step_[m] * sum;
      sum.re += 1.0;
    }
    at_end[m] = end_[m] * sum * power(step_[m], cells_after);
  }
  return endless_pulse_[width - 1] + model_->gramian_form(at_end);
}

}  // namespace emax
