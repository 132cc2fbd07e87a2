// The stages of the job, and the slices that each of them is cut into.
#include "emax/app/evaluation.hpp"

#include "emax/elementary.hpp"

namespace emax::app {
namespace {

constexpr std::uint32_t kDrawsPerStep = 100;
constexpr std::uint64_t kFitDrawsOffset = std::uint64_t{1} << 60U;

// Work is counted in cells of Phi's products: a value from the store costs next to nothing.
constexpr std::uint32_t kWorkPerStep = 4096;
constexpr std::uint32_t kWorkOfStoredValue = 2;

// Beyond these a^2 E would leave the range in which its squares are finite.
constexpr double kMinSensitivity = 1e-30;
constexpr double kMaxSensitivity = 1e30;

constexpr char kWrongSetting[] =
    "A setting is outside its range; give a value inside the stated range.";
constexpr char kWrongSensitivity[] =
    "The sensitivity is outside 1e-30 to 1e30 V/(m/s^2); check its unit.";
constexpr char kWrongDevice[] =
    "The sensitivity must be above 0, the natural frequency from 1e-3 to 1e9 Hz and the damping "
    "from 1e-4 to below 1; check the parameters and their units.";
constexpr char kWrongUncertainty[] = "An uncertainty is below 0 or not a number; give 0 or more.";
constexpr char kBoxTooLarge[] =
    "The ranges of the parameters, estimate minus to plus standard uncertainty, leave what a "
    "device may be (S and f0 above 0, damping from 1e-4 to below 1); give smaller uncertainties.";
constexpr char kNormalTooWide[] =
    "Six standard deviations from the estimate leave what a device may be (S and f0 above 0, "
    "damping from 1e-4 to below 1), or the covariance is none; give smaller uncertainties.";
constexpr char kOverdamped[] =
    "The damping is 1 or more; devices with a resonance are supported, with a damping from 1e-4 to "
    "below 1, because fit and grid follow the resonance.";
constexpr char kTooManyCellsBest[] =
    "The grid of 12 cells per period of the resonance (or of the cutoff, if that is higher) needs "
    "more than 8192 cells for this time; shorten it.";
constexpr char kTooManyCellsPaper[] =
    "The grid of the paper's step needs more than 8192 cells for this time; shorten it or take a "
    "longer step.";
constexpr char kTooManySwitches[] =
    "The best signal changes sign more than 256 times, more than the table holds; shorten the "
    "time.";
constexpr char kTrialsFailed[] =
    "The energies of the trials cannot be summed up; check the units of the parameters.";

/// Whether all parameters moved by `side` times their uncertainties are still a device.
bool is_side_valid(const Device& device, double side) noexcept {
  const Accelerometer end = {
      device.estimate.sensitivity + side * device.u.sensitivity,
      device.estimate.natural_frequency_hz + side * device.u.natural_frequency_hz,
      device.estimate.damping + side * device.u.damping};
  return validate(end) == Status::kOk;
}

// False for a value that is not a number, too.
bool is_uncertainty(double u) noexcept { return u >= 0.0 && is_finite(u); }

}  // namespace

const char* name_of(Stage stage) noexcept {
  switch (stage) {
    case Stage::kIdle:
      return "idle";
    case Stage::kFitDraws:
      return "fit";
    case Stage::kEnergy:
      return "energy";
    case Stage::kBound:
      return "bound";
    case Stage::kAdaptive:
      return "number of trials";
    case Stage::kMonteCarlo:
      return "Monte Carlo";
    case Stage::kGuard:
      return "guard";
    case Stage::kTrend:
      return "trend";
    case Stage::kDone:
      return "done";
    case Stage::kFailed:
      return "failed";
  }
  return "unknown";
}

Status Evaluation::start_from_points(const FrequencyResponse& points,
                                     const Settings& settings) noexcept {
  source_ = Source::kPoints;
  Status status = begin(settings);
  if (status != Status::kOk) {
    return status;
  }
  status = fit_.fit(points);
  const WlspFit& fit = fit_.result();
  if (status != Status::kOk) {
    return fail(status, Stage::kFitDraws,
                status == Status::kOverdamped ? kOverdamped : explain(status));
  }
  device_.estimate = fit.model;
  device_.u = {fit.u_sensitivity, fit.u_natural_frequency_hz, fit.u_damping};
  status = prepare();
  if (status != Status::kOk) {
    return status;
  }
  WichmannHill generator = seeded_generator();
  generator.jump(kFitDrawsOffset);
  status = draws_.start(fit_, kFitDraws, generator);
  if (status != Status::kOk) {
    return fail(status, Stage::kFitDraws, explain(status));
  }
  stage_ = Stage::kFitDraws;
  return Status::kOk;
}

Status Evaluation::start_from_model(const Device& device, const Settings& settings) noexcept {
  source_ = Source::kModel;
  Status status = begin(settings);
  if (status != Status::kOk) {
    return status;
  }
  device_ = device;
  status = prepare();
  if (status != Status::kOk) {
    return status;
  }
  begin_energy();
  return failure_.status;
}

Status Evaluation::begin(const Settings& settings) noexcept {
  stage_ = Stage::kIdle;
  failure_ = {};
  settings_ = settings;
  device_ = {};
  draws_ = {};
  peak_ = {};
  settling_ = {};
  absolute_error_ = {};
  guard_ = {};
  maximum_ = {};
  adaptive_trials_ = {};
  adaptive_result_ = {};
  device_at_maximum_ = {};
  trend_ = {};
  trace_count_ = 0;
  trend_done_ = 0;
  trend_search_runs_ = false;
  limit_mps2_ = 0.0;
  stored_ = 0;
  has_bound_ = false;
  has_monte_carlo_ = false;
  if (check(settings).setting != nullptr) {
    return fail(Status::kInvalidArgument, Stage::kIdle, kWrongSetting);
  }
  return Status::kOk;
}

Status Evaluation::prepare() noexcept {
  const Accelerometer& estimate = device_.estimate;
  const Status device_status = validate(estimate);
  if (device_status != Status::kOk) {
    return fail(device_status, Stage::kIdle,
                device_status == Status::kOverdamped ? kOverdamped : kWrongDevice);
  }
  if (estimate.sensitivity < kMinSensitivity || estimate.sensitivity > kMaxSensitivity) {
    return fail(Status::kInvalidArgument, Stage::kIdle, kWrongSensitivity);
  }
  limit_mps2_ = settings_.limit_is_auto ? estimate.sensitivity : settings_.limit_mps2;
  const bool gain_is_given = settings_.gain_mode == GainMode::kFixed;
  const Butterworth filter = {settings_.filter_order, settings_.cutoff_hz,
                              gain_is_given ? settings_.gain : estimate.sensitivity};
  Status status = model_.set(estimate, filter, settings_.criterion);
  if (status != Status::kOk) {
    return fail(status, Stage::kIdle, explain(status));
  }
  status = check_box();
  if (status != Status::kOk) {
    return status;
  }
  status = check_grids();
  if (status != Status::kOk) {
    return status;
  }
  peak_ = model_.peak();
  settling_ = model_.settling_time(kSettled);
  absolute_error_ = largest_absolute_error(model_, settings_.duration_s);
  return Status::kOk;
}

Status Evaluation::check_box() noexcept {
  const ParameterBox& u = device_.u;
  if (!is_uncertainty(u.sensitivity) || !is_uncertainty(u.natural_frequency_hz) ||
      !is_uncertainty(u.damping)) {
    return fail(Status::kInvalidArgument, Stage::kIdle, kWrongUncertainty);
  }
  const bool is_box = settings_.distribution == Distribution::kBox;
  const double widest = trial_scale() * (is_box ? 1.0 : EnergyTrials::kMaxDeviations);
  if (!is_side_valid(device_, -widest) || !is_side_valid(device_, widest)) {
    return fail(Status::kInvalidArgument, Stage::kMonteCarlo,
                is_box ? kBoxTooLarge : kNormalTooWide);
  }
  return Status::kOk;
}

Status Evaluation::check_grids() noexcept {
  Status status = search_.start(model_, search_settings(settings_.duration_s), workspace_);
  if (status != Status::kOk) {
    return fail_search(status, Stage::kEnergy, settings_.duration_s);
  }
  for (std::size_t i = 0; i < settings_.trend_count; ++i) {
    status = search_.start(model_, search_settings(settings_.trend_s[i]), workspace_);
    if (status != Status::kOk) {
      return fail_search(status, Stage::kTrend, settings_.trend_s[i]);
    }
  }
  return Status::kOk;
}

void Evaluation::step() noexcept {
  switch (stage_) {
    case Stage::kFitDraws:
      step_fit_draws();
      return;
    case Stage::kEnergy:
      step_energy();
      return;
    case Stage::kBound:
      step_bound();
      return;
    case Stage::kAdaptive:
      step_adaptive();
      return;
    case Stage::kMonteCarlo:
      step_monte_carlo();
      return;
    case Stage::kGuard:
      step_guard();
      return;
    case Stage::kTrend:
      step_trend();
      return;
    case Stage::kIdle:
    case Stage::kDone:
    case Stage::kFailed:
      return;
  }
}

double Evaluation::progress() const noexcept {
  switch (stage_) {
    case Stage::kFitDraws:
      return static_cast<double>(draws_.made()) / kFitDraws;
    case Stage::kEnergy:
      return search_.progress();
    case Stage::kBound:
      return bound_.progress();
    case Stage::kAdaptive:
      return adaptive_progress();
    case Stage::kMonteCarlo:
      return monte_carlo_progress();
    case Stage::kGuard:
      return guard_.progress();
    case Stage::kTrend: {
      const double running = trend_search_runs_ ? search_.progress() : 0.0;
      return (static_cast<double>(trend_done_) + running) /
             static_cast<double>(settings_.trend_count);
    }
    case Stage::kDone:
      return 1.0;
    case Stage::kIdle:
    case Stage::kFailed:
      return 0.0;
  }
  return 0.0;
}

// The scatter of a mean over blocks falls with the root of their number: that says how many it
// takes until the largest of the four is small enough.
double Evaluation::adaptive_progress() const noexcept {
  const AdaptiveResult so_far = adaptive_trials_.result();
  if (so_far.blocks < 2 || !(so_far.tolerance > 0.0)) {
    return 0.0;
  }
  double largest = 0.0;
  const double scatters[] = {so_far.s_mean, so_far.s_u, so_far.s_low, so_far.s_high};
  for (const double s : scatters) {
    largest = s > largest ? s : largest;
  }
  const double ratio = 2.0 * largest / so_far.tolerance;
  return ratio > 1.0 ? 1.0 / (ratio * ratio) : 1.0;
}

// With a store that holds all trials only the first pass takes time.
double Evaluation::monte_carlo_progress() const noexcept {
  if (store_.size() < monte_carlo_trials_) {
    return monte_carlo_.progress();
  }
  return static_cast<double>(stored_) / static_cast<double>(monte_carlo_trials_);
}

double Evaluation::covariance(std::size_t i, std::size_t j) const noexcept {
  if (source_ == Source::kPoints) {
    return fit_.result().covariance[i][j];
  }
  if (i != j) {
    return 0.0;
  }
  const double u = i == 0   ? device_.u.sensitivity
                   : i == 1 ? device_.u.natural_frequency_hz
                            : device_.u.damping;
  return u * u;
}

double Evaluation::rms_error_v() const noexcept {
  return sqrt(energy_v2s() / settings_.duration_s);
}

double Evaluation::trial_scale() const noexcept {
  const double ratio = source_ == Source::kPoints ? fit_.result().birge_ratio : 1.0;
  return settings_.birge && ratio > 1.0 ? ratio : 1.0;
}

SearchSettings Evaluation::search_settings(double duration_s) const noexcept {
  return {settings_.method, duration_s, settings_.step_s, settings_.iterations};
}

WichmannHill Evaluation::seeded_generator() const noexcept {
  WichmannHill generator;
  (void)generator.seed(settings_.generator, settings_.seed);  // `check()` has seen the seed.
  return generator;
}

Status Evaluation::fail(Status status, Stage stage, const char* reason,
                        double duration_s) noexcept {
  failure_ = {status, stage, reason, duration_s};
  stage_ = Stage::kFailed;
  adaptive_trials_ = {};
  return status;
}

Status Evaluation::fail_search(Status status, Stage stage, double duration_s) noexcept {
  const char* reason = explain(status);
  if (status == Status::kTooManyCells) {
    reason = settings_.method == Method::kPaper ? kTooManyCellsPaper : kTooManyCellsBest;
  }
  if (status == Status::kTooManySwitches) {
    reason = kTooManySwitches;
  }
  return fail(status, stage, reason, duration_s);
}

void Evaluation::step_fit_draws() noexcept {
  draws_.step(fit_, kDrawsPerStep);
  if (draws_.done()) {
    begin_energy();
  }
}

void Evaluation::begin_energy() noexcept {
  const Status status = search_.start(model_, search_settings(settings_.duration_s), workspace_);
  if (status != Status::kOk) {
    (void)fail_search(status, Stage::kEnergy, settings_.duration_s);
    return;
  }
  stage_ = Stage::kEnergy;
}

void Evaluation::step_energy() noexcept {
  const Status status = search_.step(model_, workspace_);
  if (status != Status::kOk) {
    (void)fail_search(status, Stage::kEnergy, settings_.duration_s);
    return;
  }
  if (!search_.done()) {
    return;
  }
  maximum_ = search_.result();
  if (settings_.method == Method::kPaper) {
    const Span<const double> trace = search_.trace();
    trace_count_ = trace.size();
    for (std::size_t i = 0; i < trace_count_; ++i) {
      trace_[i] = trace[i];
    }
  }
  begin_bound();
}

// A device and time for which no bound passes its check, or for which its grid would be too large,
// are reported without one.
void Evaluation::begin_bound() noexcept {
  if (bound_.start(model_, settings_.duration_s, workspace_) != Status::kOk) {
    begin_trials();
    return;
  }
  stage_ = Stage::kBound;
}

void Evaluation::step_bound() noexcept {
  const Status status = bound_.step(model_, workspace_);
  if (status == Status::kOk && !bound_.done()) {
    return;
  }
  has_bound_ = status == Status::kOk;
  begin_trials();
}

void Evaluation::begin_trials() noexcept {
  const ParameterBox& u = device_.u;
  if (u.sensitivity == 0.0 && u.natural_frequency_hz == 0.0 && u.damping == 0.0) {
    begin_trend();
    return;
  }
  TrialSettings trial_settings;
  const double scale = trial_scale();
  trial_settings.distribution = settings_.distribution;
  trial_settings.box = {scale * u.sensitivity, scale * u.natural_frequency_hz, scale * u.damping};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      trial_settings.covariance[i][j] = scale * scale * covariance(i, j);
    }
  }
  trial_settings.generator = seeded_generator();
  trial_settings.gain_follows = settings_.gain_mode == GainMode::kTrack;
  trial_settings.search = search_settings(settings_.duration_s);
  Status status = trials_.start(model_, maximum_, trial_settings, workspace_);
  if (status != Status::kOk) {
    const bool is_box = settings_.distribution == Distribution::kBox;
    (void)fail(status, Stage::kMonteCarlo, is_box ? kBoxTooLarge : kNormalTooWide);
    return;
  }
  if (!settings_.adaptive) {
    begin_monte_carlo(settings_.trials);
    return;
  }
  status = adaptive_trials_.start(monte_carlo_, settings_.probability);
  if (status != Status::kOk) {
    (void)fail(status, Stage::kAdaptive, explain(status));
    return;
  }
  stage_ = Stage::kAdaptive;
}

