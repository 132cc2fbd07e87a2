// The commands of the program: one row each, by which it is found, explained and run.
#pragma once

#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/problem.hpp"

namespace emax::desk {

/// A command of the program. Texts are in lines of at most 80 characters.
struct Command {
  const char* name;
  const char* summary;  ///< In the list of commands.
  /// Runs it with the arguments behind its name.
  Problem (*run)(Span<const std::string_view> arguments);
  std::string (*help)();    ///< Usage, what it does, and its options.
  const char* exit_status;  ///< Lines for the exit statuses 0, 3 and 130.
  const char* examples;     ///< One a line.
};

/// Runs the program: the command that is named first, or what is asked for by --help, -h or
/// --version, wherever they stand.
///
/// @param[in] about The help of the program before its list of commands.
Problem run_program(Span<const Command> commands, const char* about,
                    Span<const std::string_view> arguments);

}  // namespace emax::desk
