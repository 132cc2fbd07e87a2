// Complex numbers of single precision, for what only proposes.
#pragma once

#include "emax/base/complex.hpp"

namespace emax {

struct FloatComplex {
  float re = 0.0F;
  float im = 0.0F;
};

constexpr FloatComplex single(Complex z) noexcept {
  return {static_cast<float>(z.re), static_cast<float>(z.im)};
}
constexpr FloatComplex operator+(FloatComplex a, FloatComplex b) noexcept {
  return {a.re + b.re, a.im + b.im};
}
constexpr FloatComplex operator-(FloatComplex a, FloatComplex b) noexcept {
  return {a.re - b.re, a.im - b.im};
}
constexpr FloatComplex operator*(FloatComplex a, FloatComplex b) noexcept {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
constexpr FloatComplex operator*(float s, FloatComplex a) noexcept { return {s * a.re, s * a.im}; }
constexpr FloatComplex conj(FloatComplex a) noexcept { return {a.re, -a.im}; }

/// Re(a b).
constexpr float real_of_product(FloatComplex a, FloatComplex b) noexcept {
  return a.re * b.re - a.im * b.im;
}

}  // namespace emax
