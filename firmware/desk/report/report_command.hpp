// `emax report`: from the command line to the report on standard output and in files.
#pragma once

#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/problem.hpp"

namespace emax::host {

/// Runs the whole command. Standard output stays empty unless all has gone well.
///
/// @param[in] arguments What follows `report` on the command line.
Problem run_report(Span<const std::string_view> arguments);

}  // namespace emax::host
