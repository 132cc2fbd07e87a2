// The table of all SCPI commands for people who read.
#include "desk/scpi/command_list.hpp"

#include "emax/app/instrument/instrument.hpp"

namespace emax::desk {

namespace {

using Command = app::scpi::Command<app::Instrument>;

// A bar would end the cell.
void write_cell(const char* text, app::TextWriter& out) noexcept {
  for (; *text != '\0'; ++text) {
    if (*text == '|') {
      out.text("\\");
    }
    out.text(Span<const char>(text, 1));
  }
}

void write_code(const char* text, app::TextWriter& out) noexcept {
  if (*text != '\0') {
    out.text("`");
    write_cell(text, out);
    out.text("`");
  }
}

const char* forms_of(const Command& command) noexcept {
  if (!command.has_query()) {
    return "set";
  }
  return command.has_set() ? "set, query" : "query";
}

}  // namespace

void write_command_list(app::TextWriter& out) noexcept {
  out.text("| command | forms | parameters | |\n|---|---|---|---|\n");
  for (const Command& command : app::Instrument::commands()) {
    out.text("| `").text(command.pattern).text("` | ").text(forms_of(command)).text(" | ");
    write_code(command.parameters, out);
    out.text(" | ");
    write_cell(command.description, out);
    out.text(" |\n");
  }
}

}  // namespace emax::desk
