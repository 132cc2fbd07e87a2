// A first look at magnitudes without phases: a polynomial through 1/|K|^2.
#pragma once

#include "emax/identify/frequency_response.hpp"

namespace emax {

/// 1/|K|^2 = a0 + a1 x + a2 x^2 with x = (f/f_max)^2, in the units of 1/amplitude^2.
///
/// In terms of a device: a0 = 1/S^2, a2 = a0 (f_max/f0)^4, a1 = (4 beta^2 - 2) sqrt(a0 a2).
struct MagnitudeFit {
  bool is_found = false;  ///< The points determine the three; else they are zero.
  double a[3] = {};
  double u[3] = {};         ///< Standard uncertainties, from those of the amplitudes.
  double damping2 = 0.0;    ///< beta^2, which may come out below 0; 0 unless a0 and a2 are above 0.
  double u_damping2 = 0.0;  ///< Its standard uncertainty.

  /// @returns Whether a2, and with it f0, differs from 0 by more than two standard uncertainties.
  bool has_frequency() const noexcept { return is_found && a[0] > 0.0 && a[2] > 2.0 * u[2]; }
};

/// Linear least squares, each point weighted by its own u(1/A^2) = 2 u(A)/A^3; phases and the
/// common part are not looked at. 30 multiplications per point.
MagnitudeFit fit_magnitudes(const FrequencyResponse& response) noexcept;

}  // namespace emax
