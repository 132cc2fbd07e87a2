// The picture of a comparison: each device's figure with its uncertainty and its bound.
#pragma once

#include "emax/app/base/text_writer.hpp"

#include "desk/compare/comparison.hpp"

namespace emax::desk {

inline constexpr const char* kComparisonScript = "comparison.gp";
inline constexpr const char* kComparisonPicture = "comparison.svg";

/// Writes the script for gnuplot 5.4, with its numbers in it. One row per device, at most 40 of
/// them: the first ones. The axis is logarithmic where the figures span more than a factor of 30.
void write_comparison_script(const Comparison& comparison, app::TextWriter& out);

}  // namespace emax::desk
