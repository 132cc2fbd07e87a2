// The command line of `emax scpi`.
#include "scpi_options.hpp"

#include <vector>

#include "emax/base/decimal.hpp"

#include "desk/cli/console.hpp"
#include "desk/cli/nearest.hpp"
#include "desk/cli/option_table.hpp"

namespace emax::host {

namespace {

constexpr double kMaxPort = 65535.0;
constexpr double kMinPace = 1e-3;
constexpr double kMaxPace = 1e6;

bool take_number(std::string_view text, double& value) noexcept {
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  value = number.value;
  return number.status == Status::kOk && number.length == text.size();
}

bool take_port(std::string_view text, ScpiOptions& options) noexcept {
  double port = 0.0;
  options.listens = take_number(text, port) && port >= 0.0 && port <= kMaxPort;
  options.port = options.listens ? static_cast<std::uint16_t>(port) : std::uint16_t{0};
  return options.listens && port == options.port;
}

bool take_pace(std::string_view text, ScpiOptions& options) noexcept {
  return take_number(text, options.pace) && options.pace >= kMinPace && options.pace <= kMaxPace;
}

bool take_store(std::string_view text, ScpiOptions& options) {
  options.store_path = text;
  return true;
}

// The options that are the console's own.
struct OwnOption {
  std::string_view name;
  const char* expectation;  // Null for a switch.
  bool (*take)(std::string_view value, ScpiOptions& options);
};

constexpr OwnOption kOwnOptions[] = {
    {"tcp", "a port from 1 to 65535, or 0 for any that is free", take_port},
    {"pace", "seconds of the bench per second, from 0.001 to 1e6; 1 is real time", take_pace},
    {"store", "the name of a file", take_store},
    {"commands", nullptr,
     [](std::string_view, ScpiOptions& options) { return options.prints_commands = true; }},
};

const OwnOption* find_own(std::string_view name) noexcept {
  for (const OwnOption& option : kOwnOptions) {
    if (option.name == name) {
      return &option;
    }
  }
  return nullptr;
}

Problem unknown_option(std::string_view argument, std::string_view name) {
  std::vector<std::string_view> names = {"help", "version"};
  for (const OwnOption& option : kOwnOptions) {
    names.push_back(option.name);
  }
  for (const Option& option : option_table()) {
    if (is_for_console(option)) {
      names.push_back(option.name);
    }
  }
  const std::string_view meant =
      nearest(name, Span<const std::string_view>(names.data(), names.size()));
  return bad_input(printable(argument) + ": unknown option; did you mean --" + std::string(meant) +
                   "?");
}

// One argument, or two.
struct Given {
  std::string_view name;
  std::string_view value;
  bool has_value = false;
};

// Where the value may stand in the next argument, it is taken from there.
Given next_option(Span<const std::string_view> arguments, std::size_t& index, bool takes_value) {
  const std::string_view argument = arguments[index++];
  const std::size_t equals = argument.find('=');
  Given given;
  given.name = argument.substr(2, equals == std::string_view::npos ? equals : equals - 2);
  if (equals != std::string_view::npos) {
    given.value = argument.substr(equals + 1);
    given.has_value = true;
  } else if (takes_value && index < arguments.size() && arguments[index].substr(0, 2) != "--") {
    given.value = arguments[index++];
    given.has_value = true;
  }
  return given;
}

Problem take_own(const OwnOption& option, const Given& given, ScpiOptions& options) {
  const std::string name = "--" + std::string(option.name);
  if (option.expectation == nullptr) {
    (void)option.take({}, options);
    return given.has_value ? bad_input(name + ": takes no value; expected just " + name)
                           : Problem{};
  }
  if (given.value.empty()) {
    return bad_input(name + ": no value; expected " + option.expectation);
  }
  if (!option.take(given.value, options)) {
    return bad_input(name + ": \"" + printable(given.value) + "\" given; expected " +
                     option.expectation);
  }
  return {};
}

}  // namespace

Problem parse_scpi_options(Span<const std::string_view> arguments, ScpiOptions& options) {
  std::vector<std::string_view> others;
  std::vector<std::string_view> seen;
  for (std::size_t index = 0; index < arguments.size();) {
    const std::string_view argument = arguments[index];
    if (argument.size() < 3 || argument.substr(0, 2) != "--") {
      return bad_input(printable(argument) +
                       ": unexpected argument; expected options, such as --tcp 5025");
    }
    const std::string_view name = argument.substr(2, argument.find('=') - 2);
    const OwnOption* own = find_own(name);
    const Option* option = find_option(name);
    if (own == nullptr && (option == nullptr || !is_for_console(*option))) {
      return unknown_option(argument, name);
    }
    const std::size_t from = index;
    const bool takes_value =
        own != nullptr ? own->expectation != nullptr : option->value != nullptr;
    const Given given = next_option(arguments, index, takes_value);
    if (own == nullptr) {
      others.insert(others.end(), arguments.begin() + from, arguments.begin() + index);
      continue;
    }
    for (const std::string_view earlier : seen) {
      if (earlier == name) {
        return bad_input("--" + std::string(name) + ": given twice; expected once");
      }
    }
    seen.push_back(name);
    if (Problem problem = take_own(*own, given, options)) {
      return problem;
    }
  }
  return parse_report_options(Span<const std::string_view>(others.data(), others.size()),
                              options.report);
}

}  // namespace emax::host
