// Why points do not fit a device, in words.
#pragma once

#include <string>

#include "emax/identify/wlsp.hpp"

#include "desk/import/import_points.hpp"

namespace emax::desk {

/// @returns A sentence on the cause whose signature the points have (`diagnose()`), with what to
/// do: "A delay of 0.53 ms would bring chi2/dof from 8.3e4 to 340: ..."; or that of
/// `cause_of_measured()`; empty if there is none.
///
/// @param[in] is_phase_unit_named False where degrees were only assumed.
std::string cause_of(const Wlsp& fit, bool is_phase_unit_named);

/// @returns A sentence on the few points without which the others fit, and what may be at their
/// frequencies: "Without the point at 500 Hz chi2/dof is 1.1, not 43: ..."; empty if chi2 holds, or
/// if more than an eighth of the points, or than four, are off.
std::string cause_of_measured(const Wlsp& fit);

}  // namespace emax::desk
