// One option of a command, and one that was given.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace emax::desk {

/// How an option reads, and who takes its value.
struct Option {
  std::string name;         ///< Without dashes.
  std::string heading;      ///< Of its group in the help.
  std::string value;        ///< What stands for the value in the help; empty for a switch.
  std::string by_default;   ///< Empty if there is no default value.
  std::string expectation;  ///< What a value must look like.
  std::string help;         ///< Lines of at most 55 characters.
  /// Takes the value over, or returns false. A switch has no value.
  std::function<bool(std::string_view value)> take;
  bool is_for_bench = false;  ///< Describes the simulated bench or its sweep.
  bool may_repeat = false;    ///< May be given more than once.
};

/// An option with the value that it was given; refers to the options and the arguments.
struct Given {
  const Option* option = nullptr;
  std::string_view value;
};

/// @returns The option of that name, null if there is none.
const Option* find_option(const std::vector<Option>& options, std::string_view name) noexcept;

/// @returns Whether an option of that name was given.
bool is_given(const std::vector<Given>& all, std::string_view name) noexcept;

/// @returns The help of all options, in lines of at most 80 characters, with the headings of their
/// groups.
std::string help_on(const std::vector<Option>& options);

}  // namespace emax::desk
