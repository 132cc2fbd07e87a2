// `emax certify`: a bound that no signal exceeds, with the certificate that proves it.
#pragma once

#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/command.hpp"
#include "desk/cli/problem.hpp"

namespace emax::desk {

/// Runs the whole command. Ctrl-C ends the work early; what is proven by then is printed all the
/// same.
///
/// @param[in] arguments What follows `certify` on the command line.
Problem run_certify(Span<const std::string_view> arguments);

/// @returns What the command does, and its options.
std::string help_on_certify();

inline constexpr Command kCertifyCommand = {
    "certify",
    R"(  certify    proves how far the maximum can be from the truth, for any signal
)",
    run_certify,
    help_on_certify,
    R"(  0     all is well; also after Ctrl-C, with what was proven by then
  3     a fault while proving or writing; one line on standard error says which
  130   stopped by Ctrl-C before anything was proven, without partial files
)",
    R"(  emax certify --model 1.037,4073,0.3182 --effort 30 --out certificate.json
  emax certify --model 1.037,4073,0.3182,0.003,6,0.0004 --box auto --effort 30
  emax certify --points host_tests/data/djb_a1800v.csv --time 0.001
  emax certify --model 1.037,4073,0.3182 --order 4 --json
)"};

}  // namespace emax::desk
