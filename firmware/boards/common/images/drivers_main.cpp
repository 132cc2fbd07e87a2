// Test image: the console, or clock, store and watchdog, with a peer on the console that knows the
// same script (host_tests/boards/test_drivers.py).
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "emax/app/base/text_writer.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/board/board.hpp"
#include "emax/board/console_rings.hpp"
#include "emax/board/semihosting.hpp"
#include "emax/board/startup.hpp"
#include "emax/board/store_format.hpp"

#include "command_line.hpp"
#include "test_image.hpp"

namespace emax::board {
namespace {

constexpr int kFailed = 1;
constexpr int kBadInput = 2;

constexpr std::size_t kEchoed = 2000;
constexpr std::size_t kFlood = 5000;

constexpr std::uint32_t kSlot = kStoreFormat.slot_count - 1;
constexpr std::array<std::uint8_t, 4> kRecord = {0x45, 0x4D, 0x41, 0x58};

// With an instruction in 1024 ns, a second, and more than the 172 s in which a count of 32 bits
// starts over.
constexpr std::uint32_t kShortTurns = 500'000;
constexpr std::uint32_t kLongTurns = 100'000'000;

// Two instructions a turn.
void spin(std::uint32_t turns) noexcept {
#if defined(__riscv)
  asm volatile(".balign 8\n1: addi %0, %0, -1\nbnez %0, 1b" : "+r"(turns));
#else
  asm volatile(".balign 8\n1: subs %0, %0, #1\nbne 1b" : "+r"(turns)::"cc");
#endif
}

/// Sends back what comes in, until there have been `kEchoed` bytes.
void echo(hal::ByteStream& console, app::TextSink& sink) noexcept {
  std::array<char, 100> bytes = {};
  for (std::size_t count = 0; count < kEchoed;) {
    const std::size_t came = console.read(bytes);
    sink.write(Span<const char>(bytes).first(came));
    count += came;
  }
}

/// Reads nothing until all bytes that found no room are counted, and then what there is.
void overflow(hal::ByteStream& console, app::TextSink& sink) noexcept {
  app::TextWriter out(sink);
  out.text("flood\n");
  std::uint32_t lost = 0;
  while (lost < kFlood - kReceiveRoom) {
    lost += console.take_lost_count();
  }
  std::array<char, kReceiveRoom> bytes = {};
  const std::size_t kept = console.read(bytes);
  out.text("lost ").integer(lost).text(" kept ").integer(kept).line();
  sink.write(Span<const char>(bytes).first(kept));
}

/// Says how long a known number of instructions took.
void keep_time(std::uint32_t turns, hal::Clock& clock, app::TextWriter& out) noexcept {
  const std::uint64_t begin_us = clock.now_us();
  spin(turns);
  const std::uint64_t passed_us = clock.now_us() - begin_us;
  out.integer(2 * turns).text(" instructions took ").integer(passed_us).text(" us\n");
}

bool holds_record() noexcept {
  std::array<std::uint8_t, kRecord.size()> found = {};
  return ports().store->read(kSlot, found) == Status::kOk && found == kRecord;
}

/// Kicks for three periods, then hangs: this comes back in a new run if there is a watchdog.
int bite(app::TextWriter& out) noexcept {
  hal::Watchdog& watchdog = *ports().watchdog;
  if (watchdog.start() != Status::kOk) {
    out.text("no watchdog; reset\n");
    while (!console_sent()) {
    }
    reset();
  }
  hal::Clock& clock = ports().clock;
  const std::uint64_t end_us = clock.now_us() + 3 * std::uint64_t{watchdog.period_us()};
  while (clock.now_us() < end_us) {
    watchdog.kick();
    spin(1000);
  }
  out.text("hang\n");
  for (;;) {
    spin(1000);
  }
}

/// The second part, in two runs of the program.
int pass_time(app::TextWriter& out) noexcept {
  out.text(ports().watchdog->caused_reset() ? "watchdog reset" : "other reset");
  if (holds_record()) {
    out.text(", record kept\n");
    return 0;
  }
  out.line();
  keep_time(kShortTurns, ports().clock, out);
  keep_time(kLongTurns, ports().clock, out);
  return ports().store->write(kSlot, kRecord) == Status::kOk ? bite(out) : kFailed;
}

int run() noexcept {
  if (start_board() != Status::kOk) {
    return kFailed;
  }
  hal::ByteStream& console = ports().console;
  ConsoleSink sink(console);
  app::TextWriter out(sink);
  std::array<char, kCommandLineRoom> line = {};
  Words words({line.data(), read_command_line(line)});
  const Span<const char> part = words.last();
  if (is(part, "time")) {
    return pass_time(out);
  }
  if (!is(part, "console")) {
    return kBadInput;
  }
  echo(console, sink);
  overflow(console, sink);
  return 0;
}

}  // namespace
}  // namespace emax::board

extern "C" int main() { emax::board::finish(emax::board::run()); }
