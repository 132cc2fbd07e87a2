// Test image: ends in the fault that is asked for, while the drive is not at zero.
#include <array>
#include <cstddef>
#include <cstdint>

#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/board/board.hpp"
#include "emax/board/registers.hpp"
#include "emax/board/semihosting.hpp"
#include "emax/hal/analog_stream.hpp"

#include "command_line.hpp"
#include "test_image.hpp"

// The functions that fail; a test compares the pc of the report with where they are.
extern "C" {
[[gnu::noinline]] void fail_by_trap();
[[gnu::noinline]] void fail_by_bus();
[[gnu::noinline]] void fail_by_code();
int fail_by_stack(int depth);
}

namespace emax::board {
namespace {

constexpr int kBadInput = 2;
constexpr int kNoDrive = 3;
constexpr int kNoFault = 4;

constexpr hal::Word kAmplitude = 1 << 28;
constexpr hal::Word kStep = kAmplitude / hal::kMaxBlockFrames;

// Address space with nothing in it on every board.
constexpr std::uintptr_t kNowhere = 0xF0000000;

bool drive_up(hal::AnalogStream& stream) noexcept {
  std::array<hal::Word, hal::kMaxBlockFrames> drive = {};
  std::array<hal::Frame, hal::kMaxBlockFrames> response = {};
  for (std::size_t i = 0; i < drive.size(); ++i) {
    drive[i] = static_cast<hal::Word>(i + 1) * kStep;
  }
  return stream.start({kAmplitude, kStep}) == Status::kOk &&
         stream.exchange(drive, response).status == Status::kOk;
}

int run() noexcept {
  if (start_board() != Status::kOk || !drive_up(ports().analog)) {
    return kNoDrive;
  }
  std::array<char, kCommandLineRoom> line = {};
  Words words({line.data(), read_command_line(line)});
  const Span<const char> kind = words.last();
  if (is(kind, "trap")) {
    fail_by_trap();
    return kNoFault;
  }
  if (is(kind, "bus")) {
    fail_by_bus();
    return kNoFault;
  }
  if (is(kind, "code")) {
    fail_by_code();
    return kNoFault;
  }
  if (is(kind, "stack")) {
    return fail_by_stack(1) != 0 ? kNoFault : 0;
  }
  return kBadInput;
}

}  // namespace
}  // namespace emax::board

void fail_by_trap() { __builtin_trap(); }

void fail_by_bus() { emax::board::reg(emax::board::kNowhere) = 1; }

// Its own first instruction.
void fail_by_code() {
  emax::board::reg(reinterpret_cast<std::uintptr_t>(&fail_by_code) & ~std::uintptr_t{3}) = 0;
}

// The volatile room keeps each call's own stack, and the sum keeps this from becoming a loop.
int fail_by_stack(int depth) {
  volatile char room[64] = {};
  room[0] = static_cast<char>(depth);
  return depth == 0 ? 0 : fail_by_stack(depth + 1) + room[0];
}

extern "C" int main() { emax::board::finish(emax::board::run()); }
