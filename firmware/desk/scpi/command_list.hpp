// The table of all SCPI commands for people who read.
#pragma once

#include "emax/app/base/text_writer.hpp"

namespace emax::desk {

/// Writes the instrument's own table as Markdown, one row for each command.
void write_command_list(app::TextWriter& out) noexcept;

}  // namespace emax::desk
