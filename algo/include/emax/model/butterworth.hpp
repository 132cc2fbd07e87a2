// The reference filter: a Butterworth low-pass of order 1 to 15 by its poles and residues.
#pragma once

#include <cstddef>

#include "emax/base/status.hpp"
#include "emax/model/mode.hpp"

namespace emax {

inline constexpr int kMaxFilterOrder = 15;
inline constexpr std::size_t kMaxFilterModes = 8;  ///< Seven conjugate pairs and a real pole.

/// Kf(s) = g / prod_i (s / (2 pi fc) - e^(j (2i + L - 1) pi / (2 L))), paper equation (6).
struct Butterworth {
  int order = 0;           ///< L, 1 to 15.
  double cutoff_hz = 0.0;  ///< fc, at -3 dB.
  double gain = 0.0;       ///< g in V/(m/s^2), at frequency 0.
};

/// The modes of a filter's impulse response.
struct FilterModes {
  Mode modes[kMaxFilterModes];
  std::size_t count = 0;
};

/// @returns
/// * kOk: Order 1 to 15, cutoff 1 mHz to 1 GHz, gain finite and not negative.
/// * kInvalidOrder: An order outside 1 to 15.
/// * kInvalidArgument: Any other value outside its range, or not a number.
Status validate(const Butterworth& filter) noexcept;

/// @returns |Kf(j 2 pi f)| in V/(m/s^2).
double amplitude(const Butterworth& filter, double frequency_hz) noexcept;

/// Poles and residues by partial fractions. The filter must be valid. Order^2 complex products.
FilterModes modes_of(const Butterworth& filter) noexcept;

}  // namespace emax