std::uint32_t Evaluation::trial_cost() const noexcept {
  const auto cells = static_cast<std::uint32_t>(maximum_.cells);
  const auto switches = static_cast<std::uint32_t>(maximum_.signal.count());
  // The paper's method runs the whole fixed point, the other works on each pair of switches.
  return settings_.method == Method::kPaper ? 10 * cells : cells + switches * switches;
}

double Evaluation::trial_value(std::uint32_t trial) noexcept {
  if (trial < stored_) {
    return store_[trial];
  }
  const double value = a2() * trials_.energy(trial, workspace_);
  if (trial == stored_ && trial < store_.size()) {
    store_[trial] = value;
    ++stored_;
  }
  return value;
}

template <typename Procedure>
void Evaluation::run_slice(Procedure& procedure) noexcept {
  std::uint32_t work = 0;
  while (work < kWorkPerStep && !procedure.done()) {
    const std::uint32_t trial = procedure.next_trial();
    work += trial < stored_ ? kWorkOfStoredValue : trial_cost();
    procedure.add(trial_value(trial));
  }
}

void Evaluation::step_adaptive() noexcept {
  run_slice(adaptive_trials_);
  if (!adaptive_trials_.done()) {
    return;
  }
  adaptive_result_ = adaptive_trials_.result();
  adaptive_trials_ = {};
  if (adaptive_result_.status != Status::kOk) {
    (void)fail(adaptive_result_.status, Stage::kAdaptive, kTrialsFailed);
    return;
  }
  begin_monte_carlo(adaptive_result_.trials);
}

