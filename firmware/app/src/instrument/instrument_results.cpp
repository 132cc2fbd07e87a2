// The commands that answer what was measured or computed, and see to it that it is.
#include <limits>

#include "emax/app/points/reference_uncertainty.hpp"
#include "emax/app/settings/settings_rows.hpp"
#include "emax/base/capacity.hpp"
#include "emax/base/elementary.hpp"
#include "emax/base/units.hpp"

#include "instrument_commands.hpp"

namespace emax::app {
namespace {

using scpi::NumberRule;

constexpr double kNoDefault = std::numeric_limits<double>::quiet_NaN();
constexpr double kHuge = 1e300;
constexpr double kMaxPhase_deg = 360.0;
// An unknown phase comes in degrees, from which no double leads back to just its radians.
constexpr double kNearlyUnknown_rad = 0.999999 * kUnknownPhase_rad;
constexpr double kPercent = 100.0;
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

const EvaluationResults& results_of(const Instrument& i) noexcept {
  return i.sequencer().evaluation();
}

/// A signal that was asked for.
struct SignalWorkspace {
  double times_s[kMaxSwitches];
  SwitchingSignal signal;
};

}  // namespace

std::size_t InstrumentCommands::point_count(const Instrument& i) noexcept {
  const Sequencer& work = i.sequencer();
  return work.points_origin() == Origin::kSweep ? work.sweep().points().size()
                                                : work.points().size();
}

const ResponsePoint& InstrumentCommands::point_at(const Instrument& i, std::size_t index) noexcept {
  const Sequencer& work = i.sequencer();
  return work.points_origin() == Origin::kSweep ? work.sweep().points()[index].point
                                                : work.points().points()[index];
}

double InstrumentCommands::total_u_amplitude(const Instrument& i, std::size_t index) noexcept {
  const Sequencer& work = i.sequencer();
  const bool is_swept = work.points_origin() == Origin::kSweep;
  const ResponsePoint& point = point_at(i, index);
  const double common =
      (is_swept ? work.sweep().common.total : work.points().common()[index]) * point.amplitude;
  return sqrt(point.u_amplitude * point.u_amplitude + common * common);
}

void InstrumentCommands::answer_response(const ResponsePoint& point, scpi::Response& out) noexcept {
  out.number(point.frequency_hz).number(point.amplitude);
  out.number(point.phase_rad * kDegreesPerRadian);
}

void InstrumentCommands::answer_point(const Instrument& i, std::size_t index, double factor,
                                      scpi::Response& out) noexcept {
  const ResponsePoint& point = point_at(i, index);
  answer_response(point, out);
  out.number(factor * total_u_amplitude(i, index));
  out.number(factor * (point.u_phase_rad * kDegreesPerRadian));
}

void InstrumentCommands::fetch(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    answer_point(i, call.item(), 1.0, call.answer());
    return;
  }
  const std::size_t count = points_to_fetch(i, call);
  if (count > 0) {
    call.answer().integer(static_cast<std::int64_t>(count));
    call.answer_items(count);
  }
}

void InstrumentCommands::fetch_trace(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    answer_point(i, call.item(), kCoverageFactor, call.answer());
    return;
  }
  call.answer_items(points_to_fetch(i, call));
}

// Never waits: who watches a sweep grow asks for one point after the other.
void InstrumentCommands::fetch_point(Instrument& i, Call& call) noexcept {
  std::int64_t number = 0;
  if (!call.integer({1, kMaxPoints, 1}, number)) {
    return;
  }
  const auto index = static_cast<std::size_t>(number - 1);
  if (index >= point_count(i)) {
    call.fail(ErrorCode::kDataCorruptOrStale, "no such point: TRAC:FRES:POIN?");
    return;
  }
  answer_point(i, index, 1.0, call.answer());
}

// As SCPI-99 has it: ABORt, INITiate, FETCh?.
void InstrumentCommands::read(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kStart) {
    i.abort_command();
    report(i.initiate_sweep(), call);
  }
  if (!call.failed()) {
    fetch(i, call);
  }
}

std::size_t InstrumentCommands::points_to_fetch(Instrument& i, Call& call) noexcept {
  if (i.is_sweeping()) {
    call.wait();
    return 0;
  }
  const std::size_t count = point_count(i);
  if (count == 0) {
    call.fail(ErrorCode::kDataCorruptOrStale, "no points: INIT:SWE or TRAC:FRES:DATA");
  }
  return count;
}

