// `emax scpi`: the instrument's console on standard input and output, or on a TCP port.
#pragma once

#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/problem.hpp"

namespace emax::host {

/// Runs the whole command, until its input ends or Ctrl-C leads the drive to zero.
///
/// @param[in] arguments What follows `scpi` on the command line.
Problem run_scpi(Span<const std::string_view> arguments);

/// @returns The help of the command, in lines of at most 80 characters.
std::string help_on_scpi();

}  // namespace emax::host
