// exp, log, sin, cos, atan2 and sqrt with the same bits on every target.
//
// Built from +, -, *, / and integers alone, so that any processor and compiler with IEEE double
// gives the same result, as long as contraction is off (-ffp-contract=off, never -ffast-math).
// Rounding is to nearest. No errno, no floating-point flags, no state. Special values follow C99
// Annex F; the sign and payload of a NaN result are not specified. Errors below are the greatest
// found against 113-bit arithmetic; 1 ulp is promised.
#pragma once

namespace emax {

struct SinCos {
  double sin = 0.0;
  double cos = 0.0;
};

/// e^x.
///
/// Above 709.78: +inf. Below -745.13: +0. exp(+-0) = 1, exp(-inf) = +0, exp(+inf) = +inf.
/// Error 0.53 ulp; 0.76 ulp for subnormal results, which are rounded twice. Table of 1 KiB; 9
/// multiplications, no division.
double exp(double x) noexcept;

/// Natural logarithm.
///
/// log(+-0) = -inf, log(1) = +0, log(+inf) = +inf; NaN for x < 0. Subnormal arguments are exact.
/// Error 0.56 ulp, also next to 1. Table of 1 KiB; 11 multiplications, no division.
double log(double x) noexcept;

/// Sine of an angle in radians, for every finite x: big arguments are reduced by as much of 2/pi as
/// they need.
///
/// sin(+-0) = +-0; NaN for an infinite x.
/// Error 0.82 ulp. About 15 multiplications; from |x| = 65536 on, and within 2^-15 of a multiple of
/// pi/2, 12 integer multiplications more. Table of 156 bytes, shared with cos.
double sin(double x) noexcept;

/// Cosine of an angle in radians; as `sin()`. cos(+-0) = 1.
double cos(double x) noexcept;

/// Both at once, with the bits of `sin()` and `cos()`, for little more than the price of one.
SinCos sincos(double x) noexcept;

/// Angle of the point (x, y) in radians, -pi to pi.
///
/// y = +-0 gives +-0 for x > 0 or x = +0, and +-pi for x < 0 or x = -0. x = 0 gives +-pi/2.
/// Infinite arguments give multiples of pi/4, as Annex F says.
/// Error 0.52 ulp, also where y/x is extreme. Table of 216 bytes; one division, about 20
/// multiplications.
double atan2(double y, double x) noexcept;

/// Square root, correctly rounded: the processor's instruction where it has one for double, else
/// `detail::software_sqrt()`. sqrt(-0) = -0, sqrt(+inf) = +inf; NaN for x < 0.
double sqrt(double x) noexcept;

/// The greatest integer not above x; exact. +-0, infinities and NaN come back as they are.
double floor(double x) noexcept;

/// |x|, also of -0 and infinities. A NaN stays a NaN.
constexpr double abs(double x) noexcept { return x <= 0.0 ? 0.0 - x : x; }

/// @returns False for infinities and NaN.
constexpr bool is_finite(double x) noexcept { return x - x == 0.0; }

namespace detail {

/// `sqrt()` in integers, for processors without a square root of double. Compiled on every target,
/// so that tests can compare it with the hardware: the bits are the same. Table of 48 bytes, no
/// division.
double software_sqrt(double x) noexcept;

}  // namespace detail
}  // namespace emax
