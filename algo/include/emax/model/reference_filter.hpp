// The reference filter as a sum of modes: what energies and bounds know of it.
#pragma once

#include <cstddef>

#include "emax/base/span.hpp"
#include "emax/model/mode.hpp"

namespace emax {

inline constexpr std::size_t kMaxFilterModes = 8;  ///< Seven conjugate pairs and a real pole.

/// A low-pass filter without zeros, by the modes of its impulse response: Kf(s) = gain times the
/// product of p/(p - s) over its poles p. `butterworth()` makes one.
///
/// Bounds rely on |Kf| <= gain at every frequency, on |s Kf| <= gain 2 pi band_hz, and from a
/// relative degree of 2 on, on |s^2 Kf| <= gain (2 pi band_hz)^2.
struct ReferenceFilter {
  Mode modes[kMaxFilterModes];
  std::size_t count = 0;    ///< Of the modes.
  int relative_degree = 0;  ///< Kf falls as f to minus this power: the number of poles.
  double gain = 0.0;        ///< In V/(m/s^2), at frequency 0; not negative.
  double band_hz = 0.0;     ///< Above 0. Where it ends.

  Span<const Mode> terms() const noexcept { return Span<const Mode>(modes, count); }
};

}  // namespace emax
