// The fixed-point iteration on signs.
#include "emax/fixed_point.hpp"

namespace emax {
namespace {

void copy(Span<const std::int8_t> from, Span<std::int8_t> to) noexcept {
  for (std::size_t i = 0; i < from.size(); ++i) {
    to[i] = from[i];
  }
}

/// x <- sgn(y + c x). @returns Whether any sign changed.
bool take_signs(Span<const double> product, double shift, Span<std::int8_t> signs) noexcept {
  bool changed = false;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    const double value = product[i] + shift * signs[i];
    const std::int8_t sign =
        value > 0.0 ? std::int8_t{1} : (value < 0.0 ? std::int8_t{-1} : signs[i]);
    changed = changed || sign != signs[i];
    signs[i] = sign;
  }
  return changed;
}

}  // namespace

double dot(Span<const std::int8_t> signs, Span<const double> product) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    sum += signs[i] > 0 ? product[i] : -product[i];
  }
  return sum;
}

template <typename Phi>
FixedPointResult run_fixed_point(const Phi& phi, std::size_t max_iterations, double shift,
                                 Span<std::int8_t> signs, Span<std::int8_t> best,
                                 Span<double> product, Span<double> trace) noexcept {
  FixedPointResult result;
  phi.multiply(signs, product);
  result.energy = dot(signs, product);
  copy(signs, best);
  if (!trace.empty()) {
    trace[0] = result.energy;
  }
  while (result.iterations < max_iterations) {
    if (!take_signs(product, shift, signs)) {
      result.at_rest = true;
      break;
    }
    ++result.iterations;
    phi.multiply(signs, product);
    const double energy = dot(signs, product);
    if (result.iterations < trace.size()) {
      trace[result.iterations] = energy;
    }
    if (energy > result.energy) {
      result.energy = energy;
      result.best = result.iterations;
      copy(signs, best);
    }
  }
  if (result.best != result.iterations) {
    copy(best, signs);
    phi.multiply(signs, product);
  }
  return result;
}

template <typename Phi>
void signs_of_column(const Phi& phi, std::size_t cell, Span<std::int8_t> signs,
                     Span<double> product) noexcept {
  for (std::size_t i = 0; i < signs.size(); ++i) {
    product[i] = 0.0;
  }
  phi.add_column(cell, 1.0, product);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    signs[i] = product[i] < 0.0 ? std::int8_t{-1} : std::int8_t{1};
  }
}

template FixedPointResult run_fixed_point(const PhiMatrix&, std::size_t, double, Span<std::int8_t>,
                                          Span<std::int8_t>, Span<double>, Span<double>) noexcept;
template FixedPointResult run_fixed_point(const PhiOperator&, std::size_t, double,
                                          Span<std::int8_t>, Span<std::int8_t>, Span<double>,
                                          Span<double>) noexcept;
template void signs_of_column(const PhiMatrix&, std::size_t, Span<std::int8_t>,
                              Span<double>) noexcept;
template void signs_of_column(const PhiOperator&, std::size_t, Span<std::int8_t>,
                              Span<double>) noexcept;

}  // namespace emax
