// What points share, as a comment in a table that emax has written.
#pragma once

#include <string_view>

#include "emax/identify/frequency_response.hpp"

namespace emax::desk {

enum class SharedLine : std::uint8_t { kOther, kTaken, kWrong };

/// Reads "# shared: skew=1e-8 clock=2e-5 drift=0.0001 ...", standard uncertainties in SI units by
/// the names of results.json; what is not named is 0.
///
/// @param[in,out] shared Set by kTaken only.
/// @returns kOther for a line that does not begin so, kWrong for one with another name or no
/// number.
SharedLine read_shared(std::string_view line, SharedEffects& shared);

}  // namespace emax::desk
