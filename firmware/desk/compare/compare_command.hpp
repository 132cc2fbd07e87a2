// `emax compare`.
#pragma once

#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/problem.hpp"

namespace emax::host {

/// @param[in] arguments Those behind `emax compare`.
Problem run_compare(Span<const std::string_view> arguments);

/// @returns The help of the command, in lines of at most 80 characters.
std::string help_on_compare();

}  // namespace emax::host
