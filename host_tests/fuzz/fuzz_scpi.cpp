// Any bytes as SCPI: no crash, bounded work, sane registers, and answers that do not depend on how
// the bytes come in.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/toy_instrument.hpp"

namespace {

using emax::test::ToyConsole;

// Without a reader a byte that came in is worth three steps at most (a message is looked at,
// begun, ended), and an item of an answer takes two characters of the output.
constexpr int kMostSteps = 3 * 4200 + 512;
// Some answers are long; reading all of each would be slow.
constexpr std::size_t kMostRead = 4000;

void require(bool holds, const char* what) {
  if (!holds) {
    (void)std::fprintf(stderr, "%s\n", what);
    std::abort();
  }
}

/// A peer that sends pieces of that size and reads at once.
std::string answers_to(const std::string& bytes, std::size_t piece_size) {
  ToyConsole console;
  std::string answers;
  std::size_t sent = 0;
  bool acts = true;
  while (acts && answers.size() < kMostRead) {
    const std::size_t count = console.send(bytes.substr(sent, piece_size));
    sent += count;
    acts = count > 0;
    // All that can be done is done before the next piece comes.
    bool has_stepped = false;
    while (answers.size() < kMostRead && console.step()) {
      answers += console.read();
      has_stepped = true;
    }
    require(!has_stepped || console.session.consistent(), "not consistent");
    acts = acts || has_stepped;
  }
  answers.resize(std::min(answers.size(), kMostRead));
  return answers;
}

/// A peer that never reads; the instrument gives up on it now and then.
void never_read(const std::string& bytes) {
  ToyConsole console;
  for (std::size_t sent = 0; sent < bytes.size();) {
    const std::size_t count = console.send(bytes.substr(sent, 100));
    sent += count;
    require(console.run(kMostSteps) < kMostSteps, "too many steps");
    require(console.session.consistent(), "not consistent");
    if (count == 0 && !console.session.is_deadlocked()) {
      return;
    }
    if (count == 0) {
      console.session.break_deadlock();
      require(console.session.consistent(), "not consistent after a deadlock");
    }
  }
}

/// After whatever came before, a device clear brings everything back.
void recover(const std::string& bytes) {
  ToyConsole console;
  (void)console.send(bytes);
  (void)console.run(kMostSteps);
  console.session.clear();
  require(console.ask("*CLS;*IDN?\n") == "maker,toy,0,1.0\n", "no identity");
  require(console.error() == "0,\"No error\"\n", "an error is left");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(size, '\0');
  std::transform(data, data + size, bytes.begin(),
                 [](std::uint8_t byte) { return static_cast<char>(byte); });
  require(answers_to(bytes, 3) == answers_to(bytes, 300), "answers differ");
  never_read(bytes);
  recover(bytes);
  return 0;
}
