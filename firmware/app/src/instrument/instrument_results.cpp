// The commands that answer what was measured or computed, and see to it that it is.
#include <limits>

#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

#include "instrument_commands.hpp"

namespace emax::app {
namespace {

using scpi::NumberRule;

constexpr double kCoverageFactor = 2.0;
constexpr double kNoDefault = std::numeric_limits<double>::quiet_NaN();
constexpr double kHuge = 1e300;
constexpr double kMaxPhase_deg = 360.0;
constexpr std::int64_t kMaxRandom = 1'000'000;
constexpr std::size_t kPointFields = 5;
constexpr NumberRule kAnyNumber = {-kHuge, kHuge, kNoDefault, nullptr};
constexpr NumberRule kAnyFrequency = {-kHuge, kHuge, kNoDefault, scpi::kHertz};
constexpr NumberRule kAnyPhase = {-kHuge, kHuge, kNoDefault, scpi::kDegree};
// Of f, A, phi, uA, uphi, and of S, f0, beta.
constexpr const NumberRule* kPointRules[kPointFields] = {&kAnyFrequency, &kAnyNumber, &kAnyPhase,
                                                         &kAnyNumber, &kAnyPhase};
constexpr const NumberRule* kDeviceRules[] = {&kAnyNumber, &kAnyFrequency, &kAnyNumber};
constexpr NumberRule kAnyTime = {0.0, kMaxDuration_s, kNoDefault, scpi::kSecond};

}  // namespace

bool InstrumentCommands::provide(Instrument& i, Call& call, Goal goal) noexcept {
  if (i.has(goal)) {
    return true;
  }
  if (!can_go_on(i, call)) {
    return false;
  }
  if (const Refusal refusal = i.begin_evaluation(goal)) {
    call.fail(refusal.code, refusal.words);
    return false;
  }
  if (i.is_working()) {
    call.wait();
  }
  return !i.is_working();
}

bool InstrumentCommands::can_go_on(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kStart) {
    i.was_aborted_ = false;
    i.is_query_job_ = false;
  }
  if (i.was_aborted_) {
    call.fail(ErrorCode::kExecutionError, "aborted");
    return false;
  }
  if (i.is_working()) {
    call.wait();
    return false;
  }
  if (i.is_query_job_ && i.failure_) {
    call.fail(i.failure_.code, i.failure_.words);
    return false;
  }
  i.is_query_job_ = true;
  return true;
}

std::size_t InstrumentCommands::point_count(const Instrument& i) noexcept {
  return i.points_origin_ == Origin::kSweep ? i.sweep_.points().size() : i.points_.size();
}

void InstrumentCommands::answer_point(const Instrument& i, std::size_t index,
                                      scpi::Response& out) noexcept {
  const bool is_swept = i.points_origin_ == Origin::kSweep;
  const ResponsePoint& point =
      is_swept ? i.sweep_.points()[index].point : i.points_.points()[index];
  const double common = is_swept ? i.sweep_.common().total * point.amplitude : 0.0;
  out.number(point.frequency_hz).number(point.amplitude);
  out.number(point.phase_rad * kDegreesPerRadian);
  out.number(sqrt(point.u_amplitude * point.u_amplitude + common * common));
  out.number(point.u_phase_rad * kDegreesPerRadian);
}

void InstrumentCommands::fetch(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    answer_point(i, call.item(), call.answer());
    return;
  }
  if (i.is_sweeping()) {
    call.wait();
    return;
  }
  const std::size_t count = point_count(i);
  if (count == 0) {
    call.fail(ErrorCode::kDataCorruptOrStale, "no points: INIT:SWE or TRAC:FRES:DATA");
    return;
  }
  call.answer().integer(static_cast<std::int64_t>(count));
  call.answer_items(count);
}

