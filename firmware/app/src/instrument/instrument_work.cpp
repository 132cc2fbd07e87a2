// What the instrument has its sequencer do, for INITiate and for queries, and how that ends.
#include "emax/app/base/text_writer.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/app/report/report_warnings.hpp"

namespace emax::app {
namespace {

using scpi::Call;
using scpi::ErrorCode;

constexpr ErrorWords kRunning = {ErrorCode::kInitIgnored, "running: ABOR or *WAI first"};
constexpr ErrorWords kAborted = {ErrorCode::kExecutionError, "aborted"};

/// Text into memory.
class MemorySink final : public TextSink {
 public:
  explicit MemorySink(Span<char> memory) noexcept : memory_(memory) {}

  void write(Span<const char> text) noexcept override {
    for (const char c : text) {
      if (size_ < memory_.size()) {
        memory_[size_] = c;
      }
      ++size_;
    }
  }
  /// @returns Nothing if there was no room for all of it.
  Span<const char> text() const noexcept {
    return Span<const char>(memory_).first(size_ <= memory_.size() ? size_ : 0);
  }

 private:
  Span<char> memory_;
  std::size_t size_ = 0;
};

}  // namespace

void Instrument::work() noexcept {
  const Job job = sequencer_.job();
  sequencer_.step();
  if (job != Job::kNone && !sequencer_.is_working()) {
    end_work(job);
  }
}

void Instrument::begin_work(std::uint16_t condition) noexcept {
  is_background_ = false;
  session_.status().operation().set_condition(condition);
}

void Instrument::end_work(Job job) noexcept {
  if (job == Job::kSweep) {
    end_sweep();
  }
  if (job == Job::kEvaluation) {
    end_evaluation();
  }
  complete_work();
}

void Instrument::complete_work() noexcept {
  is_background_ = false;
  session_.status().operation().set_condition(0);
  if (completes_operation_) {
    completes_operation_ = false;
    session_.status().add_events(scpi::kOperationComplete);
  }
}

void Instrument::complete_operation() noexcept {
  if (is_working()) {
    completes_operation_ = true;
    return;
  }
  session_.status().add_events(scpi::kOperationComplete);
}

void Instrument::abort() noexcept {
  if (!is_working()) {
    return;
  }
  sequencer_.abort();
  was_aborted_ = true;
  complete_work();
}

// Sweep

ErrorWords Instrument::initiate_sweep() noexcept {
  if (is_working()) {
    return kRunning;
  }
  if (ports_.watchdog != nullptr && ports_.watchdog->failed()) {
    return kNoWatchdog;
  }
  if (const Refusal refusal = sequencer_.measure(ports_.analog, sweep_settings_)) {
    return words_of(refusal, sequencer_);
  }
  change_device();
  is_fit_kept_ = false;
  warns_of_fit_ = true;
  begin_work(scpi::kMeasuring | scpi::kSweeping);
  is_background_ = true;
  return {};
}

void Instrument::end_sweep() noexcept {
  const ErrorWords words = words_of(sequencer_.failure(), sequencer_);
  session_.status().report(words.code, words.words);
  for (const Warning warning : {Warning::kDataSheet, Warning::kChange}) {
    if (!words && contradicts(warning, sequencer_.sweep())) {
      warn(warning);
    }
  }
  session_.status().questionable().set_condition(questionable_of_sweep());
}

void Instrument::warn(Warning warning) noexcept {
  session_.status().report(ErrorCode::kDataCorruptOrStale, words_of(warning));
}

/// The bit of its fault, or of what contradicts in it.
std::uint16_t Instrument::questionable_of_sweep() const noexcept {
  const SweepResults& sweep = sequencer_.sweep();
  if (sweep.status != Status::kOk) {
    return questionable_of(sweep.status);
  }
  const bool is_doubtful =
      contradicts(Warning::kDataSheet, sweep) || contradicts(Warning::kChange, sweep);
  return is_doubtful ? scpi::kQuestionableCalibration : 0;
}

// Evaluation

ErrorWords Instrument::begin_evaluation(Goal goal) noexcept {
  if (const Refusal refusal = sequencer_.evaluate(settings_, goal)) {
    return words_of(refusal, sequencer_);
  }
  begin_work(kComputing);
  if (!is_working()) {
    end_work(Job::kEvaluation);
  }
  return words_of(sequencer_.failure(), sequencer_);
}

ErrorWords Instrument::initiate(Goal goal) noexcept {
  if (is_working()) {
    return kRunning;
  }
  if (sequencer_.holds(goal, settings_)) {
    return {};
  }
  const ErrorWords words = begin_evaluation(goal);
  is_background_ = is_working();
  return words;
}

void Instrument::end_evaluation() noexcept {
  const ErrorWords words = words_of(sequencer_.failure(), sequencer_);
  if (is_background_) {
    session_.status().report(words.code, words.words);
  }
  show_fit_quality();
  keep_identification();
}

void Instrument::show_fit_quality() noexcept {
  if (!sequencer_.evaluation().has_fit()) {
    return;
  }
  const WlspFit& fit = sequencer_.evaluation().fit.result();
  const bool is_poor = fit.chi2 / fit.dof > reduced_chi_square_limit(fit.dof);
  const bool is_swept = sequencer_.origin() == Origin::kSweep;
  const int doubt = is_swept ? questionable_of_sweep() : 0;
  const int poor = is_poor ? scpi::kQuestionableCalibration : 0;
  session_.status().questionable().set_condition(static_cast<std::uint16_t>(doubt | poor));
  if (!is_swept || !warns_of_fit_) {
    return;
  }
  warns_of_fit_ = false;
  if (sequencer_.sweep().status != Status::kOk) {
    warn(Warning::kEnded);
  }
  if (is_poor) {
    warn(Warning::kFit);
  }
}

// Queries

bool Instrument::provide(Call& call, Goal goal) noexcept {
  if (sequencer_.holds(goal, settings_)) {
    return true;
  }
  if (!can_begin(call)) {
    return false;
  }
  if (const ErrorWords words = begin_evaluation(goal)) {
    call.fail(words.code, words.words);
    return false;
  }
  if (is_working()) {
    call.wait();
  }
  return !is_working();
}

bool Instrument::provide_fit(Call& call) noexcept {
  if (!is_working() && sequencer_.points().size() == 0) {
    const ErrorWords words = words_of({Obstacle::kNoPoints}, sequencer_);
    call.fail(words.code, words.words);
    return false;
  }
  if (!is_working() && sequencer_.take_points()) {
    change_device();
  }
  return provide(call, Goal::kModel);
}

bool Instrument::provide_sensitivity(Call& call) noexcept {
  const EvaluationResults& results = sequencer_.evaluation();
  if (!is_working() && sequencer_.points().size() != 0 && can_begin(call)) {
    if (sequencer_.take_points()) {
      change_device();
    }
    if (!sequencer_.holds(Goal::kModel, settings_) && begin_evaluation(Goal::kModel) &&
        results.is_sensitivity_alone()) {
      return true;
    }
  }
  return provide_fit(call);
}

bool Instrument::provide_fixed_point(Call& call) noexcept {
  if (call.stage() == Call::Stage::kStart) {
    sequencer_.forget_fixed_point();  // One that nobody fetched.
  }
  if (!provide(call, Goal::kModel)) {
    return false;
  }
  if (sequencer_.fixed_point() != nullptr) {
    return true;
  }
  if (!can_begin(call)) {
    return false;
  }
  if (const Refusal refusal = sequencer_.iterate_fixed_point(settings_)) {
    const ErrorWords words = words_of(refusal, sequencer_);
    call.fail(words.code, words.words);
    return false;
  }
  begin_work(kComputing);
  call.wait();
  return false;
}

// The wire may be another one by now: each call measures.
bool Instrument::provide_loopback(Call& call) noexcept {
  if (call.stage() == Call::Stage::kStart) {
    sequencer_.forget_loopback();
  }
  if (sequencer_.loopback() != nullptr) {
    return true;
  }
  if (!can_begin(call)) {
    return false;
  }
  if (const Refusal refusal = sequencer_.loop_back(ports_.analog, sweep_settings_)) {
    const ErrorWords words = words_of(refusal, sequencer_);
    call.fail(words.code, words.words);
    return false;
  }
  begin_work(scpi::kMeasuring);
  call.wait();
  return false;
}

/// Whether a query may begin its computation: nothing runs, and none that it has begun before has
/// come to a bad end.
bool Instrument::can_begin(Call& call) noexcept {
  if (call.stage() == Call::Stage::kStart) {
    was_aborted_ = false;
    is_query_job_ = false;
  }
  if (was_aborted_) {
    call.fail(kAborted.code, kAborted.words);
    return false;
  }
  if (is_working()) {
    call.wait();
    return false;
  }
  const ErrorWords words = words_of(sequencer_.failure(), sequencer_);
  if (is_query_job_ && words) {
    call.fail(words.code, words.words);
    return false;
  }
  is_query_job_ = true;
  return true;
}

Span<const char> Instrument::render_report(const Labels& labels, Span<char> memory) noexcept {
  const Measurement measurement = {sequencer_.sweep(), ports_.analog.format(), board_.simulated};
  ReportContext context;
  context.labels = labels;
  context.measurement = sequencer_.origin() == Origin::kSweep ? &measurement : nullptr;
  MemorySink sink(memory);
  TextWriter out(sink);
  write_report(sequencer_.evaluation(), context, out);
  return sink.text();
}

Span<const char> Instrument::render_json() noexcept {
  const Measurement measurement = {sequencer_.sweep(), ports_.analog.format(), board_.simulated};
  const bool is_swept = sequencer_.points_origin() == Origin::kSweep;
  const auto holds = [this](Goal goal) noexcept { return sequencer_.holds(goal, settings_); };
  const InstrumentState state = {sequencer_.evaluation(),   is_swept ? &measurement : nullptr,
                                 sequencer_.points(),       holds(Goal::kModel),
                                 holds(Goal::kEnergy),      holds(Goal::kBand),
                                 holds(Goal::kUncertainty), holds(Goal::kMonteCarlo),
                                 holds(Goal::kTrend)};
  MemorySink sink(sequencer_.borrow_all());
  TextWriter out(sink);
  write_instrument_json(state, out);
  return sink.text();
}

}  // namespace emax::app
