// The product in a browser: the instrument on its simulated bench, one short piece a call.
#include <cstddef>
#include <cstdint>

#include "emax/app/base/in_place.hpp"
#include "emax/app/base/text_writer.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/base/span.hpp"
#include "emax/base/status.hpp"
#include "emax/board/simulated_bench.hpp"
#include "emax/board/store_format.hpp"
#include "emax/sim/sim_bench.hpp"
#include "emax/uncertainty/energy_trials.hpp"

#include "desk/scpi/command_list.hpp"
#include "ports.hpp"

namespace emax::web {
namespace {

/// Text to the page, past the console.
class PageSink final : public app::TextSink {
 public:
  void write(Span<const char> text) noexcept override { emax_write(text.data(), text.size()); }
};

// As many as on a PC, so that the answers are those of a PC.
constexpr std::size_t kStoredTrials = 1'000'000;

/// What `emax_poll()` answers, bit by bit.
enum State : std::uint32_t {
  kBusy = 1,      // There is more to do at once.
  kWorking = 2,   // A sweep or an evaluation runs.
  kSettled = 4,   // All that came in was executed, and all answers were handed over.
  kSweeping = 8,  // What runs is the sweep.
  kResting = 16,  // The bench is ahead of its pace: call again in a few milliseconds.
};

/// Holds the time of the bench, which moves block by block, to that of the clock on the wall.
class Pacer final {
 public:
  /// @param[in] pace Seconds of the bench per second; 0 for as fast as it goes.
  void set(double pace) noexcept { pace_ = pace > 0.0 ? pace : 0.0; }

  /// @returns Whether the next block is not due yet.
  bool is_ahead(bool is_sweeping, double bench_s, double now_s) noexcept {
    if (pace_ == 0.0 || !is_sweeping) {
      runs_ = false;
      return false;
    }
    if (!runs_) {
      runs_ = true;
      ahead_s_ = bench_s - pace_ * now_s;
    }
    return bench_s - pace_ * now_s > ahead_s_;
  }

 private:
  double pace_ = 0.0;
  double ahead_s_ = 0.0;  // When the sweep began.
  bool runs_ = false;
};

struct Hardware {
  PageStream console;
  PageClock clock;
  PageStore store{board::kStoreFormat};
  sim::SimBench bench;
};

Hardware hardware;
Pacer pacer;
app::SweepSettings bench_settings;
app::SimulatedBench simulated;
app::Instrument* instrument = nullptr;
double trials[kStoredTrials];
TrialPiece pieces[EnergyTrials::kManyPieces];
app::InPlace<app::Instrument> memory;

std::uint32_t memory_pages() noexcept {
  return static_cast<std::uint32_t>(__builtin_wasm_memory_size(0));
}

app::MemoryUse memory_use() noexcept {
  constexpr std::uint32_t kPageBytes = 65536;
  return {memory_pages() * kPageBytes, 0, 0};
}

void switch_on() noexcept {
  const app::Ports ports = {hardware.bench, hardware.console, hardware.clock, nullptr,
                            &hardware.store};
  const app::Board board = {EMAX_BOARD_NAME, "0", &bench_settings, &simulated, memory_use};
  instrument = &memory.make(ports, board);
  instrument->lend_trial_store(Span<double>(trials, kStoredTrials));
  instrument->lend_trial_pieces(TrialPieces({pieces, EnergyTrials::kManyPieces}));
  instrument->start();
}

}  // namespace
}  // namespace emax::web

extern "C" {

/// @returns How many bytes the page has to keep for the store; they begin as 0xFF.
std::uint32_t emax_store_bytes() noexcept {
  const emax::hal::StoreFormat& format = emax::board::kStoreFormat;
  return format.slot_count * format.slot_bytes;
}

/// Switches the instrument on, once, with this device on the simulated bench; its sensitivity is
/// also what the data sheet says. Zero for all three stands for the bench's usual device.
///
/// @returns 0, or 1 if there is no such device, and then nothing has happened.
std::int32_t emax_start(double sensitivity, double natural_frequency_hz, double damping) noexcept {
  using namespace emax;
  sim::BenchSettings settings;
  app::SweepSettings sweep = app::default_sweep_settings();
  if (sensitivity != 0.0 || natural_frequency_hz != 0.0 || damping != 0.0) {
    settings.device = {sensitivity, natural_frequency_hz, damping};
    sweep.expected_sensitivity = sensitivity;
  }
  if (web::hardware.bench.configure(settings) != Status::kOk) {
    return 1;
  }
  web::bench_settings = sweep;
  web::simulated = board::describe(settings);
  web::switch_on();
  return 0;
}

/// Seconds of the bench per second in sweeps; 0, as at first, for as fast as it goes.
void emax_set_pace(double pace) noexcept { emax::web::pacer.set(pace); }

/// Does a short piece of everything, after `emax_start()`.
///
/// @returns The state, as bits.
std::uint32_t emax_poll() noexcept {
  constexpr double kPerMicrosecond = 1e-6;
  emax::app::Instrument& instrument = *emax::web::instrument;
  const bool is_resting = emax::web::pacer.is_ahead(
      instrument.is_sweeping(), emax::web::hardware.bench.now_s(), kPerMicrosecond * emax_now_us());
  if (is_resting) {
    instrument.converse();
  } else {
    instrument.poll();
  }
  return (is_resting && !instrument.is_conversing() ? emax::web::kResting : 0u) |
         (instrument.is_busy() ? emax::web::kBusy : 0u) |
         (instrument.is_working() ? emax::web::kWorking : 0u) |
         (instrument.is_settled() ? emax::web::kSettled : 0u) |
         (instrument.is_sweeping() ? emax::web::kSweeping : 0u);
}

/// Writes the table of all commands, before `emax_start()` or between two calls of `emax_poll()`.
void emax_list_commands() noexcept {
  emax::web::PageSink sink;
  emax::app::TextWriter out(sink);
  emax::desk::write_command_list(out);
}

}  // extern "C"