void InstrumentCommands::add_points(Instrument& i, Call& call) noexcept {
  if (const Refusal refusal = i.conflict_with(Change::kDevice)) {
    call.fail(refusal.code, refusal.words);
    return;
  }
  if (i.points_origin_ == Origin::kSweep && i.points_.size() > 0) {
    call.fail(ErrorCode::kSettingsConflict, "points of a sweep: TRAC:FRES:CLE first");
    return;
  }
  if (call.count() % kPointFields != 0) {
    call.fail(ErrorCode::kMissingParameter, "five numbers for each point");
    return;
  }
  FrequencyResponse& grown = i.workspace_.table;
  grown = i.points_;
  while (call.has_more()) {
    double numbers[kPointFields] = {};
    for (std::size_t field = 0; field < kPointFields; ++field) {
      if (!call.number(*kPointRules[field], numbers[field])) {
        return;
      }
    }
    if (const char* problem = add_point(grown, numbers)) {
      call.fail(ErrorCode::kDataOutOfRange, problem);
      return;
    }
  }
  i.points_ = grown;
  i.has_identification_ = false;
  i.points_origin_ = Origin::kTable;
  i.is_fit_kept_ = false;
  i.origin_ = Origin::kTable;
  i.invalidate(Change::kDevice);
}

const char* InstrumentCommands::add_point(FrequencyResponse& response,
                                          const double* numbers) noexcept {
  ResponsePoint point;
  point.frequency_hz = numbers[0];
  point.amplitude = numbers[1];
  point.phase_rad = numbers[2] * kRadiansPerDegree;
  point.u_amplitude = numbers[3] / kCoverageFactor;
  point.u_phase_rad = numbers[4] / kCoverageFactor * kRadiansPerDegree;
  if (abs(numbers[2]) > kMaxPhase_deg) {
    return "phase: -360 to 360 degrees";
  }
  const Status status = response.add(point);
  if (status == Status::kNotAscending) {
    return "frequency not above the last one";
  }
  if (status == Status::kTooManyPoints) {
    return EMAX_TEXT_OF(EMAX_MAX_POINTS) " points at most";
  }
  if (status == Status::kUncertaintyNotPositive) {
    return "uncertainties must be above 0";
  }
  return status == Status::kOk ? nullptr : "frequency, amplitude must be above 0";
}

void InstrumentCommands::clear_points(Instrument& i, Call& call) noexcept {
  if (const Refusal refusal = i.conflict_with(Change::kDevice)) {
    call.fail(refusal.code, refusal.words);
    return;
  }
  i.points_.clear();
  i.points_origin_ = Origin::kNothing;
  if (i.origin_ != Origin::kModel) {
    i.origin_ = Origin::kNothing;
    i.invalidate(Change::kDevice);
  }
}

void InstrumentCommands::count_points(Instrument& i, Call& call) noexcept {
  call.answer().integer(static_cast<std::int64_t>(point_count(i)));
}

bool InstrumentCommands::provide_fit(Instrument& i, Call& call) noexcept {
  if (!i.is_working() && i.points_.size() == 0) {
    call.fail(ErrorCode::kDataCorruptOrStale, "no points: INIT:SWE or TRAC:FRES:DATA");
    return false;
  }
  if (!i.is_working() && i.origin_ == Origin::kModel) {
    i.origin_ = i.points_origin_;
    i.invalidate(Change::kDevice);
  }
  return provide(i, call, Goal::kModel);
}

const Identification* InstrumentCommands::kept(const Instrument& i) noexcept {
  const bool is_fit = i.has_identification_ && i.identification_.source == Source::kPoints;
  return is_fit && i.points_.size() == 0 ? &i.identification_ : nullptr;
}

void InstrumentCommands::identify(Instrument& i, Call& call) noexcept {
  if (const Identification* identification = kept(i)) {
    answer_device(identification->device, call.answer());
    call.answer().number(identification->chi2).integer(identification->dof);
    return;
  }
  if (!provide_fit(i, call)) {
    return;
  }
  const WlspFit& fit = i.evaluation_.fit().result();
  answer_device(i.evaluation_.device(), call.answer());
  call.answer().number(fit.chi2).integer(fit.dof);
}

void InstrumentCommands::answer_device(const Device& device, scpi::Response& out) noexcept {
  out.number(device.estimate.sensitivity).number(device.estimate.natural_frequency_hz);
  out.number(device.estimate.damping).number(device.u.sensitivity);
  out.number(device.u.natural_frequency_hz).number(device.u.damping);
}

