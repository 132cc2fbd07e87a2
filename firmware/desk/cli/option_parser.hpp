// The command lines of all commands: options with their values, and perhaps files.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "emax/base/span.hpp"

#include "desk/cli/option.hpp"
#include "desk/cli/problem.hpp"

namespace emax::desk {

/// What may stand behind a command.
struct Syntax {
  std::vector<Option> options;
  /// How an option that there is not is called, in errors.
  std::string unknown = "unknown option";
  /// Words that are no options, each with the option that it may mean; before similar names.
  std::vector<std::pair<std::string_view, std::string_view>> other_words = {};
  /// What may stand where no option stands, in errors: "options, such as --points FILE".
  std::string expected;
  /// Takes what is no option; without it everything has to be one.
  std::function<Problem(std::string_view argument)> take_file = {};
};

/// Reads the arguments behind a command, in their order: --name VALUE, --name=VALUE, --switch. Each
/// option takes its value at once.
///
/// @param[out] all What was given; refers to `syntax` and to the arguments.
/// @returns The first that is wrong: an option that there is not, with the one that may have been
/// meant; one that is given twice; a value that is missing, is not taken, or that a switch has.
Problem parse_options(Span<const std::string_view> arguments, const Syntax& syntax,
                      std::vector<Given>& all);

/// @returns The problem of a value that cannot be.
Problem wrong_value(const Given& given, const std::string& expectation);

}  // namespace emax::desk
