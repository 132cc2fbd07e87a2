// From the corners of a box of devices to all devices inside.
#pragma once

#include "emax/model/reference_filter.hpp"

namespace emax {

/// Ranges of f0 and beta; each low end is above 0 and not above its high end.
struct DeviceRange {
  double low_hz = 0.0;
  double high_hz = 0.0;
  double low_damping = 0.0;
  double high_damping = 0.0;  ///< Below 1.
};

/// How much more than at the ends of its range the energy of one signal can have inside, as part of
/// the root of the greatest energy; for a = 1, in V/(m/s^2) sqrt(s).
struct CurvatureTerms {
  double frequency = 0.0;
  double damping = 0.0;
};

/// For a fixed |x| <= 1 and p = f0 or beta, E'' = 2 ||K_p' x||^2 + 2 <K x, K_p'' x> is at least -2
/// ||K x|| ||K_p'' x||, as the filter does not depend on p. So between the ends of a range of width
/// w, E <= the larger of its ends + w^2/8 times the largest 2 ||K x|| ||K_p'' x||. With ||K x|| <=
/// sqrt(B), B the greatest energy in the box, that is
///
///     B <= greatest energy at the corners + sqrt(B) (frequency + damping),
///     term = w^2/4 times the largest ||K_p'' x||.
///
/// ||K_p'' x|| over [0, T] is at most the root of the integral over t of (integral of |k_p''| up to
/// t)^2. With u = 2 pi f0 t and p = -beta + i kappa, k = S 2 pi f0 Im e^(p u)/kappa, and sizes in
/// place of imaginary parts give envelopes that fall with beta but for powers of kappa:
///
///     |k_f0''|:   u sqrt(4 - 4 beta u + u^2) e^(-beta u)/kappa, over (2 pi f0)^2
///     |k_beta''|: e^(-beta u)/kappa [|A|^2 + |dA/dbeta|], A = i p u/kappa + beta/kappa^2.
///
/// They are summed by the trapezoidal rule on a fine mesh, and 1 % more is taken for that. In S the
/// energy is convex, so that its ends suffice.
///
/// @param[in] sensitivity The largest in the box, in V/(m/s^2).
/// @param[in] filter_integral What the output is multiplied by: 1, or the integral of |h| for the
///   error in band.
CurvatureTerms curvature_terms(const DeviceRange& range, double sensitivity, double duration_s,
                               double filter_integral) noexcept;

/// @returns The integral over [0, T] of |h|, h the filter with a gain of 1; on a mesh, 1 % more.
double filter_integral(const ReferenceFilter& filter, double duration_s) noexcept;

/// @returns The B that solves B = `corners` + `terms` sqrt(B + `more`): no energy in the box is
///   above it. `more` is 0; for the energy difference, where ||Ka x|| <= sqrt(B + ||Kf x||^2) takes
///   the place of sqrt(B), it is G^2 T.
double box_bound(double corners, double terms, double more) noexcept;

}  // namespace emax
