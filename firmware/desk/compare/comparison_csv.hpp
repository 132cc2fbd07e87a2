// A comparison as CSV.
#pragma once

#include "emax/app/base/text_writer.hpp"

#include "desk/compare/comparison.hpp"

namespace emax::desk {

/// RFC 4180, a row per device in the order of the ranks; empty fields where there is nothing:
///
/// * rank_best,rank_worst
/// * device,serial     with an apostrophe before what a spreadsheet would run as a formula, and
///                     blanks for control characters; file, at the end, too
/// * ranked_by         matched, band or energy
/// * value,u,U,low,high,bound  of the figure that ranks: standard and expanded uncertainty (k = 2),
///                     coverage interval, and what no signal exceeds; percent of S a for matched
///                     and band, V^2 s for energy
/// * matched_percent,band_percent,rms_percent  the three figures in percent of S a; the last is the
///                     root of E/T
/// * E,rms             V^2 s and V
/// * delay_mode,delay_s  what has been taken out of matched_percent: auto or given, and how much
/// * S,a               V/(m/s^2) and m/s^2
/// * mark              fit, beta, sim, several with blanks, or none
/// * file
void write_comparison_csv(const Comparison& comparison, app::TextWriter& out);

}  // namespace emax::desk
