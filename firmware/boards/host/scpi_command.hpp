// `emax scpi`: the instrument's console on standard input and output, or on a TCP port.
#pragma once

#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/command.hpp"
#include "desk/cli/problem.hpp"

namespace emax::host {

/// Runs the whole command, until its input ends or Ctrl-C leads the drive to zero.
///
/// @param[in] arguments What follows `scpi` on the command line.
desk::Problem run_scpi(Span<const std::string_view> arguments);

/// @returns What the command does, and its options.
std::string help_on_scpi();

inline constexpr desk::Command kScpiCommand = {
    "scpi",
    R"(  scpi       the instrument's console: SCPI commands in, answers out
)",
    run_scpi,
    help_on_scpi,
    R"(  0     all is well: the input has come to its end
  3     a fault of the port, the store or standard output; one line on standard
        error says which. What goes wrong while measuring is an answer
  130   stopped by Ctrl-C, with the drive at zero
)",
    R"(  echo "INIT;*OPC?;:CALC:ENER?" | emax scpi
  emax scpi --tcp 5025 --store emax.store
  emax scpi --commands
)"};

}  // namespace emax::host
