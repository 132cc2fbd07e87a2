// The program `emax`: the instrument on a PC.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fcntl.h>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>

#include "emax/app/base/version.hpp"

#include "desk/certify/certify_command.hpp"
#include "desk/cli/console.hpp"
#include "desk/cli/nearest.hpp"
#include "desk/cli/options.hpp"
#include "desk/cli/problem.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/compare/compare_command.hpp"
#include "desk/report/report_command.hpp"
#include "scpi_command.hpp"

namespace {

using emax::Span;
using emax::host::Problem;
using Arguments = Span<const std::string_view>;

constexpr const char* kHelp =
    R"(usage: emax report [options]
       emax report --points FILE [options]
       emax report --model S,f0,beta[,uS,uf0,ubeta] [options]
       emax COMMAND --help | --help | --version

How wrong can this accelerometer get? emax finds the input signal, limited to
+-a and to a time T, that makes the integral-square error at the output of an
accelerometer as large as possible, and the uncertainty of that maximum.

Commands
  report     measures and identifies the device, finds the maximum energy, its
             uncertainty by Monte Carlo and its trend over T, prints a report
  certify    proves how far the maximum can be from the truth, for any signal
  compare    ranks devices by their results
  scpi       the instrument's console: SCPI commands in, answers out
)";

constexpr const char* kReportHelp =
    R"(usage: emax report [options]
       emax report --points FILE [options]
       emax report --model S,f0,beta[,uS,uf0,ubeta] [options]

Measures an accelerometer on the simulated bench, or takes measured points or
known parameters; identifies it, finds the signal with the largest error energy
and prints a report. Numbers are in SI units; --option VALUE and --option=VALUE
both do.
)";

constexpr const char* kMoreReportHelp = R"(
Help
  --help                 this text
  --version              the version of the program
)";

constexpr const char* kCommonHelp = R"(
Exit status
  0     all is well
  2     bad input; one line on standard error says where and what was expected
  3     a fault while measuring or writing the results; one line on standard
        error says which, and what was measured is printed and written
  130   stopped by Ctrl-C, with the drive at zero and without partial files

Examples
  emax report
  emax report --bench-seed 2 --bench-fault swapped-channels@4 --out results
  emax report --points host_tests/data/djb_a1800v.csv --out results
  emax report --model 1.037,4073,0.3182,0.003,6,0.0004 --time 0.01
  emax report --model 1.037,4073,0.3182 --order 4 --json
  emax certify --model 1.037,4073,0.3182 --effort 30 --out certificate.json
)";

Problem print(const std::string& text) {
  emax::host::FileSink sink(stdout);
  sink.write(Span<const char>(text.data(), text.size()));
  return check_output(sink);
}

// What is asked for by --help or --version, wherever they stand.
Problem print_about(bool is_report, bool is_version) {
  if (is_version) {
    return print(std::string("emax ") + emax::app::kVersion + "\n");
  }
  if (is_report) {
    return print(kReportHelp + emax::host::help_on_report_options() + kMoreReportHelp +
                 kCommonHelp);
  }
  return print(std::string(kHelp) + kCommonHelp);
}

Problem unknown_command(std::string_view command) {
  const std::string words = emax::host::printable(command) + ": unknown ";
  if (command.substr(0, 1) == "-") {
    return emax::host::bad_input(words + "option; expected a command first: emax report " +
                                 emax::host::printable(command) + " ...");
  }
  constexpr std::string_view kNames[] = {"report", "certify", "compare", "scpi"};
  return emax::host::bad_input(words + "command; did you mean emax " +
                               std::string(emax::host::nearest(command, kNames)) + "?");
}

bool contains(Arguments arguments, std::string_view wanted) {
  return std::find(arguments.begin(), arguments.end(), wanted) != arguments.end();
}

Problem run(Arguments arguments) {
  if (arguments.empty()) {
    return emax::host::bad_input("no command; expected emax report, or emax --help");
  }
  const std::string_view command = arguments[0];
  const bool is_report = command == "report";
  const bool is_certify = command == "certify";
  const bool wants_help = contains(arguments, "--help") || contains(arguments, "-h");
  if (wants_help && is_certify) {
    return print(emax::host::help_on_certify() + kCommonHelp);
  }
  if (wants_help && command == "compare") {
    return print(emax::host::help_on_compare() + kCommonHelp);
  }
  if (wants_help && command == "scpi") {
    return print(emax::host::help_on_scpi() + kCommonHelp);
  }
  if (wants_help || contains(arguments, "--version")) {
    return print_about(is_report, !wants_help);
  }
  if (is_certify) {
    return emax::host::run_certify(arguments.from(1));
  }
  if (command == "compare") {
    return emax::host::run_compare(arguments.from(1));
  }
  if (command == "scpi") {
    return emax::host::run_scpi(arguments.from(1));
  }
  return is_report ? emax::host::run_report(arguments.from(1)) : unknown_command(command);
}

// A file that is opened later must not take the place of a stream that was closed from outside.
void hold_standard_streams() noexcept {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (fcntl(stream, F_GETFD) < 0) {
      (void)open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    hold_standard_streams();
    emax::host::watch_for_stop_requests();
    const std::vector<std::string_view> arguments(argv + std::min(argc, 1), argv + argc);
    return emax::host::finish(run(Arguments(arguments.data(), arguments.size())));
  } catch (const std::exception&) {
    std::fputs("emax: out of memory\n", stderr);
    return static_cast<int>(emax::host::ExitStatus::kFault);
  }
}
