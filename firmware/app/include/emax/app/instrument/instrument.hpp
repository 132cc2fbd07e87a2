// The instrument: sweep and evaluation behind an SCPI console, on every board the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/evaluate/evaluation_results.hpp"
#include "emax/app/instrument/error_words.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/app/scpi/call.hpp"
#include "emax/app/scpi/command.hpp"
#include "emax/app/scpi/session.hpp"
#include "emax/app/sequencer/sequencer.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/base/status.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/hal/analog_stream.hpp"
#include "emax/hal/byte_stream.hpp"
#include "emax/hal/clock.hpp"
#include "emax/hal/store.hpp"
#include "emax/hal/watchdog.hpp"
#include "emax/identify/frequency_response.hpp"

namespace emax::app {

/// What DIAGnostic:MEMory? answers.
struct MemoryUse {
  std::uint32_t static_bytes = 0;
  std::uint32_t stack_limit = 0;
  std::uint32_t stack_used = 0;  ///< At most, so far.
};

/// What an instrument is told of the board that it runs on. Outlives it, with all it points at.
struct Board {
  const char* name = "";  ///< The second field of *IDN?.
  const char* serial = "0";
  /// The defaults of the sweep; null for `default_sweep_settings()`.
  const SweepSettings* bench = nullptr;
  /// What a simulated bench was built from, for the report; null for a real one.
  const SimulatedBench* simulated = nullptr;
  /// Null where the board does not know.
  MemoryUse (*memory_use)() noexcept = nullptr;
  /// Makes the defaults of the sweep where `bench` is null, for a board without room to keep them.
  SweepSettings (*make_bench)() noexcept = nullptr;
  /// What *TST? answers if all else is right: 0, or a number of the board's own, from
  /// kFirstBoardCheck on. Called while nothing runs. Null where there is nothing to check.
  std::uint32_t (*check_hardware)() noexcept = nullptr;
  /// What DIAGnostic:CONVersion? answers: measures how long a result of the converters takes, in
  /// seconds; not a number if it cannot. Called while nothing runs. Null where nobody measures it.
  double (*measure_conversion_s)() noexcept = nullptr;
};

inline constexpr std::uint32_t kFirstBoardCheck = 901;

/// The hardware of an instrument.
struct Ports {
  hal::AnalogStream& analog;
  hal::ByteStream& console;
  hal::Clock& clock;
  hal::Watchdog* watchdog = nullptr;
  hal::Store* store = nullptr;
};

/// A console that executes SCPI commands with a sequencer, and keeps their settings.
///
///     static InPlace<Instrument> memory;
///     Instrument& instrument = memory.make(ports, board);
///     instrument.start();
///     for (;;) {
///       instrument.poll();
///     }
///
/// `poll()` never waits, except for a block of a sweep: it does one block or one step of what runs,
/// executes at most one unit of a message, and hands over what the console takes. One thing runs at
/// a time: a sweep, an evaluation, or a run of the fixed point. INITiate starts it in the
/// background; a query whose answer has to be computed starts it too, and the messages behind that
/// query stay where they are. ABORt ends whatever runs, at once, also from behind such a query.
///
/// All memory is inside. What a peer does that goes away or never reads ends no sweep.
class Instrument {
 public:
  Instrument(const Ports& ports, const Board& board) noexcept;
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;

  /// Power on: defaults, the identification that was kept in the store, the watchdog.
  void start() noexcept;

  /// Does a short piece of everything.
  void poll() noexcept;

  /// Does its part of the console alone: what runs stays where it is.
  void converse() noexcept;

  /// As ABORt: ends what runs, with the drive at zero. What is complete stays.
  void abort() noexcept;

  /// @returns True while a sweep, an evaluation or a fixed point runs.
  bool is_working() const noexcept { return sequencer_.is_working(); }
  bool is_sweeping() const noexcept { return sequencer_.job() == Job::kSweep; }
  /// @returns False if the next `poll()` has nothing to do but to look for bytes.
  bool is_busy() const noexcept { return is_working() || has_acted_; }
  /// @returns True if the last call took or handed over characters, or executed something.
  bool is_conversing() const noexcept { return has_acted_; }
  /// @returns True if all that came in was executed and all answers were handed over. Work in the
  /// background may go on.
  bool is_settled() const noexcept { return session_.is_idle(); }
  /// @returns False while the memory is full of messages that wait.
  bool takes_input() const noexcept { return session_.room() > 0; }
  /// @returns True while a query or *WAI keeps the messages behind it waiting.
  bool is_held() const noexcept { return session_.is_waiting(); }
  /// @returns True if there are characters that the console did not take.
  bool wants_to_write() const noexcept { return !session_.output().empty(); }

  /// Lends memory for the values of the trials: as `Evaluation::lend_trial_store()`.
  void lend_trial_store(Span<double> store) noexcept { sequencer_.lend_trial_store(store); }
  /// Lends memory for their polynomials: as `Evaluation::lend_trial_pieces()`.
  void lend_trial_pieces(TrialPieces pieces) noexcept { sequencer_.lend_trial_pieces(pieces); }

  /// @returns All commands with their texts, for documentation.
  static Span<const scpi::Command<Instrument>> commands() noexcept;
  /// @returns The same for the parser.
  static scpi::Table<Instrument> rows() noexcept;

  // What the commands are made of. Where words are answered, they say why nothing was done.

