// Phi in single precision: products from scratch, and by the stretches that change.
#include "emax/energy/float_phi.hpp"

#include <cstdint>

#include "emax/base/complex_exp.hpp"
#include "emax/base/elementary.hpp"

namespace emax {
namespace {

/// Below this part of the diagonal, what the end of the record takes away is left out.
constexpr float kNegligible = 5e-7F;
/// What is left at T below this is nothing, before it leaves the range of `float`.
constexpr float kNothing = 1e-20F;
/// Cells between two looks at whether it is.
constexpr std::size_t kCellsPerLook = 16;

/// The value of a cell, and the stretch of one value that it is in.
float value_at(Signs signs, std::size_t cell) noexcept {
  return signs.is_positive(cell) ? 1.0F : -1.0F;
}
float value_at(Span<const float> signal, std::size_t cell) noexcept { return signal[cell]; }
std::size_t stretch_end(Signs signs, std::size_t begin) noexcept { return signs.run_end(begin); }
std::size_t stretch_end(Span<const float>, std::size_t begin) noexcept { return begin + 1; }
std::size_t stretch_begin(Signs signs, std::size_t end) noexcept {
  return signs.run_begin(end - 1);
}
std::size_t stretch_begin(Span<const float>, std::size_t end) noexcept { return end - 1; }

float size(FloatComplex z) noexcept {
  return (z.re < 0.0F ? -z.re : z.re) + (z.im < 0.0F ? -z.im : z.im);
}

}  // namespace

void FloatPhi::set(const ModalModel& model, const PhiOperator& phi) noexcept {
  cells_ = phi.cells();
  count_ = model.modes().size();
  const double diagonal = abs(phi.endless_diagonal());
  scale_ = diagonal > phi.diagonal_limit() ? diagonal : phi.diagonal_limit();
  const double inverse = 1.0 / scale_;
  const double inverse_root = sqrt(inverse);
  std::size_t pair = 0;
  for (std::size_t m = 0; m < count_; ++m) {
    step_[m] = single(phi.step(m));
    correlation_[m] = single(inverse * phi.correlation(m));
    end_[m] = single(inverse_root * phi.end(m));
    for (std::size_t i = 0; i <= m; ++i, ++pair) {
      gramian_[pair] = single(model.gramian(i, m));
      conjugate_gramian_[pair] = single(model.conjugate_gramian(i, m));
    }
  }
  for (std::size_t m = count_; m < kPlaces; ++m) {
    step_[m] = {};
    correlation_[m] = {};
    end_[m] = {};
  }
  greatest_limit_per_cell_ = 0.0F;
  for (std::size_t width = 1; width <= kMaxPulse; ++width) {
    endless_pulse_[width - 1] = static_cast<float>(inverse * phi.endless_pulse(width));
    const auto limit = static_cast<float>(inverse * phi.pulse_limit(width));
    pulse_limit_[width - 1] = limit;
    const float per_cell = limit / static_cast<float>(width);
    greatest_limit_per_cell_ =
        per_cell > greatest_limit_per_cell_ ? per_cell : greatest_limit_per_cell_;
  }
  endless_diagonal_ = static_cast<float>(inverse * phi.endless_diagonal());
  edge_ = 0.0;
}

// At a distance of d cells behind an edge, a signal of +1 from there on and -1 before has the
// Toeplitz part's diagonal and twice its elements at the distances 1 to d; before the edge the same
// with the other sign. Two edges make a stretch.
void FloatPhi::fill_table(const PhiOperator& phi, std::size_t begin, std::size_t end,
                          Span<float> table) noexcept {
  Complex term[kMaxModes];
  const double inverse = 1.0 / scale_;
  for (std::size_t m = 0; m < count_; ++m) {
    term[m] = (2.0 * inverse) *
              (begin < 2 ? phi.correlation(m) : phi.correlation(m) * power(phi.step(m), begin - 1));
  }
  std::size_t i = begin;
  if (i == 0) {
    edge_ = inverse * phi.endless_diagonal();
    table[0] = static_cast<float>(edge_);
    i = 1;
  }
  for (; i < end; ++i) {
    for (std::size_t m = 0; m < count_; ++m) {
      edge_ += term[m].re;
      term[m] = phi.step(m) * term[m];
    }
    table[i] = static_cast<float>(edge_);
  }
}

template <typename Signal>
void FloatPhi::apply(Signal signal, Span<float> product) const noexcept {
  for (std::size_t i = 0; i < cells_; ++i) {
    product[i] = endless_diagonal_ * value_at(signal, i);
  }
  End at_end;
  // Two modes at a time, which with their states and factors fit into the registers.
  for (std::size_t m = 0; m < count_; m += 2) {
    const FloatComplex step[2] = {step_[m], step_[m + 1]};
    const FloatComplex correlation[2] = {correlation_[m], correlation_[m + 1]};
    FloatComplex first;
    FloatComplex second;
    for (std::size_t i = 0; i < cells_;) {
      const float value = value_at(signal, i);
      for (const std::size_t end = stretch_end(signal, i); i < end; ++i) {
        product[i] = product[i] + real_of_product(correlation[0], first) +
                     real_of_product(correlation[1], second);
        first = step[0] * first;
        second = step[1] * second;
        first.re += value;
        second.re += value;
      }
    }
    at_end.output[m] = end_[m] * first;
    if (m + 1 < count_) {
      at_end.output[m + 1] = end_[m + 1] * second;
    }
  }
  FloatComplex back[kPlaces];
  fill_back(at_end.output, back);
  for (std::size_t m = 0; m < count_; m += 2) {
    const FloatComplex step[2] = {step_[m], step_[m + 1]};
    FloatComplex first = back[m];
    FloatComplex second = back[m + 1];
    for (std::size_t i = cells_; i != 0;) {
      const std::size_t begin = stretch_begin(signal, i);
      const float value = value_at(signal, begin);
      const FloatComplex added[2] = {value * correlation_[m], value * correlation_[m + 1]};
      while (i != begin) {
        --i;
        product[i] = product[i] + first.re + second.re;
        first = step[0] * first + added[0];
        second = step[1] * second + added[1];
      }
    }
  }
}

void FloatPhi::multiply(Signs signs, Span<float> product) const noexcept { apply(signs, product); }

void FloatPhi::multiply(Span<const float> signal, Span<float> product) const noexcept {
  apply(signal, product);
}

/// What the cells from `begin` to before `end` leave in a mode's output at T: their sum of powers
/// of the step by doubling, then as many more powers as there are cells behind them.
FloatComplex FloatPhi::left_at_end(std::size_t mode, std::size_t begin,
                                   std::size_t end) const noexcept {
  const FloatComplex step = step_[mode];
  const auto width = static_cast<std::uint32_t>(end - begin);
  FloatComplex sum{1.0F, 0.0F};  // of the powers below those bits of the width that are seen
  FloatComplex factor = step;    // step to that
  for (std::uint32_t bit = (std::uint32_t{1} << (31 - __builtin_clz(width))) / 2; bit != 0;
       bit /= 2) {
    sum = sum + factor * sum;
    factor = factor * factor;
    if ((width & bit) != 0) {
      sum = step * sum;
      sum.re += 1.0F;
      factor = step * factor;
    }
  }
  FloatComplex square = step;
  FloatComplex result = end_[mode] * sum;
  for (std::size_t n = cells_ - end; n != 0; n /= 2) {
    if (n % 2 != 0) {
      result = square * result;
      if (size(result) < kNothing) {
        return {};
      }
    }
    square = square * square;
  }
  return result;
}

void FloatPhi::add_stretch(std::size_t begin, std::size_t end, float sign, Span<const float> table,
                           Span<float> product, End& at_end) const noexcept {
  const float* first = table.data() + begin;
  const float* second = table.data() + end;
  float* y = product.data();
  std::size_t i = 0;
  for (; i < begin; ++i) {
    --first;
    --second;
    y[i] += sign * (*second - *first);
  }
  for (; i < end; ++i) {
    --second;
    y[i] += sign * (*first + *second);
    ++first;
  }
  for (; i < cells_; ++i) {
    y[i] += sign * (*first - *second);
    ++first;
    ++second;
  }
  const float rise = 2.0F * sign;
  for (std::size_t m = 0; m < count_; ++m) {
    at_end.output[m] = at_end.output[m] + rise * left_at_end(m, begin, end);
  }
}

/// end times 1/2 sum_j [G_ij output_j + H_ij conj output_j] for each mode i.
void FloatPhi::fill_back(const FloatComplex* at_end, FloatComplex* back) const noexcept {
  for (std::size_t m = 0; m < kPlaces; ++m) {
    back[m] = {};
  }
  std::size_t pair = 0;
  for (std::size_t j = 0; j < count_; ++j) {
    const FloatComplex b = at_end[j];
    for (std::size_t i = 0; i < j; ++i, ++pair) {
      const FloatComplex g = gramian_[pair];
      const FloatComplex h = conjugate_gramian_[pair];
      const FloatComplex a = at_end[i];
      back[i].re += (g.re + h.re) * b.re + (h.im - g.im) * b.im;
      back[i].im += (g.im + h.im) * b.re + (g.re - h.re) * b.im;
      // H_ji is the conjugate of H_ij.
      back[j].re += (g.re + h.re) * a.re - (g.im + h.im) * a.im;
      back[j].im += (g.im - h.im) * a.re + (g.re - h.re) * a.im;
    }
    const FloatComplex g = gramian_[pair];
    const FloatComplex h = conjugate_gramian_[pair];
    back[j].re += (g.re + h.re) * b.re + (h.im - g.im) * b.im;
    back[j].im += (g.im + h.im) * b.re + (g.re - h.re) * b.im;
    ++pair;
  }
  for (std::size_t m = 0; m < count_; ++m) {
    back[m] = 0.5F * (end_[m] * back[m]);
  }
}

void FloatPhi::add_end(const End& at_end, Span<float> product) const noexcept {
  FloatComplex back[kPlaces];
  fill_back(at_end.output, back);
  // Three modes at a time: with their factors they fit into the registers of every processor.
  for (std::size_t m = 0; m < count_; m += 3) {
    const FloatComplex step[3] = {step_[m], step_[m + 1], step_[m + 2]};
    FloatComplex first = back[m];
    FloatComplex second = back[m + 1];
    FloatComplex third = back[m + 2];
    float* y = product.data() + cells_;
    std::size_t left = cells_;
    while (left != 0 && size(first) + size(second) + size(third) > kNegligible) {
      const std::size_t count = left < kCellsPerLook ? left : kCellsPerLook;
      for (float* const stop = y - count; y != stop;) {
        --y;
        *y += first.re + second.re + third.re;
        first = step[0] * first;
        second = step[1] * second;
        third = step[2] * third;
      }
      left -= count;
    }
  }
}

/// What the outputs of the modes at T still hold, with the sign of a Gramian.
float FloatPhi::form(const FloatComplex* at_end) const noexcept {
  float form = 0.0F;
  std::size_t pair = 0;
  for (std::size_t j = 0; j < count_; ++j) {
    const FloatComplex b = at_end[j];
    for (std::size_t i = 0; i < j; ++i, ++pair) {
      const FloatComplex g = gramian_[pair];
      const FloatComplex h = conjugate_gramian_[pair];
      form += at_end[i].re * ((g.re + h.re) * b.re + (h.im - g.im) * b.im) -
              at_end[i].im * ((g.im + h.im) * b.re + (g.re - h.re) * b.im);
    }
    const FloatComplex g = gramian_[pair];
    const float h = conjugate_gramian_[pair].re;
    form += 0.5F * (real_of_product(g, b * b) + h * (b.re * b.re + b.im * b.im));
    ++pair;
  }
  return form;
}

/// What each of the next cells, up to kMaxPulse, leaves in the modes' outputs at T.
std::size_t FloatPhi::fill_left(std::size_t cell,
                                FloatComplex (&left)[kMaxPulse][kMaxModes]) const noexcept {
  const std::size_t count = cells_ - cell < kMaxPulse ? cells_ - cell : kMaxPulse;
  for (std::size_t m = 0; m < count_; ++m) {
    FloatComplex of_cell = left_at_end(m, cell + count - 1, cell + count);
    for (std::size_t k = count; k-- > 0;) {
      left[k][m] = of_cell;
      of_cell = step_[m] * of_cell;
    }
  }
  return count;
}

void FloatPhi::fill_pulses(std::size_t cell, Span<float> energies) const noexcept {
  FloatComplex left[kMaxPulse][kMaxModes];
  const std::size_t count = fill_left(cell, left);
  FloatComplex at_end[kMaxModes];
  for (std::size_t k = 0; k < energies.size(); ++k) {
    energies[k] = 0.0F;
    if (k < count) {
      for (std::size_t m = 0; m < count_; ++m) {
        at_end[m] = at_end[m] + left[k][m];
      }
      const float energy = endless_pulse_[k] + form(at_end);
      energies[k] = energy < pulse_limit_[k] ? energy : pulse_limit_[k];
    }
  }
}

float FloatPhi::pulse(std::size_t cell, std::size_t width) const noexcept {
  FloatComplex left[kMaxPulse][kMaxModes];
  (void)fill_left(cell, left);
  FloatComplex at_end[kMaxModes];
  for (std::size_t m = 0; m < count_; ++m) {
    for (std::size_t k = 0; k < width; ++k) {
      at_end[m] = at_end[m] + left[k][m];
    }
  }
  const float energy = endless_pulse_[width - 1] + form(at_end);
  return energy < pulse_limit_[width - 1] ? energy : pulse_limit_[width - 1];
}

}  // namespace emax
