// A laboratory's table as the messages that give its points to the instrument.
#pragma once

#include <string>
#include <string_view>

#include "emax/app/base/text_writer.hpp"

#include "desk/cli/problem.hpp"

namespace emax::web {

/// What the program's options of the same names say, each empty where it is not given.
struct TableOptions {
  std::string_view uncertainty;
  std::string_view input_units;
  std::string_view channel_delay;
  bool is_inverted = false;
  std::string_view reference_percent;
};

/// Reads a table (`desk::read_points()`), and writes what was understood of it, then a line for
/// each point: `TRAC:FRES:DATA f,A,phi,U(A),U(phi)`. The instrument has then the points to the last
/// bit, as long as their phases came in degrees.
///
/// @param[in] name Of a file that was added.
desk::Problem write_table_lines(const std::string& name, const TableOptions& given,
                                app::TextWriter& out);

}  // namespace emax::web
