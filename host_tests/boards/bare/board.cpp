// A processor without anything around it.
#include "emax/board/board.hpp"

#include <cstddef>
#include <cstdint>

#include "emax/board/cortex_m.hpp"
#include "emax/board/fault_report.hpp"

namespace emax::board {
namespace {

class NoStream final : public hal::AnalogStream {
 public:
  constexpr NoStream() noexcept : AnalogStream({100000.0, 10.0, 10.0, hal::kMaxBlockFrames, 0}) {}

 private:
  Status do_start() noexcept override { return Status::kHardwareFault; }
  hal::Exchange do_exchange(Span<const hal::Word> /*drive*/,
                            Span<hal::Frame> /*response*/) noexcept override {
    return {Status::kHardwareFault, 0};
  }
  std::uint32_t do_ramp_to_zero(hal::Word /*step_per_frame*/) noexcept override { return 0; }
  void do_stop() noexcept override {}
  bool do_drive_is_at_zero() const noexcept override { return true; }
};

class NoConsole final : public hal::ByteStream {
 private:
  std::size_t do_read(Span<char> /*bytes*/) noexcept override { return 0; }
  std::size_t do_write(Span<const char> bytes) noexcept override { return bytes.size(); }
  bool do_connected() const noexcept override { return false; }
  std::uint32_t do_take_lost_count() noexcept override { return 0; }
};

/// A microsecond passes from one look to the next.
class LooksAsClock final : public hal::Clock {
 public:
  constexpr LooksAsClock() noexcept : Clock(1) {}

 private:
  std::uint64_t do_now_us() noexcept override { return ++looks_; }

  std::uint64_t looks_ = 0;
};

NoStream stream;
NoConsole console;
LooksAsClock looks;

constexpr app::Ports kPorts = {stream, console, looks, nullptr, nullptr};
constexpr app::Board kAbout = {EMAX_BOARD_NAME, "0", nullptr, nullptr, nullptr};

constexpr VectorTable make_vectors() {
  VectorTable table = {stack_top, start, on_fault, {}, {}};
  for (InterruptHandler& handler : table.fault) {
    handler = on_fault;
  }
  for (InterruptHandler& handler : table.interrupt) {
    handler = on_fault;
  }
  return table;
}
static_assert(kVectorTableAlignment == 512, "118 vectors of four bytes");

}  // namespace

extern "C" {
[[gnu::section(".start")]] alignas(kVectorTableAlignment) constexpr VectorTable vectors =
    make_vectors();
}

Status start_board() noexcept { return Status::kOk; }

const app::Ports& ports() noexcept { return kPorts; }

const app::Board& about() noexcept { return kAbout; }

void rest() noexcept {}

bool console_sent() noexcept { return true; }

bool lead_drive_to_zero() noexcept { return true; }

void write_polled(Span<const char> /*text*/) noexcept {}

}  // namespace emax::board
