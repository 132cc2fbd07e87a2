// Test image: prints how many instructions each piece of work takes.
//
// The arguments say what to count: kernels, energies-2, energies-10, steps-2, steps-10, report,
// sweep.
#include <array>
#include <cstddef>

#include "emax/app/base/text_writer.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/board/board.hpp"
#include "emax/board/instruction_counter.hpp"
#include "emax/board/semihosting.hpp"

#include "command_line.hpp"
#include "memory.hpp"
#include "rows.hpp"
#include "test_image.hpp"

namespace emax::cost {
namespace {

constexpr int kBadInput = 2;
constexpr int kFailed = 3;

void wait_for_console() noexcept {
  while (!board::console_sent()) {
  }
}

struct Part {
  const char* name;
  Status (*count)(Rows& rows) noexcept;
};

constexpr Part kParts[] = {
    {"kernels", count_kernels},
    {"energies-2", [](Rows& rows) noexcept { return count_energies(2, rows); }},
    {"energies-10", [](Rows& rows) noexcept { return count_energies(10, rows); }},
    {"steps-2", [](Rows& rows) noexcept { return count_steps(2, rows); }},
    {"steps-10", [](Rows& rows) noexcept { return count_steps(10, rows); }},
    {"report", count_report},
    {"sweep", count_sweep},
};

const Part* find(Span<const char> name) noexcept {
  for (const Part& part : kParts) {
    if (board::is(name, part.name)) {
      return &part;
    }
  }
  return nullptr;
}

int count_all(board::Words arguments, app::TextWriter& out) noexcept {
  Rows rows(out);
  (void)arguments.next();  // The emulator puts the path of the image in front.
  while (!arguments.done()) {
    const Part* part = find(arguments.next());
    if (part == nullptr) {
      out.text("expected: kernels, energies-2, energies-10, steps-2, steps-10, report, sweep\n");
      return kBadInput;
    }
    const Status status = part->count(rows);
    if (status != Status::kOk) {
      out.text(part->name).text(": ").text(explain(status)).line();
      return kFailed;
    }
  }
  return 0;
}

int run() noexcept {
  const Status status = board::start_board();
  board::ConsoleSink sink(board::ports().console);
  app::TextWriter out(sink);
  if (status != Status::kOk) {
    out.text(explain(status)).line();
    return kFailed;
  }
  start_counter();
  std::array<char, board::kCommandLineRoom> line = {};
  return count_all(board::Words({line.data(), board::read_command_line(line)}), out);
}

}  // namespace

Memory& memory() noexcept {
  static Memory instance;
  return instance;
}

void Rows::add(const char* name, std::uint64_t instructions) noexcept {
  out_.text(name).text(" ").integer(instructions).line();
  wait_for_console();
}

void Rows::add(const char* name, std::uint32_t duration_ms, std::uint64_t instructions) noexcept {
  out_.text(name).text(".").integer(duration_ms).text("ms ").integer(instructions).line();
  wait_for_console();
}

}  // namespace emax::cost

extern "C" int main() { emax::board::finish(emax::cost::run()); }
