// The command lines of all commands: options with their values, and perhaps files.
#include "desk/cli/option_parser.hpp"

#include <algorithm>
#include <cstddef>

#include "desk/cli/console.hpp"
#include "desk/cli/nearest.hpp"

namespace emax::desk {

namespace {

constexpr std::string_view kDashes = "--";

bool has_dashes(std::string_view argument) { return argument.substr(0, 2) == kDashes; }

std::string dashed(std::string_view name) { return std::string(kDashes) + std::string(name); }

Problem unknown_option(std::string_view argument, const Syntax& syntax) {
  std::vector<std::string> names = {"--help", "--version"};
  for (const Option& option : syntax.options) {
    names.push_back(dashed(option.name));
  }
  const std::vector<std::string_view> views(names.begin(), names.end());
  std::string_view meant =
      nearest(argument, Span<const std::string_view>(views.data(), views.size()));
  for (const auto& [word, option] : syntax.other_words) {
    meant = argument == word ? option : meant;
  }
  return bad_input(
      printable(argument) + ": " + syntax.unknown +
      (meant.empty() ? "; --help lists them" : "; did you mean " + std::string(meant) + "?"));
}

Problem no_value(const Option& option) {
  return bad_input(dashed(option.name) + ": no value; expected " + option.expectation);
}

// What stands where an option might.
Problem take_other(std::string_view argument, const Syntax& syntax) {
  if (syntax.take_file == nullptr) {
    return bad_input(printable(argument) + ": unexpected argument; expected " + syntax.expected);
  }
  const bool is_file = argument.size() < 2 || argument[0] != '-';
  return is_file ? syntax.take_file(argument) : unknown_option(argument, syntax);
}

// The value is in the same argument or in the next one, beyond which the index advances.
Problem take_value(Span<const std::string_view> arguments, std::size_t& index, Given& given) {
  const Option& option = *given.option;
  const std::string_view argument = arguments[index++];
  const std::size_t equals = argument.find('=');
  const bool has_value = equals != std::string_view::npos;
  if (option.value.empty()) {
    return has_value ? bad_input(dashed(option.name) + ": takes no value; expected just " +
                                 dashed(option.name))
                     : Problem{};
  }
  if (has_value) {
    given.value = argument.substr(equals + 1);
  } else if (index < arguments.size() && !has_dashes(arguments[index])) {
    given.value = arguments[index++];
  }
  return given.value.empty() ? no_value(option) : Problem{};
}

Problem add(const Given& given, std::vector<Given>& all) {
  if (!given.option->may_repeat && is_given(all, given.option->name)) {
    return bad_input(dashed(given.option->name) + ": given twice; expected once");
  }
  all.push_back(given);
  return given.option->take(given.value) ? Problem{}
                                         : wrong_value(given, given.option->expectation);
}

}  // namespace

Problem wrong_value(const Given& given, const std::string& expectation) {
  return bad_input(dashed(given.option->name) + ": \"" + printable(given.value) +
                   "\" given; expected " + expectation);
}

Problem parse_options(Span<const std::string_view> arguments, const Syntax& syntax,
                      std::vector<Given>& all) {
  for (std::size_t index = 0; index < arguments.size();) {
    const std::string_view argument = arguments[index];
    if (argument.size() < 3 || !has_dashes(argument)) {
      if (Problem problem = take_other(argument, syntax)) {
        return problem;
      }
      ++index;
      continue;
    }
    const std::string_view name = argument.substr(2, argument.find('=') - 2);
    Given given;
    given.option = find_option(syntax.options, name);
    if (given.option == nullptr) {
      return unknown_option(argument.substr(0, argument.find('=')), syntax);
    }
    Problem problem = take_value(arguments, index, given);
    if (problem || (problem = add(given, all))) {
      return problem;
    }
  }
  return {};
}

}  // namespace emax::desk