double InstrumentCommands::common_percent(const Instrument& i) noexcept {
  const Sequencer& work = i.sequencer();
  return work.points_origin() == Origin::kSweep ? swept_percent(i) : percent_for(i, work.points());
}

double InstrumentCommands::swept_percent(const Instrument& i) noexcept {
  return kCoverageFactor * kPercent * i.sequencer().sweep().common.total;
}

/// The common part of a table: what is set, or else, of points that the last sweep has measured,
/// what that has found.
double InstrumentCommands::percent_for(const Instrument& i,
                                       const FrequencyResponse& points) noexcept {
  const double set = i.common_percent();
  return set > 0.0 || !i.sequencer().has_measured(points) ? set : swept_percent(i);
}

void InstrumentCommands::common_part(Instrument& i, Call& call) noexcept {
  double percent = 0.0;
  if (!call.setting({0.0, ranges::kMaxCommonPercent, 0.0, scpi::kPercent}, common_percent(i),
                    percent)) {
    return;
  }
  if (const ErrorWords words = i.conflict_with(Part::kDevice)) {
    report(words, call);
    return;
  }
  if (i.sequencer().points_origin() != Origin::kSweep) {
    take_common(i, call, percent);
    return;
  }
  // What is set already may be set again: *LRN? tells it.
  if (percent != i.common_percent()) {
    call.fail(ErrorCode::kSettingsConflict, "points of a sweep: TRAC:FRES:CLE first");
  }
}

void InstrumentCommands::take_common(Instrument& i, Call& call, double percent) noexcept {
  Sequencer& work = i.sequencer();
  const bool has_points = work.points_origin() == Origin::kTable && work.points().size() > 0;
  if (!has_points || percent == i.common_percent()) {
    i.set_common_percent(percent);
    return;
  }
  FrequencyResponse& points = work.borrow<FrequencyResponse>();
  if (!split_common(i, percent, points)) {
    call.fail(ErrorCode::kDataOutOfRange, "a point has a smaller U(A)");
    return;
  }
  i.set_common_percent(percent);
  report(i.take(points), call);
}

/// The points with all of their uncertainty, and then with this common part apart from it.
bool InstrumentCommands::split_common(const Instrument& i, double percent,
                                      FrequencyResponse& points) noexcept {
  points.clear();
  for (std::size_t k = 0; k < i.sequencer().points().size(); ++k) {
    ResponsePoint point = i.sequencer().points().points()[k];
    point.u_amplitude = total_u_amplitude(i, k);
    (void)points.add(point);
  }
  return remove_common(points, percent).status == Status::kOk;
}

void InstrumentCommands::add_points(Instrument& i, Call& call) noexcept {
  if (const ErrorWords words = i.conflict_with(Part::kDevice)) {
    report(words, call);
    return;
  }
  Sequencer& work = i.sequencer();
  if (work.points_origin() == Origin::kSweep && work.points().size() > 0) {
    call.fail(ErrorCode::kSettingsConflict, "points of a sweep: TRAC:FRES:CLE first");
    return;
  }
  // All of them or none.
  FrequencyResponse& grown = work.borrow<FrequencyResponse>();
  grown.clear();
  if (work.points().size() > 0) {
    (void)split_common(i, 0.0, grown);
  }
  while (call.has_more()) {
    double numbers[kPointFields] = {};
    for (std::size_t field = 0; field < kPointFields; ++field) {
      // What stands there is looked at first: it may be no number at all.
      if (!call.has_more()) {
        call.fail(ErrorCode::kMissingParameter, "five numbers for each point");
      }
      if (call.failed() || !call.number(*kPointRules[field], numbers[field])) {
        return;
      }
    }
    if (const char* problem = add_point(grown, numbers)) {
      call.fail(ErrorCode::kDataOutOfRange, problem);
      return;
    }
  }
  if (remove_common(grown, percent_for(i, grown)).status != Status::kOk) {
    call.fail(ErrorCode::kDataOutOfRange, "U(A) must be above CALC:REF:UNC");
    return;
  }
  report(i.take(grown), call);
}

const char* InstrumentCommands::add_point(FrequencyResponse& response,
                                          const double* numbers) noexcept {
  ResponsePoint point;
  point.frequency_hz = numbers[0];
  point.amplitude = numbers[1];
  point.phase_rad = numbers[2] * kRadiansPerDegree;
  point.u_amplitude = numbers[3] / kCoverageFactor;
  point.u_phase_rad = numbers[4] / kCoverageFactor * kRadiansPerDegree;
  if (point.u_phase_rad > kNearlyUnknown_rad) {
    point.u_phase_rad = kUnknownPhase_rad;
  }
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
  report(i.clear_points(), call);
}

