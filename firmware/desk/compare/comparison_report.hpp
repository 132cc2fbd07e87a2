// A comparison to read, as CSV and as JSON.
#pragma once

#include <string>

#include "emax/app/base/text_writer.hpp"

#include "desk/compare/comparison.hpp"

namespace emax::desk {

/// @returns The device's label or file with its serial number, in one printable line.
std::string name_of(const Result& result);

/// @returns "2", or "2-4" where the uncertainties do not say which.
std::string text_of(const Rank& rank);

/// Conditions, a table with one row per device, and a sentence for each pair of neighbours; ASCII
/// but for the labels.
void write_comparison(const Comparison& comparison, app::TextWriter& out);

/// rank_best,rank_worst,device,serial,E,u,rms,rms_percent,bound,low,high,file, RFC 4180; empty
/// fields where there is nothing. V^2 s, V and percent of S a.
void write_comparison_csv(const Comparison& comparison, app::TextWriter& out);

/// `{version, conditions{...}, devices[{...}], pairs[{...}]}`.
void write_comparison_json(const Comparison& comparison, app::TextWriter& out);

}  // namespace emax::desk