void Evaluation::begin_monte_carlo(std::uint32_t trials) noexcept {
  const Status status = monte_carlo_.start(trials, settings_.probability);
  if (status != Status::kOk) {
    (void)fail(status, Stage::kMonteCarlo, explain(status));
    return;
  }
  monte_carlo_trials_ = trials;
  stage_ = Stage::kMonteCarlo;
}

void Evaluation::step_monte_carlo() noexcept {
  run_slice(monte_carlo_);
  if (!monte_carlo_.done()) {
    return;
  }
  const MonteCarloResult result = monte_carlo_.result();
  if (result.status != Status::kOk) {
    (void)fail(result.status, Stage::kMonteCarlo, kTrialsFailed);
    return;
  }
  device_at_maximum_ = trials_.device(result.trial_of_maximum);
  has_monte_carlo_ = true;
  if (settings_.method == Method::kPaper) {
    begin_trend();
    return;
  }
  guard_.start(monte_carlo_trials_, result.trial_of_maximum);
  stage_ = Stage::kGuard;
}

void Evaluation::step_guard() noexcept {
  (void)guard_.step(trials_, search_, workspace_);  // A search that fails counts as disagreement.
  if (guard_.done()) {
    begin_trend();
  }
}

void Evaluation::begin_trend() noexcept {
  stage_ = settings_.trend_count == 0 ? Stage::kDone : Stage::kTrend;
}

