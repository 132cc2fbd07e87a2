// The options of `emax report`, one entry each: parser and help both read this table.
#pragma once

#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/options.hpp"

namespace emax::host {

struct Option {
  std::string_view name;
  const char* heading;      ///< Of the group that starts here; null inside a group.
  const char* value;        ///< What stands for the value in the help; null for a switch.
  const char* by_default;   ///< Null if there is no default value.
  const char* expectation;  ///< What a value must look like.
  const char* help;         ///< Lines of at most 55 characters.
  /// Takes the value over, or returns false.
  bool (*take)(std::string_view value, ReportOptions& options);
  bool is_for_bench = false;  ///< Excludes --points and --model.
};

/// @returns All options that take part in a report, in the order of the help.
Span<const Option> option_table() noexcept;

/// @returns Whether `emax scpi` has it, too: what describes the bench and its sweep.
inline bool is_for_console(const Option& option) noexcept {
  return option.is_for_bench || option.name == "reference-uncertainty";
}

/// @returns The option of that name (without dashes), null if there is none.
const Option* find_option(std::string_view name) noexcept;

}  // namespace emax::host
