// Any bytes to the whole instrument: it neither crashes nor hangs, and ABORt and a new peer bring
// it back with the drive at zero.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/instrument_bench.hpp"

namespace {

using emax::test::InstrumentBench;

constexpr std::size_t kPiece = 200;
constexpr std::size_t kConsoleRoom = 8192;
// What runs may run for so long before the peer goes away: some blocks of a sweep, some steps of a
// search.
constexpr int kPollsPerPiece = 12;
// A step each for the messages that memory holds, and some for the end of what runs.
constexpr int kMostPolls = 3 * 4200 + 1000;

void require(bool holds, const char* what) {
  if (!holds) {
    (void)std::fprintf(stderr, "%s\n", what);
    std::abort();
  }
}

/// As `InstrumentBench::ask()`, with an end that is near.
std::string ask(InstrumentBench& board, const std::string& message) {
  board.console.send(message + "\n");
  for (int i = 0; i < kMostPolls; ++i) {
    board.poll();
    if (board.instrument->is_settled() && !board.instrument->is_busy()) {
      return board.console.receive();
    }
  }
  return "no end";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(size, '\0');
  std::transform(data, data + size, bytes.begin(),
                 [](std::uint8_t byte) { return static_cast<char>(byte); });
  InstrumentBench board({}, kConsoleRoom);
  const bool reads = size % 2 == 0;
  for (std::size_t sent = 0; sent < size; sent += kPiece) {
    board.console.send(bytes.substr(sent, kPiece));
    board.poll(kPollsPerPiece);
    if (reads) {
      (void)board.console.receive();
    }
  }
  board.console.connect(false);
  board.poll(2);
  (void)board.console.receive();
  board.console.connect(true);
  require(ask(board, "ABOR;*CLS;*SRE 0;*ESE 0;*IDN?") == "emax,test,4711,0.1.0\n", "no identity");
  require(!board.instrument->is_working(), "something runs after ABORt");
  require(board.drive_is_at_zero(), "the drive is not at zero");
  const std::string rest = ask(board, "SYST:ERR?;*ESR?");
  require(rest == "0,\"No error\";0\n", rest.c_str());
  return 0;
}
