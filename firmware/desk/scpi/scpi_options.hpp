// The command line of `emax scpi`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "emax/base/span.hpp"

#include "desk/cli/options.hpp"
#include "desk/cli/problem.hpp"

namespace emax::desk {

struct ScpiOptions {
  ReportOptions report;  ///< Its bench and its sweep; nothing else of it is asked for.
  bool listens = false;
  std::string address = "127.0.0.1";  ///< With `listens`.
  std::uint16_t port = 0;             ///< The same; 0 for one that the system chooses.
  double pace = 0.0;       ///< Seconds of the bench per second; 0 for as fast as it goes.
  std::string store_path;  ///< Empty for a store that forgets.
  bool prints_commands = false;
};

/// Reads the arguments behind `emax scpi`.
///
/// @param[out] options Of no use if there is a problem.
Problem parse_scpi_options(Span<const std::string_view> arguments, ScpiOptions& options);

/// @returns The help of all options, in lines of at most 80 characters.
std::string help_on_scpi_options();

}  // namespace emax::desk
