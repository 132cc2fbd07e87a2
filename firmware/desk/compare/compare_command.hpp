// `emax compare`.
#pragma once

#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/command.hpp"
#include "desk/cli/problem.hpp"

namespace emax::desk {

/// @param[in] arguments Those behind `emax compare`.
Problem run_compare(Span<const std::string_view> arguments);

/// @returns What the command does, and its options.
std::string help_on_compare();

inline constexpr Command kCompareCommand = {"compare",
                                            R"(  compare    ranks devices by how wrong they can get
)",
                                            run_compare,
                                            help_on_compare,
                                            R"(  0     all is well
  3     a fault while writing the results; one line on standard error says which
  130   stopped by Ctrl-C, without partial files
)",
                                            R"(  emax compare a/results.json b/results.json
  emax compare a/results.json b/results.json c/results.json --out comparison
  emax compare a/results.json b/results.json --by energy --csv
)"};

}  // namespace emax::desk
