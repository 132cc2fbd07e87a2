// The in-band error system: what its modes are, and what a delay of its reference leaves open.
#pragma once

#include "emax/model/accelerometer.hpp"
#include "emax/model/reference_filter.hpp"

namespace emax {

/// @returns Kf(s)/gain by the product over its poles, which keeps its digits where partial
///   fractions cancel.
Complex unit_transfer(const ReferenceFilter& filter, Complex s) noexcept;

/// The part of a pole by which the sensor's is moved if one of the filter's is as near. Rounding
/// grows as the inverse square of the distance, what is lost by the move as its square.
inline constexpr double kPoleDistance = 3e-4;

/// The sensor whose poles the modes take: K(s) = (Ka(s) - G) Kf(s)/G has a double pole where the
/// sensor's is one of the filter's, and its partial fractions cancel near there.
///
/// @returns The sensor itself, or with its f0 moved by `distance` as part of it, away from a pole
///   of the filter that is nearer than that.
Accelerometer with_simple_poles(const Accelerometer& device, const ReferenceFilter& filter,
                                double distance = kPoleDistance) noexcept;

/// @returns A bound of the integral of the change of ka by that move, in V/(m/s^2): f0 times
/// dka/df0
///   = ka + t ka', and both have envelopes that decay with beta w0.
double change_by_move(const Accelerometer& device) noexcept;

/// The residue at the sensor's pole: r_a Kf(p_a)/G.
Complex in_band_residue(const Accelerometer& device, const ReferenceFilter& filter) noexcept;

/// The residue at a pole of the filter: r_f (Ka(p_f) - G e^(-p_f tau))/G, without loss of digits
/// where the sensor follows a slow mode almost exactly.
///
/// @param[in] device With an f0 of 0 the ideal one, Ka = S.
/// @param[in] mode One of the filter's.
/// @param[in] delay_s tau.
Complex in_band_residue(const Accelerometer& device, const ReferenceFilter& filter,
                        const Mode& mode, double delay_s) noexcept;

/// @returns |Ka(s) - G e^(-s tau)| |Kf(s)|/G at s = j 2 pi f: how much of a sine gets through.
double in_band_amplitude(const Accelerometer& device, const ReferenceFilter& filter, double delay_s,
                         double frequency_hz) noexcept;

/// The integral from 0 to `delay_s` of h(-s), h(t) = Re sum r_f/G e^(p_f t): what the continued
/// filter has before its start. By the power series of h, which has as many terms of 0 as the
/// filter's relative degree says. h(-s) has one sign for 0 < s <= 1/(2 pi band_hz).
double reach_before_start(const ReferenceFilter& filter, double delay_s) noexcept;

}  // namespace emax