  const Board& board() const noexcept { return board_; }
  Sequencer& sequencer() noexcept { return sequencer_; }
  const Sequencer& sequencer() const noexcept { return sequencer_; }

  const Settings& settings() const noexcept { return settings_; }
  const SweepSettings& sweep_settings() const noexcept { return sweep_settings_; }
  /// Those of *RST.
  SweepSettings default_sweep() const noexcept;
  /// As `app::narrow()`, of a setting of the sweep.
  void narrow(std::size_t index, SettingLimits& limits) const noexcept {
    app::narrow(index, sweep_settings_, ports_.analog.format(), limits);
  }
  /// Takes settings that `check()` accepts, unless work runs that needs the old ones.
  ErrorWords take(const Settings& settings) noexcept;
  ErrorWords take(const SweepSettings& settings) noexcept;
  /// @returns Why this part cannot change now.
  ErrorWords conflict_with(Part part) const noexcept;

  // The device; each refused while work runs that needs the one of before.
  ErrorWords take(const Device& device) noexcept;
  ErrorWords take(const FrequencyResponse& points) noexcept;
  ErrorWords clear_points() noexcept;

  /// ABORt: what runs ends, and so does an answer that is made as long as it is read.
  void abort_command() noexcept {
    was_aborted_ = true;
    abort();
  }
  /// A query that goes on and on begins; then whether ABORt came since.
  void begin_answer() noexcept { was_aborted_ = false; }
  bool was_aborted() const noexcept { return was_aborted_; }

  /// *RST: as after power on, but for what the store holds.
  void reset() noexcept;

  // Work in the background: INITiate. Nothing happens where the goal's results are there.
  ErrorWords initiate_sweep() noexcept;
  ErrorWords initiate(Goal goal) noexcept;

  // Work for a query. True once what it needs is there; otherwise the query waits or has failed.
  bool provide(scpi::Call& call, Goal goal) noexcept;
  /// The fit: the device is then the one that the points give.
  bool provide_fit(scpi::Call& call) noexcept;
  /// The same, also true where the points give S alone.
  bool provide_sensitivity(scpi::Call& call) noexcept;
  bool provide_fixed_point(scpi::Call& call) noexcept;
  bool provide_loopback(scpi::Call& call) noexcept;

  /// *OPC: sets event bit 0 once nothing runs.
  void complete_operation() noexcept;
  /// *CLS: not any more.
  void forget_completion() noexcept { completes_operation_ = false; }

  /// The next random number from the seed of the settings.
  double next_random() noexcept { return generator_.next(); }
  /// Begins again at the seed.
  void restart_random() noexcept;

  bool has_store() const noexcept { return ports_.store != nullptr; }
  /// While nothing runs, for they borrow its memory. Statuses of `RecordStore` and `decode()`.
  Status save_settings(std::uint32_t slot) noexcept;
  Status recall_settings(std::uint32_t slot) noexcept;

  /// While nothing runs.
  ///
  /// @returns Nothing if the report is longer than the memory. Valid until something runs.
  ///
  /// @param[in] memory Of the sequencer; `labels` may be in front of it.
  Span<const char> render_report(const Labels& labels, Span<char> memory) noexcept;
  /// The same of FETCh:JSON?.
  Span<const char> render_json() noexcept;

  /// The common part of points from elsewhere, expanded, in percent.
  double common_percent() const noexcept { return settings_.common_percent; }
  void set_common_percent(double percent) noexcept { settings_.common_percent = percent; }

  /// Bit of STATus:OPERation: an evaluation or a fixed point runs.
  static constexpr std::uint16_t kComputing = 1u << 8;

 private:
  void follow_peer() noexcept;
  void end_query() noexcept;
  void clear_device() noexcept;
  void receive() noexcept;
  void execute() noexcept;
  void send() noexcept;
  void work() noexcept;
  void begin_work(std::uint16_t condition) noexcept;
  void end_work(Job job) noexcept;
  void complete_work() noexcept;
  void end_sweep() noexcept;
  void warn(Warning warning) noexcept;
  std::uint16_t questionable_of_sweep() const noexcept;
  void end_evaluation() noexcept;
  ErrorWords begin_evaluation(Goal goal) noexcept;
  bool can_begin(scpi::Call& call) noexcept;
  void change_device() noexcept;
  void reset_settings() noexcept;
  void show_fit_quality() noexcept;
  void keep_identification() noexcept;
  void restore_identification() noexcept;

  Ports ports_;
  Board board_;
  scpi::Session session_;
  Settings settings_;
  SweepSettings sweep_settings_;
  WichmannHill generator_;
  std::uint64_t deadlock_since_us_ = 0;
  bool is_fit_kept_ = false;    // The fit of these points is in the store.
  bool warns_of_fit_ = false;   // The fit of the last sweep, the first time, if it is in doubt.
  bool is_background_ = false;  // The job was begun by INITiate.
  bool is_query_job_ = false;   // The query under way has begun the job that runs or has ended.
  bool was_aborted_ = false;
  bool completes_operation_ = false;  // *OPC waits for the job.
  bool was_connected_ = false;
  bool is_deadlocked_ = false;
  bool has_acted_ = false;
  Sequencer sequencer_;
};

// Beside the sequencer: settings, console, status.
static_assert(!kHasDefaultCapacities ||
              sizeof(Instrument) <= sizeof(Sequencer) + std::size_t{9} * 1024);

}  // namespace emax::app
