// The reference filter: a Butterworth low-pass of order 1 to 15 by its poles and residues.
#pragma once

#include "emax/base/status.hpp"
#include "emax/model/reference_filter.hpp"

namespace emax {

inline constexpr int kMaxFilterOrder = 15;

/// Kf(s) = g / prod_i (s / (2 pi fc) - e^(j (2i + L - 1) pi / (2 L))), paper equation (6).
struct Butterworth {
  int order = 0;           ///< L, 1 to 15.
  double cutoff_hz = 0.0;  ///< fc, at -3 dB.
  double gain = 0.0;       ///< g in V/(m/s^2), at frequency 0.
};

/// @returns
/// * kOk: Order 1 to 15, cutoff 1 mHz to 1 GHz, gain finite and not negative.
/// * kInvalidOrder: An order outside 1 to 15.
/// * kInvalidArgument: Any other value outside its range, or not a number.
Status validate(const Butterworth& filter) noexcept;

/// @returns |Kf(j 2 pi f)| in V/(m/s^2).
double amplitude(const Butterworth& filter, double frequency_hz) noexcept;

/// Poles and residues by partial fractions; the band ends at the cutoff. The filter must be valid.
/// Order^2 complex products.
ReferenceFilter butterworth(const Butterworth& filter) noexcept;

}  // namespace emax
