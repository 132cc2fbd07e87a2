// Why points do not fit a device, in words.
#pragma once

#include <string>

#include "emax/identify/wlsp.hpp"

namespace emax::desk {

/// @returns A sentence on the cause whose signature the points have (`diagnose()`), with what to
/// do: "A delay of 0.53 ms would bring chi2/dof from 8.3e4 to 340: ..."; empty if there is none.
///
/// @param[in] is_phase_unit_named False where degrees were only assumed.
std::string cause_of(const Wlsp& fit, bool is_phase_unit_named);

}  // namespace emax::desk