void InstrumentCommands::covariance(Instrument& i, Call& call) noexcept {
  if (const Identification* identification = kept(i)) {
    for (const auto& row : identification->covariance) {
      call.answer().number(row[0]).number(row[1]).number(row[2]);
    }
    return;
  }
  if (!provide_fit(i, call)) {
    return;
  }
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      call.answer().number(i.evaluation_.covariance(row, column));
    }
  }
}

void InstrumentCommands::model(Instrument& i, Call& call) noexcept {
  if (call.is_query()) {
    if (provide(i, call, Goal::kModel)) {
      answer_device(i.evaluation_.device(), call.answer());
    }
    return;
  }
  if (call.count() != 3 && call.count() != 6) {
    call.fail(ErrorCode::kMissingParameter, "three numbers or six");
    return;
  }
  Device device = {};
  std::size_t at = 0;
  double* const fields[] = {&device.estimate.sensitivity,   &device.estimate.natural_frequency_hz,
                            &device.estimate.damping,       &device.u.sensitivity,
                            &device.u.natural_frequency_hz, &device.u.damping};
  for (double* field : fields) {
    if (call.has_more() && !call.number(*kDeviceRules[at++ % 3], *field)) {
      return;
    }
  }
  take_device(i, call, device);
}

void InstrumentCommands::take_device(Instrument& i, Call& call, const Device& device) noexcept {
  if (const Refusal refusal = i.conflict_with(Change::kDevice)) {
    call.fail(refusal.code, refusal.words);
    return;
  }
  const Accelerometer& estimate = device.estimate;
  const ParameterBox& u = device.u;
  if (validate(estimate) != Status::kOk) {
    call.fail(ErrorCode::kDataOutOfRange, "S, f0 above 0, beta 0.0001 to below 1");
    return;
  }
  if (!(u.sensitivity >= 0.0) || !(u.natural_frequency_hz >= 0.0) || !(u.damping >= 0.0)) {
    call.fail(ErrorCode::kDataOutOfRange, "uncertainties must be 0 or more");
    return;
  }
  i.device_ = device;
  i.has_identification_ = false;
  i.origin_ = Origin::kModel;
  i.invalidate(Change::kDevice);
}

void InstrumentCommands::energy(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(i.evaluation_.maximum().signal.times_s()[call.item()]);
    return;
  }
  if (!provide(i, call, Goal::kEnergy)) {
    return;
  }
  const Evaluation& evaluation = i.evaluation_;
  const std::size_t count = evaluation.maximum().signal.count();
  call.answer().number(evaluation.energy_v2s()).number(evaluation.xi());
  call.answer().number(evaluation.has_bound() ? evaluation.bound_v2s() : kNoDefault);
  call.answer().integer(static_cast<std::int64_t>(count));
  call.answer_items(count);
}

void InstrumentCommands::evaluate(Instrument& i, Call& call) noexcept {
  if (!provide(i, call, Goal::kModel)) {
    return;
  }
  if (i.is_working()) {
    call.wait();
    return;
  }
  Instrument::SignalWorkspace& work = i.workspace_.signal;
  std::size_t count = 0;
  if (!call.numbers(kAnyTime, Span<double>(work.times_s), count)) {
    return;
  }
  work.signal = {};
  const Span<const double> times_s(work.times_s, count);
  if (work.signal.set(times_s, i.settings_.duration_s) != Status::kOk) {
    call.fail(ErrorCode::kDataOutOfRange, "times must ascend inside 0 to T");
    return;
  }
  const double a = i.evaluation_.limit_mps2();
  call.answer().number(a * a * emax::energy(i.evaluation_.model(), work.signal));
}

void InstrumentCommands::fixed_point(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(i.fixed_point_energy(call.item()));
    return;
  }
  if (call.stage() == Call::Stage::kStart) {
    i.is_fixed_point_ready_ = false;  // One that nobody fetched.
  }
  if (!provide(i, call, Goal::kModel)) {
    return;
  }
  if (!i.is_fixed_point_ready_) {
    if (!can_go_on(i, call)) {
      return;
    }
    if (const Refusal refusal = i.begin_fixed_point()) {
      call.fail(refusal.code, refusal.words);
      return;
    }
    call.wait();
    return;
  }
  i.is_fixed_point_ready_ = false;
  call.answer().integer(static_cast<std::int64_t>(i.iterations_));
  call.answer_items(i.iterations_ + 1);
}

