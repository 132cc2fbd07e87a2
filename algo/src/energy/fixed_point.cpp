// The fixed-point iteration on signs.
#include "emax/energy/fixed_point.hpp"

namespace emax {

bool take_signs(Span<const double> product, double shift, Signs signs) noexcept {
  bool changed = false;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const bool before = signs.is_positive(i);
    const double value = product[i] + shift * signs[i];
    const bool positive = value > 0.0 || (!(value < 0.0) && before);
    if (positive != before) {
      signs.turn(i);
      changed = true;
    }
  }
  return changed;
}

double dot(Signs signs, Span<const double> product) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < signs.size();) {
    const double sign = signs[i];
    for (const std::size_t end = signs.run_end(i); i < end; ++i) {
      sum += sign * product[i];
    }
  }
  return sum;
}

void FixedPoint::start(std::size_t max_iterations, double shift) noexcept {
  result_ = {};
  max_iterations_ = max_iterations;
  shift_ = shift;
  begun_ = false;
  done_ = false;
}

void FixedPoint::take_energy(Signs signs, Signs best, Span<const double> product,
                             Span<double> trace) noexcept {
  const double energy = dot(signs, product);
  if (result_.iterations < trace.size()) {
    trace[result_.iterations] = energy;
  }
  if (!begun_ || energy > result_.energy) {
    result_.energy = energy;
    result_.best = result_.iterations;
    best.copy(signs);
  }
  begun_ = true;
}

template <typename Phi>
void FixedPoint::step(const Phi& phi, Signs signs, Signs best, Span<double> product,
                      Span<double> trace) noexcept {
  if (!begun_) {
    phi.multiply(signs, product);
    take_energy(signs, best, product, trace);
    return;
  }
  if (result_.iterations < max_iterations_) {
    if (take_signs(product, shift_, signs)) {
      ++result_.iterations;
      phi.multiply(signs, product);
      take_energy(signs, best, product, trace);
      return;
    }
    result_.at_rest = true;
  }
  if (result_.best != result_.iterations) {
    signs.copy(best);
    phi.multiply(signs, product);
  }
  done_ = true;
}

template <typename Phi>
FixedPointResult run_fixed_point(const Phi& phi, std::size_t max_iterations, double shift,
                                 Signs signs, Signs best, Span<double> product,
                                 Span<double> trace) noexcept {
  FixedPoint run;
  run.start(max_iterations, shift);
  while (!run.done()) {
    run.step(phi, signs, best, product, trace);
  }
  return run.result();
}

template <typename Phi>
void signs_of_column(const Phi& phi, std::size_t cell, Signs signs, Span<double> product) noexcept {
  for (std::size_t i = 0; i < signs.size(); ++i) {
    product[i] = 0.0;
  }
  phi.add_column(cell, 1.0, product);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    signs.set(i, !(product[i] < 0.0));
  }
}

template void FixedPoint::step(const PhiMatrix&, Signs, Signs, Span<double>, Span<double>) noexcept;
template void FixedPoint::step(const PhiOperator&, Signs, Signs, Span<double>,
                               Span<double>) noexcept;
template FixedPointResult run_fixed_point(const PhiMatrix&, std::size_t, double, Signs, Signs,
                                          Span<double>, Span<double>) noexcept;
template FixedPointResult run_fixed_point(const PhiOperator&, std::size_t, double, Signs, Signs,
                                          Span<double>, Span<double>) noexcept;
template void signs_of_column(const PhiMatrix&, std::size_t, Signs, Span<double>) noexcept;
template void signs_of_column(const PhiOperator&, std::size_t, Signs, Span<double>) noexcept;

}  // namespace emax
