// `emax report`: from the command line to the report on standard output and in files.
#pragma once

#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/command.hpp"
#include "desk/cli/problem.hpp"

namespace emax::desk {

/// Runs the whole command. Standard output stays empty unless all has gone well.
///
/// @param[in] arguments What follows `report` on the command line.
Problem run_report(Span<const std::string_view> arguments);

/// @returns What the command does, and its options.
std::string help_on_report();

inline constexpr Command kReportCommand = {
    "report",
    R"(  report     measures and identifies the device, finds the maximum energy, its
             uncertainty by Monte Carlo and its trend over T, prints a report
)",
    run_report,
    help_on_report,
    R"(  0     all is well
  3     a fault while measuring or writing the results; one line on standard
        error says which, and what was measured is printed and written
  130   stopped by Ctrl-C, with the drive at zero and without partial files
)",
    R"(  emax report
  emax report --bench-seed 2 --bench-fault swapped-channels@4 --out results
  emax report --instrument /dev/ttyACM0 --level 5 --out results
  emax report --points host_tests/data/djb_a1800v.csv --out results
  emax report --model 1.037,4073,0.3182,0.003,6,0.0004 --time 0.01
  emax report --model 1.037,4073,0.3182 --order 4 --json
)"};

}  // namespace emax::desk
