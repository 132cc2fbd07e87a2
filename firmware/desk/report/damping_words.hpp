// What magnitudes alone say of f0 where they leave the damping open.
#pragma once

#include <string>

#include "emax/identify/frequency_response.hpp"

namespace emax::desk {

/// How f0 follows from the damping where no phase is known.
struct FrequencyByDamping {
  double f0_hz = 0.0;    ///< At the least damping; 0 where the magnitudes do not give it.
  double u_f0_hz = 0.0;  ///< Standard, of that.
  double damping = 0.0;  ///< The largest that fits, in two digits, and
  double f0_at_damping_hz = 0.0;
};

FrequencyByDamping frequency_by_damping(const FrequencyResponse& points);

/// @returns A sentence with the numbers and the option; empty where f0 is not given either.
std::string words_on_damping(const FrequencyByDamping& found);

}  // namespace emax::desk
