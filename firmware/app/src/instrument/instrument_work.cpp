// What the instrument runs: the sweep, the evaluation and the fixed point.
#include "emax/app/base/text_writer.hpp"
#include "emax/app/instrument/instrument.hpp"
#include "emax/app/report/report.hpp"
#include "emax/app/report/report_context.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"
#include "emax/energy/fixed_point.hpp"

namespace emax::app {
namespace {

using scpi::ErrorCode;

/// A fault of a sweep in the words of an error, and what it puts in question.
struct FaultWords {
  Status status;
  const char* words;
  std::uint16_t questionable;
};

constexpr FaultWords kFaults[] = {
    {Status::kLostBlock, "lost block: INIT again", scpi::kQuestionableTime},
    {Status::kLateBlock, "late block: check converter and clock", scpi::kQuestionableTime},
    {Status::kHardwareFault, "converter fault: check its supply", scpi::kQuestionableVoltage},
    {Status::kSaturated, "saturated channel: lower its gain", scpi::kQuestionableVoltage},
    {Status::kStuckChannel, "stuck channel: check its converter", scpi::kQuestionableVoltage},
    {Status::kNoReference, "no reference: check its cable", scpi::kQuestionableVoltage},
    {Status::kNoDevice, "no device: check its cable", scpi::kQuestionableVoltage},
    {Status::kWeakSignal, "weak signal: check amplifier, gain", scpi::kQuestionableVoltage},
    {Status::kLevelNotReached, "level not reached: lower SOUR:LEV", scpi::kQuestionableVoltage},
    {Status::kSwappedChannels, "swapped channels: check cables, gains",
     scpi::kQuestionableCalibration},
    {Status::kInvertedPolarity, "inverted polarity: swap its leads", scpi::kQuestionablePhase},
    {Status::kDistorted, "distorted: lower SOUR:LEV, check mount", scpi::kQuestionableCalibration},
    {Status::kDcDrift, "DC drift: warm up, check its cable", scpi::kQuestionableVoltage},
};

FaultWords words_of(Status status) noexcept {
  for (const FaultWords& fault : kFaults) {
    if (fault.status == status) {
      return fault;
    }
  }
  return {status, explain(status), scpi::kQuestionableCalibration};
}

/// Why an evaluation ends early, in the words of an error.
struct FailureWords {
  Status status;
  ErrorCode code;
  const char* words;
};

constexpr FailureWords kFailures[] = {
    {Status::kTooManyCells, ErrorCode::kSettingsConflict,
     "T needs over " EMAX_TEXT_OF(EMAX_MAX_CELLS) " cells: shorten it"},
    {Status::kTooManySwitches, ErrorCode::kSettingsConflict,
     "over " EMAX_TEXT_OF(EMAX_MAX_SWITCHES) " switches: shorten T"},
    {Status::kTooFewPoints, ErrorCode::kDataCorruptOrStale, "a fit needs 3 points or more"},
    {Status::kNotIdentifiable, ErrorCode::kExecutionError, "points tell no device: more around f0"},
    {Status::kNotPhysical, ErrorCode::kExecutionError, "fit is no device: check units, phases"},
    {Status::kOverdamped, ErrorCode::kExecutionError, "fit has a damping of 1 or more"},
    {Status::kInvertedPolarity, ErrorCode::kExecutionError, "inverted polarity: add 180 degrees"},
};
constexpr FailureWords kTooWide = {Status::kInvalidArgument, ErrorCode::kSettingsConflict,
                                   "uncertainties too large for the trials"};
constexpr FailureWords kTrendTooLong = {
    Status::kTooManyCells, ErrorCode::kSettingsConflict,
    "a trend time needs over " EMAX_TEXT_OF(EMAX_MAX_CELLS) " cells"};

FailureWords words_of(const Failure& failure) noexcept {
  if (failure.stage == Stage::kMonteCarlo && failure.status == Status::kInvalidArgument) {
    return kTooWide;
  }
  if (failure.stage == Stage::kTrend && failure.status == Status::kTooManyCells) {
    return kTrendTooLong;
  }
  if (failure.stage == Stage::kMonteCarlo && failure.status == Status::kTooManyCells) {
    return {failure.status, ErrorCode::kSettingsConflict, failure.reason};
  }
  for (const FailureWords& words : kFailures) {
    if (words.status == failure.status) {
      return words;
    }
  }
  return {failure.status, ErrorCode::kExecutionError, failure.reason};
}

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
  switch (job_) {
    case Job::kNone:
      return;
    case Job::kSweep:
      sweep_.step(ports_.analog, workspace_.sweep);
      if (sweep_.done()) {
        end_sweep();
      }
      return;
    case Job::kEvaluation:
      evaluation_.step(workspace_.evaluation);
      if (evaluation_.done()) {
        end_evaluation();
      }
      return;
    case Job::kFixedPoint:
      step_fixed_point();
      return;
  }
}

void Instrument::begin_job(Job job) noexcept {
  job_ = job;
  failure_ = {};
  is_background_ = false;
  show_condition();
}

void Instrument::end_job() noexcept {
  job_ = Job::kNone;
  is_background_ = false;
  show_condition();
  if (completes_operation_) {
    completes_operation_ = false;
    session_.status().add_events(scpi::kOperationComplete);
  }
}

void Instrument::show_condition() noexcept {
  std::uint16_t bits = 0;
  if (job_ == Job::kSweep) {
    bits = scpi::kMeasuring | scpi::kSweeping;
  } else if (job_ != Job::kNone) {
    bits = kComputing;
  }
  session_.status().operation().set_condition(bits);
}

void Instrument::abort() noexcept {
  if (job_ == Job::kNone) {
    return;
  }
  if (job_ == Job::kSweep) {
    sweep_.stop(ports_.analog, workspace_.sweep);
  }
  if (job_ == Job::kEvaluation) {
    evaluation_.stop();
  }
  was_aborted_ = true;
  end_job();
}

// Sweep

Instrument::Refusal Instrument::begin_sweep() noexcept {
  const Status status = sweep_.start(sweep_settings_, ports_.analog, workspace_.sweep);
  if (status == Status::kInvalidArgument) {
    return {ErrorCode::kSettingsConflict, sweep_.refused_expectation()};
  }
  if (status != Status::kOk) {
    return {ErrorCode::kHardwareError, words_of(status).words};
  }
  points_.clear();
  points_origin_ = Origin::kSweep;
  has_identification_ = false;
  invalidate(Change::kDevice);
  origin_ = Origin::kSweep;
  begin_job(Job::kSweep);
  return {};
}

void Instrument::end_sweep() noexcept {
  const Status status = sweep_.status();
  if (status == Status::kOk) {
    (void)sweep_.copy_to(points_);  // A sweep that is done has points that a table takes.
    is_fit_kept_ = false;
  } else {
    const FaultWords fault = words_of(status);
    failure_ = {ErrorCode::kHardwareError, fault.words};
    session_.status().report(failure_.code, failure_.words);
    session_.status().questionable().set_condition(fault.questionable);
  }
  end_job();
}

// Evaluation

Instrument::Refusal Instrument::begin_evaluation(Goal goal) noexcept {
  constexpr Refusal kNoPoints = {ErrorCode::kDataCorruptOrStale,
                                 "no points: INIT:SWE or TRAC:FRES:DATA"};
  constexpr Refusal kNoDevice = {ErrorCode::kDataCorruptOrStale,
                                 "no device: CALC:MOD, or INIT:SWE"};
  constexpr Refusal kNoFit = {ErrorCode::kDataCorruptOrStale,
                              "NORM and BIRG need the points of the fit: INIT:SWE"};
  if (origin_ == Origin::kNothing) {
    return kNoDevice;
  }
  if ((goal == Goal::kMonteCarlo || goal == Goal::kReport) && needs_lost_fit()) {
    return kNoFit;
  }
  if (origin_ != Origin::kModel && points_.size() == 0) {
    return kNoPoints;
  }
  EvaluationWorkspace& workspace = workspace_.evaluation;
  Status status = Status::kOk;
  if (is_evaluation_valid_) {
    status = evaluation_.pursue(settings_, goal, workspace);
  } else if (origin_ == Origin::kModel) {
    status = evaluation_.start_from_model(device_, settings_, workspace, goal);
  } else {
    status = evaluation_.start_from_points(points_, settings_, workspace, goal);
  }
  if (status != Status::kOk) {
    return failure_of_evaluation();
  }
  // What was made with other settings is gone by now.
  is_evaluation_valid_ = true;
  are_trials_valid_ = true;
  is_trend_valid_ = true;
  goal_ = goal;
  begin_job(Job::kEvaluation);
  if (evaluation_.done()) {
    end_evaluation();
  }
  return failure_;
}

/// Of a fit of before power off the evaluation takes the parameters and their u, nothing more.
bool Instrument::needs_lost_fit() const noexcept {
  const Identification& fit = identification_;
  const bool is_poor = fit.chi2 > static_cast<double>(fit.dof);
  return has_identification_ && fit.source == Source::kPoints &&
         (settings_.distribution == Distribution::kNormal || (settings_.birge && is_poor));
}

Instrument::Refusal Instrument::failure_of_evaluation() const noexcept {
  const FailureWords failure = words_of(evaluation_.failure());
  return {failure.code, failure.words};
}

void Instrument::end_evaluation() noexcept {
  if (evaluation_.status() != Status::kOk) {
    failure_ = failure_of_evaluation();
  } else if (goal_ == Goal::kMonteCarlo && !evaluation_.has_monte_carlo()) {
    failure_ = {ErrorCode::kDataCorruptOrStale, "no uncertainties: CALC:MOD with uS,.."};
  } else if (goal_ == Goal::kTrend && !evaluation_.has_trend()) {
    failure_ = {ErrorCode::kDataCorruptOrStale, "no times: CALC:TREN? T1,T2,..."};
  }
  is_report_valid_ = is_report_valid_ || (goal_ == Goal::kReport && !failure_);
  if (is_background_) {
    session_.status().report(failure_.code, failure_.words);
  }
  show_fit_quality();
  keep_identification();
  end_job();
}

void Instrument::show_fit_quality() noexcept {
  if (!is_evaluation_valid_ || !evaluation_.has_fit()) {
    return;
  }
  const WlspFit& fit = evaluation_.fit().result();
  const bool is_poor = fit.chi2 / fit.dof > reduced_chi_square_limit(fit.dof);
  session_.status().questionable().set_condition(is_poor ? scpi::kQuestionableCalibration : 0);
}

/// @returns Nothing if the report is longer than the memory.
Span<const char> Instrument::render_report() noexcept {
  const hal::StreamFormat& format = ports_.analog.format();
  const Measurement measurement = {sweep_, format, board_.simulated};
  ReportContext context;
  context.measurement = origin_ == Origin::kSweep ? &measurement : nullptr;
  MemorySink sink{Span<char>(workspace_.text)};
  TextWriter out(sink);
  write_report(evaluation_, context, out);
  return sink.text();
}

// Fixed point

Instrument::Refusal Instrument::begin_fixed_point() noexcept {
  constexpr Refusal kTooLong = {
      ErrorCode::kSettingsConflict,
      "T/step > " EMAX_TEXT_OF(EMAX_MAX_CELLS) ": shorten T or longer STEP"};
  const ModalModel& model = evaluation_.model();
  const double duration_s = settings_.duration_s;
  const SearchSettings search = {Method::kPaper, duration_s, settings_.step_s,
                                 settings_.iterations};
  FixedPointWorkspace& work = workspace_.fixed_point;
  if (!(settings_.step_s <= duration_s) ||
      work.phi.set(model, duration_s, search_cells(model, search)) != Status::kOk) {
    return kTooLong;
  }
  iterations_ = 0;
  is_fixed_point_ready_ = false;
  fixed_point_rests_ = false;
  (void)fixed_point_energy(0);
  begin_job(Job::kFixedPoint);
  return {};
}

void Instrument::step_fixed_point() noexcept {
  iterate_fixed_point();
  if (fixed_point_rests_ || iterations_ == settings_.iterations) {
    is_fixed_point_ready_ = true;
    end_job();
  }
}

/// E_0 starts anew; each other one follows the one before it.
double Instrument::fixed_point_energy(std::size_t iterate) noexcept {
  FixedPointWorkspace& work = workspace_.fixed_point;
  const std::size_t cells = work.phi.cells();
  const Signs signs = work.grid.signs(cells);
  const Span<double> product = work.grid.product(cells);
  if (iterate == 0) {
    signs_of_column(work.phi, 0, signs, product);
  } else {
    (void)take_signs(product, 0.0, signs);
  }
  work.phi.multiply(signs, product);
  const double a = evaluation_.limit_mps2();
  return a * a * dot(signs, product);
}

void Instrument::iterate_fixed_point() noexcept {
  FixedPointWorkspace& work = workspace_.fixed_point;
  const std::size_t cells = work.phi.cells();
  const Signs signs = work.grid.signs(cells);
  const Span<double> product = work.grid.product(cells);
  if (!take_signs(product, 0.0, signs)) {
    fixed_point_rests_ = true;
    return;
  }
  ++iterations_;
  work.phi.multiply(signs, product);
}

// Progress

double Instrument::progress() const noexcept {
  switch (job_) {
    case Job::kNone:
      return 1.0;
    case Job::kSweep:
      return sweep_.progress();
    case Job::kEvaluation:
      return evaluation_.progress();
    case Job::kFixedPoint:
      return static_cast<double>(iterations_) / settings_.iterations;
  }
  return 1.0;
}

const char* Instrument::stage_name() const noexcept {
  switch (job_) {
    case Job::kNone:
      return "idle";
    case Job::kSweep:
      return "sweep";
    case Job::kEvaluation:
      return name_of(evaluation_.stage());
    case Job::kFixedPoint:
      return "fixed point";
  }
  return "idle";
}

}  // namespace emax::app
