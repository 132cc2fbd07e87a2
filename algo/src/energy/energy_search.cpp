// Many starting signals, each climbing on the grid; the best ends refined in continuous time.
#include "emax/energy/energy_search.hpp"

#include <limits>

#include "emax/base/elementary.hpp"
#include "emax/base/wichmann_hill.hpp"
#include "emax/energy/known_energy.hpp"
#include "emax/energy/refinement.hpp"

namespace emax {
namespace {

constexpr double kCellsPerPeriod = 12.0;
constexpr std::size_t kMinCells = 24;
constexpr std::size_t kClimbIterations = 200;
/// Pulses turned in one climb; no run has been seen to need as many.
constexpr std::size_t kMaxTurns = 1000;
/// Of the energy: a smaller gain of a pulse is left to the refinement.
constexpr double kSmallestGain = 1e-9;
/// A climb that ends this part below the highest one is not refined: refinement adds no more.
constexpr double kWorthRefining = 0.01;
/// Energies that differ by less than this part are of the same signal.
constexpr double kSame = 1e-11;
/// What a step of a refinement costs for each switch, in cells of a product.
constexpr std::size_t kWorkOfRefinement = 96;
/// What the energy of a pulse costs, and how much of that is done at once.
constexpr std::size_t kWorkOfPulse = 12;
constexpr std::size_t kWorkOfPulses = 512;
/// Rounding of more than this part of the energy may have led the search astray.
constexpr double kTrusted = 1e-4;
constexpr std::uint32_t kRandomSeed[] = {1, 2, 3, 4};
/// What each pattern may take of them, whatever the capacity, so that it changes no pattern.
constexpr std::uint64_t kNumbersPerPattern = 8192;

/// The number of cells of at most `cell_s`; a quotient within rounding of a whole number is that
/// number.
std::size_t cells_for(double duration_s, double cell_s) noexcept {
  const double cells = duration_s / cell_s;
  if (!(cells <= static_cast<double>(kMaxCells))) {
    return kMaxCells + 1;
  }
  const double whole = floor(cells);
  return static_cast<std::size_t>(whole) + (cells - whole > 1e-9 * cells ? 1u : 0u);
}

}  // namespace

void clear(MaximumEnergy& maximum) noexcept {
  maximum.energy = 0.0;
  maximum.rounding = 0.0;
  maximum.signal.clear();
  maximum.cells = 0;
  maximum.starts = 0;
  maximum.iterations = 0;
  maximum.at_rest = false;
}

std::size_t grid_cells(const ModalModel& model, double duration_s) noexcept {
  const std::size_t cells = cells_for(duration_s, 1.0 / (kCellsPerPeriod * model.grid_hz()));
  return cells < kMinCells ? kMinCells : cells;
}

std::size_t search_cells(const ModalModel& model, const SearchSettings& settings) noexcept {
  return settings.method == Method::kPaper ? cells_for(settings.duration_s, settings.step_s)
                                           : grid_cells(model, settings.duration_s);
}

double ascent_shift(const ModalModel& model, double cell_s) noexcept {
  const double gain = model.filter().gain;
  return model.is_square() ? 0.0 : gain * gain * cell_s;
}

void PulseTurn::start() noexcept {
  best_ = {};
  next_ = 0;
  done_ = false;
}

std::size_t PulseTurn::step(const PhiOperator& phi, Signs signs,
                            Span<const double> product) noexcept {
  if (done_) {
    return 0;
  }
  if (next_ == 0) {
    best_.gain = 0.25 * kSmallestGain * abs(dot(signs, product));
  }
  std::size_t work = 0;
  while (next_ < signs.size() && work < kWorkOfPulses) {
    const std::size_t run_end = signs.run_end(next_);
    for (const double sign = signs[next_]; next_ < run_end && work < kWorkOfPulses; ++next_) {
      work += look_at_next(phi, run_end, sign, product);
    }
  }
  if (next_ == signs.size()) {
    turn_best(signs);
  }
  return work;
}

std::size_t PulseTurn::look_at_next(const PhiOperator& phi, std::size_t run_end, double sign,
                                    Span<const double> product) noexcept {
  const std::size_t left = run_end - next_;
  const std::size_t longest = left < PhiOperator::kMaxPulse ? left : PhiOperator::kMaxPulse;
  const double* value = product.from(next_).data();
  std::size_t work = 1;
  double held = 0.0;
  for (std::size_t k = 0; k < longest; ++k) {
    held += sign * value[k];
    if (phi.pulse_limit(k + 1) - held > best_.gain) {
      work += kWorkOfPulse;
      const double gain = phi.pulse(next_, k + 1) - held;
      if (gain > best_.gain) {
        best_ = {next_, k + 1, gain};
      }
    } else if (held > phi.greatest_pulse_limit()) {
      break;
    }
  }
  return work;
}

void PulseTurn::turn_best(Signs signs) noexcept {
  for (std::size_t i = best_.cell; i < best_.cell + best_.width; ++i) {
    signs.turn(i);
  }
  done_ = true;
}

Status EnergySearch::start(const ModalModel& model, const SearchSettings& settings) noexcept {
  if (!(settings.duration_s > 0.0) || !is_finite(settings.duration_s)) {
    return Status::kInvalidArgument;
  }
  const bool paper = settings.method == Method::kPaper;
  if (paper && (!(settings.step_s > 0.0) || !(settings.step_s <= settings.duration_s) ||
                settings.max_iterations == 0 || settings.max_iterations > kMaxIterations)) {
    return Status::kInvalidArgument;
  }
  const std::size_t cells = search_cells(model, settings);
  if (cells > kMaxCells) {
    return Status::kTooManyCells;
  }
  settings_ = settings;
  cells_ = cells;
  clear(result_);
  result_.cells = cells;
  trace_count_ = 0;
  unstorable_energy_ = -std::numeric_limits<double>::infinity();
  climbs_made_ = 0;
  climbs_ = paper ? 1 : kStarts + kPolishings;
  phase_ = Phase::kStart;
  has_result_ = false;
  is_lost_ = false;
  rounding_ = model.is_square() ? energy_rounding(model, settings.duration_s, 0, 0.0) : 0.0;
  shift_ = paper ? 0.0 : ascent_shift(model, settings.duration_s / static_cast<double>(cells));
  const double f0 = model.device().natural_frequency_hz;
  shortest_half_period_s_ = 0.5 / (f0 > 0.0 ? f0 : model.filter().band_hz);
  return look_at_one_sided(model);
}

/// Ends the search if the constant signal is known to be the best one.
Status EnergySearch::look_at_one_sided(const ModalModel& model) noexcept {
  const OneSidedResponse constant = one_sided_response(model, settings_.duration_s);
  if (!constant.holds) {
    return Status::kOk;
  }
  const KnownEnergy& known = constant.energy;
  climbs_ = 0;
  if (!(known.rounding <= kPermittedRounding * known.energy)) {
    return Status::kLostDigits;
  }
  has_result_ = true;
  result_.energy = known.energy;
  result_.rounding = known.rounding;
  result_.at_rest = true;
  // Cannot fail: no times.
  (void)result_.signal.set(Span<const double>(), settings_.duration_s);
  return check_delay(model, known.energy, settings_.duration_s);
}

/// How far the result is known; where the closed form loses digits, by another form.
Status EnergySearch::finish(const ModalModel& model) noexcept {
  result_.rounding =
      energy_rounding(model, settings_.duration_s, result_.signal.count(), result_.energy);
  const double size = abs(result_.energy);
  if (!(result_.rounding <= kTrusted * size)) {
    return Status::kLostDigits;
  }
  if (model.moved_by() > 0.0 || !(result_.rounding <= kPermittedRounding * size)) {
    const EnergyAnswer answer = known_energy(model, result_.signal);
    if (answer.status != Status::kOk) {
      return answer.status;
    }
    result_.energy = answer.known.energy;
    result_.rounding = answer.known.rounding;
  }
  return check_delay(model, result_.energy, settings_.duration_s);
}

double EnergySearch::progress() const noexcept {
  return climbs_ == 0 ? 1.0 : static_cast<double>(climbs_made_) / static_cast<double>(climbs_);
}

Status EnergySearch::step(const ModalModel& model, GridWorkspace& workspace,
                          Span<double> trace) noexcept {
  if (done()) {
    return Status::kOk;
  }
  PhiOperator phi;
  (void)phi.set(model, settings_.duration_s, cells_);  // `start()` has seen that both are valid.
  for (std::size_t work = 0; work < kWorkPerStep && !done();) {
    work += step_once(phi, model, workspace, trace);
  }
  // A signal with more switches than the table holds must not be passed over in silence if it beats
  // all others.
  const bool lost = !has_result_ || unstorable_energy_ > result_.energy;
  if (!done()) {
    return Status::kOk;
  }
  if (is_lost_) {
    return Status::kLostDigits;
  }
  return lost ? Status::kTooManySwitches : finish(model);
}

/// @returns What it has cost, in cells of a product.
std::size_t EnergySearch::step_once(const PhiOperator& phi, const ModalModel& model,
                                    GridWorkspace& workspace, Span<double> trace) noexcept {
  switch (phase_) {
    case Phase::kStart:
      begin_climb(phi, workspace);
      return cells_;
    case Phase::kClimb:
      fixed_point_.step(phi, workspace.signs(cells_), workspace.best_signs(cells_),
                        workspace.product(cells_), trace);
      if (fixed_point_.done()) {
        end_fixed_point(trace.size());
      }
      return cells_;
    case Phase::kTurn:
      return step_turn(phi, model, workspace);
    case Phase::kRefine:
      refiner_.step(model, workspace.signal(), workspace.refinement());
      if (refiner_.done()) {
        end_refinement(workspace.signal());
      }
      return kWorkOfRefinement * (workspace.signal().count() + 1);
  }
  return 0;
}

/// The start of the climb that comes next.
void EnergySearch::set_start(const PhiOperator& phi, Signs signs, Span<double> product) noexcept {
  std::size_t index = climbs_made_;
  if (settings_.method == Method::kPaper) {
    signs_of_column(phi, 0, signs, product);
    return;
  }
  if (index == 0) {
    for (std::size_t i = 0; i < signs.size(); ++i) {
      signs.set(i, true);
    }
    return;
  }
  index -= 1;
  if (index < kColumnStarts) {
    signs_of_column(phi, index * cells_ / kColumnStarts, signs, product);
    return;
  }
  index -= kColumnStarts;
  if (index < kHalfPeriods) {
    // Half-periods in equal ratios from the shortest to T.
    const double part = static_cast<double>(index) / (kHalfPeriods - 1.0);
    const double half_period_s =
        shortest_half_period_s_ * exp(part * log(settings_.duration_s / shortest_half_period_s_));
    const double cell_s = settings_.duration_s / static_cast<double>(cells_);
    for (std::size_t i = 0; i < signs.size(); ++i) {
      const double half = 0.5 * floor((static_cast<double>(i) + 0.5) * cell_s / half_period_s);
      signs.set(i, half == floor(half));
    }
    return;
  }
  index -= kHalfPeriods;
  WichmannHill random;
  (void)random.seed(Generator::k2006, Span<const std::uint32_t>(kRandomSeed));
  random.jump(index * kNumbersPerPattern);
  for (std::size_t i = 0; i < signs.size(); ++i) {
    signs.set(i, !(random.next() < 0.5));
  }
}

/// The best signal on the cells of the grid: each takes the sign in its middle.
void EnergySearch::set_to_result(Signs signs) const noexcept {
  const Span<const double> times_s = result_.signal.times_s();
  const double cell_s = settings_.duration_s / static_cast<double>(cells_);
  std::size_t passed = 0;
  for (std::size_t i = 0; i < signs.size(); ++i) {
    while (passed < times_s.size() && times_s[passed] <= (static_cast<double>(i) + 0.5) * cell_s) {
      ++passed;
    }
    signs.set(i, passed % 2 == 0);
  }
}

void EnergySearch::begin_climb(const PhiOperator& phi, GridWorkspace& workspace) noexcept {
  turns_ = 0;
  workspace.share_nothing();
  if (is_polishing()) {
    set_to_result(workspace.signs(cells_));
  } else {
    ++result_.starts;
    set_start(phi, workspace.signs(cells_), workspace.product(cells_));
  }
  run_fixed_point();
}

void EnergySearch::run_fixed_point() noexcept {
  const bool paper = settings_.method == Method::kPaper;
  fixed_point_.start(paper ? settings_.max_iterations : kClimbIterations, shift_);
  phase_ = Phase::kClimb;
}

/// @param[in] room Of the trace.
void EnergySearch::end_fixed_point(std::size_t room) noexcept {
  const FixedPointResult& run = fixed_point_.result();
  trace_count_ = run.iterations + 1 < room ? run.iterations + 1 : room;
  climb_energy_ = run.energy;
  // No later climb finds thousands of times as much.
  if (rounding_ > 0.0 && !(run.energy > rounding_)) {
    is_lost_ = true;
    climbs_made_ = climbs_;
  }
  if (turns_ == 0) {
    iterations_ = run.iterations;
    at_rest_ = run.at_rest;
  }
  pulse_turn_.start();
  phase_ = Phase::kTurn;
}

/// Turns a pulse and lets the fixed point run again, or ends the climb if none gains any more.
std::size_t EnergySearch::step_turn(const PhiOperator& phi, const ModalModel& model,
                                    GridWorkspace& workspace) noexcept {
  if (settings_.method == Method::kPaper || turns_ == kMaxTurns) {
    end_climb(model, workspace);
    return 0;
  }
  const std::size_t work =
      pulse_turn_.step(phi, workspace.signs(cells_), workspace.product(cells_));
  if (!pulse_turn_.done()) {
    return work;
  }
  if (pulse_turn_.turned()) {
    ++turns_;
    run_fixed_point();
  } else {
    end_climb(model, workspace);
  }
  return work;
}

void EnergySearch::end_climb(const ModalModel& model, GridWorkspace& workspace) noexcept {
  SwitchingSignal& candidate = workspace.signal();
  if (candidate.set_signs(workspace.signs(cells_), settings_.duration_s) != Status::kOk) {
    unstorable_energy_ = climb_energy_ > unstorable_energy_ ? climb_energy_ : unstorable_energy_;
  } else if (settings_.method == Method::kPaper) {
    take(candidate, energy(model, candidate));
  } else if (is_polishing() || is_worth_refining(climb_energy_)) {
    refiner_.start(candidate);
    phase_ = Phase::kRefine;
    return;
  }
  next_climb();
}

void EnergySearch::end_refinement(const SwitchingSignal& refined) noexcept {
  const double before = result_.energy;
  take(refined, refiner_.result().energy);
  // The grid has nothing more to offer.
  if (is_polishing() && !(result_.energy > before + kSame * abs(before))) {
    climbs_made_ = climbs_ - 1;
  }
  next_climb();
}

void EnergySearch::next_climb() noexcept {
  if (!is_polishing()) {
    ends_[climbs_made_] = climb_energy_;
  }
  ++climbs_made_;
  // Nothing to polish.
  if (climbs_made_ == kStarts && !has_result_) {
    climbs_made_ = climbs_;
  }
  phase_ = Phase::kStart;
}

/// Whether the end of a climb is near the highest so far, and not that of an earlier climb.
bool EnergySearch::is_worth_refining(double energy) const noexcept {
  double highest = energy;
  for (const double end : Span<const double>(ends_).first(climbs_made_)) {
    if (abs(energy - end) <= kSame * abs(energy)) {
      return false;
    }
    highest = end > highest ? end : highest;
  }
  return !has_result_ || energy >= highest - kWorthRefining * abs(highest);
}

/// Makes a signal the result if it is better.
void EnergySearch::take(const SwitchingSignal& signal, double energy) noexcept {
  if (has_result_ && !(energy > result_.energy)) {
    return;
  }
  has_result_ = true;
  result_.energy = energy;
  result_.signal = signal;
  if (climbs_made_ < kStarts) {
    result_.iterations = iterations_;
    result_.at_rest = at_rest_;
  }
}

}  // namespace emax
