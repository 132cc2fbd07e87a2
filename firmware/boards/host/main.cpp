// The program `emax`: the instrument on a PC.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fcntl.h>
#include <string_view>
#include <unistd.h>
#include <vector>

#include "desk/certify/certify_command.hpp"
#include "desk/cli/command.hpp"
#include "desk/cli/console.hpp"
#include "desk/cli/problem.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/compare/compare_command.hpp"
#include "desk/report/report_command.hpp"
#include "scpi_command.hpp"

namespace {

using emax::Span;
using emax::desk::Command;

constexpr const char* kAbout =
    R"(usage: emax report [options]
       emax report --points FILE [options]
       emax report --model S,f0,beta[,uS,uf0,ubeta] [options]
       emax COMMAND --help | --help | --version

How wrong can this accelerometer get? emax finds the input signal, limited to
+-a and to a time T, that makes the integral-square error at the output of an
accelerometer as large as possible, and the uncertainty of that maximum.
)";

constexpr Command kCommands[] = {emax::desk::kReportCommand, emax::desk::kCertifyCommand,
                                 emax::desk::kCompareCommand, emax::host::kScpiCommand};

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
    emax::desk::watch_for_stop_requests();
    const std::vector<std::string_view> arguments(argv + std::min(argc, 1), argv + argc);
    return emax::desk::finish(emax::desk::run_program(
        kCommands, kAbout, Span<const std::string_view>(arguments.data(), arguments.size())));
  } catch (const std::exception&) {
    std::fputs("emax: out of memory\n", stderr);
    return static_cast<int>(emax::desk::ExitStatus::kFault);
  }
}