void InstrumentCommands::count_points(Instrument& i, Call& call) noexcept {
  call.answer().integer(static_cast<std::int64_t>(point_count(i)));
}

const Identification* InstrumentCommands::kept(const Instrument& i) noexcept {
  const Identification* const kept = i.sequencer().kept_identification();
  const bool is_fit = kept != nullptr && kept->source == Source::kPoints;
  return is_fit && i.sequencer().points().size() == 0 ? kept : nullptr;
}

void InstrumentCommands::identify(Instrument& i, Call& call) noexcept {
  if (const Identification* identification = kept(i)) {
    answer_device(identification->device, call.answer());
    call.answer().number(identification->chi2).integer(identification->dof);
    return;
  }
  if (!i.provide_sensitivity(call)) {
    return;
  }
  const WlspFit& fit = results_of(i).fit.result();
  answer_device(fitted_device(results_of(i)), call.answer());
  call.answer().number(fit.chi2).integer(fit.dof);
}

/// As fitted: a damping that the points leave open may be negative, and what they do not determine
/// at all is not a number.
Device InstrumentCommands::fitted_device(const EvaluationResults& results) noexcept {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const WlspFit& fit = results.fit.result();
  const FitJudgement& judgement = results.judgement;
  if (judgement.determined == Determined::kSensitivity) {
    return {{judgement.device.sensitivity, kNone, kNone}, {judgement.u_sensitivity, kNone, kNone}};
  }
  if (results.is_damping_open() && !fit.is_damping_held) {
    return {fit.model, {fit.u_sensitivity, fit.u_natural_frequency_hz, fit.u_damping}};
  }
  return results.device;
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
  if (!i.provide_fit(call)) {
    return;
  }
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      call.answer().number(results_of(i).covariance(row, column));
    }
  }
}

void InstrumentCommands::model(Instrument& i, Call& call) noexcept {
  if (call.is_query()) {
    if (i.provide(call, Goal::kModel)) {
      answer_device(results_of(i).device, call.answer());
    }
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
  if (at != 3 && at != 6) {
    call.fail(ErrorCode::kMissingParameter, "three numbers or six");
    return;
  }
  if (const ErrorWords words = i.conflict_with(Part::kDevice)) {
    report(words, call);
    return;
  }
  if (const char* problem = problem_of(device)) {
    call.fail(ErrorCode::kDataOutOfRange, problem);
    return;
  }
  report(i.take(device), call);
}

const char* InstrumentCommands::problem_of(const Device& device) noexcept {
  const ParameterBox& u = device.u;
  if (validate(device.estimate) != Status::kOk) {
    return "S > 0, f0 0.001 to 1E9, beta 1E-4 to < 1";
  }
  if (!(u.sensitivity >= 0.0) || !(u.natural_frequency_hz >= 0.0) || !(u.damping >= 0.0)) {
    return "uncertainties must be 0 or more";
  }
  return nullptr;
}

void InstrumentCommands::energy(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(results_of(i).maximum.signal.times_s()[call.item()]);
    return;
  }
  if (!i.provide(call, Goal::kEnergy)) {
    return;
  }
  const EvaluationResults& evaluation = results_of(i);
  const std::size_t count = evaluation.maximum.signal.count();
  call.answer().number(evaluation.energy_v2s()).number(evaluation.xi());
  call.answer().number(evaluation.has_bound ? evaluation.bound_v2s : kNoDefault);
  call.answer().integer(static_cast<std::int64_t>(count));
  call.answer_items(count);
}

void InstrumentCommands::band(Instrument& i, Call& call) noexcept {
  const EvaluationResults& evaluation = results_of(i);
  const bool is_plain = i.settings().delay_choice == DelayChoice::kNone;
  const FigureResults& figure = is_plain ? evaluation.band : evaluation.matched;
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(figure.times_s()[call.item()]);
    return;
  }
  if (!i.provide(call, Goal::kBand)) {
    return;
  }
  if (!figure.exists()) {
    call.fail(ErrorCode::kSettingsConflict, explain(figure.status));
    return;
  }
  call.answer().number(figure.energy_v2s).number(evaluation.percent_of(figure.energy_v2s));
  call.answer().number(figure.has_bound ? figure.bound_v2s : kNoDefault);
  call.answer().integer(figure.switches);
  call.answer_items(figure.times_s().size());
}