void Evaluation::step_trend() noexcept {
  const double duration_s = settings_.trend_s[trend_done_];
  if (!trend_search_runs_) {
    if (duration_s == settings_.duration_s) {
      add_trend_point(maximum_.energy);
      return;
    }
    const Status status = search_.start(model_, search_settings(duration_s), workspace_);
    if (status != Status::kOk) {
      (void)fail_search(status, Stage::kTrend, duration_s);
      return;
    }
    trend_search_runs_ = true;
    return;
  }
  const Status status = search_.step(model_, workspace_);
  if (status != Status::kOk) {
    (void)fail_search(status, Stage::kTrend, duration_s);
    return;
  }
  if (search_.done()) {
    trend_search_runs_ = false;
    add_trend_point(search_.result().energy);
  }
}

void Evaluation::add_trend_point(double energy) noexcept {
  trend_points_[trend_done_] = {settings_.trend_s[trend_done_], energy};
  ++trend_done_;
  if (trend_done_ == settings_.trend_count) {
    end_trend();
  }
}

void Evaluation::end_trend() noexcept {
  double energy_v2s[kMaxTrendPoints];
  for (std::size_t i = 0; i < trend_done_; ++i) {
    energy_v2s[i] = a2() * trend_points_[i].energy;
  }
  const Span<const double> times_s(settings_.trend_s.data(), trend_done_);
  trend_ = linear_trend(times_s, Span<const double>(energy_v2s, trend_done_));
  if (trend_.status != Status::kOk) {
    (void)fail(trend_.status, Stage::kTrend, explain(trend_.status));
    return;
  }
  stage_ = Stage::kDone;
}

}  // namespace emax::app
