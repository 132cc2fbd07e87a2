// The instrument: sweep and evaluation behind an SCPI console, on every board the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "emax/app/evaluate/evaluation.hpp"
#include "emax/app/instrument/self_test.hpp"
#include "emax/app/measure/sweep.hpp"
#include "emax/app/report/measurement.hpp"
#include "emax/app/scpi/command.hpp"
#include "emax/app/scpi/session.hpp"
#include "emax/app/settings/settings.hpp"
#include "emax/app/settings/sweep_settings.hpp"
#include "emax/app/store/record_store.hpp"
#include "emax/app/store/saved_state.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/energy/phi_operator.hpp"
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
  /// The defaults of the sweep; null for `SweepSettings{}`.
  const SweepSettings* bench = nullptr;
  /// What a simulated bench was built from, for the report; null for a real one.
  const SimulatedBench* simulated = nullptr;
  /// Null where the board does not know.
  MemoryUse (*memory_use)() noexcept = nullptr;
};

/// The hardware of an instrument.
struct Ports {
  hal::AnalogStream& analog;
  hal::ByteStream& console;
  hal::Clock& clock;
  hal::Watchdog* watchdog = nullptr;
  hal::Store* store = nullptr;
};

/// A console that executes SCPI commands, and the sequencer behind it.
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

  /// As ABORt: ends what runs, with the drive at zero. What is complete stays.
  void abort() noexcept;

  /// @returns True while a sweep, an evaluation or a fixed point runs.
  bool is_working() const noexcept { return job_ != Job::kNone; }
  bool is_sweeping() const noexcept { return job_ == Job::kSweep; }
  /// @returns False if the next `poll()` has nothing to do but to look for bytes.
  bool is_busy() const noexcept { return is_working() || has_acted_; }
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
  void lend_trial_store(Span<double> store) noexcept { evaluation_.lend_trial_store(store); }

  /// @returns The table that parser and documentation share.
  static scpi::Table<Instrument> commands() noexcept;

  /// Bit of STATus:OPERation: an evaluation or a fixed point runs.
  static constexpr std::uint16_t kComputing = 1u << 8;

 private:
  friend struct InstrumentCommands;

  /// What runs.
  enum class Job : std::uint8_t { kNone, kSweep, kEvaluation, kFixedPoint };

  /// Where the device comes from.
  enum class Origin : std::uint8_t { kNothing, kSweep, kTable, kModel };

  /// What a change makes stale, and whose work it disturbs.
  enum class Change : std::uint8_t {
    kSweep,
    kTrials,
    kTrend,
    kPaper,  ///< The energy by Method::kPaper.
    kEnergy,
    kDevice,
  };

  /// Why something cannot be done; kNoError if it can.
  struct Refusal {
    scpi::ErrorCode code = scpi::ErrorCode::kNoError;
    const char* words = nullptr;

    explicit operator bool() const noexcept { return code != scpi::ErrorCode::kNoError; }
  };

  /// The fixed point of CALCulate:ENERgy:FPA?.
  struct FixedPointWorkspace {
    GridWorkspace grid;
    PhiOperator phi;
  };
  /// A signal that was asked for.
  struct SignalWorkspace {
    double times_s[kMaxSwitches];
    SwitchingSignal signal;
  };
  /// A record on its way to the store or back.
  struct RecordWorkspace {
    std::uint8_t frame[RecordStore::kFrameBytes + kMaxSavedSettingsBytes];
    SavedSettings scratch;
  };
  /// Of a report: twice the longest that the tests have.
  static constexpr std::size_t kTextCapacity = std::size_t{24} * 1024;

  /// One memory for everything of which only one runs at a time.
  union Workspace {
    constexpr Workspace() noexcept : text{} {}

    char text[kTextCapacity];
    EvaluationWorkspace evaluation;
    SweepWorkspace sweep;
    FixedPointWorkspace fixed_point;
    SignalWorkspace signal;
    FrequencyResponse table;  // While it grows.
    SelfTestWorkspace self_test;
    RecordWorkspace record;
  };

  void follow_peer() noexcept;
  void receive() noexcept;
  void execute() noexcept;
  void send() noexcept;
  void work() noexcept;
  void show_condition() noexcept;
  void begin_job(Job job) noexcept;
  void end_job() noexcept;
  void end_sweep() noexcept;
  void end_evaluation() noexcept;

  Refusal begin_sweep() noexcept;
  Refusal begin_evaluation(Goal goal) noexcept;
  Refusal begin_fixed_point() noexcept;
  bool needs_lost_fit() const noexcept;
  Refusal failure_of_evaluation() const noexcept;
  void step_fixed_point() noexcept;
  double fixed_point_energy(std::size_t iterate) noexcept;
  void iterate_fixed_point() noexcept;

  bool has(Goal goal) const noexcept;
  Refusal conflict_with(Change change) const noexcept;
  void invalidate(Change change) noexcept;
  Status save_settings(std::uint32_t slot) noexcept;
  Status recall_settings(std::uint32_t slot) noexcept;
  void keep_identification() noexcept;
  void restore_identification() noexcept;
  void reset() noexcept;
  void reset_settings() noexcept;
  SweepSettings default_sweep() const noexcept;
  void seed_generator() noexcept;
  void show_fit_quality() noexcept;
  Span<const char> render_report() noexcept;
  double progress() const noexcept;
  const char* stage_name() const noexcept;

  Ports ports_;
  Board board_;
  scpi::Session session_;
  Settings settings_;
  SweepSettings sweep_settings_ = SweepSettings(kAllZero);
  Device device_ = {};             // Of Origin::kModel.
  Identification identification_;  // From the store.
  WichmannHill generator_;
  FrequencyResponse points_;
  Sweep sweep_;
  Evaluation evaluation_;
  Workspace workspace_;
  Refusal failure_;  // Of the job that was begun last.
  std::uint64_t deadlock_since_us_ = 0;
  std::size_t iterations_ = 0;  // Of the fixed point, so far.
  Goal goal_ = Goal::kModel;
  Job job_ = Job::kNone;
  Origin origin_ = Origin::kNothing;         // Of the device that is evaluated.
  Origin points_origin_ = Origin::kNothing;  // Of the points that FETCh answers.
  bool has_identification_ = false;
  bool is_fit_kept_ = false;          // The fit of these points is in the store.
  bool is_background_ = false;        // The job was begun by INITiate.
  bool is_evaluation_valid_ = false;  // The evaluation is that of this device and these settings,
  bool are_trials_valid_ = false;     // and so are these parts of it, if they are complete.
  bool is_trend_valid_ = false;
  bool is_report_valid_ = false;  // And complete.
  bool is_query_job_ = false;     // The query under way has begun the job that runs or has ended.
  bool is_fixed_point_ready_ = false;  // Its iterations are counted.
  bool fixed_point_rests_ = false;
  bool was_aborted_ = false;
  bool completes_operation_ = false;  // *OPC waits for the job.
  bool was_connected_ = false;
  bool is_deadlocked_ = false;
  bool has_acted_ = false;
};

// Of its own: settings, console, status.
static_assert(!kHasDefaultCapacities ||
              sizeof(Instrument) <= sizeof(Evaluation) + sizeof(EvaluationWorkspace) +
                                        sizeof(Sweep) + sizeof(FrequencyResponse) +
                                        std::size_t{9} * 1024);

}  // namespace emax::app
