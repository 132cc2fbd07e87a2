// A comparison to read.
#pragma once

#include "emax/app/base/text_writer.hpp"

#include "desk/compare/comparison.hpp"

namespace emax::desk {

/// Conditions, a table with one row per device, what it means, and a sentence for each pair of
/// neighbours; ASCII but for the names. Lines of at most 130 characters.
void write_comparison(const Comparison& comparison, app::TextWriter& out);

}  // namespace emax::desk