void InstrumentCommands::absolute_error(Instrument& i, Call& call) noexcept {
  if (!provide(i, call, Goal::kModel)) {
    return;
  }
  if (!i.evaluation_.has_absolute_error()) {
    call.fail(ErrorCode::kSettingsConflict, "k moves too often for so long a T: shorten it");
    return;
  }
  call.answer().number(i.evaluation_.absolute_error_v());
}

void InstrumentCommands::settling_time(Instrument& i, Call& call) noexcept {
  if (provide(i, call, Goal::kModel)) {
    const SettlingTime settling = i.evaluation_.settling_time();
    call.answer().number(settling.found ? settling.time_s
                                        : std::numeric_limits<double>::infinity());
  }
}

void InstrumentCommands::impulse_response(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    answer_impulse(i, call);
    return;
  }
  if (!provide(i, call, Goal::kModel)) {
    return;
  }
  call.answer_items(call.count());
  // A wrong one among them is found before the first is answered.
  double time_s = 0.0;
  while (call.has_more() && call.number(kAnyTime, time_s)) {
  }
}

void InstrumentCommands::answer_impulse(Instrument& i, Call& call) noexcept {
  double time_s = 0.0;
  for (std::size_t skip = 0; skip <= call.item(); ++skip) {
    if (!call.number(kAnyTime, time_s)) {
      return;
    }
  }
  call.answer().number(i.evaluation_.model().impulse_response(time_s));
}

void InstrumentCommands::monte_carlo(Instrument& i, Call& call) noexcept {
  if (!provide(i, call, Goal::kMonteCarlo)) {
    return;
  }
  const MonteCarloResult result = i.evaluation_.monte_carlo().result();
  const Accelerometer& device = i.evaluation_.device_at_maximum();
  scpi::Response& out = call.answer();
  out.integer(result.trials).number(result.maximum).number(device.sensitivity);
  out.number(device.natural_frequency_hz).number(device.damping);
  out.integer(result.trial_of_maximum).number(result.mean).number(result.u);
  out.number(result.symmetric.low).number(result.symmetric.high);
  out.number(result.shortest.low).number(result.shortest.high);
  out.integer(i.evaluation_.guard().disagreements());
}

void InstrumentCommands::trend(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    const double a = i.evaluation_.limit_mps2();
    call.answer().number(a * a * i.evaluation_.trend_points()[call.item()].energy);
    return;
  }
  if (call.stage() == Call::Stage::kStart && call.has_more() && !take_trend(i, call)) {
    return;
  }
  if (!provide(i, call, Goal::kTrend)) {
    return;
  }
  call.answer().number(i.evaluation_.trend().slope).number(i.evaluation_.trend().intercept);
  call.answer_items(i.evaluation_.trend_points().size());
}

bool InstrumentCommands::take_trend(Instrument& i, Call& call) noexcept {
  Settings next = i.settings_;
  next.trend_s = {};
  if (!call.numbers(kAnyTime, Span<double>(next.trend_s), next.trend_count)) {
    return false;
  }
  if (next.trend_s != i.settings_.trend_s || next.trend_count != i.settings_.trend_count) {
    take(i, call, next);
  }
  return !call.failed();
}

void InstrumentCommands::report(Instrument& i, Call& call) noexcept {
  if (!provide(i, call, Goal::kReport)) {
    return;
  }
  if (i.is_working()) {
    call.wait();
    return;
  }
  const Span<const char> text = i.render_report();
  if (text.empty()) {
    call.fail(ErrorCode::kOutOfMemory, "the report is too long");
    return;
  }
  call.answer().block(text);
}

void InstrumentCommands::random(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(i.generator_.next());
    return;
  }
  std::int64_t count = 0;
  if (call.integer({1, kMaxRandom, 1}, count)) {
    call.answer_items(static_cast<std::size_t>(count));
  }
}

void InstrumentCommands::memory(Instrument& i, Call& call) noexcept {
  const MemoryUse use = i.board_.memory_use != nullptr ? i.board_.memory_use() : MemoryUse{};
  call.answer().integer(use.static_bytes).integer(use.stack_limit).integer(use.stack_used);
}

}  // namespace emax::app
