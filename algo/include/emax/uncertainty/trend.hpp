// The straight line through points by ordinary least squares.
#pragma once

#include <cstddef>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"

namespace emax {

/// E = slope T + intercept. Units are those of the points: with T in s and E in V^2 s, the slope is
/// in V^2.
struct Trend {
  Status status = Status::kOk;
  std::size_t points = 0;
  double slope = 0.0;
  double intercept = 0.0;
  double correlation = 0.0;   ///< r, from -1 to 1; 0 where all E are the same.
  double residual_std = 0.0;  ///< sqrt(sum of squared residuals/(points - 2)); 0 for two points.
};

/// The regression of the paper's section 5.
///
/// Any order of the points. Two passes, centred, so that nothing cancels.
///
/// @param[in] time_s As many as energies, 2 or more, not all the same.
/// @returns The line with kOk; else zeros with
/// * kTooFewPoints: Fewer than 2 points.
/// * kInvalidArgument: Not as many times as energies, a number that is not finite, or sums that
/// overflow.
/// * kNotIdentifiable: All times are the same.
Trend linear_trend(Span<const double> time_s, Span<const double> energy) noexcept;

}  // namespace emax
