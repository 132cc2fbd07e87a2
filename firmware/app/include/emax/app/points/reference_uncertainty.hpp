// Takes the reference's part, common to all points, out of a table of total uncertainties.
#pragma once

#include <cstddef>

#include "emax/base/status.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

struct CommonRemoval {
  Status status = Status::kInvalidArgument;
  std::size_t bad_point =
      0;  ///< Index of the first point whose total is not above the common part.
};

/// Splits the uncertainty of each amplitude into its own part, sqrt(U^2 - U_ref^2), and the common
/// one, which `FrequencyResponse::set_common()` takes. Phases keep theirs.
///
/// @param[in,out] response         Total uncertainties. Changed only if the answer is kOk.
/// @param[in]     expanded_percent U_ref of the amplitude, k = 2, 0 to below 100 percent. 0 leaves
///                                 everything as it is.
/// @returns
/// * kOk
/// * kInvalidArgument: A percentage outside its range, or not a number.
/// * kUncertaintyNotPositive: At `bad_point` the total is not larger than the common part alone.
CommonRemoval remove_common(FrequencyResponse& response, double expanded_percent) noexcept;

}  // namespace emax::app
