// The commands of the program: one row each, by which it is found, explained and run.
#include "desk/cli/command.hpp"

#include <algorithm>
#include <vector>

#include "emax/app/base/version.hpp"

#include "desk/cli/commit.hpp"
#include "desk/cli/console.hpp"
#include "desk/cli/nearest.hpp"

namespace emax::desk {

namespace {

using Arguments = Span<const std::string_view>;

constexpr const char* kBadInputStatus =
    "  2     bad input; one line on standard error says where and what was expected\n";

Problem print(const std::string& text) {
  FileSink sink(stdout);
  sink.write(Span<const char>(text.data(), text.size()));
  return check_output(sink);
}

bool contains(Arguments arguments, std::string_view wanted) {
  return std::find(arguments.begin(), arguments.end(), wanted) != arguments.end();
}

// The status of bad input is the same everywhere; it stands behind the first.
std::string help_on_exit_status(const char* others) {
  const std::string lines = others;
  const std::size_t end = lines.find("\n  3 ") + 1;
  return "\nExit status\n" + lines.substr(0, end) + kBadInputStatus + lines.substr(end);
}

std::string help_on(const Command& command) {
  return command.help() + R"(
Help
  --help                 this text
  --version              the version of the program
)" + help_on_exit_status(command.exit_status) +
         "\nExamples\n" + command.examples;
}

std::string help_on(Span<const Command> commands, const char* about) {
  std::string text = std::string(about) + "\nCommands\n";
  std::string examples;
  for (const Command& command : commands) {
    text += command.summary;
    const std::string all = command.examples;
    examples += all.substr(0, all.find('\n') + 1);
  }
  return text + help_on_exit_status(commands[0].exit_status) + "\nExamples\n" + examples;
}

const Command* find(Span<const Command> commands, std::string_view name) {
  const auto* found = std::find_if(commands.begin(), commands.end(),
                                   [name](const Command& command) { return command.name == name; });
  return found == commands.end() ? nullptr : found;
}

Problem unknown_command(Span<const Command> commands, std::string_view name) {
  const std::string words = printable(name) + ": unknown ";
  if (name.substr(0, 1) == "-") {
    return bad_input(words + "option; expected a command first: emax report " + printable(name) +
                     " ...");
  }
  std::vector<std::string_view> names;
  for (const Command& command : commands) {
    names.emplace_back(command.name);
  }
  const std::string_view meant = nearest(name, Arguments(names.data(), names.size()));
  return bad_input(words + (meant.empty()
                                ? "command; emax --help lists them"
                                : "command; did you mean emax " + std::string(meant) + "?"));
}

}  // namespace

Problem run_program(Span<const Command> commands, const char* about, Arguments arguments) {
  if (arguments.empty()) {
    return bad_input("no command; expected emax report, or emax --help");
  }
  const Command* command = find(commands, arguments[0]);
  if (contains(arguments, "--help") || contains(arguments, "-h")) {
    return print(command != nullptr ? help_on(*command) : help_on(commands, about));
  }
  if (contains(arguments, "--version")) {
    const std::string source = commit();
    return print(std::string("emax ") + app::kVersion +
                 (source.empty() ? "" : " (commit " + source + ")") + "\n");
  }
  return command != nullptr ? command->run(arguments.from(1))
                            : unknown_command(commands, arguments[0]);
}

}  // namespace emax::desk