/// The range of E in the place of both intervals; there is no u.
void InstrumentCommands::answer_cut_range(const EvaluationResults& results,
                                          scpi::Response& out) noexcept {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  out.number(kNone).number(kNone);
  out.number(results.cut_low_v2s).number(results.cut_high_v2s);
  out.number(results.cut_low_v2s).number(results.cut_high_v2s);
  out.integer(0);
}

void InstrumentCommands::uncertainty(Instrument& i, Call& call) noexcept {
  if (!i.provide(call, Goal::kUncertainty)) {
    return;
  }
  const EnergyUncertainty& known = results_of(i).uncertainty;
  if (results_of(i).is_damping_open()) {
    answer_cut_range(results_of(i), call.answer());
    return;
  }
  if (!known.exists()) {
    call.fail(ErrorCode::kSettingsConflict, "uncertainties too large for the trials");
    return;
  }
  scpi::Response& out = call.answer();
  out.number(known.u_v2s).number(kCoverageFactor * known.u_v2s);
  out.number(known.symmetric.low).number(known.symmetric.high);
  out.number(known.shortest.low).number(known.shortest.high);
  out.integer(known.redraws);
}

void InstrumentCommands::evaluate(Instrument& i, Call& call) noexcept {
  if (!i.provide(call, Goal::kModel)) {
    return;
  }
  if (i.is_working()) {
    call.wait();
    return;
  }
  SignalWorkspace& work = i.sequencer().borrow<SignalWorkspace>();
  std::size_t count = 0;
  if (!call.numbers(kAnyTime, Span<double>(work.times_s), count)) {
    return;
  }
  work.signal = {};
  const Span<const double> times_s(work.times_s, count);
  if (work.signal.set(times_s, i.settings().duration_s) != Status::kOk) {
    call.fail(ErrorCode::kDataOutOfRange, "times must ascend inside 0 to T");
    return;
  }
  const double a = results_of(i).limit_mps2;
  call.answer().number(a * a * emax::energy(results_of(i).model, work.signal));
}

void InstrumentCommands::fixed_point(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(i.sequencer().fixed_point()->energy_v2s(call.item()));
    return;
  }
  if (!i.provide_fixed_point(call)) {
    return;
  }
  const std::size_t iterations = i.sequencer().fixed_point()->iterations();
  call.answer().integer(static_cast<std::int64_t>(iterations));
  call.answer_items(iterations + 1);
}

void InstrumentCommands::absolute_error(Instrument& i, Call& call) noexcept {
  if (!i.provide(call, Goal::kModel)) {
    return;
  }
  if (!results_of(i).has_absolute_error) {
    call.fail(ErrorCode::kSettingsConflict, "k moves too often for so long a T: shorten it");
    return;
  }
  call.answer().number(results_of(i).absolute_error_v);
}

void InstrumentCommands::settling_time(Instrument& i, Call& call) noexcept {
  if (i.provide(call, Goal::kModel)) {
    const SettlingTime& settling = results_of(i).settling_time;
    call.answer().number(settling.found ? settling.time_s
                                        : std::numeric_limits<double>::infinity());
  }
}

void InstrumentCommands::impulse_response(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    answer_impulse(i, call);
    return;
  }
  if (!i.provide(call, Goal::kModel)) {
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
  call.answer().number(results_of(i).model.impulse_response(time_s));
}

void InstrumentCommands::monte_carlo(Instrument& i, Call& call) noexcept {
  if (!i.provide(call, Goal::kMonteCarlo)) {
    return;
  }
  const MonteCarloResult& result = results_of(i).trials.result;
  const Accelerometer& device = results_of(i).device_at_maximum;
  scpi::Response& out = call.answer();
  out.integer(result.trials).number(result.maximum).number(device.sensitivity);
  out.number(device.natural_frequency_hz).number(device.damping);
  out.integer(result.trial_of_maximum).number(result.mean).number(result.u);
  out.number(result.symmetric.low).number(result.symmetric.high);
  out.number(result.shortest.low).number(result.shortest.high);
  out.integer(results_of(i).guard.disagreements);
}

void InstrumentCommands::histogram(Instrument& i, Call& call) noexcept {
  const TrialResults& trials = results_of(i).trials;
  if (call.stage() == Call::Stage::kItem) {
    call.answer().integer(trials.histogram()[call.item()]);
    return;
  }
  if (i.provide(call, Goal::kMonteCarlo)) {
    call.answer().number(trials.result.minimum).number(trials.result.maximum);
    call.answer_items(kHistogramRows);
  }
}

