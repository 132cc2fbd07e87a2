// The switching times of a signal moved to where they make its energy largest.
#pragma once

#include <cstddef>

#include "emax/modal_model.hpp"
#include "emax/span.hpp"
#include "emax/switching_signal.hpp"

namespace emax {

/// The number of doubles that `refine()` and `energy_gradient()` work in, whatever the signal.
inline constexpr std::size_t kRefinementScratch =
    2 * kMaxModes * (kMaxSwitches + 1) + 6 * kMaxSwitches;

/// How a refinement ended.
struct Refinement {
  double energy = 0.0;      ///< Of the refined signal, for a = 1.
  std::size_t steps = 0;    ///< Newton steps taken.
  std::size_t dropped = 0;  ///< Switches that met in pairs or left [0, T].
};

/// dE/dt_j of every switch, for a = 1: 2 (x(t_j-) - x(t_j+)) (Phi x)(t_j), by closed form.
///
/// One forward and one backward recursion over the switches: `PhiOperator` in continuous time.
///
/// @param[out] gradient One number per switch, in (V/(m/s^2))^2.
/// @param      scratch  kRefinementScratch doubles.
/// @returns The energy of the signal.
double energy_gradient(const ModalModel& model, const SwitchingSignal& signal,
                       Span<double> gradient, Span<double> scratch) noexcept;

/// Moves the switching times by Newton's method until their gradient is that of rounding.
///
/// The curvature d2E/(dt_i dt_j) = 8 c_i c_j Phi(t_i, t_j), plus 4 c_i (Phi x)'(t_i) for i = j, c_i
/// being the sign before switch i, is never stored: a step is found by conjugate gradients, each of
/// which costs two recursions over the switches. Where the energy is not concave the step follows
/// the gradient. A step that would lower the energy is shortened; two switches that meet are
/// dropped, and so is one that reaches 0 or T. The energy never falls by more than rounding. (The
/// energy difference has flat ridges, on which it may stop before the gradient is that of
/// rounding.)
///
/// @param[in,out] signal  Any signal; refined in place.
/// @param         scratch kRefinementScratch doubles.
/// At most 200 steps; from the grid of a search, 2 to 6.
Refinement refine(const ModalModel& model, SwitchingSignal& signal, Span<double> scratch) noexcept;

}  // namespace emax
