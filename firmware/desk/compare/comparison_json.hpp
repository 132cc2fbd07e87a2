// A comparison as JSON.
#pragma once

#include "emax/app/base/text_writer.hpp"

#include "desk/compare/comparison.hpp"

namespace emax::desk {

/// `{version, asked_by, ranked_by, conditions{...}, devices[{...}], pairs[{...}]}`.
///
/// `asked_by` and `ranked_by` are "matched", "band" or "energy"; they differ where a device has no
/// matched figure. value, u, U, interval and bound of a device and all numbers of a pair are those
/// of the figure that ranks: percent of S a, or V^2 s for "energy". A pair is a device and the next
/// one; `difference` has the uncertainty `U`, and may be off by `epsilon` beside that.
void write_comparison_json(const Comparison& comparison, app::TextWriter& out);

}  // namespace emax::desk
