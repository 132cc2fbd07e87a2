// `emax certify`: a bound that no signal exceeds, with the certificate that proves it.
#pragma once

#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/problem.hpp"

namespace emax::host {

/// Runs the whole command. Ctrl-C ends the work early; what is proven by then is printed all the
/// same.
///
/// @param[in] arguments What follows `certify` on the command line.
Problem run_certify(Span<const std::string_view> arguments);

/// @returns The help of the command, in lines of at most 80 characters.
std::string help_on_certify();

}  // namespace emax::host
