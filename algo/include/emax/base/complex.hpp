// Complex numbers for poles and residues; std::complex is not among the freestanding headers.
#pragma once

namespace emax {

struct Complex {
  double re = 0.0;
  double im = 0.0;
};

constexpr Complex operator+(Complex a, Complex b) noexcept { return {a.re + b.re, a.im + b.im}; }
constexpr Complex operator-(Complex a, Complex b) noexcept { return {a.re - b.re, a.im - b.im}; }
constexpr Complex operator-(Complex a) noexcept { return {-a.re, -a.im}; }
constexpr Complex operator*(Complex a, Complex b) noexcept {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
constexpr Complex operator*(double s, Complex a) noexcept { return {s * a.re, s * a.im}; }
constexpr Complex conj(Complex a) noexcept { return {a.re, -a.im}; }
constexpr double norm(Complex a) noexcept { return a.re * a.re + a.im * a.im; }

/// a / b by the textbook formula: exponents of poles and residues stay far from the limits of
/// double.
constexpr Complex operator/(Complex a, Complex b) noexcept {
  const double scale = 1.0 / norm(b);
  return {(a.re * b.re + a.im * b.im) * scale, (a.im * b.re - a.re * b.im) * scale};
}

/// 1 / a, with the bits of the quotient.
constexpr Complex reciprocal(Complex a) noexcept {
  const double scale = 1.0 / norm(a);
  return {a.re * scale, -a.im * scale};
}

/// Re(a b), without computing the imaginary part.
constexpr double real_of_product(Complex a, Complex b) noexcept {
  return a.re * b.re - a.im * b.im;
}

}  // namespace emax