void InstrumentCommands::trend(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    call.answer().number(results_of(i).trend_points()[call.item()].energy_v2s);
    return;
  }
  if (call.stage() == Call::Stage::kStart && call.has_more() && !take_trend(i, call)) {
    return;
  }
  if (!i.provide(call, Goal::kTrend)) {
    return;
  }
  if (results_of(i).trend_points().empty()) {
    call.fail(ErrorCode::kSettingsConflict, "trend times too long: CALC:TREN? T1,T2,...");
    return;
  }
  call.answer().number(results_of(i).trend.slope).number(results_of(i).trend.intercept);
  call.answer_items(results_of(i).trend_points().size());
}

void InstrumentCommands::trend_times(Instrument& i, Call& call) noexcept {
  if (!call.is_query()) {
    (void)take_trend(i, call);
    return;
  }
  if (i.settings().trend_count == 0) {
    call.answer().number(kNoDefault);
  }
  for (std::size_t k = 0; k < i.settings().trend_count; ++k) {
    call.answer().number(i.settings().trend_s[k]);
  }
}

bool InstrumentCommands::take_trend(Instrument& i, Call& call) noexcept {
  Settings next = i.settings();
  next.trend_s = {};
  if (!call.numbers(kAnyTime, Span<double>(next.trend_s), next.trend_count)) {
    return false;
  }
  if (next.trend_s != i.settings().trend_s || next.trend_count != i.settings().trend_count) {
    take(i, call, next);
  }
  return !call.failed();
}

namespace {

/// What a report is headed with: a view of the message.
struct GivenLabels {
  Span<const char> text[5];
  std::size_t count = 0;
};

bool take_labels(scpi::Call& call, GivenLabels& labels) noexcept {
  while (call.has_more()) {
    if (!call.string(labels.text[labels.count])) {
      return false;
    }
    ++labels.count;
  }
  return true;
}

/// Puts a label with a zero behind it to the front of the memory; doubled quotes are one.
const char* keep_label(Span<const char> text, Span<char>& memory) noexcept {
  std::size_t size = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    memory[size++] = text[k];
    const bool is_quote = text[k] == '"' || text[k] == '\'';
    k += is_quote && k + 1 < text.size() && text[k + 1] == text[k] ? 1U : 0U;
  }
  memory[size] = '\0';
  const char* const label = memory.data();
  memory = memory.from(size + 1);
  return size > 0 ? label : nullptr;
}

}  // namespace

void InstrumentCommands::report_text(Instrument& i, Call& call) noexcept {
  GivenLabels given;
  if (!take_labels(call, given) || !i.provide(call, Goal::kReport)) {
    return;
  }
  if (i.is_working()) {
    call.wait();
    return;
  }
  Span<char> memory = i.sequencer().borrow_all();
  Labels labels;
  const char** const all[] = {&labels.device, &labels.serial, &labels.operated_by, &labels.date,
                              &labels.note};
  for (std::size_t k = 0; k < given.count; ++k) {
    *all[k] = keep_label(given.text[k], memory);
  }
  answer_text(i.render_report(labels, memory), call);
}

void InstrumentCommands::fetch_json(Instrument& i, Call& call) noexcept {
  if (i.is_working()) {
    call.wait();
    return;
  }
  answer_text(i.render_json(), call);
}

void InstrumentCommands::answer_text(Span<const char> text, Call& call) noexcept {
  if (text.empty()) {
    call.fail(ErrorCode::kOutOfMemory, "the text is too long");
    return;
  }
  call.answer().block(text);
}

void InstrumentCommands::random(Instrument& i, Call& call) noexcept {
  if (call.stage() == Call::Stage::kItem) {
    if (i.was_aborted()) {
      call.fail(ErrorCode::kExecutionError, "aborted");
      return;
    }
    call.answer().number(i.next_random());
    return;
  }
  std::int64_t count = 0;
  if (call.integer({1, kMaxRandom, 1}, count)) {
    i.begin_answer();
    call.answer_items(static_cast<std::size_t>(count));
  }
}

void InstrumentCommands::memory(Instrument& i, Call& call) noexcept {
  const Board& board = i.board();
  const MemoryUse use = board.memory_use != nullptr ? board.memory_use() : MemoryUse{};
  call.answer().integer(use.static_bytes).integer(use.stack_limit).integer(use.stack_used);
}

}  // namespace emax::app
