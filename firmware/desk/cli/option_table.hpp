// The options of `emax report`, some of which other commands have, too.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

#include "desk/cli/option.hpp"
#include "desk/cli/options.hpp"

namespace emax::desk {

/// Heading of all options that say what a table of points does not.
inline constexpr const char kTableHeading[] = "Of the table that --points names";

/// @returns All options that take part in a report, in the order of the help. They write to
/// `options`, which has to outlive them.
std::vector<Option> report_options(ReportOptions& options);

/// @returns Those that describe the simulated bench and its sweep.
std::vector<Option> bench_options(ReportOptions& options);

/// @returns The option of that name, with another text in the help if there is one.
Option report_option(ReportOptions& options, const char* name, const char* help = nullptr);

/// For `Syntax::other_words`: what is no option of a report, but may be taken for one.
std::vector<std::pair<std::string_view, std::string_view>> other_words();

}  // namespace emax::desk
