// The command line of `emax scpi`.
#include "desk/scpi/scpi_options.hpp"

#include <vector>

#include "emax/base/decimal.hpp"

#include "desk/cli/option_parser.hpp"
#include "desk/cli/option_table.hpp"
#include "desk/cli/value_text.hpp"

namespace emax::desk {

namespace {

constexpr double kMaxPort = 65535.0;
constexpr double kMinPace = 1e-3;
constexpr double kMaxPace = 1e6;

// Without blanks around it.
bool take_plain_number(std::string_view text, double& value) noexcept {
  const ParsedNumber number = parse_decimal(Span<const char>(text.data(), text.size()));
  value = number.value;
  return number.status == Status::kOk && number.length == text.size();
}

bool take_port(std::string_view text, ScpiOptions& options) {
  double port = 0.0;
  if (const std::size_t colon = text.rfind(':'); colon != std::string_view::npos) {
    options.address = text.substr(0, colon);
    text.remove_prefix(colon + 1);
  }
  options.listens = take_plain_number(text, port) && port >= 0.0 && port <= kMaxPort;
  options.port = options.listens ? static_cast<std::uint16_t>(port) : std::uint16_t{0};
  return options.listens && port == options.port;
}

bool take_pace(std::string_view text, ScpiOptions& options) noexcept {
  return take_plain_number(text, options.pace) && options.pace >= kMinPace &&
         options.pace <= kMaxPace;
}

Syntax syntax_of(ScpiOptions& options) {
  constexpr const char* kHeading = "The console";
  Syntax syntax;
  syntax.options = {
      {"tcp", kHeading, "[ADDRESS:]PORT", "",
       "a port from 1 to 65535, or 0 for any that is free, with or without an address before it",
       "serves one client after the other on this port; 0\n"
       "takes a free one, and standard error says which.\n"
       "Without an address only this computer can connect\n"
       "(127.0.0.1). With another one, such as 0.0.0.0 for\n"
       "all, anybody who reaches it can drive the shaker:\n"
       "there is no password",
       [&options](std::string_view text) { return take_port(text, options); }},
      {"pace", kHeading, "X", "as fast as it goes",
       "seconds of the bench per second, from 0.001 to 1e6; 1 is real time",
       "seconds of the simulated bench per second; 1 is real\n"
       "time",
       [&options](std::string_view text) { return take_pace(text, options); }},
      {"store", kHeading, "FILE", "", "the name of a file",
       "keeps what *SAV saves and the last identification;\n"
       "without it they are forgotten at the end",
       [&options](std::string_view text) { return take_text(text, options.store_path); }},
      {"commands", kHeading, "", "", "", "prints the table of all commands, as Markdown",
       [&options](std::string_view) { return options.prints_commands = true; }}};
  for (Option& option : bench_options(options.report)) {
    option.heading = "The simulated bench";
    syntax.options.push_back(option);
  }
  syntax.other_words = other_words();
  syntax.expected = "options, such as --tcp 5025";
  return syntax;
}

}  // namespace

Problem parse_scpi_options(Span<const std::string_view> arguments, ScpiOptions& options) {
  const Syntax syntax = syntax_of(options);
  std::vector<Given> all;
  const Problem problem = parse_options(arguments, syntax, all);
  return problem ? problem : check_report_options(all, options.report);
}

std::string help_on_scpi_options() {
  ScpiOptions options;
  return help_on(syntax_of(options).options);
}

}  // namespace emax::desk
